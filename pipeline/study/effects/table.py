"""The comparison of effects as a table on the terminal."""

from pipeline.study.effects.rows import BASE, EffectRow

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
