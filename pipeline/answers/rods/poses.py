"""Shapes of an arm over its pressures and a force on its tip, between which a page bends it under the reader's hand."""

import base64
import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from html import escape
from itertools import product
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.mesh_content import read_tetrahedra
from pipeline.answers.rods.choice import choose_rod
from pipeline.answers.rods.rods import Rods
from pipeline.values.errors import InputError
from pipeline.values.formats import BODY
from pipeline.values.json_values import JsonObject
from pipeline.values.page import render
from pipeline.values.run import Run
from rod.errors import RodError
from rod.load import Load
from rod.mechanics.equilibrium import Rod
from rod.same_pressure import Pressures
from rod.solution import RodSolution, SpatialSolution

#: points of a shape, and of the outline of the body along the arm
POINTS, OUTLINE = 33, 160
#: pressures of an arm with one, two and three of them; more of one where it turns by more than so many degrees each
PRESSURES, TURN, MOST = {1: 12, 2: 4, 3: 4}, 9.0, 24
#: directions of a force from that of the chord of an arm in its plane, how much denser they are where it pushes against
#: the tip, which buckles the arm, and steps of asinh of its size over the scale
DIRECTIONS, DENSER, STEP = 24, 0.5, 0.32
#: forces along each axis of an arm in space, over the largest one
ALONG_AXIS = np.linspace(-1.0, 1.0, 5)
#: the largest force over the largest moment by the length; over rigidity / length^2
BY_MOMENT, BY_RIGIDITY = 2.0, 6.0
#: of an arm in space, over the one that bends it at rest to the end of its law
BY_LAW = 1.3
#: of the length: an arm whose tip moves farther from one force to the next one is about to snap
SNAP = 0.35
#: parts of the law: up to which shapes are solved, so that there are some around those within; of shapes that are not
AROUND, FILLED = 1.4, 3.0


@dataclass(frozen=True)
class Point:
    """A tip, or another point of the arm, that was measured or solved with finite elements."""

    x: float  #: mm, from the clamp
    y: float
    pressure_kPa: float
    told: str


@dataclass(frozen=True)
class Hand:
    """An arm that bends under the hand, in a notebook and as a page; `str` is the page."""

    arm: JsonObject = field(repr=False)  #: what the page needs; empty where there is no rod to bend

    @staticmethod
    def of(run: Run, points: Sequence[Point] = (), error_mm: float | None = None) -> "Hand":
        """The rod that the verdict recommends.

        points: shown beside the arm, by default the tips of the finite elements. error_mm: of the tip, by default that
        of rod and mesh.
        """
        with suppress(InputError, RodError):
            rods = choose_rod(run)
            if len(rods.law.cavities) in PRESSURES:
                curves = run.curves_of("II") if len(rods.law.cavities) == 1 and rods.law.has_plane else []
                told = "finite elements, {:g} kPa"
                tips = [Point(*one.tip_mm, one.pressure_kPa, told.format(one.pressure_kPa)) for one in curves]
                return Hand(_poses(run, rods, points or tips, error_mm))
        return Hand({})

    def __str__(self) -> str:
        return render("hand.html.j2", arm=self.arm)

    def _repr_html_(self) -> str:
        """The page in a frame."""
        return f'<iframe srcdoc="{escape(str(self))}" style="width: 100%; height: 38rem; border: 0"></iframe>'


def _poses(run: Run, rods: Rods, points: Sequence[Point], error_mm: float | None) -> JsonObject:
    flat, nodes = rods.law.has_plane, _pressures(rods)
    if error_mm is None and rods.error_text and rods.errors:
        error_mm = rods.errors.shape * rods.law.length
    at_nodes = [_rod_at(rods, at) for at in product(*nodes)]
    return {
        "length_mm": rods.law.length,
        "pressures": [{"name": n, "nodes": p.tolist()} for n, p in zip(rods.law.cavities, nodes, strict=True)],
        "points_along": POINTS,
        "axes": 2 if flat else 3,
        **(_in_plane(at_nodes) if flat else _in_space(at_nodes)),
        "error_mm": error_mm,
        "points": [asdict(point) for point in points] if flat else [],
        "body": _outline(run) if flat else None,
    }


def _pressures(rods: Rods) -> list[Array]:
    """The nodes of each pressure, kPa."""
    highest = np.max(rods.law.rows, axis=0)
    if len(highest) > 1:
        return [np.linspace(0.0, high, PRESSURES[len(highest)]) for high in highest]
    low, high = rods.pressures_kPa
    turns = [abs(rods.at(p).solve().bending_deg) for p in (low, high)]
    return [np.linspace(low, high, min(MOST, max(PRESSURES[1], 1 + round(sum(turns) / TURN))))]


def _rod_at(rods: Rods, pressures: Pressures) -> Rod | None:
    with suppress(RodError):
        return rods.at(pressures)
    return None


def _in_plane(rods: Sequence[Rod | None]) -> JsonObject:
    """Shapes over pressures, directions of the force from the chord at rest, and its size over rigidity / length^2."""
    known = [rod for rod in rods if rod is not None]
    reach = max(max(map(abs, _moments(rod))) / (rod.length * _scale(rod)) for rod in known)
    most = math.asinh(min(BY_RIGIDITY, BY_MOMENT * reach))
    sizes = np.linspace(0.0, most, 1 + math.ceil(most / STEP))
    rests = [None if rod is None else rod.arm.in_plane(Load()) for rod in rods]
    chords = [0.0 if rest is None else math.atan2(*rest.end[::-1]) for rest in rests]
    scales = [math.nan if rod is None else _scale(rod) for rod in rods]
    rows, even = list[Array](), np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    for rod, rest, chord, scale in zip(rods, rests, chords, scales, strict=True):
        for angle in chord + even + DENSER * np.sin(even):
            rows += _along(rod, rest, np.outer(scale * np.sinh(sizes), [np.cos(angle), np.sin(angle), 0.0]), 2)
    scales = [scale if math.isfinite(scale) else 0.0 for scale in scales]
    return {
        "chords": chords,
        "scales_N": scales,
        "sizes": sizes.tolist(),
        "around": DIRECTIONS,
        "denser": DENSER,
        **_packed(rows),
    }


def _in_space(rods: Sequence[Rod | None]) -> JsonObject:
    """Shapes over pressures and the force along each of three axes; what forces along several do is added."""
    forces = min(BY_LAW * _moments(rod)[1] / rod.length for rod in rods if rod is not None) * ALONG_AXIS
    rows, middle = [], len(forces) // 2
    for rod in rods:
        rest = None if rod is None else rod.arm.solve_in_space(Load())
        for axis in np.eye(3):
            down, up = (
                _along(rod, rest, np.outer(forces[side], axis), 3)
                for side in (slice(middle, None, -1), slice(middle, None))
            )
            rows += down[:0:-1] + up
    return {"forces_N": forces.tolist(), **_packed(rows)}


def _scale(rod: Rod) -> float:
    """N, a force that bends a rod much."""
    return rod.arm.rigidity_at(rod.arm.kappa_0) / rod.length**2


def _moments(rod: Rod) -> tuple[float, float]:
    """N mm, the smallest and the largest moment that the law of a rod knows."""
    known = rod.moment_range
    return rod.arm.moments if known is None else (min(0.0, known.low), max(0.0, known.high))


def _along(rod: Rod | None, shape: Any, forces: Array, axes: int) -> list[Array]:
    """A row of the grid at each of growing forces (n, 3), from none on, at which the rod has this shape.

    Rows have x, y (and z) of `POINTS` along the material curve (mm), how far it bends (degrees), and the part of the
    law that it uses. Far beyond, after a snap and without equilibrium they go on straight, with the part `FILLED`.
    """
    if rod is None:
        return [np.full(axes * POINTS + 2, np.nan)] * len(forces)
    arm, rows = rod.arm, list[Array]()
    side = math.copysign(1.0, shape.bending_deg * shape.theta[-1]) if arm.has_plane else 0.0
    for force in forces:
        with suppress(RodError):
            if not rows or rows[-1][-1] <= AROUND:
                shape = arm.beside(shape, Load(tuple(force.tolist()))) if rows else shape
                curve = _smooth(shape)
                bent = math.degrees(side * shape.theta[-1]) if side else shape.bending_deg
                is_lost = bool(rod.moment_range and rod.moment_range.warning(shape))
                rows.append(np.array([*curve.ravel(), bent, max(arm.used_by(shape), 2.0 * is_lost)]))
                moved = math.dist(*(row[-2 - curve.shape[1] : -2] for row in (rows[-1], rows[max(0, len(rows) - 2)])))
                rows[-1][-1] += FILLED * (moved > SNAP * rod.length)
                continue
        before, last = [*rows[:1], *rows][-2:]
        rows.append(2.0 * last - before)
        rows[-1][-1] = FILLED
    return rows


def _smooth(shape: RodSolution | SpatialSolution) -> Array:
    """(POINTS, 2 or 3) mm: the axis, shifted to begin and end as the material curve, which ripples beside it."""
    parts = np.linspace(0.0, 1.0, POINTS)
    begins, ends = (shape.curve[k] - shape.axis[k] for k in (0, -1))
    along = np.column_stack([np.interp(parts * shape.s[-1], shape.s, column) for column in shape.axis.T])
    return np.asarray(along + np.outer(1.0 - parts, begins) + np.outer(parts, ends))


def _outline(run: Run) -> JsonObject | None:
    """The lowest and the highest y (mm, from the material curve) of the body at rest; None without its mesh."""
    path = run.directory / BODY
    if run.mesh is None or not path.is_file():
        return None
    points, tets = read_tetrahedra(path)
    x, y = points[tets, 0], points[tets, 1] - run.mesh.curve_height_mm
    edges = np.linspace(0.0, float(points[:, 0].max()), OUTLINE + 1)
    middles = 0.5 * (edges[1:] + edges[:-1])
    within = [(x.min(axis=1) <= s) & (s <= x.max(axis=1)) for s in middles]
    low, high = ([float(f(y[one])) if one.any() else 0.0 for one in within] for f in (np.min, np.max))
    return {"s_mm": middles.tolist(), "low_mm": low, "high_mm": high}


def _packed(rows: Sequence[Array]) -> JsonObject:
    """Rows as whole numbers of two bytes, with the unit of each column; -32768 where there is none."""
    values = np.array(rows)
    values[:, -1] = np.minimum(values[:, -1], 2.0 * FILLED)
    units = np.maximum(np.nanmax(np.abs(values), axis=0), 1e-9) / 32767.0
    counts = np.where(np.isfinite(values), np.rint(values / units), -32768.0).astype("<i2")
    return {"units": units.tolist(), "shapes": base64.b64encode(counts.tobytes()).decode()}
