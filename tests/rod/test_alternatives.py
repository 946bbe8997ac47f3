"""Simpler and richer laws, by their predictions out of sample."""

import numpy as np
import pytest

from rod import FiveParameters, Load, Moment, Rod, RodError, cell_averaged, moment_from_load
from rod.identification.alternatives import EQUAL_ERROR, Candidate, Observation, compare_laws, simplest
from rod.identification.shape_fit import rest_curvature
from tests.synthetic_arm import SyntheticArm, exact_curvature

S = np.linspace(0.125, 111.875, 448)
#: moments of three loads, one after the other larger, none a multiple of another
MOMENTS = [-6.0 * (1.0 - S / 112.0), -9.0 * (1.0 - S / 112.0) ** 1.3, 5.0 * (1.0 - S / 112.0) ** 0.8]


def observed(law, moment, noise=0.0, seed=0):
    error = noise * np.random.default_rng(seed).standard_normal(len(S))
    free, bent = (exact_curvature(S, k, length=112.0, pitch=10.0) for k in (0 * S + 0.02, 0.02 + law(moment) + error))
    return Observation(free, bent, Moment(S, moment))


def compared(law, noise=1e-4):
    first, *others = (observed(law, m, noise, k) for k, m in enumerate(MOMENTS))
    return compare_laws(first, others)


@pytest.mark.parametrize(
    ("law", "name"),
    [
        (lambda m: m / 200.0, "one line"),
        (lambda m: m / np.where(S < 12.0, 150.0, 400.0), "two slopes"),
        (lambda m: m / 200.0 - 0.4 / 200.0 + (S < 2.24) * m / 20.0, "spring and one line"),
        (lambda m: m / 150.0 - np.sign(m) * np.maximum(np.abs(m) - 3.0, 0.0) / 300.0, "contact"),
        (lambda m: np.where(S < 14.0, (m + 2.0) / 60.0, m / 400.0), "five parameters"),
    ],
)
def test_the_law_behind_the_data_is_found_again(law, name):
    candidates = compared(law)
    assert simplest(candidates).name == name
    truth = next(c for c in candidates if c.name == name)
    assert truth.out_of_sample < 0.03


def test_secants_do_not_predict_other_loads():
    """Intercepts fitted to a curved law are right where they were fitted and wrong where the moment turns round."""
    candidates = {
        c.name: c for c in compared(lambda m: m / 150.0 - np.sign(m) * np.maximum(np.abs(m) - 3.0, 0.0) / 300.0)
    }
    assert candidates["five parameters"].out_of_sample > 2.0 * candidates["contact"].out_of_sample


def test_simplest_prefers_fewer_numbers_when_as_good():
    single, five = Candidate("one", 2, 0.1, 0.1 * EQUAL_ERROR * 0.99), Candidate("five", 5, 0.05, 0.1)
    assert simplest([five, single]) is single
    assert simplest([five, Candidate("one", 2, 0.1, 0.2)]) is five


def test_a_rod_with_a_soft_cell_held_at_other_ends():
    """From curves, through the estimator, as the pipeline does it."""
    arm = SyntheticArm(FiveParameters(150.0, 400.0, 0.0, 0.0, 11.0), kappa_0=0.02)
    free, _, _ = arm.curves()
    rod = Rod(112.0, rest_curvature(free)[1], arm.law)
    observations = []
    for end_y in (0.0, 10.0, -10.0):
        shape = rod.solve(end_y=end_y)
        curve = type(free)(free.s, *shape.positions(free.s).T)
        moment = moment_from_load(curve, Load(tuple(shape.force)))
        observations.append(Observation(cell_averaged(free, 10.0), cell_averaged(curve, 10.0), moment))
    candidates = compare_laws(observations[0], observations[1:])
    assert simplest(candidates).name == "two slopes"
    assert min(c.out_of_sample for c in candidates) < 1e-2


def test_nothing_to_compare_is_refused():
    first = observed(lambda m: m / 200.0, MOMENTS[0])
    with pytest.raises(RodError, match="loads that were not used for the fit; there is none"):
        compare_laws(first, [])
