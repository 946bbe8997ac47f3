"""Identification of the five parameters from two curves and a force of a rod with known parameters."""

import dataclasses
import re

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import rod
from rod.identification.observed import Observed
from rod.identification.two_lines import CLEAR
from tests.synthetic_arm import SyntheticArm, exact_curvature

#: Delta continuous at d, as the lines of the paper's Fig. 9 meet
MEETING = rod.FiveParameters(55.0, 400.0, -5.2, 0.1, 14.0)
#: a soft first cell, both lines through the origin
STEP = rod.FiveParameters(200.0, 400.0, 0.0, 0.0, 11.0)
ONE = rod.FiveParameters(200.0, 200.0, 0.0, 0.0, 11.0)


def by_cells(arm, seed=0):
    free, loaded, load = arm.curves(seed)
    return rod.cell_averaged(free, arm.pitch), rod.cell_averaged(loaded, arm.pitch), rod.moment_from_load(loaded, load)


@pytest.mark.parametrize("law", [MEETING, STEP])
def test_round_trip_from_the_rod_itself(law):
    """Data made by the rod give the five numbers back to 1e-4."""
    shape = rod.Rod(112.0, 0.03, law).solve(end_y=0.0)
    s = np.linspace(0.0, 112.0, 449)[:-1] + 0.125
    moment = CubicSpline(shape.s, shape.moment)(s)
    loaded = 0.03 + law.deviation(s, moment)
    free, bent = (exact_curvature(s, k, length=112.0, pitch=10.0) for k in (np.full(len(s), 0.03), loaded))
    identified = rod.identify(free, bent, rod.Moment(shape.s, shape.moment), bootstrap=rod.Bootstrap(20))
    for name in rod.PARAMETER_NAMES:
        scale = abs(shape.moment[0]) if name.startswith("m0") else getattr(law, name)
        assert abs(getattr(identified.law, name) - getattr(law, name)) < 1e-4 * scale, name
    assert identified.two_lines


@pytest.mark.parametrize("law", [MEETING, STEP])
def test_cells_find_the_parameters_despite_a_ripple(law):
    identified = rod.identify(*by_cells(SyntheticArm(law, ripple=0.25, node_spacing=0.5)), bootstrap=rod.Bootstrap(50))
    assert identified.two_lines
    assert identified.law.d == pytest.approx(law.d, abs=0.05)
    assert identified.law.alpha2 == pytest.approx(law.alpha2, rel=1e-3)
    assert identified.law.alpha1 == pytest.approx(law.alpha1, rel=0.02)


@pytest.mark.parametrize("law", [MEETING, STEP])
def test_two_lines_are_found_with_their_break_at_the_soft_cell(law):
    arm = SyntheticArm(law, ripple=0.2, compliance_ripple=0.1, phase=0.7, noise=0.003)
    identified = rod.identify(*by_cells(arm), bootstrap=rod.Bootstrap(100))
    assert identified.two_lines
    assert 0.05 <= identified.law.d / arm.length <= 0.15
    assert identified.law.alpha2 == pytest.approx(law.alpha2, rel=0.03)
    for name in rod.PARAMETER_NAMES:
        number = getattr(identified, name)
        assert number.low <= number.value <= number.high, name


def test_one_line_is_found_where_there_is_one():
    arm = SyntheticArm(ONE, ripple=0.2, compliance_ripple=0.15, phase=0.7, noise=0.003)
    identified = rod.identify(*by_cells(arm), bootstrap=rod.Bootstrap(100))
    assert not identified.two_lines
    assert identified.single_line.alpha.value == pytest.approx(200.0, rel=0.02)
    assert identified.single_line.alpha.low <= 200.0 <= identified.single_line.alpha.high


def test_nearly_one_line_stays_one_line():
    """Rigidity rising by 3 % along the arm, as measured without contact: not worth three more numbers."""
    arm = SyntheticArm(ONE, ripple=0.2, noise=0.001)
    free, loaded, moment = by_cells(arm)
    rising = 1.0 - 0.03 * loaded.s / arm.length
    bent = dataclasses.replace(loaded, kappa=free.kappa + (loaded.kappa - free.kappa) * rising)
    identified = rod.identify(free, bent, moment, bootstrap=rod.Bootstrap(50))
    assert identified.single_line.r2 > 0.999
    assert not identified.two_lines


@pytest.mark.parametrize("law", [MEETING, STEP])
def test_a_given_d_is_that_of_the_law_and_the_other_numbers_are_the_best_with_it(law):
    data = by_cells(SyntheticArm(law))
    sought, given = (rod.identify(*data, d=d, bootstrap=rod.Bootstrap(20)) for d in (None, law.d))
    assert given.law.d == law.d
    assert (given.d.std, given.d.low, given.d.high) == (0.0, law.d, law.d)
    assert given.law.alpha2 == pytest.approx(law.alpha2, rel=2e-3)
    assert given.law.alpha1 == pytest.approx(law.alpha1, rel=0.05)
    assert not sought.d_given
    elsewhere = rod.identify(*data, d=30.0, bootstrap=rod.Bootstrap(2))
    assert (elsewhere.law.d, elsewhere.two_lines) == (30.0, True)
    assert elsewhere.r2 < given.r2


def test_two_lines_are_used_where_their_d_is_given_though_one_would_do():
    data = by_cells(SyntheticArm(ONE))
    assert not rod.identify(*data, bootstrap=rod.Bootstrap(2)).two_lines
    given = rod.identify(*data, d=11.0, bootstrap=rod.Bootstrap(2))
    assert given.two_lines
    assert (given.law.alpha1, given.law.alpha2) == pytest.approx((200.0, 200.0), rel=0.05)


def test_the_evidence_for_two_lines_is_the_difference_of_the_criteria():
    identified = rod.identify(*by_cells(SyntheticArm(STEP, noise=0.003)), bootstrap=rod.Bootstrap(2))
    assert identified.evidence == identified.criterion_single_line - identified.criterion_two_lines > CLEAR
    assert identified.two_lines
    assert rod.is_clear(identified.evidence)
    for difference, two_lines, clear in ((-6.1, False, True), (-5.9, False, False), (5.9, True, False)):
        other = dataclasses.replace(identified, criterion_two_lines=identified.criterion_single_line - difference)
        assert (other.two_lines, rod.is_clear(other.evidence)) == (two_lines, clear)
        assert dataclasses.replace(other, d_given=True).two_lines


def test_same_seed_same_intervals():
    data = by_cells(SyntheticArm(STEP, noise=0.003))
    first, again, other = (rod.identify(*data, bootstrap=rod.Bootstrap(40, k)).alpha2 for k in (1, 1, 2))
    assert first == again
    assert first.value == other.value
    assert first.low != other.low


def test_more_noise_more_uncertainty():
    stds = [
        rod.identify(*by_cells(SyntheticArm(STEP, noise=n)), bootstrap=rod.Bootstrap(100)).alpha2.std
        for n in (0.001, 0.004, 0.016)
    ]
    assert stds[0] < stds[1] < stds[2]


DATA = by_cells(SyntheticArm(STEP))


def test_an_arm_that_is_slightly_too_short_is_not_said_to_have_as_many_pitches_as_it_needs() -> None:
    assert "this arm of 43 mm has 6.49 of 6.62 mm" in rod.too_few_pitches(43.0, 6.62)
    assert rod.too_few_pitches(43.04, 6.62) == ""


def test_the_range_of_the_break_begins_in_the_first_cell() -> None:
    assert rod.shortest_break(112.0, 10.0) == pytest.approx(5.6)
    assert rod.shortest_break(72.0, 10.0) == pytest.approx(5.0)  # half a pitch
    assert rod.shortest_break(202.0, 10.0) == pytest.approx(6.0)  # not 0.05 of a long arm


@pytest.mark.parametrize(("length", "identified"), [(64.0, False), (65.0, True)])
def test_the_length_that_five_parameters_need_is_known_before_the_curves(length: float, identified: bool) -> None:
    assert (rod.too_few_pitches(length, 10.0) == "") is identified
    arm = SyntheticArm(rod.FiveParameters(190.0, 380.0, 0.0, 0.0, 8.0), length=length, node_spacing=0.5)
    if identified:
        assert rod.identify(*by_cells(arm), bootstrap=rod.Bootstrap(20)).law.alpha2 == pytest.approx(380.0, rel=0.05)
        return
    with pytest.raises(rod.RodError, match=re.escape(rod.too_few_pitches(length, 10.0))):
        rod.identify(*by_cells(arm))


def test_a_line_that_explains_less_than_the_mean_explains_nothing() -> None:
    observed = Observed.of(*DATA, None)
    assert observed.r_squared(observed.delta) == 1.0
    assert observed.r_squared(np.full_like(observed.delta, observed.delta.mean())) == pytest.approx(0.0, abs=1e-12)
    assert observed.r_squared(-observed.delta) == 0.0


def test_an_arm_of_seven_cells_gives_its_numbers() -> None:
    arm = SyntheticArm(rod.FiveParameters(190.0, 380.0, 0.0, 0.0, 8.0), length=72.0, ripple=0.2, node_spacing=0.5)
    identified = rod.identify(*by_cells(arm), bootstrap=rod.Bootstrap(50))
    assert identified.law.alpha2 == pytest.approx(380.0, rel=0.02)
    assert identified.two_lines
