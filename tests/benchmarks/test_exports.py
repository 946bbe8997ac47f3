"""The comparison of an exported rod with the rod itself: point by point, at the same arc lengths."""

import numpy as np
import pytest

from benchmarks.exports import at_hinges, at_nodes, largest_distance
from rod import FiveParameters, Rod

LAW = FiveParameters(alpha1=150.0, alpha2=400.0, m01=-0.8, m02=0.1, d=14.0)


def test_points_are_compared_at_their_arc_lengths() -> None:
    """An arm that is too short has all of its points on the curve, and its end at the wrong place."""
    shape = Rod(112.0, -0.015, LAW).solve(force=(0.0, 0.02))
    for at in (at_hinges(61), at_nodes(61)):
        exact = shape.positions(112.0 * at)
        assert largest_distance(exact, at, shape) == pytest.approx(0.0, abs=1e-12)
        assert largest_distance(shape.positions(0.9 * 112.0 * at), at, shape) == pytest.approx(0.1, rel=0.1)
        lifted = exact + np.outer(at, [0.0, 1.12])
        assert largest_distance(lifted, at, shape) == pytest.approx(0.01)


def test_arc_lengths_of_hinges_and_nodes() -> None:
    assert at_hinges(5) == pytest.approx([0.125, 0.375, 0.625, 0.875, 1.0])
    assert at_nodes(5) == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
