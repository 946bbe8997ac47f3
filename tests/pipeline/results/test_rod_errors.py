"""How wrong rods are: errors over all loads, the order of the rods, and what an error of the mesh does to the tip."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.results.rod_errors import RodErrors, mesh_errors, rod_errors, tip_moves_by
from pipeline.values.law import LawMeshError
from pipeline.values.run import Curve, RodError
from tests.coarse import coarse_run


def row(rod: str, distance: float, force: float | None = None, force_N: float | None = None, **more: str) -> RodError:
    return RodError("III", 10.0, rod=rod, distance_over_length=distance, force_error=force, force_N=force_N, **more)


def test_the_force_is_relative_to_the_largest_of_all_loads() -> None:
    rows = (row("five", 0.01, 0.5, 0.1), row("five", 0.02, -0.1, 2.0, sample="out"), row("arm_law", 0.0, 0.0, 4.0))
    errors = RodErrors.of(replace(coarse_run(), rod_errors=rows), "five")
    assert (errors.loads_in_sample, errors.loads_out_of_sample) == (1, 1)
    assert errors.force_error_in_sample == pytest.approx(0.5 * 0.1 / 4.0)
    assert errors.force_error_out_of_sample == pytest.approx(0.1 * 2.0 / 4.0)
    assert (errors.shape, errors.force) == (0.02, pytest.approx(0.05))


def test_the_rod_to_take_is_first() -> None:
    exact, lost = row("arm_law", 0.001), row("arm_law", 0.0, reason="no equilibrium")
    for rows, first in (((row("five", 0.02), exact), "arm_law"), ((row("five", 0.02), lost), "five")):
        assert rod_errors(replace(coarse_run(), rod_errors=rows))[0].rod == first
    far = (row("five", 0.3), replace(exact, distance_over_length=0.05, reason="no equilibrium"), exact)
    assert rod_errors(replace(coarse_run(), rod_errors=far))[0].rod == "arm_law"


def test_a_load_that_a_rod_does_not_bear_does_not_make_the_other_rods_better() -> None:
    lost = row("arm_law", 0.0, reason="beyond the law")
    rows = (row("five", 0.02), row("five", 0.02), row("arm_law", 0.001), lost)
    assert rod_errors(replace(coarse_run(0.01), rod_errors=rows))[0].rod == "arm_law"
    most = (*rows, row("five", 0.02), lost)  # of three loads it bears one
    assert rod_errors(replace(coarse_run(0.01), rod_errors=most))[0].rod == "five"


def test_a_rod_that_is_far_nearer_in_shape_is_not_behind_one_that_is_little_nearer_in_force() -> None:
    five, law = row("five", 0.06, 0.02, 1.0), row("arm_law", 0.001, 0.07, 1.0)
    assert [errors.rod for errors in rod_errors(replace(coarse_run(), rod_errors=(five, law)))] == ["arm_law", "five"]
    closer = replace(five, distance_over_length=0.002, force_error=0.01)
    assert rod_errors(replace(coarse_run(), rod_errors=(closer, law)))[0].rod == "five"


def test_errors_of_the_mesh_are_relative_to_their_values() -> None:
    errors = mesh_errors(coarse_run(0.03), "arm_law")
    assert errors.kappa_0 == pytest.approx(0.03)
    assert errors.largest == pytest.approx(0.03)
    assert mesh_errors(coarse_run(), "five").largest is None  # no second mesh was solved


def test_a_small_curvature_is_no_measure_of_its_error() -> None:
    run = coarse_run()
    assert run.law is not None
    error = LawMeshError(pressures_kPa=(5.0,), kappa_0_per_mm=(1e-9,), kappa_0_per_mm_std=(1e-5,))
    small = mesh_errors(replace(run, law=replace(run.law, mesh_error=error)), "arm_law")
    assert small.kappa_0 == pytest.approx(1e-5 / (0.1 / 112.0))


@pytest.mark.parametrize("relative", [1e-3, 0.05])
def test_the_tip_of_an_arc_moves_as_its_closed_form_says(relative: float) -> None:
    length, kappa = 80.0, -0.02
    s = np.linspace(0.0, length, 400)

    def tip(curvature: float) -> np.ndarray:
        return np.array([np.sin(curvature * length), 1.0 - np.cos(curvature * length)]) / curvature

    curve = Curve("II", 10.0, {"s_mm": s, "theta_rad": kappa * s})
    expected = np.linalg.norm(tip(kappa * (1.0 + relative)) - tip(kappa)) / length
    assert tip_moves_by(curve["s_mm"], curve["theta_rad"], kappa * relative) == pytest.approx(expected, rel=1e-3)
