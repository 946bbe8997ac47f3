"""Tables on the terminal: the effects of a run, and what each of them changes and costs."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table
from rich.text import Text

from pipeline.effects_table import BASE, COLUMNS

__all__ = ["comparison", "sentences"]

Row = Mapping[str, Any]


def comparison(rows: Sequence[Row]) -> Table:
    """Rows of effects_table.json: every number with its change against the configuration, and the cost."""
    table = Table("effect", "p kPa", *COLUMNS.values(), "one line suffices", "seconds", "factorizations", box=None)
    for column in table.columns[1:]:
        column.justify = "right"
    before = ""
    for row in rows:
        name = f"{row['effect']} {row['state']}".strip()
        first, before = name != before, name
        numbers = [_number(row, key) for key in COLUMNS]
        cost = (f"{row['seconds']:.0f}", str(row["factorizations"])) if first else ("", "")
        suffices = "yes" if row["one_line_suffices"] else "no"
        table.add_row(name if first else "", f"{row['pressure_kPa']:g}", *numbers, suffices, *cost)
    return table


def sentences(rows: Sequence[Row]) -> Table:
    """Rows of effects.json: which effects were simulated, and why."""
    table = Table.grid(padding=(0, 2))
    for row in rows:
        state = Text(row["state"], style="green" if row["state"] == "on" else "dim")
        table.add_row(row["effect"], state, Text(row["reason"]))
    return table


def _number(row: Row, key: str) -> str:
    value, change = row[key], row["relative_change"][key]
    if value is None:
        return ""
    shown = f"{value:.4g}"
    return shown if row["effect"] == BASE or change is None else f"{shown} ({100 * change:+.1f} %)"
