"""The results of experiments: states with their numbers, how far an experiment went, and several experiments."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf

import fem
from geometry import Centreline, Reason, Values
from geometry.arrays import Array, Index
from pipeline.values.reasons import render_all
from pipeline.values.record import Indicator
from pipeline.values.run import State
from rod import Load, RodError, cell_averaged
from rod.same_pressure import is_same

#: code of a limit point that a path has found
HAS_LIMIT = "has_limit"


@dataclass(frozen=True)
class Failure:
    """A pressure that an experiment did not reach."""

    pressure_kPa: float
    reasons: tuple[Reason, ...]  #: where its path ended, and why
    cutbacks: int  #: attempts that failed on the way to it
    factorizations: int  #: of these attempts
    limit_kPa: float = 0.0  #: of a limit point that was found; 0 where none was
    reached_kPa: float = 0.0  #: of the last equilibrium on the way to it
    not_followed: bool = False  #: whether the path was left because of the end of another experiment
    #: whether the path ended before all of the displacement of the end, or of the force on it, was reached
    with_part_of_end: bool = False
    #: whether there is an equilibrium at the pressure, and the body passes through itself in it
    passes_through_itself: bool = False

    @property
    def end_kPa(self) -> float:
        """The limit point, else the last equilibrium. Where there is none below a first pressure at which the body
        passes through itself, that pressure, which is an upper bound then. 0 where there is nothing to tell, also where
        the path ended with a part of the displacement or force of the end, which the body may not bear in full."""
        if self.with_part_of_end:
            return 0.0
        first_kPa = self.pressure_kPa if self.passes_through_itself else 0.0
        return self.limit_kPa or self.reached_kPa or first_kPa

    @property
    def codes(self) -> list[str]:
        """The codes of the reasons."""
        return [reason.code for reason in self.reasons]

    @property
    def brief(self) -> tuple[Reason, ...]:
        """The limit, or where the path ended, without what explains it."""
        limit = tuple(reason for reason in self.reasons if reason.code == HAS_LIMIT)
        return self.reasons if self.not_followed else limit or self.reasons[:1]


@dataclass(frozen=True)
class Record:
    """One experiment at one pressure: what later stages need of it. Forces are those on the full body."""

    state: State
    centreline: Centreline
    load: Load  #: end force, its couple about the end of the curve, and the weight of the arm
    displacement: Array = field(repr=False)  #: (n, 3), mm
    fields: Mapping[str, Array] = field(repr=False)  #: per tetrahedron, in the order of the mesh
    effects: tuple[str, ...]  #: names of the effects that took part
    spent: fem.Seconds
    held: tuple[bool, bool]  #: whether the displacement of the end along x and along y was prescribed
    cpu_seconds: float = 0.0  #: processor time since the state before, failed increments included
    inexact: tuple[Reason, ...] = ()  #: why its contact could not be compared with exact distances, where it should be
    path_dependence: float = 0.0  #: of contact in creases (`fem.Step`)
    instability: tuple[Reason, ...] = ()  #: in which directions it falls (`fem.Step`)

    @property
    def held_end(self) -> tuple[float | None, float | None]:
        """mm, the position of the end along the axes where it is held, None along the others."""
        x, y = float(self.centreline.x[-1]), float(self.centreline.y[-1])
        return x if self.held[0] else None, y if self.held[1] else None

    def kappa_middle(self, pitch: float) -> float | None:
        """The curvature in the middle, averaged over cells (pitch in mm), 1/mm; None for an arm of one or two cells."""
        try:
            return cell_averaged(self.centreline, pitch).middle
        except RodError:
            return None

    @property
    def experiment(self) -> str:
        """I, II, III or dead."""
        return self.state.experiment

    @property
    def pressure_kPa(self) -> float:
        """The pressure of the run."""
        return self.state.pressure_kPa


@dataclass(frozen=True)
class Outcome:
    """One experiment as far as it went."""

    name: str  #: of its load case
    records: tuple[Record, ...]  #: in the order of the load case
    failure: Failure | None  #: None where every pressure was reached
    seconds: fem.Seconds
    factorizations: int  #: of the states reached
    degrees_of_freedom: int
    solver: str  #: name of the linear solver
    points: Array = field(repr=False)  #: (n, 3) all nodes at rest, mm
    nodes: Index = field(repr=False)  #: (e, 10), (e, 4) with linear elements, in the order of the mesh
    unused_cpu_seconds: float = 0.0  #: processor time that led to none of the records, s

    @property
    def cpu_seconds(self) -> float:
        """Processor time of the whole load path, failed attempts included, s."""
        return sum(record.cpu_seconds for record in self.records) + self.unused_cpu_seconds

    def at(self, pressure_kPa: float) -> Record | None:
        """The state at a pressure, None where it was not reached."""
        return next((record for record in self.records if is_same(record.pressure_kPa, pressure_kPa)), None)

    def why_stopped(self, load: str = "") -> Reason | None:
        """Which pressure was not reached and why; None where all were. `load`: the name of a load of the validation."""
        if (failure := self.failure) is None:
            return None
        values: Values = {
            "pressure_kPa": failure.pressure_kPa,
            "reached_kPa": failure.reached_kPa,
            "limit_kPa": failure.limit_kPa,
            "why": list(failure.reasons),
        }
        if load:
            return Reason("load_stopped", {"load": load, **values})
        return Reason("stopped", {"experiment": self.name, **values})

    def merged(self, more: "Outcome") -> "Outcome":
        """One outcome with the records of both; states that `more` restored from this one count once."""
        added = [record for record in more.records if self.at(record.pressure_kPa) is None]
        spent = sum((record.spent for record in added), fem.Seconds(set_up=more.seconds.set_up))
        return replace(
            self,
            records=tuple(sorted((*self.records, *added), key=lambda record: record.pressure_kPa)),
            seconds=self.seconds + spent,
            factorizations=self.factorizations + sum(record.state.factorizations or 0 for record in added),
            unused_cpu_seconds=self.unused_cpu_seconds + more.unused_cpu_seconds,
        )


@dataclass(frozen=True)
class Outcomes:
    """The outcomes of several load cases on one body."""

    by_name: Mapping[str, Outcome]  #: by the name of the load case, in alphabetical order

    def __getitem__(self, name: str) -> Outcome:
        return self.by_name[name]

    def __iter__(self) -> Iterator[Outcome]:
        return iter(self.by_name.values())

    @property
    def pairs(self) -> tuple[tuple[Record, Record], ...]:
        """The states of II and of III at every pressure that both reached, by ascending pressure."""
        free = sorted(self["II"].records, key=lambda record: record.pressure_kPa)
        return tuple((record, loaded) for record in free if (loaded := self["III"].at(record.pressure_kPa)))

    @property
    def reached_kPa(self) -> tuple[float, ...]:
        """The pressures that II and III both reached, ascending."""
        return tuple(free.pressure_kPa for free, _ in self.pairs)

    @property
    def records(self) -> tuple[Record, ...]:
        """All states that were reached."""
        return tuple(record for outcome in self for record in outcome.records)

    @property
    def failures(self) -> tuple[Reason, ...]:
        """Why experiments stopped early, first those with a reason of their own."""
        ended = sorted((o for o in self if o.failure), key=lambda o: bool(o.failure and o.failure.not_followed))
        return tuple(filter(None, (outcome.why_stopped() for outcome in ended)))

    @property
    def first_to_end(self) -> tuple[str, float] | None:
        """The experiment that ended at the lowest pressure, and this pressure in kPa (`Failure.end_kPa`). None where
        that is not known of any.

        One that was not followed because of the end of another tells nothing.
        """
        known = [o for o in self if o.failure and not o.failure.not_followed]
        ends = [(o.failure.end_kPa, o.name) for o in known if o.failure]
        lowest = min((end for end in ends if end[0] > 0.0), default=None)
        return lowest and (lowest[1], lowest[0])

    def lowest_end_kPa(self, *names: str) -> float:
        """The lowest end in kPa, of these experiments alone where any are named; infinite where none is known."""
        among = Outcomes({name: outcome for name, outcome in self.by_name.items() if not names or name in names})
        return among.first_to_end[1] if among.first_to_end else inf

    @property
    def seconds(self) -> fem.Seconds:
        """Seconds of the solver over all experiments."""
        return sum((outcome.seconds for outcome in self), fem.Seconds())

    @property
    def seconds_by_stage(self) -> dict[str, float]:
        """Seconds by set_up, assembly, analysis, factorization, solve and contact; other effects are assembly."""
        spent = self.seconds
        contact = spent.effects.get("self_contact", 0.0)
        return {
            "set_up": spent.set_up,
            "assembly": spent.assembly + sum(spent.effects.values()) - contact,
            "analysis": spent.analysis,
            "factorization": spent.factorization,
            "solve": spent.solve,
            "contact": contact,
        }

    @property
    def factorizations(self) -> int:
        """Factorizations of the states reached, over all experiments."""
        return sum(outcome.factorizations for outcome in self)

    @property
    def cpu_seconds(self) -> float:
        """Processor time over all experiments, failed attempts included, s."""
        return sum(outcome.cpu_seconds for outcome in self)

    @property
    def degrees_of_freedom(self) -> int:
        """Degrees of freedom of the experiment with the most."""
        return max(outcome.degrees_of_freedom for outcome in self)

    @property
    def largest_indicator(self) -> Indicator | None:
        """The error indicator of the state in which it is largest; None where no state was reached."""
        if not self.records:
            return None
        worst = max((record.state for record in self.records), key=lambda state: state.stress_error)
        assert worst.stress_error_at_mm is not None
        found = Indicator(worst.stress_error, worst.experiment, worst.pressure_kPa, worst.stress_error_at_mm)
        sentence = (
            "The stress of the elements differs from a smooth one recovered from it by at most "
            f"{100 * found.stress_error:.2g} % in energy, {found.location}"
        )
        return replace(found, sentence=sentence)

    def merged(self, more: "Outcomes") -> "Outcomes":
        """These outcomes with the further states of `more`, which has the same load cases."""
        return Outcomes({name: outcome.merged(more[name]) for name, outcome in self.by_name.items()})

    @property
    def states(self) -> tuple[State, ...]:
        """The rows of experiments.json: every state, and behind those of an experiment the pressure it failed at."""
        states: list[State] = []
        for outcome in self:
            states += [record.state for record in outcome.records]
            if failure := outcome.failure:
                why = render_all(failure.reasons)
                states.append(State(outcome.name, failure.pressure_kPa, status="not converged", reason=why))
        return tuple(states)
