"""Which terms of a model are in the potential: contact joins where walls meet, and is stiffened where they cross."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self, final

from fem.effects.effect import Terms, UnilateralTerm
from fem.effects.tightening import Tightening
from fem.reasons import Reasons
from fem.solution import Step
from geometry.arrays import Array


@final
@dataclass(frozen=True, eq=False)  # terms hold arrays and are told apart by identity
class ActiveSet:
    """The terms of a model in their order, which of them are in the sum, and what stands for each of them there."""

    model: Terms  #: as the effects were bound
    is_active: tuple[bool, ...]  #: which of them are in the sum
    stiffened: Terms  #: what is in the sum for each: the term itself, or the tightened one where walls crossed

    @classmethod
    def of(cls, model: Terms, x: Array) -> Self:
        """All terms but those contacts that start inactive and do not touch at x (n, 3)."""
        return cls.resumed(model, [not isinstance(term, UnilateralTerm) for term in model], x)

    @classmethod
    def resumed(cls, model: Terms, was_active: Sequence[bool], x: Array) -> Self:
        """The terms that were active in a stored step, and those that its positions x (n, 3) activate.

        Both are needed: a contact may have been activated at an intermediate increment that is not stored.
        """
        return cls(model, tuple(was_active), model).activated(x)

    @classmethod
    def of_step(cls, model: Terms, step: Step) -> Self:
        """The terms that were active in a finished step, as they stood there, and those that its positions activate.

        The last terms, which the model of the step may lack, are loads: active.
        """
        lacking = len(model) - len(step.active)
        resumed = cls.resumed(model, (*step.active, *[True] * lacking), step.positions)
        return resumed.with_tightenings((*step.contacts, *[None] * lacking))

    @property
    def active(self) -> Terms:
        """The terms in the sum, stiffened where they have been."""
        return tuple(term for term, active in zip(self.stiffened, self.is_active, strict=True) if active)

    @property
    def inactive(self) -> tuple[UnilateralTerm, ...]:
        """The contacts that are not in the sum."""
        terms = zip(self.model, self.is_active, strict=True)
        return tuple(term for term, active in terms if isinstance(term, UnilateralTerm) and not active)

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects in the sum, each once."""
        terms = zip(self.model, self.is_active, strict=True)
        return tuple(dict.fromkeys(term.effect for term, active in terms if active))

    @property
    def tightenings(self) -> tuple[Tightening | None, ...]:
        """For each term of the model: how its contact was tightened in the equations; None where it was not."""
        return tuple(
            term.tightening(model) if isinstance(model, UnilateralTerm) and isinstance(term, UnilateralTerm) else None
            for term, model in zip(self.stiffened, self.model, strict=True)
        )

    def with_tightenings(self, tightenings: Sequence[Tightening | None]) -> Self:
        """With the terms of the model as they stood in a state where `tightenings` was this; itself where all None."""
        terms = tuple(
            term.with_tightening(by) if by is not None and isinstance(term, UnilateralTerm) else term
            for term, by in zip(self.model, tightenings, strict=True)
        )
        return replace(self, stiffened=terms) if any(tightenings) else self

    @property
    def needs_admissible_start(self) -> bool:
        """Whether Newton's method must start from a state in which no walls cross."""
        return any(term.is_infinite for term in self.active)

    def activated(self, x: Array) -> Self:
        """With those contacts too that the state x (n, 3) activates; itself where there are none."""
        new = [isinstance(term, UnilateralTerm) and term.must_activate(x) for term in self.model]
        is_active = tuple(was or now for was, now in zip(self.is_active, new, strict=True))
        return self if is_active == self.is_active else replace(self, is_active=is_active)

    def approached(self, x: Array, dx: Array) -> Self:
        """With those contacts too whose gaps a motion dx (n, 3) from x closes at their present rates.

        Itself where there are none.
        """
        closing = [term for term in self.inactive if term.gap_ahead(x, dx) < 0]
        is_active = tuple(was or term in closing for was, term in zip(self.is_active, self.model, strict=True))
        return self if is_active == self.is_active else replace(self, is_active=is_active)

    def touching(self, x: Array) -> bool:
        """Whether walls are in contact at x (n, 3)."""
        terms = zip(self.model, self.is_active, strict=True)
        return any(isinstance(term, UnilateralTerm) and active and term.touching(x) for term, active in terms)

    def violations(self, x: Array) -> Reasons:
        """Why the state x (n, 3), converged with the active terms, is not admissible; a reason for each violation."""
        reasons = (term.violation(x) for term in self.active if isinstance(term, UnilateralTerm))
        return tuple(reason for reason in reasons if reason)

    def tightened(self, x: Array) -> Self:
        """With the next stiffer term for each active contact that x (n, 3) violates; itself where there is none."""
        return self._changed(lambda term: term.tightened(x) if term.violation(x) else term)

    def at_new_increment(self) -> Self:
        """With as many attempts to keep walls apart as an increment may take; itself where none are spent."""
        return self._changed(lambda term: term.at_new_increment())

    def with_exact_distances(self, x: Array) -> Self:
        """With exact distances for each active contact whose distances may be inaccurate at x (n, 3).

        Itself where there is none.
        """
        return self._changed(lambda term: term.with_exact_distances(x))

    def _changed(self, change: Callable[[UnilateralTerm], UnilateralTerm]) -> Self:
        """With what `change` gives for each active contact; itself where all stay the same."""
        terms = tuple(
            change(term) if active and isinstance(term, UnilateralTerm) else term
            for term, active in zip(self.stiffened, self.is_active, strict=True)
        )
        return self if terms == self.stiffened else replace(self, stiffened=terms)

    def restored(self) -> Self:
        """With the terms of the model in place of the tightened ones."""
        return replace(self, stiffened=self.model)
