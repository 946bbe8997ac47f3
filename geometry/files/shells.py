"""The parts of a closed surface: its outside, the walls around its air, and the mouths of its inlets."""

from collections.abc import Iterable, Mapping
from typing import Protocol, TypeVar

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.errors import DesignError, position_text
from geometry.files.frame import Point
from geometry.topology import cross, open_edges, parts_of_graph, passes_through, row_keys, triangle_edges

#: why `plug: true` is refused for a body that is closed there
NOTHING_OPEN = "no cavity under pressure is open in the plane of the clamp; leave plug out"
#: a point in the middle of the air sees the walls around it under the solid angle 4 pi
FULL_ANGLE = 4 * np.pi
#: distance of a point from its mouth, over the size of the body: points are read off the screen
NEAR_MOUTH = 1e-3
#: size of the other end of a channel over that of its mouth from which the channel is a part of the cavity
WIDER = 1.6


class _Boxed(Protocol):
    @property
    def box(self) -> Array:
        """Corners (2, 3) of the box around a rim, mm."""


Mouth = TypeVar("Mouth", bound=_Boxed)


def shells(triangles: Index, count: int) -> list[Index]:
    """The triangles (k, 3) on `count` points in parts that share no edge with each other."""
    edges = row_keys(triangle_edges(triangles), count)
    order = np.argsort(edges, kind="stable")
    same = edges[order[1:]] == edges[order[:-1]]
    number = parts_of_graph(len(triangles), np.column_stack([order[1:][same], order[:-1][same]]) // 3)
    return [triangles[number == part] for part in range(int(number.max()) + 1)]


def outside_first(points: Array, parts: list[Index]) -> list[Index]:
    """The parts of a surface with the one that reaches farthest in front; the others by increasing x."""

    def reach(part: Index) -> float:
        return float(np.prod(np.ptp(points[part].reshape(-1, 3), axis=0)))

    outside = max(range(len(parts)), key=lambda k: reach(parts[k]))
    rest = [part for k, part in enumerate(parts) if k != outside]
    return [parts[outside], *sorted(rest, key=lambda part: float(points[part][:, :, 0].mean()))]


def find_crossing(points: Array, triangles: Index) -> Array | None:
    """A position (3,) near which an edge of the triangles (k, 3) passes through another triangle; None where none does.

    Edges are not compared with triangles that have one of their ends.
    """
    edges = np.unique(np.sort(triangle_edges(triangles), axis=1), axis=0)
    ends = points[edges]
    low, high = ends.min(axis=1), ends.max(axis=1)
    for triangle in triangles:
        corners = points[triangle]
        lowest, highest = corners.min(axis=0), corners.max(axis=0)
        near = np.flatnonzero((low <= highest).all(axis=1) & (high >= lowest).all(axis=1))
        near = near[~np.isin(edges[near], triangle).any(axis=1)]
        crossing = near[passes_through(ends[near], np.broadcast_to(corners, (len(near), 3, 3)))]
        if len(crossing):
            both = np.maximum(lowest, low[crossing[0]]), np.minimum(highest, high[crossing[0]])
            return np.asarray((both[0] + both[1]) / 2)
    return None


def parts_of(points: Array, surface: Index, plug: float | None, tolerance: float) -> tuple[Index, list[Index]]:
    """The outside of a surface (k, 3), and the walls of each cavity.

    plug: x of the plane in which cavities may be open, mm; the triangles in it belong to neither then.
    """
    if plug is not None:
        surface = surface[~lies_in(points, surface, (0, plug), tolerance)]
    outside, *inner = outside_first(points, shells(surface, len(points)))
    return outside, inner


def refuse_open(
    points: Array, surface: Index, ends: tuple[float, float], plug: object, tolerance: float, fills: bool = False
) -> None:
    """Raise `DesignError` for a surface without cavities, with the place of its inlet where that is in the plane of an
    end; ends: x of clamp and tip, mm; plug: the key as it is; fills: whether points in it fill inlets."""
    for name, x in zip(("clamp", "tip"), ends, strict=True):
        _, inner = parts_of(points, surface, x, tolerance)
        if inner and not (plug is True and name == "clamp"):
            rim = points[open_edges(inner[0], len(points))].reshape(-1, 3).mean(axis=0)
            place = "[" + ", ".join(f"{round(float(at), 3) + 0.0:g} mm" for at in (x, rim[1], rim[2])) + "]"
            ways = ["write plug: true"] if name == "clamp" and plug is False else []
            ways.append(f"give this point in plug: {{inlet: {place}}}" if fills else "close it in CAD")
            raise DesignError(("air", "file"), f"the air is open at the {name}, around {place}; {', or '.join(ways)}")
    mouths = ", or give a point in each of their mouths in plug: {inlet: [x, y, z]}" if fills else ""
    without = "the body has no closed cavity: its surface has no walls of air, or several inlets"
    raise DesignError(("air", "file"), f"{without}; close them in CAD{mouths}")


def windings(at: Array, corners: Array) -> float:
    """How often triangles with the corners (k, 3, 3) surround the point `at` (3,); negative if they face inward.

    The solid angle of a triangle is that of A. van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
    """
    a, b, c = (corners[:, i] - at for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("ij,ij->i", a, cross(b, c))
    angle = la * lb * lc + sum(np.einsum("ij,ij->i", p, q) * r for p, q, r in ((a, b, lc), (b, c, la), (c, a, lb)))
    return float(2 * np.arctan2(volume, angle).sum() / FULL_ANGLE)


def enclosed(points: Array, triangles: Index) -> float:
    """Volume inside triangles (k, 3) that face outward, closed by planes through the origin; negative if they face
    inward."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def closed_by_mirrors(corners: Array, planes: Iterable[tuple[int, float]]) -> Array:
    """Triangles (k, 3, 3) with their mirror images at planes (axis, position) through their open edges."""
    for axis, position in planes:
        image = corners[:, ::-1].copy()
        image[:, :, axis] = 2 * position - image[:, :, axis]
        corners = np.vstack([corners, image])
    return corners


def named_cavities(
    points: Array, inner: list[Index], surface: Index, air: Mapping[str, Point], mirrors: list[tuple[int, float]]
) -> dict[str, Index]:
    """The walls of each cavity by name: around the points `air` (mm), or `cavity` where there is one cavity alone.

    points: (n, 3), mm. inner: walls (k, 3) of each cavity. surface: all triangles of the boundary. mirrors: planes
    (axis, position) in which walls may be open: x of the clamp, z = 0 of a half. Raises `DesignError` unless every
    cavity has exactly one point in it, and one of them is open at the clamp where walls may be.
    """
    clamps = [position for axis, position in mirrors if axis == 0]
    closed = [closed_by_mirrors(points[walls], mirrors) for walls in inner] if air else []
    named, taken = {} if air or len(inner) > 1 else {"cavity": inner[0]}, dict[int, str]()
    for name, given in air.items():
        at, place = np.array(given, dtype=float), f"the point {position_text(given, 'g')}"
        holder = next((k for k, corners in enumerate(closed) if abs(windings(at, corners)) > 0.5), None)
        if holder is not None and any((at[0] - x) * (middle_of(points, inner[holder])[0] - x) < 0 for x in clamps):
            raise DesignError(f"air.{name}", f"{place} lies behind the plane of the clamp; give a point in a cavity")
        if holder is None:
            whole = closed_by_mirrors(points[surface], [plane for plane in mirrors if plane[0] == 2])
            where = "in the material" if abs(windings(at, whole)) > 0.5 else "in no closed cavity"
            raise DesignError(f"air.{name}", f"{place} lies {where}; give a point in a closed cavity")
        if holder in taken:
            raise DesignError(f"air.{name}", f"{place} lies in the same cavity as that of {taken[holder]}")
        taken[holder], named[name] = name, inner[holder]
    # a hole in the clamped face may have no name
    others = [walls for k, walls in enumerate(inner) if k not in taken] if air or not named else []
    nameless = [walls for walls in others if not (air and opens_at(points, walls, mirrors))]
    if nameless:
        places = "; ".join(position_text(middle_of(points, walls) + 0.0, ".4g") for walls in nameless)
        raise DesignError("air", f"no name for {len(nameless)} cavities, around {places}; give a point in each")
    if clamps and not any(opens_at(points, walls, mirrors) for walls in named.values()):
        raise DesignError("plug", NOTHING_OPEN)
    return named


def opens_at(points: Array, walls: Index, mirrors: list[tuple[int, float]]) -> bool:
    """Whether walls (k, 3) are open in the plane of the clamp, one of axis 0."""
    rim = points[open_edges(walls, len(points))]
    tolerance = 1e-5 * float(np.ptp(points, axis=0).max())
    return any(
        bool((np.abs(rim[:, :, 0] - position) <= tolerance).all(axis=1).any()) for axis, position in mirrors if not axis
    )


def lies_in(points: Array, triangles: Index, plane: tuple[int, float], tolerance: float) -> Mask:
    """True for each of the triangles (k, 3) whose corners lie in the plane (axis, position), (k,)."""
    axis, position = plane
    return np.asarray((np.abs(points[triangles][:, :, axis] - position) <= tolerance).all(axis=1))


def middle_of(points: Array, walls: Index) -> Array:
    corners = points[walls].reshape(-1, 3)
    return np.asarray((corners.min(axis=0) + corners.max(axis=0)) / 2)


def smallest_around(mouths: Iterable[Mouth], point: Point, near: float) -> Mouth | None:
    """The smallest mouth in whose box a point lies, to a distance in mm."""
    around = [mouth for mouth in mouths if holds(mouth.box, point, near)]
    return min(around, key=lambda mouth: diagonal(mouth.box), default=None)


def holds(box: Array, point: Point, near: float) -> bool:
    """Whether a point lies in a box (2, 3), to a distance in mm."""
    return bool(((box[0] - near <= point) & (point <= box[1] + near)).all())


def diagonal(box: Array) -> float:
    """Length of the diagonal of a box (2, 3), mm."""
    return float(np.linalg.norm(box[1] - box[0]))


def no_mouth(name: str, point: str, advice: str = "") -> DesignError:
    """The refusal of the plug `name` at a point that is in no mouth of an inlet that can be filled."""
    where = f"the point {point} is in no hole of a flat face behind which one wall leads to the air"
    return DesignError(f"plug.{name}", f"{where}; close it in CAD{advice}")
