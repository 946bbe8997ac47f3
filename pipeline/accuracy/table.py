"""The rows of accuracy.json as cells of a table, for the terminal and for the docs."""

from collections.abc import Mapping
from typing import Any

from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE
from pipeline.accuracy.reference import NUMBERS

#: stages of a rung, in the order of its column
STAGES = ("mesh", "set_up", "assembly", "factorization", "contact", "fit")
COLUMNS_OF_RUNGS = (
    *("choice", "", "dofs", "CPU s", "mesh / set-up / assembly / factors / contact / fit s", "MB", "factors"),
    *(f"{name} %" for name in NUMBERS.values()),
)
_UNITS = {TOLERANCE: "", CONTACT: " mm", POINTS: " points"}


def cells(row: Mapping[str, Any]) -> list[str]:
    """One rung; errors are the largest over the pressures, in per cent. A rung that failed says so."""
    varies = f"{row['value']:g}{_UNITS.get(row['choice'], ' mm')}" if row["value"] is not None else ""
    if not row["errors"]:
        return [row["choice"], varies, *["-"] * 5, *["-"] * len(NUMBERS)]
    share = row["cpu_seconds"] / row["wall_seconds"]  # of the processor that other work on the machine left
    stages = " / ".join(f"{share * row['seconds'][name]:.1f}" for name in STAGES)
    return [
        row["choice"],
        varies,
        f"{row['degrees_of_freedom']}",
        f"{row['cpu_seconds']:.1f}",
        stages,
        f"{row['peak_memory_MB']:.0f}",
        f"{row['factorizations']}",
        *(_largest(row, key) for key in NUMBERS),
    ]


def _largest(row: Mapping[str, Any], key: str) -> str:
    found = [one[key] for one in row["errors"] if one[key] is not None]
    return f"{100 * max(found, key=abs):+.1f}" if found else ""


def reference_sentences(record: Mapping[str, Any]) -> list[str]:
    """What the errors are counted from, at every pressure, with two standard deviations."""
    sentences = []
    for found in record["reference"]:
        parts = []
        for key, name in NUMBERS.items():
            if found[key] is None:
                continue
            pairs = found[key] if key == "end_mm" else [found[key]]
            parts.append(f"{name} = " + ", ".join(f"{one['value']:.4g} ± {2 * one['std']:.2g}" for one in pairs))
        sentences.append(f"{found['pressure_kPa']:g} kPa: {'; '.join(parts)} ({_UNITS_SAID})")
    return sentences


_UNITS_SAID = "1/mm, N mm², mm, N; ± two standard deviations"


def markdown(record: Mapping[str, Any]) -> str:
    """The table of the docs: the rungs by choice, those that nothing beats in bold."""
    lines = ["| " + " | ".join(COLUMNS_OF_RUNGS) + " |", "|---|" + "---:|" * (len(COLUMNS_OF_RUNGS) - 1)]
    for row in record["rungs"]:
        shown = cells(row)
        if row["on_front"]:
            shown[0] = f"**{shown[0]}**"
        lines.append("| " + " | ".join(shown) + " |")
    return "\n".join(lines) + "\n"
