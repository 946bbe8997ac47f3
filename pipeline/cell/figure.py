"""Moment over curvature at every pressure, stretch, curvature without moment, and rigidities: a page and an SVG."""

import io
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from pipeline.drawing.plots import COLOURS, GREY, GRID, INK, four_panels, standalone_page
from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.section import section_at

#: titles of the panels: of the panel, of its x axis, of its y axis
PANELS = (
    ("moment over curvature", "κ (1/mm)", "M (N mm)"),
    ("stretch of the axis", "κ (1/mm)", "λ"),
    ("curvature without moment", "p (kPa)", "κ₀ (1/mm)"),
    ("rigidity against bending", "κ (1/mm)", "dM/dκ (N mm²)"),
)
#: points of a line between the states of a cell
POINTS = 200


@dataclass(frozen=True)
class _Line:
    """A line of the figure, in the panel of that number."""

    panel: int
    name: str
    colour: str
    x: Array
    y: Array
    is_marker: bool = False


def html_page(name: str, law: ArmLaw) -> str:
    """The figure alone on a page that opens offline."""
    figure = four_panels([panel for panel, _, _ in PANELS])
    for number, (_, x, y) in enumerate(PANELS):
        row, column = 1 + number // 2, 1 + number % 2
        figure.update_xaxes(title=x, row=row, col=column)
        figure.update_yaxes(title=y, row=row, col=column)
    named: set[str] = set()
    for line in _lines(law):
        figure.add_scatter(
            x=line.x, y=line.y, name=line.name, legendgroup=line.name, showlegend=line.name not in named,
            mode="markers" if line.is_marker else "lines",
            marker={"color": line.colour, "size": 8, "symbol": "circle-open"},
            line={"color": line.colour, "width": 2},
            row=1 + line.panel // 2, col=1 + line.panel % 2,
        )  # fmt: skip
        named.add(line.name)
    figure.update_yaxes(type="log", row=2, col=2)
    figure.update_layout(title={"text": f"{name}: the law of a cell", "font": {"size": 15}}, margin={"t": 80})
    return standalone_page(figure)


def svg_picture(name: str, law: ArmLaw) -> str:
    """The same as a picture."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 7.0), layout="constrained")
    axes = figure.subplots(2, 2).ravel()
    for axis, (title, x, y) in zip(axes, PANELS, strict=True):
        axis.set(title=title, xlabel=x, ylabel=y)
        axis.grid(True, color=GRID)
        axis.tick_params(labelsize=8)
    named: set[str] = set()
    for line in _lines(law):
        label = None if line.name in named else line.name
        named.add(line.name)
        form = {"marker": "o", "fillstyle": "none", "linestyle": "none"} if line.is_marker else {"linewidth": 1.4}
        axes[line.panel].plot(line.x, line.y, color=line.colour, label=label, **form)
    axes[3].set_yscale("log")
    axes[0].legend(frameon=False, fontsize=8)
    figure.suptitle(f"{name}: the law of a cell")
    text = io.StringIO()
    with rc_context({"svg.hashsalt": name}):  # the same file for the same law
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _lines(law: ArmLaw) -> Iterator[_Line]:
    for number, cell in enumerate(law.cells):
        colour, name = COLOURS[number % len(COLOURS)], f"{cell.pressure:g} kPa"
        moment = np.linspace(cell.moment[0], cell.moment[-1], POINTS)
        kappa, stretch = cell.on(moment)
        yield _Line(0, name, colour, kappa, moment)
        yield _Line(1, name, colour, kappa, stretch)
        yield _Line(3, name, colour, cell.kappa, cell.rigidity)
        for row in _onsets(cell):
            yield _Line(0, "walls begin to touch", INK, cell.kappa[[row]], cell.moment[[row]], is_marker=True)
    pressures = np.linspace(law.pressures[0], law.pressures[-1], 41)
    yield _Line(
        2,
        "κ₀",
        GREY,
        pressures,
        np.array([section_at(law.cells, float(pressure)).kappa_0 for pressure in pressures]),
    )
    yield _Line(
        2, "κ₀ of a cell", INK, np.array(law.pressures), np.array([cell.at(0.0)[0] for cell in law.cells]),
        is_marker=True,
    )  # fmt: skip


def _onsets(cell: CellCurve) -> list[int]:
    """First states in contact next to states without."""
    changes = np.flatnonzero(np.diff(cell.contact.astype(int)))
    return [int(row) + 1 if cell.contact[row + 1] else int(row) for row in changes]
