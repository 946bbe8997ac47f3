"""What threads and sheets do to an arm, as its law tells it."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import pneurod
from pipeline.config.load import load_config
from pipeline.law.layers import growth_of, largest_pull
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.results.files import read_results
from pipeline.results.verdict import verdict_of
from pipeline.simulate.scene import Scene

TUBE = f"""
name: tube
geometry: {{family: own, file: {Path(__file__).resolve().parents[2] / "data" / "tube.step"}, curve: -5 mm, clamp: 0 mm, tip: 100 mm}}
material: {{law: neo_hooke, mu: 0.1 MPa, nu: 0.4999}}
pressures: [40 kPa]
mesh: {{size: 5 mm}}
effects: {{hoops: {{threads: {{EA: 4 kN, pitch: 2 mm}}}}}}
"""  # noqa: E501 - one line of YAML
THIN_END = """
name: thin_end
geometry: {family: semicircular_single, length: 40 mm, end_wall: 1 mm}
material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.4999}
pressures: [15 kPa, 60 kPa]
mesh: {size: 6 mm}
law: cell
effects: {hoops: {threads: {EA: 40 N, pitch: 2 mm}}}
"""
MU, INNER, OUTER = 0.1, 5.0, 6.0


def loop_force(pressure: float) -> float:
    """N/mm, of loops that do not stretch about a closed incompressible neo-Hookean tube, which grows longer."""

    def inside(longer: float) -> float:
        return float(np.sqrt(OUTER**2 - (OUTER**2 - INNER**2) / longer))

    def differences(r: float, longer: float) -> tuple[float, float]:
        """Hoop and axial stress less the radial one."""
        around = r / np.sqrt(OUTER**2 - longer * (OUTER**2 - r**2))
        radial = (1.0 / (longer * around)) ** 2
        return MU * (around**2 - radial), MU * (longer**2 - radial)

    def radial(r: float, longer: float) -> float:
        return -pressure + float(quad(lambda t: differences(t, longer)[0] / t, inside(longer), r)[0])

    def thrust(longer: float) -> float:
        axial = quad(lambda r: (radial(r, longer) + differences(r, longer)[1]) * r, inside(longer), OUTER)[0]
        return float(axial - pressure * inside(longer) ** 2 / 2.0)

    return -radial(OUTER, brentq(thrust, 1.0, 4.0)) * OUTER


def test_the_force_of_a_thread_is_that_of_a_wound_tube(tmp_path: Path) -> None:
    """Its section stays round, and as wide as it was."""
    (tmp_path / "tube.yaml").write_text(TUBE)
    cell = ArmPieces.of(Scene.meshed(load_config(tmp_path / "tube.yaml"))).cell
    state = cell_without_moment(cell, 0.04).state
    [(pull, _)] = largest_pull(cell, state)
    assert pull == pytest.approx(loop_force(0.04), rel=0.03)
    assert growth_of(cell, state) == pytest.approx((1.0, 1.0), abs=2e-3)


def test_a_verdict_tells_the_thread_what_bulges_and_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "thin.yaml").write_text(THIN_END)
    with pytest.raises(pneurod.RunFailed, match="the free end has no form at 60 kPa"):
        pneurod.characterize(tmp_path / "thin.yaml", tmp_path / "out", draft=True, jobs=1)
    run = read_results(tmp_path / "out")
    assert run.law.layers is not None
    layers = run.law.layers
    assert layers.pressure_kPa == 15.0
    assert layers.bending_deg == pytest.approx(run.law.unloaded[-1].bending_deg, rel=0.02)
    assert layers.without_deg["hoops"] is None  # a soft half disc alone is a balloon
    assert "without the thread it bulges" in layers.text
    assert layers.text in verdict_of(run).lines
    assert layers.stretch_at.partition("mm from ")[2].startswith("its end")
    assert "no thread runs across its plate" in (tmp_path / "out" / "law.json").read_text(encoding="utf-8")
