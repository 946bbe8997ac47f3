"""Curvature of a curve, averaged over cells, the rest shape of a rod, and the closure condition."""

import dataclasses

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import rod
from geometry import Centreline
from rod import RodError, cell_averaged, rest_curvature, shortest_pitch, without_stretch
from rod.curves.closure import CLOSURE_ERROR
from rod.curves.curve import fine_grid, mean_angle_weights, moment_from_load
from rod.law import FiveParameters
from rod.load import Load
from tests.synthetic_arm import SyntheticArm

PITCH = 10.0
NODES = np.linspace(0.0, 112.0, 113)
LAW = FiveParameters(200.0, 400.0, 0.0, 0.0, 11.0)


def arc(kappa, *, noise=0.0, seed=0):
    x, y = np.sin(kappa * NODES) / kappa, (1.0 - np.cos(kappa * NODES)) / kappa
    wobble = noise * np.random.default_rng(seed).standard_normal((2, len(NODES)))
    return Centreline(NODES, x + wobble[0], y + wobble[1])


def clothoid(a=0.01, b=3e-4):
    """A curve whose curvature is a + b s."""
    s = np.linspace(0.0, 112.0, 20001)
    theta = a * s + 0.5 * b * s**2
    h = s[1] - s[0]
    x = np.concatenate([[0.0], np.cumsum(0.5 * h * (np.cos(theta[1:]) + np.cos(theta[:-1])))])
    y = np.concatenate([[0.0], np.cumsum(0.5 * h * (np.sin(theta[1:]) + np.sin(theta[:-1])))])
    return Centreline(NODES, np.interp(NODES, s, x), np.interp(NODES, s, y))


def test_cells_of_a_circle():
    curvature = cell_averaged(arc(0.03), PITCH)
    assert curvature.kappa == pytest.approx(0.03, abs=1e-12)
    assert curvature.theta == pytest.approx(0.03 * curvature.s, abs=1e-12)
    assert (curvature.s[0], curvature.s[-1]) == pytest.approx((5.5, 101.5))


def test_linear_curvature_is_found_and_reversed_with_the_curve():
    curve = clothoid()
    curvature = cell_averaged(curve, PITCH)
    assert curvature.kappa == pytest.approx(0.01 + 3e-4 * curvature.s, abs=1e-4)
    mirrored = cell_averaged(Centreline(curve.s, curve.x, -curve.y), PITCH)
    assert mirrored.kappa == pytest.approx(-curvature.kappa, abs=1e-6)


def test_a_ripple_with_the_pitch_does_not_change_cell_averages():
    arm = SyntheticArm(LAW, ripple=0.3, phase=1.0)
    rest, _, _ = arm.curves()
    assert cell_averaged(rest, PITCH).kappa == pytest.approx(0.03, rel=1e-4)


def test_resolution_says_what_the_estimate_sees_of_a_step():
    """The difference of two curves with a step in their curvature, against the weights that the estimates carry."""
    grid = fine_grid(112.0)
    step = np.where(grid < 20.0, -0.01, -0.002)
    curves = []
    for kappa in (np.full(len(grid), 0.02), 0.02 + step):
        h = grid[1] - grid[0]
        theta = np.concatenate([[0.0], np.cumsum(kappa) * h])
        middle = 0.5 * (theta[1:] + theta[:-1])
        edges = np.linspace(0.0, 112.0, len(grid) + 1)
        x, y = (np.concatenate([[0.0], np.cumsum(f(middle)) * h]) for f in (np.cos, np.sin))
        curves.append(Centreline(NODES, np.interp(NODES, edges, x), np.interp(NODES, edges, y)))
    free, loaded = (cell_averaged(curve, PITCH) for curve in curves)
    predicted = 0.5 * (free.resolution + loaded.resolution) @ step
    assert loaded.kappa - free.kappa == pytest.approx(predicted, abs=2e-4)
    assert (
        np.abs(loaded.kappa - free.kappa - np.interp(free.s, grid, step)).max() > 2e-3
    )  # and it is not the step itself


def test_mean_angle_weights_integrate_a_linear_curvature():
    s = np.array([0.0, 0.7, 3.0, 10.0])
    theta = mean_angle_weights(s, 10.0) @ (2.0 + 0.3 * fine_grid(10.0))
    integral = 2.0 * s**2 / 2 + 0.3 * s**3 / 6  # of theta
    assert theta == pytest.approx(np.diff(integral) / np.diff(s), abs=1e-4)


def test_standard_deviation_of_cell_averages_is_calibrated():
    errors = []
    for seed in range(20):
        curvature = cell_averaged(arc(0.02, noise=0.01, seed=seed), PITCH)
        errors.append((curvature.kappa - 0.02) / curvature.kappa_std)
    assert np.std(errors) == pytest.approx(1.0, abs=0.15)


def test_ends_that_bend_quickly_do_not_widen_the_deviation_of_cell_averages_elsewhere():
    quiet, disturbed = arc(0.02, noise=1e-4, seed=3), arc(0.02, noise=1e-4, seed=3)
    s = disturbed.s - disturbed.s[0]
    disturbed = dataclasses.replace(disturbed, y=disturbed.y + 0.5 * np.exp(-((s / PITCH) ** 2) * 16.0))
    alone, beside = (cell_averaged(curve, PITCH) for curve in (quiet, disturbed))
    inside = (alone.s > 3 * PITCH) & (alone.s < alone.length - 3 * PITCH)
    np.testing.assert_allclose(beside.kappa_std[inside], alone.kappa_std[inside], rtol=1e-9)
    assert beside.kappa_std[0] > 5 * alone.kappa_std[0]
    assert np.sqrt(np.diag(beside.covariance))[inside].mean() > 2 * beside.kappa_std[inside].mean()


def test_moment_by_equation_7():
    curve = arc(0.01)
    moment = moment_from_load(curve, Load((0.02, -0.05)))
    assert moment.value[-1] == 0.0
    assert moment.value[0] == pytest.approx(curve.x[-1] * -0.05 - curve.y[-1] * 0.02)
    assert moment_from_load(curve, Load(couple=2.0)).value == pytest.approx(2.0)


def test_estimates_are_frozen_and_read_only():
    curvature = cell_averaged(arc(0.03), PITCH)
    with pytest.raises(dataclasses.FrozenInstanceError):
        curvature.pitch = 3.0  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        curvature.kappa[0] = 1.0


def test_the_shortest_pitch_is_averaged_over_and_a_shorter_one_refused() -> None:
    curve = arc(0.03)
    pitch = shortest_pitch(float(np.diff(curve.s).max()))
    assert cell_averaged(curve, pitch).pitch == pitch
    with pytest.raises(RodError, match="cannot resolve cells"):
        cell_averaged(curve, 0.999 * pitch)


def test_rest_curvature_gives_back_the_chords():
    free, _, _ = SyntheticArm(LAW, ripple=0.3, noise=0.002).curves(4)
    theta0, profile = rest_curvature(free)
    h, kappa = np.diff(free.s), profile[:, 1]
    # theta is the integral of straight pieces, and its mean over an interval the direction of the chord
    theta = theta0 + np.concatenate([[0.0], np.cumsum(h * (kappa[1:] + kappa[:-1]) / 2)])
    mean = theta[:-1] + h * (2 * kappa[:-1] + kappa[1:]) / 6
    assert mean == pytest.approx(free.angle, abs=1e-9)


def test_without_stretch_keeps_angles_and_rest_length():
    free, _, _ = SyntheticArm(LAW).curves()
    back = without_stretch(Centreline(free.s, 1.02 * free.x, 1.02 * free.y))
    assert np.hypot(np.diff(back.x), np.diff(back.y)) == pytest.approx(np.diff(free.s), rel=1e-4)  # chords of arcs
    assert back.x == pytest.approx(free.x, abs=1e-2)


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
