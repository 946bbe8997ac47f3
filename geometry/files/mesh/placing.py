"""A body from the elements of a file: turned into the frame of the arm, with its faces found by planes.

All lengths in mm. Positions that a user gives (clamp, tip, curve, points in the air) are those in the directions of the
arm, before the body is moved so that its clamp is at x = 0.
"""

from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import CurvedEdges
from geometry.errors import DesignError, MeshError
from geometry.files.frame import (
    HEIGHTS,
    check_dimensions,
    check_within,
    goes_on,
    height_advice,
    misplaced,
    no_end_face,
    outside_material,
)
from geometry.files.from_file import FLAT, FileDesign
from geometry.files.mesh.curve import with_curve
from geometry.files.mesh.reader import FileMesh
from geometry.files.shells import lies_in, named_cavities, parts_of, refuse_open, windings
from geometry.manifold import check_manifold, check_untangled, count_components
from geometry.mesh import Mesh
from geometry.topology import find_rows


@dataclass(frozen=True)
class Placed:
    """A mesh in the frame of bodies, with named faces."""

    mesh: Mesh
    length: float  #: mm
    cavities: tuple[str, ...]
    turned: bool = False  #: whether it is clamped at the larger x of its file


def turned(content: FileMesh, design: FileDesign, half: bool) -> FileMesh:
    """The content of a file in mm and in the directions of the arm; of a half z <= 0 its mirror image, the other half.

    half: whether the file holds one half alone. Raises `DesignError`.
    """
    points = design.in_frame(content.points)
    check_dimensions(np.ptp(points, axis=0))
    signs = np.ones(3)
    if half and abs(points[:, 2].max()) <= FLAT * np.ptp(points, axis=0).max():
        signs[2] = -1.0

    def there(positions: Array) -> Array:
        return design.in_frame(positions) * signs

    curved = CurvedEdges(content.curved.ends, there(content.curved.middles))
    return replace(content, points=points * signs, curved=curved, straightened=there(content.straightened))


def placed_by_planes(content: FileMesh, design: FileDesign) -> Placed:
    """The body with the faces clamp, tip, sym (of a half), outer, and its cavities.

    content: in mm and in the directions of the arm. Raises `DesignError`, and `MeshError` for elements that cannot be
    used.
    """
    points, tets, curved = joined(content)
    clamp, tip = ends = ends_of(points, design)
    check_across(points, design)
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    points = points.copy()  # those near the plane of a flat face are moved exactly into it
    for axis, position in ((0, clamp), (0, tip), *([(2, 0.0)] if design.holds_half else [])):
        points[np.abs(points[:, axis] - position) < tolerance, axis] = position
    mesh = Mesh(points, tets, {}, curved, content.regions)
    check_manifold(mesh)
    check_untangled(mesh)
    for name, position in (("clamp", clamp), ("tip", tip)):
        _flat(name, position, mesh.points, mesh.boundary)
    check_beyond(mesh.points, mesh.boundary, ends, design)
    cavities, faces = _named(mesh, design, ends)
    return moved(replace(mesh, faces=faces), design, ends, cavities)


def moved(mesh: Mesh, design: FileDesign, ends: tuple[float, float], cavities: tuple[str, ...]) -> Placed:
    """The mesh with its clamp at x = 0 and its tip at a larger x, and with the material curve along edges.

    A body that is clamped at its larger x is turned about y by half a turn; a half is mirrored, which gives its other
    half. ends: x of clamp and tip, mm. Raises `DesignError` where the curve leaves the material.
    """
    clamp, tip = ends
    turned = tip < clamp
    signs = np.array([-1.0, 1.0, 1.0 if design.holds_half else -1.0]) if turned else np.ones(3)

    def there(points: Array) -> Array:
        return (points - [clamp, 0.0, 0.0]) * signs

    length = abs(tip - clamp)
    points = there(mesh.points)
    points[mesh.points[:, 0] == tip, 0] = length
    curved = CurvedEdges(mesh.curved.ends, there(mesh.curved.middles))
    mesh = divided(Mesh(points, mesh.tets, mesh.faces, curved, mesh.regions), design.curve, length)
    for name in cavities:
        if not mesh.enclosed_volume(name) > 0:
            raise DesignError(f"air.{name}", f"the surface of {name} encloses material, not air")
    return Placed(mesh, length, cavities, turned)


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


def ends_of(points: Array, design: FileDesign) -> tuple[float, float]:
    """x of clamp and tip, mm. Raises `DesignError` where one lies outside the body or both are the same."""
    low, high = points.min(axis=0), points.max(axis=0)
    tolerance = FLAT * float((high - low).max())
    check_within({"clamp": design.clamp, "tip": design.tip, "curve": design.curve}, low, high, tolerance)
    return design.ends_between(float(low[0]), float(high[0]))


def check_beyond(points: Array, boundary: Index, ends: tuple[float, float], design: FileDesign) -> None:
    """Raise `DesignError` where the material goes on beyond the plane of an end at the height of the curve.

    points (n, 3), mm; boundary (k, 3); ends: x of clamp and tip, mm. Whether the curve leaves the material between the
    ends shows when the mesh is divided along it.
    """
    (low_y, low_z), (high_y, high_z) = points[:, 1:].min(axis=0), points[:, 1:].max(axis=0)
    z = 1e-3 * (high_z - low_z) if design.holds_half else 0.0
    heights = [design.curve + side * 1e-4 * (high_y - low_y) for side in (1.0, -1.0)]
    step, corners = 1e-5 * (ends[1] - ends[0]), points[boundary]

    def is_inside(x: float, y: float) -> bool:
        return abs(windings(np.array([x, y, z]), corners)) > 0.5

    for name, x, outwards in (("clamp", ends[0], -step), ("tip", ends[1], step)):
        if any(is_inside(x - outwards, y) and is_inside(x + outwards, y) for y in heights):
            raise goes_on(name, x)


def check_across(points: Array, design: FileDesign) -> None:
    """Raise `DesignError` unless z = 0 is within a whole body, and at the side of a half."""
    low, high = points.min(axis=0), points.max(axis=0)
    tolerance = FLAT * float((high - low).max())
    is_within = low[2] < -tolerance < tolerance < high[2]
    if design.holds_half and is_within:
        raise DesignError("symmetric", "true is for a file that holds one half alone, z = 0 at its side: leave it out")
    if (design.holds_half and abs(low[2]) > tolerance) or not (design.holds_half or is_within):
        raise misplaced(low, high, design.middle, design.is_reoriented)


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
        undivided = f"the elements around the line y = {curve_y:g} mm, z = 0 cannot be divided along it"
        raise DesignError("curve", f"{undivided}, because {error}; {_heights(mesh, length)}") from error
    gap = curve_gap(result, curve_y, length)
    if gap is not None:
        raise outside_material(curve_y, gap, _heights(mesh, length))
    return result


def _heights(mesh: Mesh, length: float) -> str:
    """At which of some heights the material curve is inside the mesh, the second half of a sentence."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    z = 1e-3 * float(high[2] - low[2]) if low[2] >= 0 else 0.0  # within a half body
    along = np.linspace(0.0, length, 2 * HEIGHTS + 2)
    along[[0, -1]] += [FLAT * length, -FLAT * length]
    corners = mesh.points[mesh.boundary]

    def fits(y: float) -> bool:
        return all(windings(np.array([x, y, z]), corners) > 0.5 for x in along)

    return height_advice(float(low[1]), float(high[1]), fits)


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


def _named(mesh: Mesh, design: FileDesign, ends: tuple[float, float]) -> tuple[tuple[str, ...], dict[str, Index]]:
    """Names of the cavities, and the triangles of all faces by name; ends: x of clamp and tip, mm.

    Raises `DesignError`.
    """
    points, free = mesh.points, mesh.boundary
    tolerance = 1e-9 * float(np.ptp(points, axis=0).max())
    faces: dict[str, Index] = {}
    if design.holds_half:
        sym = lies_in(points, free, (2, 0.0), tolerance)
        faces["sym"], free = free[sym], free[~sym]
    cavities = walls_of_air(points, free, mesh.boundary, ends, design)
    outside = free[find_rows(free, np.vstack(list(cavities.values())), len(points)) < 0]
    for name, position in zip(("clamp", "tip"), ends, strict=True):
        flat = _flat(name, position, points, outside)
        faces[name], outside = outside[flat], outside[~flat]
    faces |= {**cavities, "outer": outside}
    return tuple(cavities), {name: triangles for name, triangles in faces.items() if len(triangles)}


def walls_of_air(
    points: Array, free: Index, boundary: Index, ends: tuple[float, float], design: FileDesign
) -> dict[str, Index]:
    """The triangles around the air of each cavity by its name; ends: x of clamp and tip, mm.

    free (k, 3): the boundary without the plane of symmetry of a half. Raises `DesignError`.
    """
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    _, inner = parts_of(points, free, ends[0] if design.plug is True else None, tolerance)
    if not inner:
        refuse_open(points, free, ends, design.plug, tolerance, fills=design.fills_inlets)
    mirrors = [(2, 0.0)] * design.holds_half + [(0, ends[0])] * (design.plug is True)
    return named_cavities(points, inner, boundary, design.air, mirrors)


def _flat(name: str, position: float, points: Array, triangles: Index) -> Mask:
    """True for the triangles (k, 3) in the plane x = position (mm) of the end `name`, (k,).

    Raises `DesignError` where there is none.
    """
    flat = lies_in(points, triangles, (0, position), 1e-9 * float(np.ptp(points, axis=0).max()))
    if not flat.any():
        raise no_end_face(name, position)
    return flat
