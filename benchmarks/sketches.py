"""Sections of the drawn bodies with the configuration keys of their dimensions: docs/pictures/sketch_*.svg.

    python benchmarks/sketches.py [FOLDER]

Beside each other: the section z = 0 along the arm from the clamp on, and the section across it through a cavity. The
sketches are not to scale: walls are thicker than those of an arm, so that they can be told apart.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle, Wedge

# the rooms stand beside this folder
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from benchmarks.arguments import parser_of

DOCS = Path(__file__).resolve().parent.parent / "docs" / "pictures"
SOLID, AIR, LINE, SIZE = "#b8c4d0", "white", "#222222", 8
#: distance of a key from its arrow, in the units of the sketch
AWAY = 0.35

Point = tuple[float, float]


class Sketch:
    """One section: solid, air and arrows with keys."""

    def __init__(self, axes: Axes, title: str, directions: tuple[str, str]) -> None:
        self.axes = axes
        axes.set_title(f"{title} ({directions[0]} to the right, {directions[1]} up)", fontsize=SIZE, pad=18)
        axes.set_aspect("equal")
        axes.axis("off")

    def box(self, start: Point, stop: Point, colour: str = SOLID) -> None:
        """A rectangle between two corners."""
        size = stop[0] - start[0], stop[1] - start[1]
        self.axes.add_patch(Rectangle(start, *size, facecolor=colour, edgecolor="none"))

    def disc(self, centre: Point, radius: float, colour: str = SOLID) -> None:
        """A full disc."""
        self.axes.add_patch(Circle(centre, radius, facecolor=colour, edgecolor="none"))

    def half_disc(self, centre: Point, radius: float, colour: str = SOLID, upper: bool = True) -> None:
        """The half of a disc above or below its centre."""
        angles = (0.0, 180.0) if upper else (180.0, 360.0)
        self.axes.add_patch(Wedge(centre, radius, *angles, facecolor=colour, edgecolor="none"))

    def along(self, start: float, stop: float, y: float, key: str, above: bool = True) -> None:
        """A dimension to the right."""
        self._arrow((start, y), (stop, y))
        self.text((start + stop) / 2, y + (AWAY if above else -AWAY), key, "center", "bottom" if above else "top")

    def up(self, low: float, high: float, x: float, key: str, right: bool = True) -> None:
        """A dimension upwards."""
        self._arrow((x, low), (x, high))
        self.text(x + (AWAY if right else -AWAY), (low + high) / 2, key, "left" if right else "right", "center")

    def text(self, x: float, y: float, text: str, across: str, upward: str) -> None:
        """A key, or a word."""
        self.axes.text(x, y, text, ha=across, va=upward, fontsize=SIZE, color=LINE)

    def pointed(self, at: Point, text: Point, key: str) -> None:
        """A key with an arrow to what it names."""
        style = {"arrowstyle": "-|>", "linewidth": 0.8, "mutation_scale": 6.0, "color": LINE}
        self.axes.annotate(key, at, text, arrowprops=style, fontsize=SIZE, color=LINE, ha="center", va="bottom")

    def curve(self, start: Point, stop: Point) -> None:
        """The material curve."""
        self.axes.plot(*zip(start, stop, strict=True), color="#c03030", linewidth=1.0, linestyle="--")

    def clamp(self, low: float, high: float) -> None:
        """The clamped face at x = 0."""
        self.axes.plot((0.0, 0.0), (low, high), color=LINE, linewidth=2.5)
        self.text(-AWAY, high, "clamp", "right", "top")

    def _arrow(self, start: Point, stop: Point) -> None:
        style = {"arrowstyle": "<|-|>", "linewidth": 0.8, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 6.0}
        self.axes.annotate("", stop, start, arrowprops={**style, "color": LINE})


def pneunet(along: Sketch, across: Sketch) -> None:
    """Gapped chambers on a strip."""
    base, strip, height, gap, chamber, wall, roof, channel, width, side = 2, 3, 10, 3, 8, 1.6, 2, 1.6, 15, 2.5
    top, length = base + strip, 4 * gap + 3 * chamber
    along.box((0, 0), (length, top))
    starts = [gap + k * (gap + chamber) for k in range(3)]
    for x in starts:
        along.box((x, top), (x + chamber, top + height))
        along.box((x + wall, base), (x + chamber - wall, top + height - roof), AIR)
    along.box((starts[0] + wall, base), (starts[2] + wall, base + channel), AIR)
    along.clamp(0, top)
    along.curve((0, base / 2), (length, base / 2))
    a, b, c = starts
    along.along(0, gap, top + 1, "gap")
    along.along(a, a + chamber, top + height + 1, "chamber_length")
    along.along(a + chamber, b, top + height / 2, "gap")
    along.along(b, b + wall, top + height + 1, "wall")
    along.up(top, top + height, c + chamber + 0.8, "chamber_height")
    along.up(base, top, c + chamber + 0.8, "strip")
    along.up(0, base, c + chamber + 0.8, "base")
    along.up(top + height - roof, top + height, b + chamber / 2, "roof")
    along.up(base, base + channel, b + chamber + gap / 2 - 0.4, "channel")
    along.pointed((b + chamber, top), (b + chamber + gap / 2, top + height / 3), "fillet")
    across.box((-width / 2, 0), (width / 2, top + height))
    across.box((side - width / 2, base), (width / 2 - side, top + height - roof), AIR)
    across.along(-width / 2, width / 2, -1, "width", above=False)
    across.along(-width / 2, side - width / 2, top + height / 2, "side_wall")
    across.up(top + height - roof, top + height, 0, "roof")


def semicircular(along: Sketch, across: Sketch) -> None:
    """A half disc with several cavities."""
    radius, chamber, partition, end, base, wall, channel = 9, 8, 2.5, 2.5, 2, 1.6, 1.8
    length = 2 * end + 3 * chamber + 2 * partition
    along.box((0, 0), (length, base + radius))
    starts = [end + k * (chamber + partition) for k in range(3)]
    for x in starts:
        along.box((x, base), (x + chamber, base + radius - wall), AIR)
    along.box((starts[0], base), (starts[2], base + channel), AIR)
    along.clamp(0, base + radius)
    along.curve((0, base / 2), (length, base / 2))
    a, b, c = starts
    along.along(0, end, base + radius + 1, "end_wall")
    along.along(a, a + chamber, base + radius / 2, "chamber_length")
    along.along(a + chamber, b, base + radius + 1, "partition")
    along.up(0, base, length + 0.8, "base")
    along.up(base, base + radius, length + 0.8, "radius")
    along.up(base + radius - wall, base + radius, c + chamber / 2, "wall")
    along.up(base, base + channel, b + chamber / 2, "channel")
    _half_disc(across, radius, base, wall)


def semicircular_single(along: Sketch, across: Sketch) -> None:
    """A half disc with one cavity."""
    radius, length, end, base, wall = 9, 32, 2.5, 2, 1.6
    along.box((0, 0), (length, base + radius))
    along.box((end, base), (length - end, base + radius - wall), AIR)
    along.clamp(0, base + radius)
    along.curve((0, base / 2), (length, base / 2))
    along.along(0, length, -1, "length", above=False)
    along.along(0, end, base + radius + 1, "end_wall")
    along.up(0, base, length + 0.8, "base")
    along.up(base, base + radius, length + 0.8, "radius")
    along.up(base + radius - wall, base + radius, length / 2, "wall")
    _half_disc(across, radius, base, wall)


def _half_disc(across: Sketch, radius: float, base: float, wall: float) -> None:
    across.box((-radius, 0), (radius, base))
    across.half_disc((0, base), radius)
    across.half_disc((0, base), radius - wall, AIR)
    across.along(0, radius, -1, "radius", above=False)
    across.up(base + radius - wall, base + radius, 0, "wall")
    across.up(0, base, radius + 0.8, "base")


def bisected_circle(along: Sketch, across: Sketch) -> None:
    """A disc with a cavity on each side of a dividing wall."""
    radius, length, end, divider, wall = 8, 32, 2.5, 2.4, 1.6
    inner = radius - wall
    along.box((0, -radius), (length, radius))
    for low, high in ((divider / 2, inner), (-inner, -divider / 2)):
        along.box((end, low), (length - end, high), AIR)
    along.clamp(-radius, radius)
    along.curve((0, 0), (length, 0))
    along.along(0, length, -radius - 1, "length", above=False)
    along.along(0, end, radius + 1, "end_wall")
    along.up(-divider / 2, divider / 2, length + 0.8, "divider")
    along.up(inner, radius, length / 2, "wall")
    along.text(length / 3, radius / 2, "cavity", "center", "center")
    along.text(length / 3, -radius / 2, "cavity_lower", "center", "center")
    across.disc((0, 0), radius)
    across.disc((0, 0), inner, AIR)
    across.box((-inner, -divider / 2), (inner, divider / 2))
    across.along(0, radius, -radius - 1, "radius", above=False)
    across.up(inner, radius, 0, "wall")
    across.up(-divider / 2, divider / 2, radius + 0.8, "divider")


def rectangular(along: Sketch, across: Sketch) -> None:
    """A bar with several cavities."""
    width, height, chamber, partition, end, base, side, roof, channel = 15, 13, 8, 2.5, 2.5, 2.5, 2.2, 2, 1.8
    length = 2 * end + 3 * chamber + 2 * partition
    along.box((0, 0), (length, height))
    starts = [end + k * (chamber + partition) for k in range(3)]
    for x in starts:
        along.box((x, base), (x + chamber, height - roof), AIR)
    along.box((starts[0], base), (starts[2], base + channel), AIR)
    along.clamp(0, height)
    along.curve((0, base / 2), (length, base / 2))
    a, b, c = starts
    along.along(0, end, height + 1, "end_wall")
    along.along(a, a + chamber, height / 2, "chamber_length")
    along.along(a + chamber, b, height + 1, "partition")
    along.up(0, height, length + 0.8, "height")
    along.up(0, base, length - end / 2 - 2.2, "base")
    along.up(height - roof, height, c + chamber / 2 - 1.5, "roof")
    along.up(base, base + channel, b + chamber / 2, "channel")
    across.box((-width / 2, 0), (width / 2, height))
    across.box((side - width / 2, base), (width / 2 - side, height - roof), AIR)
    across.along(-width / 2, width / 2, -1, "width", above=False)
    across.along(-width / 2, side - width / 2, height / 2, "side_wall")
    across.up(height - roof, height, 0, "roof")
    across.up(0, base, 0, "base")


SKETCHES: dict[str, Callable[[Sketch, Sketch], None]] = {
    "pneunet": pneunet,
    "semicircular": semicircular,
    "semicircular_single": semicircular_single,
    "bisected_circle": bisected_circle,
    "rectangular": rectangular,
}


def draw(family: str, file: Path) -> None:
    """Write the sketch of a family."""
    figure = Figure(figsize=(9.0, 3.4))
    left, right = figure.subplots(1, 2, width_ratios=(2.2, 1.0))
    sketches = Sketch(left, "section along the arm", ("x", "y")), Sketch(right, "section across it", ("z", "y"))
    SKETCHES[family](*sketches)
    for axes in (left, right):
        axes.autoscale_view()
        axes.margins(0.12)
    figure.tight_layout()
    with mpl.rc_context({"svg.hashsalt": family, "svg.fonttype": "none"}):
        figure.savefig(file, metadata={"Date": None})


def main() -> None:
    """All families, into docs/pictures or the given folder."""
    parser = parser_of(__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=DOCS)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for family in SKETCHES:
        draw(family, folder / f"sketch_{family}.svg")


if __name__ == "__main__":
    main()
