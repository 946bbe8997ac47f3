"""What all virtual arms together say: errors before and after, and how often stated intervals hold."""

from collections.abc import Sequence

import numpy as np

from benchmarks.markdown import table
from benchmarks.virtual_arms.bench import WHAT
from benchmarks.virtual_arms.predicted import Judged, Prediction
from pipeline.values.page import figure_page
from pipeline.values.plots import GREY, INK, Line, Panel

#: probabilities of the intervals of the table, and of the plot
STATED, PLOTTED = (0.5, 0.8, 0.9, 0.95), tuple(float(p) for p in np.linspace(0.05, 0.95, 19))


def summary(arms: Sequence[Judged]) -> str:
    """Two Markdown tables: errors in percent, and the share of numbers in intervals of stated probability."""
    of_all = _predictions(arms)
    rows = []
    for name, kinds in _kinds():
        chosen = [one for one in of_all if one.what in kinds]
        cells = [_both([getattr(one, when) for one in chosen]) for when in ("before", "after")]
        rows.append([name, str(len(chosen)), *cells, *(f"{100 * share(chosen, p):.0f} %" for p in STATED)])
    heads = ["predicted", "states", "error before: median, nine of ten", "after: median, nine of ten"]
    text = table([*heads, *(f"in {100 * p:.0f} % intervals" for p in STATED)], rows)
    failed = [f"{one.arm} ({one.family}): {one.failure}" for one in arms if one.failure]
    return "\n\n".join([text, *failed])


def _kinds() -> list[tuple[str, tuple[str, ...]]]:
    tips = tuple(name for name in WHAT if name.startswith("tip"))
    return [*((name, (name,)) for name in WHAT), ("all tips", tips), ("all", WHAT)]


def _predictions(arms: Sequence[Judged]) -> list[Prediction]:
    return [prediction for arm in arms for prediction in arm.predictions]


def _both(errors: Sequence[float]) -> str:
    if not (known := [error for error in errors if np.isfinite(error)]):
        return "-"
    return f"{100 * float(np.median(known)):.2g} %, {100 * float(np.quantile(known, 0.9)):.2g} %"


def share(predictions: Sequence[Prediction], probability: float) -> float:
    """The part of the numbers that lie in their intervals of a stated probability."""
    levels = [level for one in predictions for level in one.levels]
    return float(np.mean(np.array(levels) <= probability)) if levels else float("nan")


def calibration_page(arms: Sequence[Judged]) -> str:
    """A page: the share of the numbers in their intervals over the stated probability."""
    lines = [Line([0.0, 1.0], [0.0, 1.0], "as stated", GREY, dash="dash")]
    for (name, kinds), colour in zip((("tips", WHAT[:3]), ("forces", WHAT[3:])), (INK, "#d55e00"), strict=True):
        chosen = [one for one in _predictions(arms) if one.what in kinds]
        lines.append(Line(PLOTTED, [share(chosen, p) for p in PLOTTED], name, colour, marker="circle"))
    axes = "stated probability", "share of numbers inside"
    panel = Panel(f"{len(arms)} virtual arms", *axes, tuple(lines), x_range=(0.0, 1.0), y_range=(0.0, 1.0))
    return figure_page("Intervals of calibrated arms", [panel])
