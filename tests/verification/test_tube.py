"""A tube from a STEP file: the limit point of its inflation, and how far it sags under its weight.

The radii are 4 and 6 mm, the length is 100 mm, and walls of 4 mm close both ends. Incompressible neo-Hooke tube: the
pressure is the integral of (hoop - radial stress) / r, at the axial stretch at which the ends carry it (A. E. Green, W.
Zerna, "Theoretical elasticity", 2nd ed. 1968). Weight: a bar without shear, (EI theta')' = W cos(theta), where W is the
weight of what is farther out.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, quad
from scipy.optimize import brentq, minimize_scalar

from pipeline.config.load import load_config
from pipeline.simulate.outcome import Outcome
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from tests.solved import alone

FILE = Path(__file__).resolve().parents[1] / "data" / "tube.step"
INNER, OUTER, LENGTH, WALL = 4.0, 6.0, 100.0, 4.0  # mm; the last one of the ends
MU, NU, DENSITY = 0.1, 0.49, 1070e-9  # MPa, 1, kg/mm3


def bent(folder: Path, lines: str) -> Outcome:
    path = folder / "tube.yaml"
    geometry = f"geometry: {{family: own, file: {FILE}, curve: -5 mm}}"
    path.write_text(f"name: tube\n{geometry}\nmesh: {{size: 5 mm}}\n{lines}\n", encoding="utf-8")
    scene = Scene.meshed(config := load_config(path))
    with alone(folder / "out", config) as context:
        return simulate(scene, context, ("II",))["II"]


def largest_pressure() -> float:
    """Of the tube in closed form, MPa."""

    def integral(inside: float, along: float, axial: bool) -> float:
        def of(start: float) -> float:
            square = (inside * INNER) ** 2 + (start**2 - INNER**2) / along
            hoop, radial = square / start**2, start**2 / (square * along**2)
            return (2 * along**2 - hoop - radial if axial else (hoop - radial) / square) * start / along

        return quad(of, INNER, OUTER)[0]

    def pressure(inside: float) -> float:
        return MU * integral(inside, brentq(lambda along: integral(inside, along, True), 0.5, 3.0), False)

    return -minimize_scalar(lambda inside: -pressure(inside), bounds=(1.1, 3.0), method="bounded").fun


def test_the_limit_point_of_a_tube(tmp_path: Path) -> None:
    """30.38 kPa; elements of 5 mm are stiffer."""
    assert largest_pressure() == pytest.approx(30.38e-3, rel=1e-3)
    outcome = bent(
        tmp_path, f"material: {{law: neo_hooke, mu: {MU} MPa, nu: 0.4999}}\npressures: [10 kPa, 28 kPa, 40 kPa]"
    )
    assert [record.state.pressure_kPa for record in outcome.records] == [10.0, 28.0]
    assert {"limit_point", "has_limit"} <= {reason.code for reason in outcome.failure.reasons}
    assert outcome.failure.limit_kPa == pytest.approx(1e3 * largest_pressure(), rel=4e-3)


def test_a_tube_sags_under_its_weight(tmp_path: Path) -> None:
    """By 32.8 mm."""
    law = f"{{law: neo_hooke, mu: {MU} MPa, nu: {NU}, density: 1070 kg/m^3}}"
    outcome = bent(tmp_path, f"material: {law}\npressures: [0.01 kPa]\neffects: {{gravity: on}}")
    s = np.linspace(0.0, LENGTH, 401)
    inner = np.where((s > WALL) & (s < LENGTH - WALL), INNER, 0.0)
    weight = DENSITY * 9.81 * np.pi * (OUTER**2 - inner**2)  # N/mm
    rigidity = 2 * MU * (1 + NU) * np.pi / 4 * (OUTER**4 - inner**4)
    beyond = np.trapezoid(weight, s) - cumulative_trapezoid(weight, s, initial=0.0)  # N, that of what is farther out
    angle = np.zeros_like(s)
    for _ in range(100):
        moment = cumulative_trapezoid((beyond * np.cos(angle))[::-1], s, initial=0.0)[::-1]
        angle = 0.5 * angle - 0.5 * cumulative_trapezoid(moment / rigidity, s, initial=0.0)
    (record,) = outcome.records
    assert record.state.end_mm[1] + 5.0 == pytest.approx(np.trapezoid(np.sin(angle), s), rel=0.015)
    assert record.state.end_mm[1] + 5.0 == pytest.approx(-32.8, rel=5e-3)
