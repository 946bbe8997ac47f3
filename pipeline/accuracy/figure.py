"""Error over seconds, one line per choice, and the front that nothing beats: a page that can be zoomed, and an SVG."""

import io
from collections.abc import Mapping
from typing import Any

from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE
from pipeline.plots import COLOURS, GREY, GRID, INK, single_panel, standalone_page, styled

Row = Mapping[str, Any]
Record = Mapping[str, Any]

#: what varies along a line that is none of meshes, with its unit
_VARIES = {TOLERANCE: "tolerance {:g}", CONTACT: "distance {:g} mm", POINTS: "{:g} points"}
_SECONDS = "CPU seconds of II and III, one thread"
_UNSURE = "deviation of the reference"
_ERROR = "largest error of κ₀(l/2), α₂ and F (%)"


def html_page(record: Record) -> str:
    """The figure alone on a page that opens offline."""
    figure = single_panel(_SECONDS, _ERROR)
    for colour, (choice, rows) in zip(COLOURS, _lines(record).items(), strict=False):
        figure.add_scatter(
            x=[row["cpu_seconds"] for row in rows],
            y=[100 * row["headline"] for row in rows],
            mode="lines+markers" if len(rows) > 1 else "markers",
            line={"color": colour, "dash": "dot" if choice in _VARIES else "solid"},
            name=choice,
            text=[_label(row) for row in rows],
            hovertemplate="%{text}<br>%{x:.3g} s, %{y:.2g} %<extra></extra>",
        )
    front = _front(record)
    figure.add_scatter(
        x=[x for x, _ in front], y=[y for _, y in front], mode="lines", name="nothing is better",
        line={"color": INK, "width": 6}, opacity=0.2, hoverinfo="skip",
    )  # fmt: skip
    figure.add_hline(y=100 * record["reference_error"], line={"dash": "dash", "color": GREY}, annotation_text=_UNSURE)
    figure.update_xaxes(type="log")
    figure.update_yaxes(type="log")
    return standalone_page(styled(figure, 620))


def svg_picture(record: Record) -> str:
    """The same as a picture."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure
    from matplotlib.ticker import ScalarFormatter

    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    axes = figure.subplots()
    for colour, (choice, rows) in zip(COLOURS, _lines(record).items(), strict=False):
        seconds, error = [row["cpu_seconds"] for row in rows], [100 * row["headline"] for row in rows]
        form = "o:" if choice in _VARIES else "o-"
        axes.plot(seconds, error, form, color=colour, label=choice, markersize=4.5, linewidth=1.4)
    front = _front(record)
    axes.plot([x for x, _ in front], [y for _, y in front], color=INK, alpha=0.18, linewidth=8, zorder=0)
    axes.axhline(100 * record["reference_error"], color=GREY, linestyle="--", linewidth=1, label=_UNSURE)
    axes.set(xscale="log", yscale="log", xlabel=_SECONDS, ylabel=_ERROR, title=record["config"]["name"])
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(ScalarFormatter())
        axis.set_minor_formatter(ScalarFormatter())
    axes.tick_params(which="both", labelsize=8)
    axes.grid(True, which="both", color=GRID)
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    text = io.StringIO()
    with rc_context({"svg.hashsalt": record["config_hash"]}):  # the same file for the same record
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _lines(record: Record) -> dict[str, list[Row]]:
    """The rungs that have an error, by line and in the order of what varies along it."""
    known = [row for row in record["rungs"] if row["headline"] is not None]
    lines: dict[str, list[Row]] = {}
    for row in known:
        lines.setdefault(row["choice"], []).append(row)
    return {choice: sorted(rows, key=lambda row: row["value"]) for choice, rows in lines.items()}


def _front(record: Record) -> list[tuple[float, float]]:
    """Corners of the front by seconds: (seconds, error in per cent)."""
    return sorted((row["cpu_seconds"], 100 * row["headline"]) for row in record["rungs"] if row["on_front"])


def _label(row: Row) -> str:
    varies = _VARIES.get(row["choice"], "mesh {:g} mm").format(row["value"])
    return f"{row['choice']}: {varies}, {row['degrees_of_freedom']} degrees of freedom"
