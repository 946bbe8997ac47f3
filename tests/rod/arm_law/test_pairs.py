"""The arm's own law over the pressures of two cavities, of an arm whose law is known in closed form."""

import json
from dataclasses import replace

import numpy as np
import pytest

from pipeline.results.laws import law_of_record, law_record
from rod.arm_law.kinds import along
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import PairLaw, direction_of, fractions_of
from tests.pair_laws import KAPPA, moment, ray, rotation


def fan(*directions: float) -> PairLaw:
    return PairLaw(("upper", "lower"), directions, tuple(ray(d) for d in directions))


def test_directions_and_fractions_are_the_same() -> None:
    assert direction_of((20.0, 5.0)) == (20.0, 0.25)
    assert direction_of((5.0, 20.0)) == (20.0, 1.75)
    assert direction_of((0.0, 7.0)) == (7.0, 2.0)
    assert [fractions_of(d) for d in (0.0, 0.25, 1.0, 1.75, 2.0)] == [(1, 0), (1, 0.25), (1, 1), (0.25, 1), (0, 1)]


def test_on_a_ray_it_is_the_law_of_the_ray() -> None:
    law, alone = fan(0.0, 1.0, 2.0), ray(0.0)
    for kwargs in ({}, {"end_y": 0.0}, {"force": (0.01, 0.02)}):
        both, one = law.at((17.0, 0.0)).solve(**kwargs), alone.at(17.0).solve(**kwargs)
        assert np.array_equal(both.curve, one.curve)
        assert np.array_equal(both.force, one.force)


@pytest.mark.parametrize(
    ("pair", "error"),
    # at 14 and 25 kPa, between the pressures of the rays, M is of the fourth order in p and slopes are straight lines
    [((20.0, 8.0), 1e-7), ((8.0, 20.0), 1e-7), ((14.0, 13.0), 1e-6), ((3.0, 25.0), 1e-6)],
)
def test_between_rays_it_is_the_known_law(pair: tuple[float, float], error: float) -> None:
    section = fan(0.0, 1.0, 2.0).at(pair).section
    exact = np.interp(section.moment, moment(KAPPA, *pair)[0], KAPPA)
    assert section.kappa == pytest.approx(exact, abs=error)
    assert section.stretch == pytest.approx(1.0 + 1e-4 * sum(pair) + 0.5 * exact, abs=1e-6)


@pytest.mark.parametrize("pair", [(20.0, 8.0), (8.0, 20.0)])
def test_between_rays_the_clamped_end_turns_as_it_is_known_to(pair: tuple[float, float]) -> None:
    clamp = fan(0.0, 1.0, 2.0).at(pair).clamp
    assert clamp.rotation == pytest.approx(rotation(clamp.moment, *pair)[0], abs=1e-7)


def test_swapped_pressures_bend_the_arm_the_other_way() -> None:
    law = fan(0.0, 1.0, 2.0)
    one, other = (law.at(pair).section.kappa_0 for pair in ((24.0, 6.0), (6.0, 24.0)))
    assert one == pytest.approx(-other, rel=1e-6)
    assert law.at((15.0, 15.0)).section.kappa_0 == pytest.approx(0.0, abs=1e-12)


def test_clamped_ends_of_different_lengths_are_joined() -> None:
    law = PairLaw(("upper", "lower"), (0.0, 1.0), (ray(0.0, positions=5), ray(1.0)))
    rod = law.at((20.0, 10.0))
    assert list(rod.clamp.s) == [0.0, 5.0, 10.0]
    assert rod.solve().end == pytest.approx(fan(0.0, 1.0).at((20.0, 10.0)).solve().end)


def test_without_derivatives_there_is_nothing_between_rays() -> None:
    law = fan(0.0, 1.0)
    bare = law.laws[0].at(20.0).section
    assert law.at((20.0, 0.0)).section.kappa_0 == bare.kappa_0


def law_without_derivatives(law: ArmLaw) -> ArmLaw:
    cells = tuple(replace(c, moment_by_other=np.empty(0), stretch_by_other=np.empty(0)) for c in law.cells)
    return replace(law, cells=cells)


def test_the_record_is_the_law() -> None:
    law = fan(0.0, 1.0)
    again = law_of_record(json.loads(json.dumps(law_record(law))))
    assert again.cavities == law.cavities
    assert np.array_equal(again.at((20.0, 8.0)).solve().curve, law.at((20.0, 8.0)).solve().curve)
    with pytest.raises(ValueError, match="error_between"):
        law_of_record({"format": 4, "kind": "pairs", "rays": []})


def test_along_a_ratio_it_is_a_law_of_one_pressure() -> None:
    law = fan(0.0, 1.0, 2.0)
    assert law.ratios == ((1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    assert along(law, (2.0, 2.0)) is law.laws[1] is law.laws[1].plane
    assert (law.plane, law.has_plane, law.fractions) == (None, True, {})
    assert law.notes == ("The error of this law between its ratios is not known.",)
    assert replace(law, error_between=0.01).notes == law.laws[0].notes == ()
    between = along(law, (1.0, 0.5))
    assert between.rows[-1] == (30.0,)
    assert between.at(20.0).section.kappa_0 == law.at((20.0, 10.0)).section.kappa_0
