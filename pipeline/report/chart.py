"""Charts of the report as SVG: axes, lines, bands and points, with colours and line styles from its style sheet.

The text of a chart is part of the page, so that it is there without a script, in print, and in light and dark. Lines
of one pressure carry it (`data-p`), so that the slider of the figure can show that pressure alone.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

from geometry.arrays import Array
from pipeline.report.formatting import fixed

_WIDTH, _HEIGHT = 460, 330
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 10, 26, 46
_PLOT = (_LEFT, _TOP, _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM)
#: height over width of the data below which two lengths do not share a scale
FLAT = 0.25


@dataclass(frozen=True)
class Marks:
    """A line, or points, of a chart."""

    x: Array  #: (n,)
    y: Array  #: (n,); NaN interrupts a line
    name: str  #: shown beside the pointer
    style: str = "line"  #: class of the style sheet: line, rod, single, slope, dots, touch, dot, ring, square
    colour: int | None = None  #: number of the colour of a pressure; None for the colour of the style
    pressure: float | None = None  #: kPa; None for marks that belong to every pressure
    spread: Array | None = None  #: (n,) half the height of a band around the line, or of the error bars of points

    @property
    def attributes(self) -> str:
        """Class and pressure, for an element of the chart."""
        colour = "" if self.colour is None else f" p{self.colour}"
        pressure = "" if self.pressure is None else f' data-p="{self.pressure:g}"'
        return f'class="{self.style}{colour}"{pressure}'


@dataclass(frozen=True)
class Chart:
    """One pair of axes."""

    title: str
    x: str  #: title of the axis, with its unit
    y: str
    marks: tuple[Marks, ...] = field(repr=False)
    lengths: bool = False  #: both axes are lengths: they share a scale unless the data are flat
    from_zero: bool = False  #: the y axis begins at zero

    @property
    def to_scale(self) -> bool:
        """Whether x and y share a scale."""
        (left, right), (low, high) = self._extent()
        return self.lengths and (high - low) >= FLAT * (right - left)

    def svg(self) -> str:
        """The chart as an SVG element."""
        axes = _Axes(*self._ranges())
        y_title = f"{self.y}, not to scale" if self.lengths and not self.to_scale else self.y
        parts = [axes.grid(), *(axes.drawn(marks) for marks in self.marks)]
        ranges = " ".join(f"{value:.6g}" for value in (*axes.x, *axes.y))
        return (
            f'<svg class="chart" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(self.title)}" '
            f'data-plot="{" ".join(map(str, _PLOT))}" data-range="{ranges}">'
            f'<text class="title" x="{_LEFT}" y="16">{escape(self.title)}</text>{"".join(parts)}'
            f'<text class="axis" x="{_LEFT + _PLOT[2] / 2}" y="{_HEIGHT - 8}">{escape(self.x)}</text>'
            f'<text class="axis" transform="translate(14 {_TOP + _PLOT[3] / 2}) rotate(-90)">{escape(y_title)}</text>'
            f'<g class="pointer"></g></svg>'
        )

    def _extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The ranges of x and y of all marks, bands included."""
        low, high = (
            [np.where(np.isfinite(m.y), m.y + sign * _half(m), np.nan) for m in self.marks] for sign in (-1.0, 1.0)
        )
        return _range([m.x for m in self.marks]), _range([*low, *high])

    def _ranges(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The ranges of the axes: those of the data with a margin, with one scale for lengths."""
        (left, right), (low, high) = self._extent()
        if self.from_zero:
            low, high = min(low, 0.0), max(high, 0.0)
        x, y = _widened(left, right, 0.03), _widened(low, high, 0.06)
        if self.from_zero:
            y = (low if low == 0.0 else y[0], high if high == 0.0 else y[1])
        if not self.to_scale:
            return x, y
        scale = max((x[1] - x[0]) / _PLOT[2], (y[1] - y[0]) / _PLOT[3])
        return _stretched(x, scale * _PLOT[2]), _stretched(y, scale * _PLOT[3])


@dataclass(frozen=True)
class _Axes:
    x: tuple[float, float]
    y: tuple[float, float]

    def across(self, values: Array) -> Array:
        """Positions of values of x, pixels of the view box."""
        return _LEFT + (np.asarray(values) - self.x[0]) / (self.x[1] - self.x[0]) * _PLOT[2]

    def down(self, values: Array) -> Array:
        """Positions of values of y."""
        return _TOP + (self.y[1] - np.asarray(values)) / (self.y[1] - self.y[0]) * _PLOT[3]

    def grid(self) -> str:
        """Grid lines with their numbers, and the frame."""
        parts = []
        for value, text in ticks(*self.x):
            at = float(self.across(np.array(value)))
            parts.append(f'<path class="grid" d="M{at:.1f} {_TOP}v{_PLOT[3]}"/>')
            parts.append(f'<text class="tick" x="{at:.1f}" y="{_TOP + _PLOT[3] + 16}">{text}</text>')
        for value, text in ticks(*self.y):
            at = float(self.down(np.array(value)))
            parts.append(f'<path class="grid" d="M{_LEFT} {at:.1f}h{_PLOT[2]}"/>')
            parts.append(f'<text class="tick left" x="{_LEFT - 6}" y="{at + 4:.1f}">{text}</text>')
        return "".join(parts)

    def drawn(self, marks: Marks) -> str:
        """One line or set of points, with its band or error bars."""
        x, y = self.across(marks.x), self.down(marks.y)
        title = escape(marks.name)
        band = "" if marks.spread is None else self._band(marks)
        if marks.style in ("dot", "ring", "square"):
            shapes = "".join(
                _shape(marks.style, *point) for point in zip(x, y, strict=True) if np.isfinite(point).all()
            )
            return f"{band}<g {marks.attributes}><title>{title}</title>{shapes}</g>"
        path = _points(x, y) if marks.style in ("dots", "touch") else _line(x, y)
        return f'{band}<path {marks.attributes} data-name="{title}" d="{path}"/>' if path else ""

    def _band(self, marks: Marks) -> str:
        half = _half(marks)
        top, bottom = self.down(marks.y + half), self.down(marks.y - half)
        finite = np.isfinite(top) & np.isfinite(bottom)
        x, top, bottom = self.across(marks.x)[finite], top[finite], bottom[finite]
        if marks.style in ("dot", "ring", "square"):
            bars = "".join(f"M{a:.1f} {b:.1f}V{c:.1f}" for a, b, c in zip(x, top, bottom, strict=True))
            return f'<path class="bar{_colour(marks)}" d="{bars}"/>'
        outline = _line(np.concatenate([x, x[::-1]]), np.concatenate([top, bottom[::-1]]))
        pressure = "" if marks.pressure is None else f' data-p="{marks.pressure:g}"'
        return f'<path class="band{_colour(marks)}"{pressure} d="{outline}z"/>' if outline else ""


def ticks(low: float, high: float, about: int = 5) -> list[tuple[float, str]]:
    """Round numbers between low and high, roughly `about` of them, with their text."""
    raw = (high - low) / about
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if factor * power >= 0.999 * raw)
    decimals = max(0, int(-np.floor(np.log10(step))) + (round(step / power * 10) == 25))
    values = step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    return [(float(value), fixed(float(value), decimals)) for value in values]


def _colour(marks: Marks) -> str:
    return "" if marks.colour is None else f" p{marks.colour}"


def _half(marks: Marks) -> Array:
    return np.zeros(len(marks.y)) if marks.spread is None else np.nan_to_num(marks.spread)


def _range(values: Sequence[Array]) -> tuple[float, float]:
    finite = np.concatenate([v[np.isfinite(v)] for v in map(np.asarray, values)] or [np.zeros(0)])
    return (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)


def _widened(low: float, high: float, margin: float) -> tuple[float, float]:
    width = (high - low) or max(abs(high), 1.0)
    return low - margin * width, high + margin * width


def _stretched(ends: tuple[float, float], width: float) -> tuple[float, float]:
    middle = (ends[0] + ends[1]) / 2
    return middle - width / 2, middle + width / 2


def _line(x: Array, y: Array) -> str:
    """The `d` of a path through the points, interrupted where one is not finite."""
    pieces: list[list[str]] = [[]]
    for a, b in zip(x, y, strict=True):
        if np.isfinite(a) and np.isfinite(b):
            pieces[-1].append(f"{a:.1f} {b:.1f}")
        elif pieces[-1]:
            pieces.append([])
    return "".join(f"M{'L'.join(piece)}" for piece in pieces if piece)


def _points(x: Array, y: Array) -> str:
    """The `d` of a path that is one round dot per point."""
    pairs: Iterable[tuple[float, float]] = zip(x, y, strict=True)
    return "".join(f"M{a:.1f} {b:.1f}h0" for a, b in pairs if np.isfinite(a) and np.isfinite(b))


def _shape(style: str, x: float, y: float) -> str:
    if style == "square":
        return f'<rect x="{x - 6:.1f}" y="{y - 6:.1f}" width="12" height="12"/>'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{4 if style == "dot" else 8}"/>'
