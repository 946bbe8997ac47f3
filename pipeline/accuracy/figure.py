"""Error over CPU seconds, one line per series, and the Pareto front: a page that can be zoomed, and an SVG."""

import io

from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE
from pipeline.accuracy.record import ConvergenceStudy, StudyRow
from pipeline.drawing.plots import COLOURS, GREY, GRID, INK, single_panel, standalone_page, styled

#: what varies along a series that is none of meshes, with its unit
_VARIED = {TOLERANCE: "tolerance {:g}", CONTACT: "distance {:g} mm", POINTS: "{:g} points"}
_SECONDS = "CPU seconds of II and III, one thread"
_UNCERTAINTY = "standard deviation of the reference"
_FRONT = "Pareto front"
_ERROR = "largest error of κ₀(l/2), α₂ and F (%)"


def html_page(study: ConvergenceStudy) -> str:
    """The figure alone on a page that opens offline."""
    figure = single_panel(_SECONDS, _ERROR)
    for colour, (name, rows) in zip(COLOURS, _series(study).items(), strict=False):
        seconds, errors = _points(rows)
        figure.add_scatter(
            x=seconds, y=errors, name=name, mode="lines+markers" if len(rows) > 1 else "markers",
            line={"color": colour, "dash": "dot" if name in _VARIED else "solid"},
            text=[_label(row) for row in rows], hovertemplate="%{text}<br>%{x:.3g} s, %{y:.2g} %<extra></extra>",
        )  # fmt: skip
    seconds, errors = _points(_front(study))
    figure.add_scatter(
        x=seconds, y=errors, mode="lines", name=_FRONT,
        line={"color": INK, "width": 6}, opacity=0.2, hoverinfo="skip",
    )  # fmt: skip
    uncertainty = {"dash": "dash", "color": GREY}
    figure.add_hline(y=100 * study.reference_error, line=uncertainty, annotation_text=_UNCERTAINTY)
    figure.update_xaxes(type="log")
    figure.update_yaxes(type="log")
    return standalone_page(styled(figure, 620))


def svg_picture(study: ConvergenceStudy) -> str:
    """The same as a picture."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    axes = figure.subplots()
    for colour, (name, rows) in zip(COLOURS, _series(study).items(), strict=False):
        form = "o:" if name in _VARIED else "o-"
        axes.plot(*_points(rows), form, color=colour, label=name, markersize=4.5, linewidth=1.4)
    axes.plot(*_points(_front(study)), color=INK, alpha=0.18, linewidth=8, zorder=0)
    axes.axhline(100 * study.reference_error, color=GREY, linestyle="--", linewidth=1, label=_UNCERTAINTY)
    axes.set(xscale="log", yscale="log", xlabel=_SECONDS, ylabel=_ERROR, title=study.name)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))  # more labels overlap over three decades
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(which="both", labelsize=8)
    axes.grid(True, which="both", color=GRID)
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    text = io.StringIO()
    with rc_context({"svg.hashsalt": study.config_hash}):  # the same file for the same study
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _series(study: ConvergenceStudy) -> dict[str, list[StudyRow]]:
    """The rows that have an error, by series and in the order of what varies along it."""
    series: dict[str, list[StudyRow]] = {}
    for row in study.rows:
        if row.point is not None:
            series.setdefault(row.series, []).append(row)
    return {name: sorted(rows, key=lambda row: row.value or 0.0) for name, rows in series.items()}


def _front(study: ConvergenceStudy) -> list[StudyRow]:
    """The rows of the Pareto front by seconds."""
    return sorted((row for row in study.rows if row.on_front), key=lambda row: row.point or (0.0, 0.0))


def _points(rows: list[StudyRow]) -> tuple[list[float], list[float]]:
    """Seconds and errors in per cent."""
    points = [row.point for row in rows if row.point is not None]
    return [seconds for seconds, _ in points], [100 * error for _, error in points]


def _label(row: StudyRow) -> str:
    varied = _VARIED.get(row.series, "mesh {:g} mm").format(row.value)
    freedom = "" if row.result.cost is None else f", {row.result.cost.degrees_of_freedom} degrees of freedom"
    return f"{row.series}: {varied}{freedom}"
