"""A body from the elements of a file: turned into the frame of the arm, with its faces found by planes.

All lengths in mm. Positions that a user gives (clamp, tip, curve, points in the air) are those in the directions of the
arm, before the body is moved so that its clamp is at x = 0.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import CurvedEdges
from geometry.errors import DesignError, MeshError
from geometry.files.cad_import import Point
from geometry.files.cad_position import check_dimensions, doubt_of_unit, goes_on
from geometry.files.curve import with_curve
from geometry.files.curve_height import HEIGHTS, height_advice
from geometry.files.frame import SAME, Axes, in_frame
from geometry.files.mesh_reader import FileMesh
from geometry.files.orientation import Lying
from geometry.files.shells import lies_in, named_cavities, parts_of, refuse_open, windings
from geometry.manifold import check_manifold, check_untangled, count_components
from geometry.mesh import Mesh
from geometry.topology import find_rows

#: how far the vertices of a flat face may lie from their plane, over the size of the body: files have six digits
FLAT = 1e-5


@dataclass(frozen=True)
class Placing:
    """How a file becomes a body."""

    curve: float  #: y of the material curve, mm
    clamp: float | None  #: x of the clamped end, mm; None for the end with the smallest x
    tip: float | None  #: x of the other end, mm; None for the end with the largest x
    air: Mapping[str, Point]  #: name of a cavity -> a point in it, mm; empty where there is one cavity alone
    half: bool  #: the file holds one half alone, z >= 0 or z <= 0
    unit: float  #: mm per unit of length of the file
    axes: Axes = SAME
    middle: float = 0.0  #: z of the plane of the file that becomes z = 0, in the directions of the arm, mm
    plug: bool = False  #: whether an inlet in the plane of the clamp is closed there


@dataclass(frozen=True)
class Placed:
    """A mesh in the frame of bodies, with named faces."""

    mesh: Mesh
    length: float  #: mm
    cavities: tuple[str, ...]
    turned: bool = False  #: whether it is clamped at the larger x of its file


def turned(content: FileMesh, placing: Placing, half: bool) -> FileMesh:
    """The content of a file in mm and in the directions of the arm; of a half z <= 0 its mirror image, the other half.

    half: whether the file holds one half alone. Raises `DesignError`.
    """
    points = in_frame(content.points, placing.unit, placing.axes, placing.middle)
    check_dimensions(np.ptp(points, axis=0), placing.unit)
    signs = np.ones(3)
    if half and abs(points[:, 2].max()) <= FLAT * np.ptp(points, axis=0).max():
        signs[2] = -1.0

    def there(positions: Array) -> Array:
        return in_frame(positions, placing.unit, placing.axes, placing.middle) * signs

    curved = CurvedEdges(content.curved.ends, there(content.curved.middles))
    return replace(content, points=points * signs, curved=curved, straightened=there(content.straightened))


def placed_by_planes(content: FileMesh, placing: Placing) -> Placed:
    """The body with the faces clamp, tip, sym (of a half), outer, and its cavities.

    content: in mm and in the directions of the arm. Raises `DesignError`, and `MeshError` for elements that cannot be
    used.
    """
    points, tets, curved = joined(content)
    ends = ends_of(points, placing)
    check_across(points, placing)
    before = Mesh(points, tets, {})  # its positions are those that a user knows
    check_manifold(before)
    check_untangled(before)
    move = Move(ends, placing.half)
    original, points, length = points, _in_planes(move.there(points), move.length, placing), move.length
    moved = CurvedEdges(curved.ends, move.there(curved.middles))
    mesh = Mesh(points, tets, {}, moved, content.regions)
    for name, position in (("clamp", 0.0), ("tip", length)):
        _flat(name, position, mesh.points, mesh.boundary, placing)
    check_beyond(original, before.boundary, ends, placing)
    mesh = divided(mesh, placing.curve, length)
    cavities, named = _named(mesh, placing, move)
    return Placed(replace(mesh, faces=named), length, cavities, move.is_turned)


def joined(content: FileMesh) -> tuple[Array, Index, CurvedEdges]:
    """Points (n, 3), tetrahedra and curved edges; points at the same position become one where parts of the mesh share
    none.

    Some programs write the points of each part or element for themselves.
    """
    points, tets = content.points, content.tets
    if count_components(Mesh(points, tets, {})) == 1:
        return points, tets, content.curved
    size = float(np.ptp(points, axis=0).max())
    _, first, same = np.unique(np.round(points / (1e-7 * size)), axis=0, return_index=True, return_inverse=True)
    same = same.reshape(-1)
    points, tets = points[first], same[tets]
    # an edge that two parts have is curved in both of them or in none, whichever had it curved
    return points, tets, content.curved.renumbered(same).usable(points, tets)


def ends_of(points: Array, placing: Placing) -> tuple[float, float]:
    """x of clamp and tip, mm. Raises `DesignError` where one lies outside the body or both are the same."""
    low, high = points.min(axis=0), points.max(axis=0)
    tolerance = FLAT * float((high - low).max())
    given = {"clamp": placing.clamp, "tip": placing.tip, "curve": placing.curve}
    for key, position in given.items():
        axis = 1 if key == "curve" else 0
        if position is not None and not low[axis] - tolerance <= position <= high[axis] + tolerance:
            raise DesignError(
                key,
                f"{'xyz'[axis]} = {position:g} mm lies outside the body, which reaches from {low[axis]:.4g} to "
                f"{high[axis]:.4g} mm{doubt_of_unit(high - low)}",
            )
    clamp = placing.clamp if placing.clamp is not None else float(low[0])
    other = float(high[0] if clamp <= (low[0] + high[0]) / 2 else low[0])
    tip = placing.tip if placing.tip is not None else other
    if abs(tip - clamp) <= tolerance:
        raise DesignError(("clamp", "tip"), f"clamp and tip are both at x = {clamp:g} mm; they are the two ends")
    return clamp, tip


def check_beyond(points: Array, boundary: Index, ends: tuple[float, float], placing: Placing) -> None:
    """Raise `DesignError` where the material goes on beyond the plane of an end at the height of the curve.

    points (n, 3), mm; boundary (k, 3); ends: x of clamp and tip, mm. Whether the curve leaves the material between the
    ends shows when the mesh is divided along it.
    """
    (low_y, low_z), (high_y, high_z) = points[:, 1:].min(axis=0), points[:, 1:].max(axis=0)
    z = 1e-3 * (high_z - low_z) if placing.half else 0.0
    heights = [placing.curve + side * 1e-4 * (high_y - low_y) for side in (1.0, -1.0)]
    step, corners = 1e-5 * (ends[1] - ends[0]), points[boundary]

    def is_inside(x: float, y: float) -> bool:
        return abs(windings(np.array([x, y, z]), corners)) > 0.5

    for name, x, outwards in (("clamp", ends[0], -step), ("tip", ends[1], step)):
        if any(is_inside(x - outwards, y) and is_inside(x + outwards, y) for y in heights):
            raise goes_on(name, x)


@dataclass(frozen=True)
class Move:
    """The motion that brings the clamp to x = 0 and the tip to a larger x.

    An arm that is clamped at its larger x is turned about y by half a turn; a half body is mirrored, which gives its
    other half.
    """

    ends: tuple[float, float]  #: x of clamp and tip, mm
    half: bool

    @property
    def length(self) -> float:
        """mm."""
        return abs(self.ends[1] - self.ends[0])

    @property
    def is_turned(self) -> bool:
        """Whether the arm is clamped at its larger x."""
        return self.ends[1] < self.ends[0]

    @property
    def _signs(self) -> Array:
        return np.array([-1.0, 1.0, 1.0 if self.half else -1.0]) if self.is_turned else np.ones(3)

    def there(self, points: Array) -> Array:
        """Points (n, 3) after the motion."""
        return (points - [self.ends[0], 0.0, 0.0]) * self._signs

    def back(self, points: Array) -> Array:
        """Where points (n, 3) were before the motion."""
        return points * self._signs + [self.ends[0], 0.0, 0.0]


def check_across(points: Array, placing: Placing) -> None:
    """Raise `DesignError` unless z = 0 is within a whole body, and at the side of a half."""
    lying = Lying(points.min(axis=0), points.max(axis=0), placing.middle, placing.axes != SAME)
    low, high = float(lying.low[2]), float(lying.high[2])
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    is_within = low < -tolerance < tolerance < high
    if placing.half and abs(low) > tolerance:
        of_half = "" if is_within else f", or write the z of the plane of symmetry, middle: {lying.sides}"
        raise DesignError(
            ("symmetric", "middle"),
            f"{lying.reach}; true is for a file that holds one half alone, with z = 0 at its side: leave it out"
            f"{of_half}",
        )
    if not placing.half and not is_within:
        raise DesignError(("symmetric", "middle"), lying.beside(halves=True))


def _in_planes(points: Array, length: float, placing: Placing) -> Array:
    """Points (n, 3) with those that are near the plane of a flat face exactly in it."""
    points = points.copy()
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    planes = [(0, 0.0), (0, length), *([(2, 0.0)] if placing.half else [])]
    for axis, position in planes:
        points[np.abs(points[:, axis] - position) < tolerance, axis] = position
    return points


def divided(mesh: Mesh, curve_y: float, length: float) -> Mesh:
    """The mesh, with faces and regions, with the material curve along element edges; itself where it runs along edges
    already.

    Raises `DesignError` where the curve leaves the material, or elements would become flat.
    """
    if curve_gap(mesh, curve_y, length) is None:
        return mesh
    try:
        result = with_curve(mesh, curve_y, length)
    except MeshError as error:
        raise DesignError(
            "curve",
            f"the elements around the line y = {curve_y:g} mm, z = 0 cannot be divided along it, because "
            f"{error}; {_heights(mesh, length)}",
        ) from error
    gap = curve_gap(result, curve_y, length)
    if gap is not None:
        raise DesignError(
            "curve",
            f"the line y = {curve_y:g} mm, z = 0 is outside the material from {gap[0]:.4g} to {gap[1]:.4g} mm behind "
            f"the clamp; {_heights(mesh, length)}",
        )
    return result


def _heights(mesh: Mesh, length: float) -> str:
    """At which of some heights the mesh could be divided along the material curve, the second half of a sentence."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    z = 1e-3 * float(high[2] - low[2]) if low[2] >= 0 else 0.0  # within a half body
    along = np.linspace(0.0, length, 2 * HEIGHTS + 2)
    along[[0, -1]] += [FLAT * length, -FLAT * length]
    corners = mesh.points[mesh.boundary]

    def fits(y: float) -> bool:
        return all(windings(np.array([x, y, z]), corners) > 0.5 for x in along)

    def accepted(y: float) -> bool:
        try:
            return curve_gap(with_curve(mesh, y, length, improved=False), y, length) is None
        except MeshError:  # an element would become flat
            return False

    return height_advice(float(low[1]), float(high[1]), fits, accepted)


def curve_gap(mesh: Mesh, curve_y: float, length: float) -> tuple[float, float] | None:
    """From where to where (x, mm) the line y = curve_y, z = 0 does not run along edges for the first time."""
    tolerance = 1e-7 * length
    on = np.flatnonzero((np.abs(mesh.points[:, 1] - curve_y) < tolerance) & (np.abs(mesh.points[:, 2]) < tolerance))
    on = on[np.argsort(mesh.points[on, 0], kind="stable")]
    x = mesh.points[on, 0]
    stops = [0.0, *map(float, x), length]
    pairs = np.column_stack([on[:-1], on[1:]])
    along = mesh.has_edges(pairs) if len(pairs) else np.zeros(0, dtype=bool)
    filled = [bool(len(x)) and x[0] <= tolerance, *map(bool, along), bool(len(x)) and x[-1] >= length - tolerance]
    return next(((stops[k], stops[k + 1]) for k, ok in enumerate(filled) if not ok), None)


def _named(mesh: Mesh, placing: Placing, move: Move) -> tuple[tuple[str, ...], dict[str, Index]]:
    """Names of the cavities, and the triangles of all faces by name. Raises `DesignError`.

    Cavities are looked for where the body was before the motion, so that sentences have positions that a user knows.
    """
    points, boundary, length = mesh.points, mesh.boundary, move.length
    tolerance = 1e-9 * float(np.ptp(points, axis=0).max())
    original, clamp = move.back(points), move.ends[0]
    named = {}
    mirrors: list[tuple[int, float]] = []
    free = boundary
    if placing.half:
        sym = lies_in(points, boundary, (2, 0.0), tolerance)
        named["sym"], free = boundary[sym], boundary[~sym]
        mirrors.append((2, 0.0))
    outside, inner = parts_of(original, free, clamp if placing.plug else None, tolerance)
    if not inner:
        refuse_open(original, free, move.ends, placing.plug, tolerance)
    if placing.plug:
        mirrors.append((0, clamp))
    cavities = named_cavities(original, inner, boundary, placing.air, mirrors)
    walls = np.vstack(list(cavities.values()))
    outside = free[find_rows(free, walls, len(points)) < 0]
    for name, position in (("clamp", 0.0), ("tip", length)):
        flat = _flat(name, position, points, outside, placing)
        named[name], outside = outside[flat], outside[~flat]
    for name, walls in cavities.items():
        if not Mesh(points, mesh.tets, {name: walls}).enclosed_volume(name) > 0:
            raise DesignError(f"air.{name}", f"the surface of {name} encloses material, not air")
    named |= cavities
    named["outer"] = outside
    return tuple(cavities), {name: triangles for name, triangles in named.items() if len(triangles)}


def _flat(name: str, position: float, points: Array, triangles: Index, placing: Placing) -> Mask:
    """True for the triangles (k, 3) in the plane x = position (mm) of the end `name`, (k,).

    Raises `DesignError` where there is none.
    """
    flat = lies_in(points, triangles, (0, position), 1e-9 * float(np.ptp(points, axis=0).max()))
    if not flat.any():
        given = getattr(placing, name)
        where = "at its end" if given is None else f"in the plane x = {given:g} mm"
        raise DesignError(
            name,
            f"the body has no flat face {where}; cut a rounded end off, or give the x of a plane in which its surface "
            "lies",
        )
    return flat
