"""Extreme stretches, and the clause that names a stretch outside the stable range of a law."""

from dataclasses import replace

import numpy as np
import pytest

from fem import NeoHooke, StVenantKirchhoff, outside_stable_range
from fem.discretisation import Discretisation
from fem.post.extremes import extremes_of, principal_stretches, strain_at_stress_points
from fem.solution import Extremes
from tests.bodies import box

LAW = StVenantKirchhoff(1.2, 0.495)
MILD = Extremes(0.95, 1.2, 0.8, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0))


def test_no_clause_for_stretches_within_the_stable_range() -> None:
    assert outside_stable_range(MILD, LAW) == ""
    assert outside_stable_range(replace(MILD, min_stretch=0.5), NeoHooke(0.4, 40.0)) == ""


def test_the_clause_for_compression_beyond_the_limit_point_of_the_law() -> None:
    assert outside_stable_range(replace(MILD, min_stretch=0.5), LAW) == (
        "a stretch of 0.5 at (7.0, 8.0, 9.0) mm is below 0.577, where the law svk in compression is no longer "
        "stable; the smallest volume ratio J is 0.95 at (1.0, 2.0, 3.0) mm"
    )


def test_the_clause_for_tension_beyond_zero_volume() -> None:
    clause = outside_stable_range(replace(MILD, max_stretch=1.8), LAW)
    assert clause.startswith(
        "a stretch of 1.8 at (4.0, 5.0, 6.0) mm is above 1.74, the largest at which the law svk is"
    )


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.02, 0.3])
def test_extremes_are_those_of_all_stress_points(size: float) -> None:
    """Only the points that can have an extreme stretch are evaluated; the result must not depend on that."""
    space = Discretisation.of(box((3, 2, 2), (1.0, 1.0, 1.0)), "p2p0")
    displacement = size * np.random.default_rng(5).normal(size=space.points.shape)
    strain, jacobian = strain_at_stress_points(space, displacement)
    stretches = principal_stretches(strain)
    extremes = extremes_of(space, strain, jacobian)
    assert (extremes.min_stretch, extremes.max_stretch) == (stretches.min(), stretches.max())
    centres = space.points[space.nodes[:, :4]].mean(axis=1)
    np.testing.assert_array_equal(extremes.max_stretch_at, centres[stretches[..., 2].max(axis=1).argmax()])
    np.testing.assert_array_equal(extremes.min_stretch_at, centres[stretches[..., 0].min(axis=1).argmin()])
