"""The comparison of effects as a table on the terminal."""

from collections.abc import Sequence

from rich.table import Table

from pipeline.study.effects.rows import BASE, COLUMNS, EffectRow


def effects_comparison(rows: Sequence[EffectRow]) -> Table:
    """Every number above its change against the configuration, and the cost; it fits into 80 columns."""
    heads = [name.replace(" ", "\n", 1) for name in COLUMNS.values()]
    last = ("single\nline", "CPU\ns", "facto-\nriza-\ntions")
    table = Table("effect", "p\nkPa", *heads, *last, box=None, padding=(0, 1, 0, 0))
    table.caption = "single line: whether one slope describes the arm as well as two"
    if any(row["other_states"] for row in rows):
        table.caption += f"\n{_OTHER_STATES} reached more or fewer states than as configured, so the costs differ"
    for column in table.columns[1:]:
        column.justify = "right"
        column.no_wrap = True
    previous = ""
    for row in rows:
        name = f"{row['effect']} {row['state']}".strip().replace("_", " ")
        first, previous = name != previous, name
        cost = _costs(row) if first else ("", "")
        suffices = {True: "yes", False: "no", None: ""}[row["single_line_suffices"]]
        numbers = [_number(row, row[key], key) for key in COLUMNS]
        table.add_row(name if first else "", f"{row['pressure_kPa']:g}", *numbers, suffices, *cost)
    return table


#: marks the cost of a variant that reached other states
_OTHER_STATES = "*"


def _costs(row: EffectRow) -> tuple[str, str]:
    """Processor seconds to two digits above their change, and factorizations."""
    if row["cpu_seconds"] is None:
        return "", ""
    mark = _OTHER_STATES if row["other_states"] else ""
    seconds = float(f"{row['cpu_seconds']:.2g}")
    return _number(row, seconds, "cpu_seconds", mark), f"{row['factorizations']}{mark}"


def _number(row: EffectRow, value: float | None, name: str, mark: str = "") -> str:
    """A number above its change."""
    change = row["relative_change"][name]
    if value is None:
        return ""
    shown = f"{value:.4g}{mark}"
    if row["effect"] == BASE or change is None:
        return shown
    return f"{shown}\n{100 * change:+.{1 if abs(change) < 0.0995 else 0}f} %"
