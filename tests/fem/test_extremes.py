"""Extreme stretches, and the reason that names a stretch outside the stable range of a law."""

from dataclasses import replace

import numpy as np
import pytest

from fem import NeoHooke, StVenantKirchhoff, outside_stable_range
from fem.discretisation import Discretisation
from fem.post.extremes import extremes_of, principal_stretches
from fem.reasons import sentence
from fem.solution import Extremes
from tests.bodies import box

LAW = StVenantKirchhoff(1.2, 0.495)
MILD = Extremes(0.95, 1.2, 0.8, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0))


def test_no_reason_for_stretches_within_the_stable_range() -> None:
    assert outside_stable_range(MILD, LAW) is None
    assert outside_stable_range(replace(MILD, min_stretch=0.5), NeoHooke(0.4, 40.0)) is None


def test_compression_beyond_the_limit_point_of_the_law() -> None:
    reason = outside_stable_range(replace(MILD, min_stretch=0.5), LAW)
    assert sentence((reason,)) == (
        "a stretch of 0.5 at (7.0, 8.0, 9.0) mm is below 0.577, where the law svk in compression is no longer stable"
    )


def test_tension_beyond_zero_volume() -> None:
    reason = outside_stable_range(replace(MILD, max_stretch=1.8), LAW)
    assert reason is not None
    assert (reason.code, reason.where) == ("stretch_too_large", (4.0, 5.0, 6.0))
    assert (reason.values["stretch"], reason.values["law"]) == (1.8, "svk")
    assert reason.values["limit"] == pytest.approx(1.74, abs=5e-3)


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.02, 0.3])
def test_extremes_are_those_of_all_stress_points(size: float) -> None:
    """Only the points that can have an extreme stretch are evaluated; the result must not depend on that."""
    space = Discretisation.of(box((3, 2, 2), (1.0, 1.0, 1.0)), "p2p0")
    displacement = size * np.random.default_rng(5).normal(size=space.points.shape)
    strain, jacobian = space.strain_of(displacement)
    stretches = principal_stretches(strain)
    extremes = extremes_of(space, strain, jacobian)
    assert (extremes.min_stretch, extremes.max_stretch) == (stretches.min(), stretches.max())
    centres = space.points[space.nodes[:, :4]].mean(axis=1)
    np.testing.assert_array_equal(extremes.max_stretch_at, centres[stretches[..., 2].max(axis=1).argmax()])
    np.testing.assert_array_equal(extremes.min_stretch_at, centres[stretches[..., 0].min(axis=1).argmin()])
