"""The verdict follows from the shape and the force of one rod, in parts of its length and of its largest force.

Designs drawn at random are those of studies/unseen_designs.csv, which `make unseen` has solved.
"""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.results.rod_errors import uncertain_forces
from pipeline.results.verdict import Verdict, verdict_of
from pipeline.values.errors import RunFailed
from pipeline.values.law import LawMeshError
from pipeline.values.run import Curve, Reported, RodError, Run
from tests.coarse import coarse_run

DESIGNS = Path(__file__).resolve().parents[3] / "studies" / "unseen_designs.csv"
LENGTH = 112.0
#: the moments that bend a cell, N mm
MOMENTS = (0.0, 4.0)


def row(rod: str, shape: float, force: float, pressure: float = 20.0, reason: str = "") -> RodError:
    if reason:
        return RodError("dead", pressure, "dead force 0, -1 N", rod, "out", reason=reason)
    return RodError("III", pressure, "", rod, "in", distance_over_length=shape, force_error=force, force_N=1.0)


def of_mesh(kappa_0: float, moment: float, rigidity: float = 0.0) -> LawMeshError:
    """Of an arm whose curvature and moment pass through zero; parts of the largest curvature, moment and rigidity."""
    return LawMeshError(
        4.0,
        2.0,
        (17.0, 37.0),
        kappa_0_per_mm=(1e-9, 0.02),
        kappa_0_per_mm_std=(0.02 * kappa_0, 0.02 * kappa_0),
        rigidity_N_mm2=(250.0, 250.0),
        rigidity_N_mm2_std=(250.0 * rigidity, 0.0),
        moment_N_mm=MOMENTS,
        moment_N_mm_std=(4.0 * moment, 4.0 * moment),
    )


def straight(run: Run) -> Run:
    """The run of a straight arm, whose end a curvature moves by a closed form, without a mass."""
    s = np.linspace(0.0, LENGTH, 200)
    assert run.law is not None
    law = replace(run.law, law=replace(run.law.law, mass=None))
    return replace(
        run, curves=(Curve("II", 20.0, {"s_mm": s, "x_mm": s, "y_mm": 0.0 * s, "theta_rad": 0.0 * s}),), law=law
    )


def moved(kappa: float) -> float:
    """The tip of a straight arm over its length, by a curvature."""
    turn = kappa * LENGTH
    return math.hypot(math.sin(turn) / turn - 1.0, (1.0 - math.cos(turn)) / turn) if turn else 0.0


def judged(run: Run, *rows: RodError, mesh: LawMeshError | None = None) -> Verdict:
    assert run.law is not None
    return verdict_of(replace(run, rod_errors=rows, law=replace(run.law, mesh_error=mesh)))


def check(verdict: Verdict, shape: float, force: float) -> None:
    """Taken within 5 % of the length and 10 % of the force; else both errors are the reason."""
    line = verdict.lines[1]
    if shape <= 0.05 and force <= 0.10:
        assert verdict.usable
        assert line.startswith("Take the rod with ")
        assert verdict.shape_error == pytest.approx(shape, rel=1e-2)
    else:
        assert not verdict.usable
        assert line.startswith("Do not use a rod of this run: error of the shape ")
        assert verdict.refusal is not None
        assert verdict.refusal.values["shape_percent"] == pytest.approx(100.0 * shape, rel=1e-2)
        assert verdict.refusal.values["force_percent"] == pytest.approx(100.0 * force, rel=1e-2)
    assert "of the length, of the force" in line


def drawn() -> list[tuple[float, float, float, float, float]]:
    """Shape and force of the rod, and curvature, force and rigidity of the mesh, of the designs that have all."""
    keys = ("shape_error", "force_error", "kappa_0_mesh_error", "force_mesh_error", "alpha2_mesh_error")
    rows = list(csv.DictReader(DESIGNS.read_text(encoding="utf-8").splitlines()))
    numbers = [tuple(abs(float(one[key] or 0.0)) for key in keys) for one in rows if one["shape_error"]]
    return [(a, b, c, d, e) for a, b, c, d, e in numbers]


def test_designs_drawn_at_random() -> None:
    run, random = straight(coarse_run()), np.random.default_rng(20261130)
    designs = drawn()
    assert len(designs) > 400
    taken = 0
    for shape, force, kappa_0, of_force, rigidity in (designs[k] for k in random.permutation(len(designs))[:150]):
        for larger in (1.0, float(random.uniform(2.0, 40.0))):  # and as if the rod were worse
            a, b = larger * shape, larger * force
            verdict = judged(run, row("arm_law", a, b), mesh=of_mesh(kappa_0, of_force, rigidity))
            check(verdict, a + moved(0.02 * kappa_0), b + of_force)
            taken += verdict.usable
    assert 100 < taken < 290


def test_of_two_rods_one_that_is_good_is_taken() -> None:
    run, random = straight(coarse_run()), np.random.default_rng(7)
    for _ in range(60):
        sizes = random.uniform(0.0, 0.08, 2), random.uniform(0.0, 0.16, 2)
        rows = [row(rod, a, b) for rod, a, b in zip(("arm_law", "five"), *sizes, strict=True)]
        lost = [row(("arm_law", "five")[random.integers(2)], 0.0, 0.0, reason="beyond its law") for _ in range(2)]
        verdict = judged(run, *rows, *lost, mesh=of_mesh(1e-4, 1e-4))
        good = (sizes[0] < 0.0497) & (sizes[1] < 0.0999)
        assert verdict.usable == good.any()
        assert not good.any() or good[("arm_law", "five").index(verdict.rod)]


def test_a_load_that_the_rod_does_not_bear_is_said_beside() -> None:
    rows = row("five", 0.019, 0.024), row("arm_law", 0.0002, 0.005), row("arm_law", 0.0, 0.0, 14.0, "beyond the law")
    verdict = judged(straight(coarse_run()), *rows, mesh=of_mesh(0.006, 0.005))
    assert (verdict.rod, verdict.usable) == ("arm_law", True)
    assert verdict.lines[1].startswith("Take the rod with the arm's own law: error of the shape 0.69 % of the length")
    assert "It does not bear 1 of 2 loads, such as dead force 0, -1 N, 14 kPa." in verdict.lines[2]


def test_one_rigidity_at_one_pressure_is_a_note() -> None:
    run = straight(coarse_run())
    verdict = judged(run, row("arm_law", 0.03, 0.05), mesh=of_mesh(0.006, 0.005, rigidity=0.13))
    assert verdict.usable
    (note,) = (one for one in verdict.warnings if one.code == "forces_uncertain")
    assert note.text == "Forces are uncertain by up to 13 % at 17 kPa because of the mesh; shapes hold."
    assert run.law is not None
    crossing = replace(run, law=replace(run.law, mesh_error=of_mesh(0.1, 0.05)))
    assert uncertain_forces(crossing, "arm_law") is None  # a moment of zero is uncertain by more than itself


def with_remarks(run: Run, *remarks: Reported) -> Run:
    return replace(run, record=replace(run.record, remarks=remarks))


def test_remarks_on_five_parameters_are_not_those_of_the_law() -> None:
    poor = Reported("one_rigidity_poor", {}, None, "R² is 0.00 at 14 kPa.")
    run = with_remarks(straight(coarse_run()), poor)
    law = judged(run, row("five", 0.03, 0.02), row("arm_law", 0.001, 0.001), mesh=of_mesh(1e-4, 1e-4))
    five = judged(run, row("five", 0.001, 0.001), row("arm_law", 0.03, 0.02), mesh=of_mesh(1e-4, 1e-4))
    assert (law.rod, five.rod) == ("arm_law", "five")
    assert poor not in law.warnings
    assert poor in five.warnings
    assert "the arm's own law" not in " ".join(five.lines)


def test_an_arm_that_falls_over_does_not_bend() -> None:
    text = "The arm falls over in its plane (along y): its equilibrium at 30 kPa (II) is unstable; make it shorter."
    falls = Reported("unstable_states", {"experiment": "II", "pressure_kPa": 30.0, "directions": 1}, None, text)
    lost = Reported("not_identified", {}, None, "No five parameters at 30 kPa: the moment turns back.")
    run = coarse_run()
    run = replace(run, record=replace(run.record, remarks=(falls,), failures=(lost,)), rod_errors=(), law=None)
    verdict = verdict_of(run)
    assert verdict.lines[0] == f"pneunet_coarse, 112 mm long: {text}"
    assert "bends by 74° at 17 kPa" in verdict.lines[1]
    assert not any("turns back" in line or "lower pressures" in line for line in verdict.lines)
    assert falls not in verdict.warnings
    with pytest.raises(RunFailed) as raised:
        run.raise_if_failed()
    assert raised.value.brief.startswith(text)
