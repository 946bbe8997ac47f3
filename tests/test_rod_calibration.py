"""Are the intervals true? Arms with known numbers, noise and cell wiggle drawn anew (table: docs/identification.md)."""

from __future__ import annotations

import numpy as np
import pytest

from rod import (
    FiveParameters,
    LoadedShape,
    SyntheticArm,
    cell_averaged,
    fit_rod,
    gaussian_process,
    identify,
    moment_from_force,
    shared_smoothing,
)

#: Delta continuous at d, as the two lines of the paper meet; a step in rigidity with lines through the origin
MEETING = FiveParameters(55.0, 400.0, -5.2, 0.1, 14.0)
STEP = FiveParameters(200.0, 400.0, 0.0, 0.0, 11.0)
NAMES = ("alpha1", "alpha2", "m01", "m02", "d")
PITCH = 10.0


def by_cells(free, loaded, force, seed):
    curvatures = (cell_averaged(c, PITCH) for c in (free, loaded))
    return identify(*curvatures, moment_from_force(loaded, force), draws=300, seed=seed)


def by_process(free, loaded, force, seed):
    smoothing = shared_smoothing([free, loaded], PITCH)
    curvatures = (gaussian_process(c, smoothing, PITCH) for c in (free, loaded))
    return identify(*curvatures, moment_from_force(loaded, force), draws=300, seed=seed)


def by_rod(free, loaded, force, seed):
    start = by_cells(free, loaded, force, seed).law
    return fit_rod(LoadedShape(free, loaded, force, PITCH), [start], draws=300, seed=seed)


def coverage(estimate, law, draws):
    """Shares of the draws whose 95 % intervals contain the true numbers, (5,), and whose d/l is right."""
    random = np.random.default_rng(1)
    inside, near = np.zeros(5), 0
    for seed in range(draws):
        arm = SyntheticArm(
            law,
            wiggle=0.2 * random.standard_normal(),
            compliance_wiggle=0.15 * random.standard_normal(),
            phase=random.uniform(0.0, 2.0 * np.pi),
            noise=0.005,
        )
        found = estimate(*arm.curves(seed), seed)
        inside += [getattr(found, n).low <= getattr(law, n) <= getattr(found, n).high for n in NAMES]
        near += 0.05 <= found.law.d / arm.length <= 0.15
    return inside / draws, near / draws


@pytest.mark.slow
@pytest.mark.parametrize("law", [MEETING, STEP], ids=["meeting", "step"])
@pytest.mark.parametrize("estimate", [by_cells, by_process, by_rod])
def test_95_percent_intervals_contain_the_truth(estimate, law):
    inside, near = coverage(estimate, law, 200)
    assert near == 1.0
    assert np.all(inside >= 0.90), dict(zip(NAMES, inside, strict=True))


@pytest.mark.parametrize("law", [MEETING, STEP], ids=["meeting", "step"])
def test_intervals_of_the_cell_averages_on_few_draws(law):
    """The quick form of the calibration: 12 draws, of which the binomial law lets a true 95 % lose at most three."""
    inside, near = coverage(by_cells, law, 12)
    assert near == 1.0
    assert np.all(inside >= 0.75), dict(zip(NAMES, inside, strict=True))
