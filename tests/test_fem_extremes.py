"""Extreme stretches in words: which limit of which law, and where."""

from dataclasses import replace

from fem import NeoHooke, StVenantKirchhoff, beyond_the_law
from fem.solution import Extremes

LAW = StVenantKirchhoff(1.2, 0.495)
MILD = Extremes(0.95, 1.2, 0.8, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0))


def test_nothing_is_said_of_stretches_that_a_law_can_bear() -> None:
    assert beyond_the_law(MILD, LAW) == ""
    assert beyond_the_law(replace(MILD, min_stretch=0.5), NeoHooke(0.4, 40.0)) == ""


def test_compression_beyond_the_limit_point_of_the_law() -> None:
    assert beyond_the_law(replace(MILD, min_stretch=0.5), LAW) == (
        "a stretch of 0.5 at (7.0, 8.0, 9.0) mm is below 0.577, where StVenantKirchhoff in compression is no longer "
        "stable; the smallest J is 0.95 at (1.0, 2.0, 3.0) mm"
    )


def test_tension_that_leaves_no_volume() -> None:
    said = beyond_the_law(replace(MILD, max_stretch=1.8), LAW)
    assert said.startswith("a stretch of 1.8 at (4.0, 5.0, 6.0) mm is above 1.74, the largest that StVenantKirchhoff")
