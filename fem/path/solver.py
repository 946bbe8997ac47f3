"""Solves one increment of a path: an equilibrium with the contact that its states demand.

Within an increment contact is activated and stiffened (`fem.path.active_set`), and stays so for the rest of the way to
the target; beyond it only where an increment from there fails with the contact of the model.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import final

from fem.effects.effect import at_constant_fraction
from fem.equations.system import System
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.control import Control
from fem.path.effort import Effort
from fem.path.newton import Converged, NewtonOptions, NotAdmissible, Start, StepFailed, Unstable, Watch
from fem.path.predictor import PathPoint, Predictor
from fem.post.extremes import extremes_of
from geometry import Reason
from geometry.arrays import Array


@dataclass(frozen=True)
class Increment:
    """From the last points of a path to an equilibrium."""

    points: Sequence[PathPoint]  #: the last two, one at rest
    control: Control  #: what is prescribed at the end
    limit: float | None  #: value of the driven quantity at which the path announces its end
    effort: Effort
    watch: Watch  #: called after every iteration with its number and the relative residual


@final
class IncrementSolver:
    """Solves increments one after the other; keeps the contact that is active, and what it has learnt of starts."""

    def __init__(self, system: System, predictor: Predictor, active_set: ActiveSet, options: NewtonOptions) -> None:
        self.system, self.predictor, self.options = system, predictor, options
        self.active_set = self.of_last_target = active_set
        self.contact_is_kept = False  #: whether the contact of the last target is used on the way to the next one
        self.predictor_failed = False  #: whether an extrapolated start has failed on the way to the target
        self.iterations = 0  #: of all solutions of the last increment that converged
        self.began_with_pairs = False  #: whether it began with pairs in creases, of earlier increments

    def begin_target(self) -> None:
        """Forget what held on the way to the last target alone."""
        self.of_last_target, self.contact_is_kept = self.active_set, False
        self.predictor_failed, self.active_set = False, self.active_set.restored()

    def keep_contact(self) -> bool:
        """Go on with the contact of the last target where it had become stiffer or had got pairs in creases.

        With the contact of the model the last state is no equilibrium, and increments, however small, lead elsewhere.
        Whether this changes the contact; it does so once on the way to a target.
        """
        if self.contact_is_kept or not any(self.of_last_target.tightenings):
            return False
        self.predictor_failed, self.active_set, self.contact_is_kept = False, self.of_last_target, True
        return True

    def positions(self, converged: Converged) -> Array:
        """Positions of all nodes, (n, 3) in mm."""
        return self.system.space.points + converged.state.displacement

    def solve(self, increment: Increment) -> Converged:
        """An admissible equilibrium at the end of the increment; raises `StepFailed`.

        Contact that is foreseen and does not come is not active afterwards, and whatever contact an increment that
        fails has activated or made stiffer is as before.
        """
        self.iterations, self.active_set = 0, self.active_set.at_new_increment()
        self.began_with_pairs = any(one and one.pairs.nodes.size for one in self.active_set.tightenings)
        known, foreseen = self.active_set, self._approach(increment)
        try:
            converged = self._admissible(increment)
        except StepFailed:
            self.active_set = known
            raise
        if foreseen and not self.active_set.touching(self.positions(converged)):
            self.active_set = known
        return converged

    def settled(self, converged: Converged, increment: Increment) -> Converged | None:
        """The equilibrium whose pairs in creases are those of this load alone, not of increments on the way to it.

        The pairs are searched again from the equilibrium without any. The given one where the last increment began
        without pairs; None where this leads to none that is as stable and needs no exact distances.
        """
        if not self.began_with_pairs:
            return converged
        before = self.active_set
        self.active_set = before.restored().at_new_increment()
        with suppress(StepFailed):
            without = self._solve(Start.at(converged.state, self.active_set.active), increment)
            settled = self._checked(self._kept_apart(self._activate(without, increment), increment))
            is_as_stable = settled.negative_pivots <= converged.negative_pivots
            if is_as_stable and not self.active_set.needs_admissible_start:
                return settled
        self.active_set = before
        return None

    def _admissible(self, increment: Increment) -> Converged:
        """An equilibrium without overlap and without an element that is turned inside out; raises `StepFailed`."""
        last = increment.points[-1].state
        if self.active_set.needs_admissible_start:
            converged = self._solve(Start.at(last, self.active_set.active), increment)
        else:
            converged = self._from_predictor(increment)
        return self._checked(self._kept_apart(self._activate(converged, increment), increment))

    def _checked(self, converged: Converged) -> Converged:
        """The same; raises `NotAdmissible` where an element is turned inside out."""
        if converged.assembly.jacobian.min() <= 0:
            worst = extremes_of(self.system.space, converged.assembly.strain, converged.assembly.jacobian)
            raise NotAdmissible(Reason("element_inverted", {"min_J": worst.min_J}, worst.min_J_at))
        return converged

    def _kept_apart(self, converged: Converged, increment: Increment) -> Converged:
        """Equilibrium without walls that cross, with more or stiffer contact where needed; raises `StepFailed`."""
        last = increment.points[-1].state
        while violations := self.active_set.violations(x := self.positions(converged)):
            tightened = self.active_set.tightened(x)
            if tightened is self.active_set:
                raise NotAdmissible(violations[0])
            self.active_set = tightened
            start = Start.at(last if tightened.needs_admissible_start else converged.state, tightened.active)
            try:
                converged = self._activate(self._solve(start, increment), increment)
            except StepFailed as failure:
                reasons = violations[0], Reason("stiffer_contact_fails"), *failure.reasons
                raise type(failure)(*reasons) from None
        return converged

    def _approach(self, increment: Increment) -> bool:
        """Activate contact whose gaps close on the way at the rates of the last equilibrium; whether there is some.

        Behind the first contact an extrapolated path is far off, and is not tried.
        """
        last = increment.points[-1]
        if len(increment.points) == 1 or last.rate is None:  # rates at rest are too large by far where walls are thin
            return False
        motion = (increment.control.value - last.value) * last.rate.displacement
        approached = self.active_set.approached(self.system.space.points + last.state.displacement, motion)
        if approached is self.active_set:
            return False
        self.active_set, self.predictor_failed = approached, True
        return True

    def _activate(self, converged: Converged, increment: Increment) -> Converged:
        """Equilibrium with those contacts too that a state activates; each may activate the next."""
        while (activated := self.active_set.activated(self.positions(converged))) is not self.active_set:
            self.active_set = activated
            converged = self._solve(Start.at(converged.state, activated.active), increment)
        return converged

    def _from_predictor(self, increment: Increment) -> Converged:
        """Equilibrium, or a state that activates contact, from the first start of the predictor that leads to one."""
        failure, points, effort = StepFailed(Reason("nothing_tried")), increment.points, increment.effort
        for start in self.predictor.starts(points, increment.control, self.active_set.active, increment.limit):
            is_extrapolated = start.max_iterations is not None
            if is_extrapolated and self.predictor_failed:
                continue
            try:
                return self._solve(start, increment)
            except StepFailed as failed:
                failure, is_unstable = failed, isinstance(failed, Unstable)
                # where the load is too large, the start is not to blame
                self.predictor_failed = self.predictor_failed or (is_extrapolated and not is_unstable)
                is_enough = effort.is_near_limit or (is_unstable and effort.stays_stable)
                if is_enough and len(points) > 1:
                    break
        raise failure

    def _solve(self, start: Start, increment: Increment) -> Converged:
        control, effort = increment.control, increment.effort
        start = replace(start, terms=at_constant_fraction(start.terms, control.constant_fraction))
        if self.active_set.needs_admissible_start:  # iterates approach slowly, because no wall may cross in them
            start = replace(start, max_unstable=effort.unstable)
        else:
            limits = [limit for limit in (effort.iterations, start.max_iterations) if limit]
            start = replace(start, max_iterations=min(limits, default=None), max_unstable=effort.unstable)
            start = replace(start, stays_stable=effort.stays_stable)
        converged = newton.solve(start, control, self.options, increment.watch, self.active_set.inactive)
        self.iterations += converged.iterations
        return converged
