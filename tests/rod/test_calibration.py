"""Calibration of the 95 % intervals on synthetic arms with noise and ripple (table in studies/identification.md)."""

import numpy as np
import pytest

import rod
from tests.synthetic_arm import SyntheticArm

PITCH = 10.0


def known(free, loaded, load):
    """Moment and movement of the end, as the pipeline takes them."""
    return rod.moment_from_load(rod.without_stretch(loaded), load), rod.end_displacement_closure(free, loaded, load)


def by_cells(free, loaded, load, seed):
    curvatures = (rod.cell_averaged(c, PITCH) for c in (free, loaded))
    return rod.identify(*curvatures, *known(free, loaded, load), bootstrap=rod.Bootstrap(300, seed))


def drawn_law(random):
    """Parameters like those of the gapped pneu-net with contact; the first offset from its prior, 0.15 of M(0)."""
    return rod.FiveParameters(
        alpha1=random.uniform(150.0, 250.0),
        alpha2=random.uniform(300.0, 480.0),
        m01=1.8 * random.standard_normal(),
        m02=random.uniform(-0.5, 0.8),
        d=random.uniform(6.5, 15.0),
    )


def coverage(estimate, draws):
    """Shares of the draws whose 95 % intervals contain the true numbers, (5,), and whose d/l is right."""
    random = np.random.default_rng(1)
    inside, near = np.zeros(5), 0
    for seed in range(draws):
        arm = SyntheticArm(
            drawn_law(random),
            ripple=0.2 * random.standard_normal(),
            compliance_ripple=0.5 * random.standard_normal(),
            phase=random.uniform(0.0, 2.0 * np.pi),
            noise=0.005,
            force_noise=1e-3,
        )
        fit = estimate(*arm.curves(seed), seed)
        inside += [getattr(fit, n).low <= getattr(arm.law, n) <= getattr(fit, n).high for n in rod.PARAMETER_NAMES]
        near += 0.05 <= fit.law.d / arm.length <= 0.15
    return inside / draws, near / draws


@pytest.mark.slow
def test_95_percent_intervals_contain_the_truth():
    inside, near = coverage(by_cells, 200)
    assert near > 0.95
    assert np.all((inside >= 0.90) & (inside <= 0.995)), dict(zip(rod.PARAMETER_NAMES, inside, strict=True))


def test_intervals_of_the_cell_averages_on_few_draws():
    """The quick form of the calibration: 20 draws, of which the binomial law lets a true 95 % lose at most four."""
    inside, near = coverage(by_cells, 20)
    assert near > 0.9
    assert np.all(inside >= 0.8), dict(zip(rod.PARAMETER_NAMES, inside, strict=True))
