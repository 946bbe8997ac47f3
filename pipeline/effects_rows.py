"""The numbers and the cost of the variants of an effect study, and their changes against the configuration."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

from pipeline.config.config import Config
from pipeline.identification.parameters import Parameters, identify_all
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.store.json_values import JsonObject

BASE = "as configured"
#: number of a row -> title of its column
COLUMNS = {
    "kappa_0_middle_per_mm": "κ₀(l/2) 1/mm",
    "alpha1_N_mm2": "α₁ N mm²",
    "alpha2_N_mm2": "α₂ N mm²",
    "d_mm": "d mm",
    "end_force_N": "F N",
}


@dataclass(frozen=True)
class Variant:
    """A configuration and the effect that was changed in it."""

    effect: str  #: BASE, or the effect that was changed
    state: str  #: what it was changed to; empty for BASE
    config: Config

    @property
    def name(self) -> str:
        """self_contact off"""
        return f"{self.effect} {self.state}".strip()

    @property
    def folder(self) -> str:
        """Folder of its states, relative to that of the study; the configuration itself is solved in the latter."""
        return f"{self.effect}_{self.state}" if self.state else "."


@dataclass(frozen=True)
class VariantNumbers:
    """The numbers of the rod at one pressure; None where a state or the five parameters they come from is missing."""

    pressure_kPa: float
    kappa_0_middle_per_mm: float | None = None
    end_force_N: float | None = None  #: y component in III
    end_y_II_mm: float | None = None
    alpha1_N_mm2: float | None = None
    alpha2_N_mm2: float | None = None
    d_mm: float | None = None  #: also None where a single line suffices, which has no break
    single_line_suffices: bool | None = None
    r2_single_line: float | None = None
    r2_two_lines: float | None = None
    stretch_of_curve: tuple[float | None, float | None] = (None, None)  #: in II and III
    contact: bool | None = None  #: whether contact took part in II or III

    @staticmethod
    def of(pressure_kPa: float, outcomes: Outcomes, pitch: float, parameters: Parameters | None) -> "VariantNumbers":
        """From the states at one pressure, as far as they were reached, and the parameters, if there are any.

        pitch: of the cells, mm.
        """
        free, loaded = outcomes["II"].at(pressure_kPa), outcomes["III"].at(pressure_kPa)
        identified = {} if parameters is None else _identified(parameters)
        return VariantNumbers(
            pressure_kPa=pressure_kPa,
            kappa_0_middle_per_mm=free.kappa_middle(pitch) if free else None,
            end_force_N=loaded.load.force[1] if loaded else None,
            end_y_II_mm=free.summary.end_mm[1] if free else None,
            **identified,
            stretch_of_curve=(
                free.centreline.stretch if free else None,
                loaded.centreline.stretch if loaded else None,
            ),
            contact=any("self_contact" in record.effects for record in (free, loaded) if record),
        )


def _identified(parameters: Parameters) -> dict[str, Any]:
    numbers = {name: interval.value for name, interval in parameters.numbers.items()}
    return {
        "alpha1_N_mm2": numbers["alpha1"],
        "alpha2_N_mm2": numbers["alpha2"],
        "d_mm": numbers["d"] if parameters.two_lines else None,
        "single_line_suffices": not parameters.two_lines,
        "r2_single_line": parameters.by_cells.single_line.r2,
        "r2_two_lines": parameters.by_cells.r2,
    }


@dataclass(frozen=True)
class VariantCost:
    """Cost of II and III over all pressures, failed attempts included."""

    cpu_seconds: float  #: of all processes; kernels are loaded before
    factorizations: int
    degrees_of_freedom: int
    states: int  #: that were reached

    @staticmethod
    def of(outcomes: Outcomes) -> "VariantCost":
        """From the experiments."""
        return VariantCost(
            outcomes.cpu_seconds,
            outcomes.factorizations + outcomes.failed_factorizations,
            outcomes.degrees_of_freedom,
            len(outcomes.records),
        )


@dataclass(frozen=True)
class VariantResult:
    """What one variant gives."""

    numbers: tuple[VariantNumbers, ...]  #: one for every pressure of the configuration
    cost: VariantCost | None  #: None where nothing could be solved
    reasons: Mapping[float, str]  #: by pressure in kPa, where a number is missing, one sentence

    @staticmethod
    def of(scene: Scene, outcomes: Outcomes) -> "VariantResult":
        """From the experiments II and III."""
        config, pitch = scene.config, scene.body.pitch
        # by the criterion alone: whether two lines need contact is what this study shows
        parameters, refused = identify_all(outcomes, pitch, config.identification.d_mm, equal_cells=False)
        identified = {at_pressure.pressure_kPa: at_pressure for at_pressure in parameters}
        without = [pressure for pressure in outcomes.reached_kPa if pressure not in identified]
        reasons = dict(zip(without, refused, strict=True))
        for pressure in config.pressures_kPa:
            if pressure not in outcomes.reached_kPa:
                ended = [outcome.failure_sentence() for outcome in outcomes if outcome.at(pressure) is None]
                reasons[pressure] = "; ".join(ended)
        numbers = [VariantNumbers.of(p, outcomes, pitch, identified.get(p)) for p in config.pressures_kPa]
        return VariantResult(tuple(numbers), VariantCost.of(outcomes), reasons)

    @staticmethod
    def none(config: Config, reason: str) -> "VariantResult":
        """Of a variant that cannot be solved."""
        numbers = tuple(VariantNumbers(pressure) for pressure in config.pressures_kPa)
        return VariantResult(numbers, None, dict.fromkeys(config.pressures_kPa, reason))


@dataclass(frozen=True)
class EffectRow:
    """One variant at one pressure, and its relative changes against the configuration at the same pressure."""

    effect: str
    state: str
    numbers: VariantNumbers
    cost: VariantCost | None
    #: by the names of `COLUMNS`, and of the processor time over all pressures; None where a number is missing
    relative_change: Mapping[str, float | None]
    reason: str = ""  #: why a number is missing, one sentence
    other_states: bool = False  #: whether more or fewer states were reached than as configured, so that costs differ

    def record(self) -> JsonObject:
        """As in effects_table.json."""
        return {
            "effect": self.effect,
            "state": self.state,
            **asdict(self.numbers),
            **(asdict(self.cost) if self.cost else dict.fromkeys(field.name for field in fields(VariantCost))),
            "other_states": self.other_states,
            "relative_change": self.relative_change,
            "reason": self.reason,
        }


def effect_rows(results: Sequence[tuple[Variant, VariantResult]]) -> list[EffectRow]:
    """One row per variant and pressure."""
    base = next((result for variant, result in results if variant.effect == BASE), None)
    numbers_of_base = {numbers.pressure_kPa: numbers for numbers in base.numbers} if base else {}
    cost = base.cost if base else None
    return [
        EffectRow(
            variant.effect,
            variant.state,
            numbers,
            result.cost,
            {**_changes(numbers, numbers_of_base.get(numbers.pressure_kPa)), "cpu_seconds": _cost(result.cost, cost)},
            result.reasons.get(numbers.pressure_kPa, ""),
            result.cost is not None and cost is not None and result.cost.states != cost.states,
        )
        for variant, result in results
        for numbers in result.numbers
    ]


def _changes(numbers: VariantNumbers, base: VariantNumbers | None) -> dict[str, float | None]:
    return {name: _change(getattr(numbers, name), getattr(base, name) if base else None) for name in COLUMNS}


def _cost(cost: VariantCost | None, base: VariantCost | None) -> float | None:
    return _change(cost.cpu_seconds, base.cpu_seconds) if cost and base else None


def _change(value: float | None, reference: float | None) -> float | None:
    return value / reference - 1.0 if value is not None and reference else None


def contact_sentences(rows: Sequence[EffectRow]) -> list[str]:
    """Whether the two slopes are caused by chambers in contact, one sentence per pressure; none without both cases."""
    by_state: dict[float, dict[str, VariantNumbers]] = {}
    for row in rows:
        if row.effect in (BASE, "self_contact") and row.numbers.alpha1_N_mm2 is not None:
            by_state.setdefault(row.numbers.pressure_kPa, {})[row.state] = row.numbers
    return [
        f"{pressure:g} kPa: {_compared(states.get('on', states['']), states.get('off', states['']))}"
        for pressure, states in by_state.items()
        if len(states) == 2 and "" in states
    ]


def _compared(touching: VariantNumbers, free: VariantNumbers) -> str:
    """The slopes with and without contact."""
    if not touching.contact:
        return f"no walls met; {_slopes(touching)}"
    return f"with contact {_slopes(touching)}; without contact {_slopes(free)}"


def _slopes(numbers: VariantNumbers) -> str:
    if numbers.d_mm is None:
        return f"a single line suffices, alpha = {numbers.alpha1_N_mm2:.4g} N mm2"
    slopes = f"alpha1 = {numbers.alpha1_N_mm2:.4g}, alpha2 = {numbers.alpha2_N_mm2:.4g} N mm2"
    return f"{slopes}, d = {numbers.d_mm:.3g} mm"
