"""The estimators of a reader of the paper: what they give for rods with known parameters, and what they distort."""

import numpy as np
import pytest

from benchmarks.paper.free_lines import Subtracted, TestedCurves, paper_cells, paper_process
from benchmarks.paper.free_lines import single_rigidity_control as control
from geometry import Centreline
from rod import FiveParameters, Rod, RodError, TwoSlopes
from tests.synthetic_arm import SyntheticArm

LENGTH, PITCH = 112.0, 10.0


def curves_of(law: FiveParameters, noise: float = 0.0) -> TestedCurves:
    free, loaded, load = SyntheticArm(law, kappa_0=-0.0115, noise=noise).curves()
    return TestedCurves(free, loaded, load.force)


def test_means_over_a_pitch_widen_the_boundary_zone_and_make_it_softer() -> None:
    """The zone of 6.5 mm is read as 11 to 13 mm, for the first mean ends at 10 mm; the rest of the arm is right."""
    lines = paper_cells(curves_of(FiveParameters(190.0, 400.0, 0.0, 0.0, 6.5)), PITCH)
    assert 0.10 < lines.law.d / LENGTH < 0.12
    assert 28.0 < lines.law.alpha1 < 36.0
    assert lines.law.alpha2 == pytest.approx(400.0, rel=2e-3)
    assert lines.r2 > 0.999 > lines.single_r2


def test_means_over_a_pitch_give_a_single_rigidity_back() -> None:
    lines = paper_cells(curves_of(FiveParameters(290.0, 290.0, 0.0, 0.0, 50.0)), PITCH)
    assert lines.single_alpha == pytest.approx(290.0, rel=1e-3)
    assert lines.law.alpha2 == pytest.approx(290.0, rel=5e-3)
    assert lines.single_r2 > 0.9999


def test_the_process_makes_a_negative_slope_at_the_clamp_of_a_rod_with_one_rigidity() -> None:
    curves = curves_of(FiveParameters(290.0, 290.0, 0.0, 0.0, 50.0), noise=0.07)
    lines = paper_process(curves, 20.0)
    assert lines.law.alpha1 < 0.0
    assert 0.08 < lines.law.d / LENGTH < 0.2
    assert lines.law.alpha2 == pytest.approx(290.0, rel=0.1)
    assert lines.noise == pytest.approx((0.07, 0.07), rel=0.15)


def test_the_smoothing_alone_makes_two_sections_of_a_rod_with_one_rigidity() -> None:
    """Smoothed as an arm with noise of 0.07 mm, but without noise itself."""
    curves = curves_of(FiveParameters(190.0, 400.0, 0.0, 0.0, 6.5), noise=0.07)
    lines = control(curves, 20.0, 290.0, -0.0115)
    assert lines.law.alpha1 < 0.0
    assert lines.law.d / LENGTH == pytest.approx(0.13, abs=0.02)
    assert lines.law.alpha2 == pytest.approx(290.0, rel=0.05)
    assert lines.r2 > 0.99 > 0.95 > lines.single_r2


def test_what_is_subtracted_from_the_coordinates_decides_on_the_slope_at_the_clamp() -> None:
    """Of a rod with one rigidity, which the rest of the arm gives back if the chord is subtracted."""
    curves = curves_of(FiveParameters(290.0, 290.0, 0.0, 0.0, 50.0), noise=0.07)
    chord, both, mean = (paper_process(curves, 20.0, subtracted=s) for s in ("chord", "chord and mean", "mean"))
    assert chord.law.alpha1 < 1.1 * both.law.alpha1 < 0.0 < mean.law.alpha1
    assert [lines.law.alpha2 for lines in (chord, both)] == pytest.approx([290.0] * 2, rel=0.1)


@pytest.mark.parametrize("subtracted", ["chord", "chord and mean", "mean"])
def test_curvature_of_the_process_is_that_of_a_circle_without_noise(subtracted: Subtracted) -> None:
    """Away from the ends, where data lie on both sides; the moment of the same force follows from the shape."""
    s = np.linspace(0.0, LENGTH, 113)
    arcs = [Centreline(s, np.sin(k * s) / k, (1.0 - np.cos(k * s)) / k) for k in (0.01, 0.012)]
    points = paper_process(TestedCurves(arcs[0], arcs[1], (0.0, 0.1)), 20.0, subtracted=subtracted).points
    inner = (points[:, 0] > 25.0) & (points[:, 0] < LENGTH - 25.0)
    assert points[inner, 1] == pytest.approx(0.002, rel=3e-3)
    lever = arcs[1].x[-1] - np.interp(points[:, 0], s, arcs[1].x)
    assert points[:, 2] == pytest.approx(0.1 * lever, abs=1e-9)


def test_a_given_d_is_not_sought() -> None:
    curves = curves_of(FiveParameters(190.0, 400.0, 0.0, 0.0, 20.0))
    free = paper_cells(curves, PITCH)
    given = [paper_cells(curves, PITCH, d) for d in (14.0, 40.0)]
    assert [lines.law.d for lines in given] == [14.0, 40.0]
    assert max(lines.r2 for lines in given) < free.r2
    assert paper_process(curves, 20.0, 15.0).law.d == 15.0


def test_a_negative_slope_is_allowed_to_two_lines_and_their_rod_but_not_to_five_parameters() -> None:
    with pytest.raises(RodError, match="alpha1 is a rigidity and must be positive"):
        FiveParameters(-40.0, 300.0, 5.0, 0.0, 14.0)
    with pytest.raises(RodError, match="alpha1 is the slope of a line and must not be zero"):
        TwoSlopes(0.0, 300.0, 5.0, 0.0, 14.0)
    law = TwoSlopes(-40.0, 300.0, 5.0, 0.2, 14.0)
    rod = Rod(LENGTH, -0.0115, law)
    shape = rod.solve(end_y=0.0)
    assert shape.y[-1] == pytest.approx(0.0, abs=1e-9)
    before, beyond = shape.s < 14.0 - 1e-9, (shape.s > 14.0) & (shape.s < LENGTH)
    delta = shape.kappa + 0.0115
    assert shape.moment[before] == pytest.approx(-40.0 * delta[before] + 5.0, rel=1e-9)
    assert shape.moment[beyond] == pytest.approx(300.0 * delta[beyond] + 0.2, rel=1e-9)
    lever = (shape.x[-1] - shape.x) * shape.force[1]
    assert shape.moment == pytest.approx(lever, abs=1e-5)
    with pytest.raises(RodError, match="slopes of this rod may be negative"):
        _ = rod.five


def test_two_lines_with_positive_slopes_are_five_parameters() -> None:
    numbers = (190.0, 400.0, -0.5, 0.3, 6.5)
    shapes = [Rod(LENGTH, -0.0115, law).solve(end_y=0.0) for law in (FiveParameters(*numbers), TwoSlopes(*numbers))]
    assert np.array_equal(shapes[0].y, shapes[1].y)
    assert np.array_equal(shapes[0].moment, shapes[1].moment)
