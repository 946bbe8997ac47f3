"""Extreme stretches: which they are, and in words which limit of which law they pass, and where."""

from dataclasses import replace

import numpy as np
import pytest
from bodies import box

from fem import NeoHooke, StVenantKirchhoff, outside_stable_range
from fem.discretisation import Discretisation
from fem.post.extremes import extremes_of, principal_stretches, strain_at_stress_points
from fem.solution import Extremes

LAW = StVenantKirchhoff(1.2, 0.495)
MILD = Extremes(0.95, 1.2, 0.8, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0))


def test_nothing_is_said_of_stretches_that_a_law_can_bear() -> None:
    assert outside_stable_range(MILD, LAW) == ""
    assert outside_stable_range(replace(MILD, min_stretch=0.5), NeoHooke(0.4, 40.0)) == ""


def test_compression_beyond_the_limit_point_of_the_law() -> None:
    assert outside_stable_range(replace(MILD, min_stretch=0.5), LAW) == (
        "a stretch of 0.5 at (7.0, 8.0, 9.0) mm is below 0.577, where StVenantKirchhoff in compression is no longer "
        "stable; the smallest J is 0.95 at (1.0, 2.0, 3.0) mm"
    )


def test_tension_that_leaves_no_volume() -> None:
    said = outside_stable_range(replace(MILD, max_stretch=1.8), LAW)
    assert said.startswith("a stretch of 1.8 at (4.0, 5.0, 6.0) mm is above 1.74, the largest that StVenantKirchhoff")


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.02, 0.3])
def test_the_extremes_are_those_of_all_points(size: float) -> None:
    """Few points can be the extreme ones, and the stretches of those alone are computed."""
    space = Discretisation.of(box((3, 2, 2), (1.0, 1.0, 1.0)), "p2p0")
    displacement = size * np.random.default_rng(5).normal(size=space.points.shape)
    strain, jacobian = strain_at_stress_points(space, displacement)
    stretches = principal_stretches(strain)
    found = extremes_of(space, strain, jacobian)
    assert (found.min_stretch, found.max_stretch) == (stretches.min(), stretches.max())
    centres = space.points[space.nodes[:, :4]].mean(axis=1)
    np.testing.assert_array_equal(found.max_stretch_at, centres[stretches[..., 2].max(axis=1).argmax()])
    np.testing.assert_array_equal(found.min_stretch_at, centres[stretches[..., 0].min(axis=1).argmin()])
