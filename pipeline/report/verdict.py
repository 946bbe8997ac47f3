"""The verdict of a run: the five parameters, the rod to take with its errors, and what a reader must know of them.

It is one value, made from the result files alone. The terminal, the report, `pneurod run --json` and
`pneurod.read_results` show the same numbers and the same sentences of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.report.formatting import number
from pipeline.report.law_range import moments_of_identification, moments_sentence
from pipeline.report.mesh import mesh_sentences
from pipeline.report.mesh_error import law_mesh_error, mesh_besides, mesh_error, what_spread_is
from pipeline.report.next_steps import next_steps
from pipeline.report.numbers import NUMBERS, Cell, eccentricity, five_parameters
from pipeline.report.offsets import jump_sentence
from pipeline.report.results import EffectRow, Results
from pipeline.report.sentences import in_short, lines_needed
from pipeline.report.untested import untested
from pipeline.report.validation import TITLES, RodErrors, recommended_rod, rod_errors, rod_to_take
from pipeline.store.formats import of_extensible
from pipeline.store.json_values import JsonObject
from pipeline.validation.rods import ARM_LAW, EXTENSIBLE, FIVE

#: the topic of what was not reached
FAILURE = "failure"
#: clauses of the reason of an effect that are shown; an own law that ends early at every pressure has fifteen
CLAUSES = 5


@dataclass(frozen=True)
class Statement:
    """Sentences on one question that a reader has."""

    topic: str  #: failure, rod, errors, single line, unusual, simulated, mesh, mesh error, not tested, next
    sentences: tuple[str, ...]  #: at least one


@dataclass(frozen=True)
class FiveNumbers:
    """The five parameters at one pressure, as they are written."""

    pressure: str  #: kPa
    cells: tuple[Cell, ...]  #: α₁, α₂ (N mm²), m₀₁, m₀₂ (N mm), d (mm); of the rod that stretches e (mm) as well


@dataclass(frozen=True)
class Verdict:
    """What a run has found, and how far it can be relied on."""

    design: str  #: its name
    length_mm: float  #: NaN where the body was not meshed
    #: by pressure; of the rod that stretches where that is to be taken, else of the one that does not; empty where the
    #: parameters were not identified
    five: tuple[FiveNumbers, ...]
    spread: str  #: what stands behind ±: one standard deviation, with or without the error of the mesh
    rod: str  #: the rod to take: one of the names in `pipeline.validation.rods`; empty where none is recommended
    errors: tuple[RodErrors, ...]  #: of every rod, that to take first
    statements: tuple[Statement, ...]
    parameters: tuple[JsonObject, ...]  #: by pressure: those of `five` unrounded, with _std and _95
    accuracy: JsonObject | None  #: requested and estimated error; None where none was requested or could be estimated
    failure_in_short: tuple[str, ...]  #: what is shown on a terminal for the statement on failure; empty without one

    @property
    def stretches(self) -> bool:
        """Whether `five` are the parameters of the rod that stretches, with its eccentricity e."""
        return self.rod == EXTENSIBLE

    @property
    def parameters_of(self) -> str:
        """The rod that `five` and `parameters` belong to, five or five_extensible; empty without them."""
        return (EXTENSIBLE if self.stretches else FIVE) if self.parameters else ""

    @property
    def whose_parameters(self) -> str:
        """A sentence where the parameters are not those of the rod to take; else empty."""
        other = self.parameters and self.rod and self.parameters_of != self.rod
        return f"They belong to {TITLES[self.parameters_of]}, not to the rod to take." if other else ""

    @property
    def sentences(self) -> tuple[str, ...]:
        """All sentences, in the order in which they are shown."""
        return tuple(sentence for statement in self.statements for sentence in statement.sentences)

    @property
    def terminal_sentences(self) -> tuple[str, ...]:
        """All sentences, with those on failure in short."""
        return (
            *self.failure_in_short,
            *(sentence for s in self.statements if s.topic != FAILURE for sentence in s.sentences),
        )

    def on(self, topic: str) -> tuple[str, ...]:
        """The sentences on one topic; none where nothing is said of it."""
        return next((s.sentences for s in self.statements if s.topic == topic), ())

    def record(self) -> JsonObject:
        """The verdict as `pneurod run --json` writes it."""
        return {
            "design": self.design,
            "length_mm": self.length_mm,
            "parameters": self.parameters,
            "parameters_of": self.parameters_of,
            "rod": self.rod,
            "errors": [errors.record() for errors in self.errors],
            "accuracy": self.accuracy,
            "sentences": {statement.topic: statement.sentences for statement in self.statements},
        }


def verdict_of(results: Results) -> Verdict:
    """The verdict on the result files of a run."""
    errors = rod_errors(results)
    rod = recommended_rod(errors)
    topics = {
        FAILURE: _failure(results),
        "rod": _rod(results, rod),
        "errors": [*rod_to_take(results)[1:], *filter(None, [jump_sentence(results)]), *_moments(results, rod)],
        "single line": _single_line(results),
        "unusual": [f"Note: {sentence}." for sentence in results.run.get("remarks") or ()],
        "simulated": _simulated(results.effects),
        "mesh": mesh_sentences(results),
        "mesh error": _mesh_error(results),
        "not tested": untested(results),
        "next": next_steps(results, rod),
    }
    return Verdict(
        design=str(results.run.get("config", {}).get("name", results.directory.name)),
        length_mm=results.length,
        five=tuple(FiveNumbers(pressure, tuple(cells)) for pressure, cells in _five(results, rod)),
        spread=what_spread_is(results),
        rod=rod,
        errors=tuple(errors),
        statements=tuple(Statement(topic, tuple(sentences)) for topic, sentences in topics.items() if sentences),
        parameters=tuple(_parameters(results, rod, index) for index in range(len(results.identified_pressures))),
        accuracy=_accuracy(results),
        failure_in_short=tuple(_failure_in_short(results)),
    )


def _five(results: Results, rod: str) -> list[tuple[str, list[Cell]]]:
    """Rows by pressure: p and the parameters of the rod to take, or of the one that does not stretch."""
    return eccentricity(results) if rod == EXTENSIBLE else five_parameters(results)


def _failure(results: Results) -> list[str]:
    """What was not reached, with all that is known of the reason."""
    if results.run.get("failure"):
        return [f"Not everything was reached: {results.run['failure']}."]
    lost = _lost(results)
    return [f"Not every pressure was reached: {'; '.join(lost)}."] if lost else []


def _failure_in_short(results: Results) -> list[str]:
    """The same with the limit and a place of each reason."""
    run = results.run
    failures = run.get("failures") or ([run["failure"]] if run.get("failure") else _lost(results))
    if not failures:
        return []
    return [f"Not reached: {'; '.join(in_short(failures))}. The report and run.json have the whole reason."]


def _lost(results: Results) -> list[str]:
    """The pressures that were not reached."""
    return [f"{row.experiment} at {number(row.pressure_kPa)} kPa: {row.reason}" for row in results.failures]


def _rod(results: Results, rod: str) -> list[str]:
    """Which rod to take, and the error of the mesh beside its own."""
    to_take = rod_to_take(results)[:1]
    return [*to_take, mesh_besides(results, rod)] if to_take else ["No rod was compared with the finite elements."]


def _moments(results: Results, rod: str) -> list[str]:
    """For which moments the rod to take is known: with the arm's own law, or identified."""
    sentence = moments_sentence(results) if rod == ARM_LAW else moments_of_identification(results, rod)
    return [sentence] if sentence else []


def _single_line(results: Results) -> list[str]:
    """At which pressures there are two parameters instead of five."""
    return [lines_needed(results)] if any(results.parameters.get("single_line_suffices") or ()) else []


def _simulated(effects: Sequence[EffectRow]) -> list[str]:
    """Which effects were simulated and which were not, each with its reason."""
    sentences = []
    for state, beginning in (("on", "Simulated"), ("off", "Not simulated")):
        parts = [f"{row.effect.replace('_', ' ')} ({_beginning(row.reason)})" for row in effects if row.state == state]
        if parts:
            sentences.append(f"{beginning}: {'; '.join(parts)}.")
    return sentences


def _beginning(reason: str) -> str:
    """A reason, or its first clauses and how many more effects.json has."""
    clauses = reason.split("; ")
    if len(clauses) <= CLAUSES + 1:
        return reason
    left_out = f"{len(clauses) - CLAUSES} more clauses are in effects.json and in the report's table of effects"
    return "; ".join((*clauses[:CLAUSES], left_out))


def _mesh_error(results: Results) -> list[str]:
    """What the mesh contributes to the errors, or that this was not estimated."""
    if not results.parameters and not results.arm_law:
        return []
    planned = (results.run.get("accuracy") or {}).get("sentence")
    accuracy = f"Accuracy: {planned}." if planned else ""
    return [*filter(None, (accuracy, mesh_error(results), law_mesh_error(results)))]


def _accuracy(results: Results) -> JsonObject | None:
    """The requested error, the latest estimate, and whether that is within it."""
    accuracy = results.run.get("accuracy") or {}
    if "is_reached" not in accuracy:  # files from before this key
        return None
    present = accuracy["after"] or accuracy
    keys = {key: accuracy[key] for key in ("requested", "is_reached")}
    return {**keys, "estimated_error": present["estimated_error"]}


def _parameters(results: Results, rod: str, index: int) -> JsonObject:
    """The parameters of the rod to take, or of the one that does not stretch, by their keys in parameters.json."""
    columns = of_extensible(results.parameters) if rod == EXTENSIBLE else results.parameters
    names = [*(key for key, _, _ in NUMBERS), *(["eccentricity_mm"] if rod == EXTENSIBLE else [])]
    keys = [f"{name}{ending}" for name in names for ending in ("", "_std", "_95")]
    there = {key: columns[key][index] for key in keys if columns.get(key)}
    return {"pressure_kPa": results.identified_pressures[index], **there}
