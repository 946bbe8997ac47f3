"""The numbers and the cost of the variants of an effect study, and their changes against the configuration."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

from pipeline.config.config import Config
from pipeline.identify.parameters import Parameters, identify_all
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.study.sweep.record import Row
from pipeline.values.reasons import render, render_all
from pipeline.values.table import Table
from rod.same_pressure import is_among

#: what is run on a variant, as in a sweep
EFFECTS_RUN = ("effects",)
BASE = "as configured"
#: number of a row -> title of its column
COLUMNS = {
    "kappa_0_middle_per_mm": "κ₀(l/2) 1/mm",
    "alpha1_N_mm2": "α₁ N mm²",
    "alpha2_N_mm2": "α₂ N mm²",
    "d_mm": "d mm",
    "end_force_N": "F N",
}
#: marks the cost of a variant that reached other states
_OTHER_STATES = "*"


@dataclass(frozen=True)
class VariantRow:
    """Numbers and cost of a variant at one pressure; None where a state, or the five parameters, are missing."""

    pressure_kPa: float
    kappa_0_middle_per_mm: float | None = None
    end_force_N: float | None = None  #: in III, along y
    end_y_II_mm: float | None = None
    alpha1_N_mm2: float | None = None
    alpha2_N_mm2: float | None = None
    d_mm: float | None = None
    single_line_suffices: bool | None = None  #: by the criterion alone
    r2_single_line: float | None = None
    r2_two_lines: float | None = None
    stretch_of_curve: tuple[float | None, float | None] | None = None  #: in II and III
    contact: bool | None = None  #: whether walls touch in II or III
    cpu_seconds: float | None = None  #: over all pressures, as the following
    factorizations: int | None = None
    degrees_of_freedom: int | None = None
    states: int | None = None
    reason: str = ""  #: why a number is missing


@dataclass(frozen=True)
class EffectRow(VariantRow):
    """A row of effects_table.json: a variant at one pressure, and its changes against the configuration."""

    effect: str = BASE
    state: str = ""
    other_states: bool = False  #: whether more or fewer states were reached than as configured, so that costs differ
    relative_change: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def variant(self) -> str:
        """self_contact off"""
        return f"{self.effect} {self.state}".strip()


def solve_variant(config: Config, context: RunContext) -> tuple[list[Row], list[str]]:
    """II and III: a `VariantRow` for every pressure, and a sentence for each missing number."""
    scene = Scene.meshed(config)
    rows = variant_rows(scene, simulate(scene, context, ("III", "II")))
    return [asdict(row) for row in rows], list(dict.fromkeys(row.reason for row in rows if row.reason))


def variant_rows(scene: Scene, outcomes: Outcomes) -> list[VariantRow]:
    """Numbers, cost and what is missing, at every pressure of the configuration."""
    config, pitch = scene.config, scene.body.pitch
    # by the criterion alone: whether two lines need contact is what this study shows
    parameters, refused = identify_all(outcomes, pitch, config.identification.d_mm, equal_cells=False)
    identified = {at_pressure.pressure_kPa: at_pressure for at_pressure in parameters}
    without = [pressure for pressure in outcomes.reached_kPa if pressure not in identified]
    reasons = dict(zip(without, map(render, refused), strict=True))
    for pressure in config.pressures_kPa:
        if not is_among(outcomes.reached_kPa, pressure):
            stopped = (outcome.why_stopped() for outcome in outcomes if outcome.at(pressure) is None)
            reasons[pressure] = render_all(filter(None, stopped))
    return [
        _row(outcomes, pressure, pitch, identified.get(pressure), reasons.get(pressure, ""))
        for pressure in config.pressures_kPa
    ]


def _row(outcomes: Outcomes, pressure: float, pitch: float, parameters: Parameters | None, reason: str) -> VariantRow:
    """From the states at one pressure, as far as they were reached, and the parameters, if there are any."""
    free, loaded = outcomes["II"].at(pressure), outcomes["III"].at(pressure)
    return VariantRow(
        pressure,
        kappa_0_middle_per_mm=free.kappa_middle(pitch) if free else None,
        end_force_N=loaded.load.force[1] if loaded else None,
        end_y_II_mm=free.state.end_mm[1] if free else None,
        stretch_of_curve=(free.centreline.stretch if free else None, loaded.centreline.stretch if loaded else None),
        contact=any("self_contact" in record.effects for record in (free, loaded) if record),
        cpu_seconds=outcomes.cpu_seconds,
        factorizations=outcomes.factorizations + outcomes.failed_factorizations,
        degrees_of_freedom=outcomes.degrees_of_freedom,
        states=len(outcomes.records),
        reason=reason,
        alpha1_N_mm2=parameters.numbers["alpha1"].value if parameters else None,
        alpha2_N_mm2=parameters.numbers["alpha2"].value if parameters else None,
        d_mm=parameters.numbers["d"].value if parameters and parameters.two_lines else None,
        single_line_suffices=not parameters.two_lines if parameters else None,
        r2_single_line=parameters.by_cells.single_line.r2 if parameters else None,
        r2_two_lines=parameters.by_cells.r2 if parameters else None,
    )


def compared(variants: Sequence[tuple[str, str, Sequence[VariantRow]]]) -> list[EffectRow]:
    """Rows of effects_table.json from the rows of (effect, state); changes are relative to those of `BASE`."""
    as_configured = {row.pressure_kPa: row for effect, _, rows in variants if effect == BASE for row in rows}
    table = []
    for effect, state, rows in variants:
        for row in rows:
            base = as_configured.get(row.pressure_kPa, VariantRow(row.pressure_kPa))
            other_states = None not in (row.states, base.states) and row.states != base.states
            changes = {name: _change(getattr(row, name), getattr(base, name)) for name in (*COLUMNS, "cpu_seconds")}
            table.append(
                EffectRow(**vars(row), effect=effect, state=state, other_states=other_states, relative_change=changes)
            )
    return table


def _change(value: float | None, reference: float | None) -> float | None:
    return value / reference - 1.0 if value is not None and reference else None


def effects_table(rows: Sequence[EffectRow]) -> Table:
    """Every number above its change against the configuration, and the cost; it fits into 80 columns."""
    titles = [title.replace(" ", "\n", 1) for title in COLUMNS.values()]
    heads = ("effect", "p\nkPa", *titles, "single\nline", "CPU\ns", "facto-\nriza-\ntions")
    caption = "single line: whether one slope describes the arm as well as two"
    if any(row.other_states for row in rows):
        caption += f"\n{_OTHER_STATES} reached more or fewer states than as configured, so the costs differ"
    cells, previous = [], ""
    for row in rows:
        name = row.variant.replace("_", " ")
        first, previous = name != previous, name
        suffices = {True: "yes", False: "no", None: ""}[row.single_line_suffices]
        numbers = [_with_change(row, getattr(row, key), key) for key in COLUMNS]
        cost = _costs(row) if first else ("", "")
        cells.append((name if first else "", f"{row.pressure_kPa:g}", *numbers, suffices, *cost))
    return Table(heads, tuple(cells), caption)


def _costs(row: EffectRow) -> tuple[str, str]:
    """Processor seconds to two digits above their change, and factorizations."""
    if row.cpu_seconds is None:
        return "", ""
    mark = _OTHER_STATES if row.other_states else ""
    seconds = float(f"{row.cpu_seconds:.2g}")
    return _with_change(row, seconds, "cpu_seconds", mark), f"{row.factorizations}{mark}"


def _with_change(row: EffectRow, value: float | None, name: str, mark: str = "") -> str:
    """A number above its change."""
    change = row.relative_change[name]
    if value is None:
        return ""
    shown = f"{value:.4g}{mark}"
    if row.effect == BASE or change is None:
        return shown
    return f"{shown}\n{100 * change:+.{1 if abs(change) < 0.0995 else 0}f} %"
