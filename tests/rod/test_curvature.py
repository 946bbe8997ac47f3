"""Curvature of a material curve: cell averages and Gaussian process (paper, equation (6))."""

import dataclasses

import numpy as np
import pytest

from geometry import Centreline
from rod import RodError, Smoothing, cell_averaged, gaussian_process, shared_smoothing, shortest_pitch
from rod.curves.curve import fine_grid, mean_angle_weights, moment_from_load
from rod.curves.gaussian_process import _derivative_posterior
from rod.law import FiveParameters
from rod.load import Load
from tests.synthetic_arm import SyntheticArm, exact_curvature

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


def by_process(curve):
    return gaussian_process(curve, shared_smoothing([curve], PITCH))


def test_cells_of_a_circle():
    curvature = cell_averaged(arc(0.03), PITCH)
    assert curvature.kappa == pytest.approx(0.03, abs=1e-12)
    assert curvature.theta == pytest.approx(0.03 * curvature.s, abs=1e-12)
    assert (curvature.s[0], curvature.s[-1]) == pytest.approx((5.5, 101.5))


def test_process_on_a_circle():
    curvature = by_process(arc(0.03))
    assert curvature.kappa == pytest.approx(0.03, rel=1e-3)
    assert curvature.theta == pytest.approx(0.03 * curvature.s, abs=1e-3)


@pytest.mark.parametrize("estimate", [lambda c: cell_averaged(c, PITCH), by_process])
def test_linear_curvature_is_found_and_reversed_with_the_curve(estimate):
    curve = clothoid()
    curvature = estimate(curve)
    assert curvature.kappa == pytest.approx(0.01 + 3e-4 * curvature.s, abs=1e-4)
    mirrored = estimate(Centreline(curve.s, curve.x, -curve.y))
    assert mirrored.kappa == pytest.approx(-curvature.kappa, abs=1e-6)


def test_a_ripple_with_the_pitch_does_not_change_cell_averages():
    arm = SyntheticArm(LAW, ripple=0.3, phase=1.0)
    rest, _, _ = arm.curves()
    assert cell_averaged(rest, PITCH).kappa == pytest.approx(0.03, rel=1e-4)
    assert by_process(rest).kappa == pytest.approx(0.03, rel=0.03)


@pytest.mark.parametrize("estimate", [lambda c: cell_averaged(c, PITCH), by_process])
def test_resolution_says_what_the_estimate_sees_of_a_step(estimate):
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
    if estimate is by_process:
        smoothing = Smoothing(30.0, 20.0, 0.005, 0.0, PITCH, at_bound=False)
        free, loaded = (gaussian_process(c, smoothing) for c in curves)
    else:
        free, loaded = (estimate(c) for c in curves)
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


def test_derivatives_of_the_derivative_posterior_against_finite_differences():
    """The mean's derivatives, by differencing means that include an added point without data."""
    smoothing = Smoothing(5.0, 20.0, 0.01, 0.0, PITCH, at_bound=False)
    s = np.linspace(0.0, 100.0, 51)
    values = np.sin(s / 15.0) + 0.1 * np.cos(s / 9.0)
    maps, _ = _derivative_posterior(s, smoothing)

    def mean(at):
        kernel = smoothing.amplitude**2 * np.exp(-0.5 * ((at[:, None] - s[None, :]) / smoothing.length_scale) ** 2)
        own = smoothing.amplitude**2 * np.exp(-0.5 * ((s[:, None] - s[None, :]) / smoothing.length_scale) ** 2)
        noise = smoothing.noise**2 + 1e-14 * smoothing.amplitude**2
        return kernel @ np.linalg.solve(own + noise * np.eye(len(s)), values)

    h = 0.05
    assert maps[1] @ values == pytest.approx((mean(s + h) - mean(s - h)) / (2 * h), abs=1e-6)
    assert maps[2] @ values == pytest.approx((mean(s + h) - 2 * mean(s) + mean(s - h)) / h**2, abs=1e-5)


def test_covariance_of_the_derivatives_against_draws_of_the_process():
    """Draws of the prior with noise; the posterior's errors have the covariance that is claimed."""
    smoothing = Smoothing(1.0, 20.0, 0.02, 0.0, PITCH, at_bound=False)
    s, h = np.linspace(0.0, 60.0, 25), 0.25
    at = np.concatenate([s, s + h, s - h])
    kernel = np.exp(-0.5 * ((at[:, None] - at[None, :]) / 20.0) ** 2)
    size, vectors = np.linalg.eigh(kernel)
    random = np.random.default_rng(1)
    draws = vectors @ (np.sqrt(np.maximum(size, 0.0))[:, None] * random.standard_normal((len(at), 4000)))
    f, ahead, behind = draws[:25], draws[25:50], draws[50:]
    maps, (c11, c12, c22) = _derivative_posterior(s, smoothing)
    measured = f + 0.02 * random.standard_normal(f.shape)
    first = maps[1] @ measured - (ahead - behind) / (2 * h)
    second = maps[2] @ measured - (ahead - 2 * f + behind) / h**2
    for claimed, a, b in ((c11, first, first), (c12, first, second), (c22, second, second)):
        scale = np.sqrt(np.mean(a**2) * np.mean(b**2))
        assert a @ b.T / a.shape[1] == pytest.approx(claimed, abs=0.25 * scale)


def test_standard_deviation_of_the_process_is_calibrated():
    """White noise on an arc: two thirds of the errors lie within one standard deviation, in the middle of the arm."""
    inside = []
    curves = [arc(0.02, noise=0.02, seed=seed) for seed in range(12)]
    smoothing = shared_smoothing(curves, PITCH)
    for curve in curves:
        curvature = gaussian_process(curve, smoothing)
        error = (curvature.kappa - 0.02) / curvature.kappa_std
        inside.append(np.mean(np.abs(error) < 1.0))
        assert np.abs(error).max() < 7.0
    assert 0.5 < np.mean(inside) < 0.98


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


def test_the_length_scale_keeps_the_rule_and_is_shared():
    free, loaded, _ = SyntheticArm(LAW, ripple=0.3).curves()
    smoothing = shared_smoothing([free, loaded], PITCH)
    assert smoothing.length_scale >= 1.5 * PITCH * 0.999
    tight = shared_smoothing([free, loaded], PITCH, shortest=4.0)
    assert tight.length_scale >= 40.0 * 0.999
    assert shared_smoothing([loaded, free], PITCH).length_scale == pytest.approx(smoothing.length_scale, rel=0.05)


def test_moment_by_equation_7():
    curve = arc(0.01)
    moment = moment_from_load(curve, Load((0.02, -0.05)))
    assert moment.value[-1] == 0.0
    assert moment.value[0] == pytest.approx(curve.x[-1] * -0.05 - curve.y[-1] * 0.02)
    assert moment_from_load(curve, Load(couple=2.0)).value == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: cell_averaged(arc(0.03), 0.0), r"The pitch of the cells must be positive, not 0\.0 mm"),
        (lambda: cell_averaged(arc(0.03), 50.0), r"needs three cells; a curve of 112 mm has no three of 50 mm"),
        (lambda: cell_averaged(arc(0.03), 1.5), r"Nodes 1 mm apart cannot resolve cells of 1\.5 mm"),
        (lambda: shared_smoothing([arc(0.03)], -1.0), r"The pitch and the smallest length scale must be positive"),
        (
            lambda: shared_smoothing([Centreline(NODES[:5], NODES[:5], NODES[:5])], 10.0),
            r"A Gaussian process needs at least 8 points along the curve; there are 5",
        ),
        (
            lambda: shared_smoothing([arc(0.03), Centreline(2 * NODES, NODES, NODES)], 10.0),
            r"must have the same points s; these are of different bodies",
        ),
        (
            lambda: exact_curvature(NODES[:4], NODES[:4], length=3.0, pitch=1.0),
            r"A curvature needs at least 6 points along the curve; there are 4",
        ),
    ],
)
def test_unusable_curves_are_refused(call, sentence):
    with pytest.raises(RodError, match=sentence):
        call()


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
