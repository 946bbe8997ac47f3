"""The closure condition: the movement of the end is the weighted mean of the curvature change."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import rod
from geometry import Centreline
from rod.curves.closure import CLOSURE_ERROR
from rod.curves.curve import fine_grid
from tests.synthetic_arm import SyntheticArm

STEP = rod.FiveParameters(200.0, 400.0, 0.0, 0.0, 11.0)


def test_the_weights_add_the_law_up_to_the_movement_of_the_end():
    """Without ripple and noise: exact for turns of more than a right angle, but for the grid."""
    free, loaded, load = SyntheticArm(STEP, kappa_0=0.025, node_spacing=0.5).curves()
    closure = rod.end_displacement_closure(free, loaded, load)
    assert closure.value == pytest.approx(free.y[-1] - loaded.y[-1], rel=1e-4)  # the force points down
    moment = rod.moment_from_load(loaded, load)
    grid = fine_grid(112.0)
    delta = STEP.deviation(grid, CubicSpline(moment.s, moment.value)(grid))
    assert closure.weights @ delta == pytest.approx(closure.value, rel=1e-3)
    assert closure.error == pytest.approx(CLOSURE_ERROR * closure.value)


def test_stretch_does_not_count():
    free, loaded, load = SyntheticArm(STEP, node_spacing=0.5).curves()
    longer = Centreline(loaded.s, 1.02 * loaded.x, 1.02 * loaded.y)
    assert rod.end_displacement_closure(free, longer, load).value == pytest.approx(
        rod.end_displacement_closure(free, loaded, load).value, rel=1e-9
    )


def rods_force(free, loaded, law):
    theta0, kappa_0 = rod.rest_curvature(free)
    return rod.Rod(112.0, kappa_0, law, theta0).solve(end_y=float(loaded.y[-1])).force[1]


@pytest.mark.parametrize("phase", [0.0, 0.5 * np.pi, np.pi])
def test_the_closed_numbers_predict_the_force(phase):
    """A ripple changes the closure at the clamp, where no cell average contains all of it."""
    arm = SyntheticArm(STEP, ripple=0.2, compliance_ripple=0.5, phase=phase, node_spacing=0.5)
    free, loaded, load = arm.curves()
    data = (
        rod.cell_averaged(free, 10.0),
        rod.cell_averaged(loaded, 10.0),
        rod.moment_from_load(rod.without_stretch(loaded), load),
    )
    open_end = rod.identify(*data, bootstrap=rod.Bootstrap(10)).law
    closed = rod.identify(*data, rod.end_displacement_closure(free, loaded, load), bootstrap=rod.Bootstrap(10)).law
    errors = [abs(rods_force(free, loaded, law) / load.force[1] - 1.0) for law in (open_end, closed)]
    assert errors[1] < max(0.5 * errors[0], 0.015)
