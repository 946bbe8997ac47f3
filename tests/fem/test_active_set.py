"""The active set of contact: activation and tightening of terms, without solving."""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.effects.effect import NO_BLOCKS, Blocks, Term, UnilateralTerm
from fem.effects.facing_pairs import NO_PAIRS
from fem.effects.tightening import Tightening
from fem.path.active_set import ActiveSet
from geometry import Reason
from geometry.arrays import Array

BEYOND_FLOOR, BEYOND_WALL = Reason("walls_cross"), Reason("far_walls_cross")


def at(height: float) -> Array:
    """A single node at a height above a floor, mm."""
    return np.array([[0.0, height, 0.0]])


@final
@dataclass(frozen=True, eq=False)
class Weight(Term):
    effect = "weight"

    def energy(self, x: Array, factor: float) -> float:
        return factor * float(x[0, 1])

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out[0, 1] += factor

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return NO_BLOCKS


@final
@dataclass(frozen=True, eq=False)
class Wall(UnilateralTerm):
    """The floor at height 0, impenetrable."""

    effect = "contact"
    starts_inactive = False
    is_infinite = True

    def energy(self, x: Array, factor: float) -> float:
        return -float(np.log(x[0, 1]))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out[0, 1] -= 1.0 / x[0, 1]

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return NO_BLOCKS

    def gap(self, x: Array) -> float:
        return float(x[0, 1])

    def touching(self, x: Array) -> bool:
        return self.gap(x) < 0.1

    def violation(self, x: Array) -> Reason | None:
        return None if self.gap(x) > 0 else BEYOND_WALL

    def step_limit(self, x: Array, dx: Array) -> float:
        return 0.5

    def tightening(self, model: UnilateralTerm) -> Tightening:
        return Tightening(0.0, 0, True, NO_PAIRS, NO_PAIRS.area)


@final
@dataclass(frozen=True, eq=False)
class Floor(UnilateralTerm):
    """A floor at height 0, felt from 0.1 mm on, that may be stiffened once before it becomes impenetrable."""

    effect = "contact"

    starts_inactive: bool
    stiffness: float = 1.0

    def energy(self, x: Array, factor: float) -> float:
        return 0.5 * self.stiffness * min(x[0, 1] - 0.1, 0.0) ** 2

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out[0, 1] += self.stiffness * min(x[0, 1] - 0.1, 0.0)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return NO_BLOCKS

    def gap(self, x: Array) -> float:
        return float(x[0, 1])

    def gap_ahead(self, x: Array, dx: Array) -> float:
        return self.gap(x + dx)

    def touching(self, x: Array) -> bool:
        return self.gap(x) < 0.1

    def violation(self, x: Array) -> Reason | None:
        return None if self.gap(x) > 0 else BEYOND_FLOOR

    def tightened(self, x: Array) -> UnilateralTerm:
        return replace(self, stiffness=4.0) if self.stiffness < 4.0 else Wall()

    def with_exact_distances(self, x: Array) -> UnilateralTerm:
        return Wall() if x[0, 0] > 1.0 else self

    def tightening(self, model: UnilateralTerm) -> Tightening | None:
        return None if self is model else Tightening(self.stiffness, 0, False, NO_PAIRS, NO_PAIRS.area)

    def with_tightening(self, tightening: Tightening) -> UnilateralTerm:
        return Wall() if tightening.is_exact else replace(self, stiffness=tightening.stiffness)


WEIGHT, PRESENT, LATER = Weight(), Floor(starts_inactive=False), Floor(starts_inactive=True)
MODEL = (WEIGHT, LATER, PRESENT)


def test_contact_that_starts_inactive_joins_where_it_touches_in_the_order_of_the_model() -> None:
    apart = ActiveSet.of(MODEL, at(1.0))
    assert apart.active == (WEIGHT, PRESENT)
    assert apart.inactive == (LATER,)
    assert apart.activated(at(0.5)) is apart
    met = apart.activated(at(0.05))
    assert met.active == MODEL
    assert met.inactive == ()
    assert met.is_active == (True, True, True)
    assert met.effects == ("weight", "contact")
    assert met.activated(at(1.0)) is met  # once active, a contact stays
    assert ActiveSet.of(MODEL, at(0.05)).active == MODEL


def test_contact_whose_gap_closes_on_the_way_joins_before_it_touches() -> None:
    apart = ActiveSet.of(MODEL, at(1.0))
    assert apart.approached(at(1.0), at(-0.95)) is apart  # within reach of the floor, but not through it
    met = apart.approached(at(1.0), at(-1.05))
    assert met.is_active == (True, True, True)
    assert met.approached(at(1.0), at(-2.0)) is met
    walled = ActiveSet((Wall(),), (False,), (Wall(),))
    assert walled.approached(at(1.0), at(-2.0)) is walled  # a term without rates


def test_walls_are_in_contact_within_the_activation_distance_of_an_active_term() -> None:
    later = (WEIGHT, LATER)
    assert not ActiveSet.of(later, at(1.0)).touching(at(0.05))
    assert ActiveSet.of(later, at(0.05)).touching(at(0.05))
    assert not ActiveSet.of(later, at(0.05)).touching(at(0.2))


def test_violated_contact_is_tightened_until_there_is_nothing_stiffer() -> None:
    active = ActiveSet.of((WEIGHT, PRESENT), at(1.0))
    assert active.violations(at(0.05)) == ()
    assert active.tightened(at(0.05)) is active
    assert active.violations(at(-0.1)) == (BEYOND_FLOOR,)
    stiffer = active.tightened(at(-0.1))
    assert stiffer.stiffened != stiffer.model
    assert not stiffer.needs_admissible_start
    assert isinstance(stiffer.active[1], Floor)
    assert stiffer.active[1].stiffness == 4.0
    exact = stiffer.tightened(at(-0.1))
    assert isinstance(exact.active[1], Wall)
    assert exact.needs_admissible_start
    assert exact.violations(at(-0.1)) == (BEYOND_WALL,)
    assert exact.tightened(at(-0.1)) is exact
    assert exact.restored().active == active.active
    assert exact.restored().stiffened == active.model


def test_only_the_violated_contact_is_tightened_and_new_contact_joins_as_it_is() -> None:
    stiffer = ActiveSet.of(MODEL, at(1.0)).tightened(at(-0.1))
    both = stiffer.activated(at(-0.1))
    assert both.active[:2] == (WEIGHT, LATER)
    assert both.active[2] is stiffer.active[1]


def test_a_stored_step_restores_its_contacts_and_those_its_positions_touch() -> None:
    assert ActiveSet.resumed(MODEL, (True, True, True), at(1.0)).active == MODEL
    assert ActiveSet.resumed(MODEL, (True, False, True), at(1.0)).active == (WEIGHT, PRESENT)
    assert ActiveSet.resumed(MODEL, (True, False, True), at(0.05)).active == MODEL


def test_active_contact_that_has_slid_gets_exact_distances() -> None:
    met = ActiveSet.of(MODEL, at(0.05))
    assert met.with_exact_distances(at(0.05)) is met
    slid = at(0.05)
    slid[0, 0] = 2.0
    exact = met.with_exact_distances(slid)
    assert [type(term) for term in exact.active] == [Weight, Wall, Wall]
    assert met.active == MODEL
    assert [type(term) for term in ActiveSet.of(MODEL, at(1.0)).with_exact_distances(slid).active] == [Weight, Wall]


def test_contact_stands_again_as_it_stood_in_a_stored_state() -> None:
    soft = ActiveSet.of(MODEL, at(0.05))
    assert soft.tightenings == (None, None, None)
    assert soft.with_tightenings(soft.tightenings) is soft
    stiff = soft.tightened(at(-0.05))
    again = soft.with_tightenings(stiff.tightenings)
    assert [term.stiffness for term in again.active if isinstance(term, Floor)] == [4.0, 4.0]
    hard = stiff.tightened(at(-0.05))
    again = soft.with_tightenings(hard.tightenings)
    assert again.needs_admissible_start
    assert again.restored().active == soft.active
