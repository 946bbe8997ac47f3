"""The numbers and the cost of the variants of an effect study, and their changes against the configuration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from pipeline.values.table import Table

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
class EffectRow:
    """A row of effects_table.json: numbers and cost of a variant at one pressure, and what it changes.

    None where a state, or the five parameters, are missing.
    """

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
    effect: str = BASE
    state: str = ""
    other_states: bool = False  #: whether more or fewer states were reached than as configured, so that costs differ
    relative_change: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def variant(self) -> str:
        """self_contact off"""
        return f"{self.effect} {self.state}".strip()


def compared(rows: Sequence[EffectRow]) -> list[EffectRow]:
    """The rows with their changes against those of `BASE`."""
    as_configured = {row.pressure_kPa: row for row in rows if row.effect == BASE}
    table = []
    for row in rows:
        base = as_configured.get(row.pressure_kPa, EffectRow(row.pressure_kPa))
        other_states = None not in (row.states, base.states) and row.states != base.states
        changes = {name: _change(getattr(row, name), getattr(base, name)) for name in (*COLUMNS, "cpu_seconds")}
        table.append(replace(row, other_states=other_states, relative_change=changes))
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
