"""The load path of one case: its states, each stored as soon as it is reached, and why a pressure was not."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from time import process_time
from typing import final

import fem
from geometry import Reason, Values
from pipeline.simulate.known_limit import PART_FOR_III, EndOfII
from pipeline.simulate.loadcase import LoadCase
from pipeline.simulate.outcome import Failure
from pipeline.store.progress import Progress
from pipeline.store.store import Store


@final
@dataclass
class CasePath:
    """The path of one case; it reports its progress, with pressures in kPa."""

    case: LoadCase
    model: fem.Model
    newton: fem.NewtonOptions
    store: Store
    progress: Progress
    end_of_II: EndOfII | None  #: None for a case that it does not concern
    reached: int = 0  #: pressures of the schedule that are reached
    is_given_up: bool = False  #: whether the last pressure was given up because of the end of II
    #: processor time of this process, s, from the state before to each one that is reached, and since the last of them;
    #: of states that an earlier run has stored, that of its process
    cpu_seconds: list[float] = field(default_factory=list)
    cpu_seconds_since: float = 0.0
    _clock: float = field(default=0.0, init=False, repr=False)

    def follow(self) -> tuple[fem.Solution, Failure | None]:
        """The states that are reached, those stored by an earlier run included, and why the next pressure is not.

        Where II ends below a pressure, I is given up there, and III is followed up to a part of the end of II, because
        its own may be lower.
        """
        self._clock = process_time()
        try:
            return self._follow()
        finally:
            self.cpu_seconds_since = self._lap()

    def _follow(self) -> tuple[fem.Solution, Failure | None]:
        end_of_II, options = self.end_of_II, fem.PathOptions(self.newton)
        if end_of_II is not None:
            options = fem.PathOptions(self.newton, give_up=self._gives_up)
        observer = fem.PathObserver(self._iteration, self._step_done)
        stored = self._stored_steps()
        factors, begin = self.case.schedule.factors, self._begin(len(stored))
        try:
            return fem.follow(self.model, factors, options, observer, resume=stored, begin=begin), None
        except fem.NotConverged as ended:
            solution, end = ended.partial, ended.end
        failure = self._failure(end, end.factorizations)
        # on the way to a first pressure a moved end moves as well, and at a lower one less of it
        is_three_given_up = self.is_given_up and self.case.experiment == "III"
        if end_of_II is not None and is_three_given_up and not failure.with_part_of_end:
            failure = self._follow_below_II(end_of_II, failure, solution.steps)
        return solution, failure

    @property
    def _pressure(self) -> float:
        """The pressure that is being solved."""
        return self.case.schedule.pressures_kPa[self.reached]

    def _stored_steps(self) -> list[fem.Step]:
        """The finished steps of an earlier run with this configuration, up to the first that is missing."""
        steps: list[fem.Step] = []
        for pressure in self.case.schedule.pressures_kPa:
            arrays = self.store.load_state(self.case.name, pressure)
            if arrays is None:
                break
            steps.append(fem.step_from_arrays(self.model.space, arrays))
            self.cpu_seconds.append(float(arrays["cpu_seconds"]))
            self.progress.step_done(self.case.name, pressure, 0.0)
            self.reached += 1
        return steps

    def _begin(self, finished: int) -> list[fem.Step | None]:
        """For each pressure the near state where the way to it begins; None for the finished ones, and for rest."""
        steps: dict[float | None, fem.Step | None] = {None: None}
        near = [self.case.begin_kPa(pressure) for pressure in self.case.schedule.pressures_kPa[finished:]]
        for pressure in near:
            if pressure is not None and pressure not in steps:
                arrays = self.store.load_state(self.case.near, pressure)
                steps[pressure] = None if arrays is None else fem.step_from_arrays(self.model.space, arrays)
        return [None] * finished + [steps[pressure] for pressure in near]

    def _gives_up(self, factor: float) -> bool:
        """Whether a load is not worth being tried further, from where II ends."""
        assert self.end_of_II is not None
        self.is_given_up = self.end_of_II.is_below(self.case.schedule.pressure_at(factor))
        return self.is_given_up

    def _follow_below_II(self, end_of_II: EndOfII, failure: Failure, steps: Sequence[fem.Step]) -> Failure:
        """The failure of III after it was followed up to a part of the end of II, or how it ends before that."""
        part_kPa = PART_FOR_III * end_of_II.end_kPa
        if part_kPa <= failure.reached_kPa:
            return failure
        factors = (*(step.factor for step in steps), self.case.schedule.factor_at(part_kPa))
        options, observer = fem.PathOptions(self.newton), fem.PathObserver(self._iteration)
        try:
            last = fem.follow(self.model, factors, options, observer, resume=steps).steps[-1]
        except fem.NotConverged as ended:
            self.is_given_up = False
            end = replace(ended.end, target=self.case.schedule.factors[self.reached])
            return self._failure(end, failure.factorizations + end.factorizations)
        values: Values = {"reached_kPa": part_kPa, "percent": 100 * PART_FOR_III, "end": end_of_II.name}
        reasons = (Reason("followed_near_end_of_II", values),)
        factorizations = failure.factorizations + last.factorizations
        return replace(failure, reasons=reasons, reached_kPa=part_kPa, factorizations=factorizations)

    def _failure(self, end: fem.End, factorizations: int) -> Failure:
        """Why the pressure that is being solved was not reached."""
        at = self.case.schedule.pressure_at
        given_up, second = self.is_given_up, self.end_of_II
        return Failure(
            self._pressure,
            why_left(end, self.case, second) if given_up and second else why_ended(end, self.case),
            end.cutbacks,
            factorizations,
            limit_kPa=at(end.limit) if end.limit else 0.0,
            reached_kPa=at(end.reached),
            not_followed=self.is_given_up,
            with_part_of_end=_has_part_of_end(end, self.case),
        )

    def _iteration(self, factor: float, iteration: int, residual: float) -> None:
        self.progress.iteration(self.case.name, self._pressure, iteration, residual)

    def _step_done(self, step: fem.Step) -> None:
        self.cpu_seconds.append(self._lap())
        arrays = fem.step_to_arrays(step)
        self.store.save_state(self.case.name, self._pressure, **arrays, cpu_seconds=self.cpu_seconds[-1])
        self.progress.step_done(self.case.name, self._pressure, step.seconds)
        self.reached += 1

    def _lap(self) -> float:
        """Processor time of this process since the last call, s."""
        before, self._clock = self._clock, process_time()
        return self._clock - before


def why_ended(end: fem.End, case: LoadCase) -> tuple[Reason, ...]:
    """Where a path ended, in the units of the configuration, and why."""
    reached, target = (case.schedule.pressure_at(factor) for factor in (end.reached, end.target))
    values: Values = {"reached_kPa": reached, "target_kPa": target, **_part_of_end(end, case)}
    beyond = Reason("ends_with_part" if _has_part_of_end(end, case) else "ends_beyond", values)
    limit = [Reason("has_limit", {"limit_kPa": case.schedule.pressure_at(end.limit)})] if end.limit else []
    return (beyond, *limit, *end.reasons)


def why_left(end: fem.End, case: LoadCase, end_of_II: EndOfII) -> tuple[Reason, ...]:
    """How far a path was followed that was given up, and where experiment II ends."""
    values: Values = {"reached_kPa": case.schedule.pressure_at(end.reached), **_part_of_end(end, case)}
    followed = Reason("followed_with_part" if _has_part_of_end(end, case) else "followed_to", values)
    second = Reason("end_of_II", {"end": end_of_II.name, "end_kPa": end_of_II.end_kPa})
    return (followed if end.reached else Reason("not_tried"), second)


def _part_of_end(end: fem.End, case: LoadCase) -> Values:
    return {"percent": 100 * end.constant_fraction, "on_end": case.on_end} if _has_part_of_end(end, case) else {}


def _has_part_of_end(end: fem.End, case: LoadCase) -> bool:
    """Whether only a part of the displacement of the end, or of the force on it, was reached."""
    return end.constant_fraction < 1.0 and bool(case.on_end)
