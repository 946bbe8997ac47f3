"""Plots for HTML pages: lines, points, bands and error bars in one or more panels, drawn in the browser by plotly.js.

A page holds plotly.js once (`packed_plotly`, 2.0 MB) and needs no network. Colours `INK` and `GREY` follow the page,
light or dark; `plots.js` among the templates of pages draws.
"""

import base64
import gzip
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from plotly.offline import get_plotlyjs
from plotly.subplots import make_subplots

from geometry.arrays import Array
from pipeline.values.json_values import Json, JsonObject

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

#: colours of text and of less important lines; the browser puts those of the page in their place
INK, GREY = "ink", "grey"
_PRINTED = {INK: "black", GREY: "gray"}
#: of series without an order; they can be told apart by colour-blind readers, on white and on black
COLOURS = ("#2a78b8", "#d55e00", "#009e73", "#b8558f", "#c98600", "#3d9ad1", "#8c6bb1", "#7a8b2a", "#a0522d", "#708090")
#: of series with an order, from the first to the last
_SCALE = ("#8fc93a", "#35b779", "#1f9e89", "#2a88a0", "#4a78c0", "#6a62bd", "#8a4fb0")
#: signs of markers and styles of lines in a legend
_MARKERS = {"circle": "●", "circle-open": "○", "square": "■", "square-open": "□", "x": "✕"}
_DASHES = {"solid": "solid", "dash": "dashed", "dot": "dotted"}
#: a panel where one unit is equally long on both axes must not be flatter than this
FLAT = 0.25
#: more points than these are drawn by WebGL
_MANY_POINTS = 4000


def ordered_colour(number: int, count: int) -> str:
    """Colour of series `number` of `count` series that have an order, such as pressures."""
    return _SCALE[round(number * (len(_SCALE) - 1) / max(count - 1, 1))]


@dataclass(frozen=True)
class Line:
    """A line, or points, of a panel. Values that are not finite interrupt it."""

    x: Array | Sequence[Any]  #: (n,) numbers, or words for an axis of words
    y: Array | Sequence[float]  #: (n,)
    name: str  #: shown beside the pointer
    colour: str = INK
    dash: str = "solid"  #: solid, dash, dot, or "" for no line
    marker: str = ""  #: a symbol of plotly such as circle, circle-open, square-open, x, or "" for none
    width: float = 2.0  #: pixels
    marker_size: float = 7.0  #: pixels
    opacity: float = 1.0
    spread: Array | None = None  #: (n,) half the height of a band around the line, of error bars where there is no line
    texts: Sequence[str] = ()  #: (n,) shown beside the pointer in place of the name
    entry: str | None = None  #: in the legend, where it shows and hides all lines of this entry; None for the name
    bars: bool = False  #: bars from zero in place of a line
    z: Array | None = None  #: (n,) of a line in a panel in space
    frame: str = ""  #: such as "17 kPa": a figure with several frames lets the reader choose one; "" for all

    @property
    def legend(self) -> str:
        """The entry in the legend; "" for none."""
        return self.name if self.entry is None else self.entry

    def traces(self) -> list[JsonObject]:
        """The traces of plotly: the band, if any, and the line."""
        return [*([self._band()] if self.spread is not None and self.dash else []), self._trace()]

    def _trace(self) -> JsonObject:
        mode = "+".join(word for word, has in (("lines", self.dash), ("markers", self.marker)) if has)
        place = "%{x}, %{y}" if self.z is None else "%{x}, %{y}, %{z}"
        shared: dict[str, Json] = {
            "x": _values(self.x),
            "y": _values(self.y),
            "name": self.name,
            "hovertemplate": f"{'%{text}' if self.texts else escape(self.name)}<br>{place}<extra></extra>",
            "meta": {"entry": self.legend, "frame": self.frame},
        }
        if self.texts:
            shared["text"] = list(self.texts)
        if self.spread is not None and not self.dash:
            shared["error_y"] = {"array": _values(self.spread), "color": self.colour, "thickness": 1.2}
        if self.bars:
            return {**shared, "type": "bar", "marker": {"color": self.colour}}
        if self.z is not None:
            shared["z"] = _values(self.z)
        return {
            **shared,
            "type": "scatter3d" if self.z is not None else "scattergl" if len(self.x) > _MANY_POINTS else "scatter",
            "mode": mode,
            "opacity": self.opacity,
            "line": {"color": self.colour, "dash": self.dash or "solid", "width": self.width},
            "marker": {"color": self.colour, "symbol": self.marker or "circle", "size": self.marker_size},
        }

    def _band(self) -> JsonObject:
        x, y, half = np.asarray(self.x), np.asarray(self.y), np.nan_to_num(np.asarray(self.spread))
        there = np.isfinite(y)
        x, low, high = x[there], (y - half)[there], (y + half)[there]
        return {
            "type": "scatter", "mode": "lines", "x": _values([*x, *x[::-1]]), "y": _values([*high, *low[::-1]]),
            "line": {"width": 0, "color": self.colour}, "fill": "toself", "fillcolor": self.colour, "opacity": 0.16,
            "hoverinfo": "skip", "meta": {"entry": self.legend, "frame": self.frame},
        }  # fmt: skip


@dataclass(frozen=True)
class Panel:
    """One pair of axes."""

    title: str
    x: str  #: title of the axis, with its unit
    y: str
    lines: tuple[Line, ...]
    z: str = ""  #: of a panel in space, whose axes are lengths to scale
    log_x: bool = False
    log_y: bool = False
    from_zero: bool = False  #: the y axis begins at zero
    lengths: bool = False  #: both axes are lengths: one unit is equally long on both, unless the panel becomes flat
    flat: bool = False  #: lengths are to scale even so
    percent_x: bool = False  #: numbers on the x axis are percentages of the values
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None

    @property
    def is_to_scale(self) -> bool:
        """Whether one unit is equally long on both axes."""
        if not self.lengths or self.flat:
            return self.lengths
        tall, wide = (_extent([getattr(line, axis) for line in self.lines]) for axis in "yx")
        return tall >= FLAT * wide

    def axes(self) -> tuple[JsonObject, JsonObject]:
        """The axes x and y of plotly."""
        unlike = ", not to scale" if self.lengths and not self.is_to_scale else ""
        x = {"title": {"text": self.x}, **_axis(self.x_range, self.log_x)}
        y = {"title": {"text": f"{self.y}{unlike}"}, **_axis(self.y_range, self.log_y)}
        if self.percent_x:
            x["tickformat"] = ".0%"
        if self.from_zero:
            y["rangemode"] = "tozero"
        if self.is_to_scale:
            y |= {"scaleanchor": "x", "constrain": "domain"}
            x["constrain"] = "domain"
        return x, y

    def html(self) -> str:
        """The panel as an element that `plots.js` draws."""
        x, y = self.axes()
        traces = [trace for line in self.lines for trace in line.traces()]
        layout: JsonObject = {"xaxis": x, "yaxis": y}
        if self.z:
            sizes = {axis: _extent([getattr(line, axis) for line in self.lines]) for axis in "xyz"}
            ratio = {axis: size / max(1e-9, *sizes.values()) for axis, size in sizes.items()}
            layout = {"scene": {**layout, "zaxis": {"title": {"text": self.z}}, "aspectratio": ratio}}
        content = {"data": traces, "layout": layout}
        drawn = json.dumps(content, ensure_ascii=False, allow_nan=False).replace("</", "<\\/")
        title = f'<div class="plot-title">{escape(self.title)}</div>' if self.title else ""
        return (
            f'<div class="plot" role="img" aria-label="{escape(self.title or self.y)}">{title}'
            '<div class="plot-area"></div>'
            f'<script type="application/json">{drawn}</script></div>'
        )


def figure(panels: Sequence[Panel]) -> str:
    """Panels with one legend as an HTML element, beside each other where the page is wide; empty without panels."""
    if not panels:
        return ""
    lines = [line for panel in panels for line in panel.lines]
    frames = list(dict.fromkeys(line.frame for line in lines if line.frame))
    entries = list(dict.fromkeys(line.legend for line in lines if line.legend))
    buttons = ""
    if len(frames) > 1:
        colour = {line.frame: line.colour for line in reversed(lines)}
        shown = [_button("frame", name, _swatch([Line((), (), name, colour[name], width=6)])) for name in frames]
        buttons += f'<div class="plot-keys">{_button("frame", "", "", "all")}{"".join(shown)}</div>'
    if len(entries) > 1:
        shown = [_button("entry", name, _swatch([line for line in lines if line.legend == name])) for name in entries]
        buttons += f'<div class="plot-keys">{"".join(shown)}</div>'
    drawn = "".join(panel.html() for panel in panels)
    return f'<div class="plots">{buttons}<div class="plot-panels">{drawn}</div></div>'


def plotly_figure(panels: Sequence[Panel]) -> "Figure":
    """Panels beside each other as a figure of plotly, which a notebook shows and a program can change."""
    drawn = make_subplots(rows=1, cols=len(panels), subplot_titles=[panel.title for panel in panels])
    names: set[str] = set()
    for column, panel in enumerate(panels, start=1):
        for line in panel.lines:
            *bands, trace = replace(line, colour=_PRINTED.get(line.colour, line.colour)).traces()
            shown = bool(line.legend) and line.name not in names
            names.add(line.name)
            for part in bands:
                drawn.add_trace({**part, "showlegend": False, "legendgroup": line.name}, row=1, col=column)
            drawn.add_trace({**trace, "showlegend": shown, "legendgroup": line.name}, row=1, col=column)
        x, y = panel.axes()
        drawn.update_xaxes(x, row=1, col=column)
        drawn.update_yaxes({**y, **({"scaleanchor": f"x{column}"} if "scaleanchor" in y else {})}, row=1, col=column)
    return drawn.update_layout(template="plotly_white")


@cache
def packed_plotly() -> str:
    """plotly.js for the pages that hold figures, compressed, in base64."""
    return base64.b64encode(gzip.compress(get_plotlyjs().encode(), 9, mtime=0)).decode()


def _axis(ends: tuple[float, float] | None, log: bool) -> dict[str, Json]:
    axis: dict[str, Json] = {"type": "log", "dtick": "D2", "exponentformat": "none"} if log else {}
    if ends is not None:
        axis["range"] = [float(np.log10(end)) if log else float(end) for end in ends]
    return axis


def _values(values: Array | Sequence[Any]) -> list[Any]:
    """Numbers with six digits, None where they are not finite; words as they are."""
    return [
        value if isinstance(value, str) else float(f"{value:.6g}") if np.isfinite(value) else None for value in values
    ]


def _extent(values: Sequence[Any]) -> float:
    numbers = np.concatenate([np.asarray(of_line, dtype=float) for of_line in values] or [np.zeros(1)])
    finite = numbers[np.isfinite(numbers)]
    return float(np.ptp(finite)) if len(finite) else 0.0


def _button(kind: str, name: str, swatch: str, text: str | None = None) -> str:
    pressed = "true" if kind == "entry" or not name else "false"
    return (
        f'<button type="button" data-{kind}="{escape(name)}" aria-pressed="{pressed}">'
        f"{swatch}{escape(name if text is None else text)}</button>"
    )


def _swatch(lines: Sequence[Line]) -> str:
    """A small picture of an entry; in the colour of the text where its lines have several colours."""
    first, colours = lines[0], {line.colour for line in lines}
    colour = colours.pop() if len(colours) == 1 else INK
    shown = {INK: "currentColor", GREY: "gray"}.get(colour, colour)
    line = f"; --line: {min(first.width, 6):g}px {_DASHES[first.dash]}" if first.dash else ""
    style = f"color: {shown}; opacity: {first.opacity:g}{line}"
    return f'<i aria-hidden="true" style="{style}">{_MARKERS.get(first.marker, "")}</i>'
