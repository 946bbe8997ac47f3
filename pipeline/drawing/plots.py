"""The plotly figures of material, accuracy and cell: style, colours, lines, panels. Only here is plotly imported."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import plotly.graph_objects as go
from plotly.colors import qualitative
from plotly.subplots import make_subplots

from geometry.arrays import Array

#: text; what stands for all pressures; grid lines
INK, GREY, GRID = "#1f2933", "#7b8794", "#eceff2"
#: of series, for plotly and matplotlib
COLOURS: tuple[str, ...] = tuple(qualitative.D3)
#: plotly ships no type information
Figure = Any


@dataclass(frozen=True)
class Stroke:
    """How a line is drawn."""

    colour: str
    dash: str = "solid"  #: solid, dash or dot
    width: float = 2.0  #: pixels

    @property
    def plotly(self) -> dict[str, str | float]:
        """The argument `line` of a plotly trace."""
        return {"color": self.colour, "dash": self.dash, "width": self.width}


@dataclass(frozen=True)
class Panel:
    """One pair of axes of a figure with two columns."""

    figure: Figure
    column: int  #: 1 or 2

    def line(self, x: Array, y: Array, stroke: Stroke, name: str, *, legend: bool = False) -> None:
        """Add a line through the points x (n,), y (n,). Lines of one name are hidden together."""
        self.figure.add_scatter(
            x=x, y=y, mode="lines", line=stroke.plotly, name=name, legendgroup=name, showlegend=legend,
            row=1, col=self.column,
        )  # fmt: skip


def two_panels(titles: tuple[str, str], x: str, y: str) -> tuple[Panel, Panel]:
    """An empty figure with two pairs of axes in one row; x and y are the titles of the axes, y on the left only."""
    figure = make_subplots(cols=2, subplot_titles=titles, horizontal_spacing=0.09)
    figure.update_xaxes(title=x)
    figure.update_yaxes(title=y, col=1)
    styled(figure, 430)
    return Panel(figure, 1), Panel(figure, 2)


def single_panel(x: str, y: str) -> Figure:
    """An empty figure with one pair of axes and their titles."""
    figure = go.Figure()
    figure.update_xaxes(title=x)
    figure.update_yaxes(title=y)
    return figure


def four_panels(titles: Sequence[str]) -> Figure:
    """An empty figure with two rows of two pairs of axes."""
    return styled(make_subplots(2, 2, subplot_titles=titles, horizontal_spacing=0.09, vertical_spacing=0.14), 820)


def series_colour(number: int) -> str:
    """Colour of the series with this number, from a palette that colour-blind readers can tell apart."""
    return str(qualitative.Safe[number % len(qualitative.Safe)])


def styled(figure: Figure, height: int) -> Figure:
    """The figure with the fonts, margins and grid of all pneurod figures; height in pixels."""
    figure.update_layout(
        template="simple_white",
        height=height,
        margin={"l": 64, "r": 16, "t": 36, "b": 52},
        font={"family": "system-ui, sans-serif", "size": 13, "color": INK},
        legend={"orientation": "v"},
        hoverlabel={"font_size": 12},
    )
    figure.update_xaxes(showgrid=True, gridcolor=GRID, zeroline=False)
    figure.update_yaxes(showgrid=True, gridcolor=GRID, zeroline=False)
    return figure


def standalone_page(figure: Figure) -> str:
    """An HTML page with this figure alone; it opens offline."""
    return str(figure.to_html(full_html=True, include_plotlyjs=True, config={"displaylogo": False}))
