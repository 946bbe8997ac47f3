"""A body from the elements of a file: turned into the frame of the arm, with its faces found by planes and names.

All lengths in mm. Positions that a user gives (clamp, tip, curve, points in the air) are those in the directions of the
arm, before the body is moved so that its clamp is at x = 0.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.body import curve_in
from geometry.curved import CurvedEdges
from geometry.errors import DesignError, MeshError, position_text
from geometry.files.frame import (
    check_dimensions,
    check_within,
    goes_on,
    misplaced,
    no_end_face,
    outside_material,
)
from geometry.files.from_file import FLAT, TAKEN, FileDesign
from geometry.files.mesh.curve import with_curve
from geometry.files.mesh.reader import FileMesh
from geometry.files.shells import lies_in, middle_of, named_cavities, opens_at, parts_of, refuse_open, windings
from geometry.manifold import check_manifold, check_untangled, count_components
from geometry.mesh import Mesh
from geometry.topology import find_rows, row_keys


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


def placed_body(content: FileMesh, design: FileDesign, half: bool) -> Placed:
    """The body with the faces clamp, tip, sym (of a half), outer, its cavities, and others that the file names.

    content: in mm and in the directions of the arm; half: whether it is one half alone. Raises `DesignError`, and
    `MeshError` for elements that cannot be used.
    """
    content = joined(content)
    clamp, tip = ends = ends_of(content.points, design, content.faces)
    check_across(content.points, design, half)
    tolerance = FLAT * float(np.ptp(content.points, axis=0).max())
    points = content.points.copy()  # those near the plane of a flat face are moved exactly into it
    for axis, position in ((0, clamp), (0, tip), *([(2, 0.0)] if half else [])):
        points[np.abs(points[:, axis] - position) < tolerance, axis] = position
    mesh = Mesh(points, content.tets, {}, content.curved, content.regions)
    check_manifold(mesh)
    check_untangled(mesh)
    for name, position in (("clamp", clamp), ("tip", tip)):
        _flat(name, position, mesh.points, mesh.boundary)
    check_beyond(mesh.points, mesh.boundary, ends, design.curve, half)
    cavities, faces = _named(mesh, design, ends, half, content.faces)
    return moved(replace(mesh, faces=faces), design.curve, ends, cavities, half)


def moved(mesh: Mesh, curve: float, ends: tuple[float, float], cavities: tuple[str, ...], half: bool) -> Placed:
    """The mesh with its clamp at x = 0 and its tip at a larger x, and with the material curve along edges.

    A body that is clamped at its larger x is turned about y by half a turn; a half is mirrored, which gives its other
    half. ends: x of clamp and tip, mm. Raises `DesignError` where the curve leaves the material.
    """
    clamp, tip = ends
    turned = tip < clamp
    signs = np.array([-1.0, 1.0, 1.0 if half else -1.0]) if turned else np.ones(3)

    def there(points: Array) -> Array:
        return (points - [clamp, 0.0, 0.0]) * signs

    length = abs(tip - clamp)
    points = there(mesh.points)
    points[mesh.points[:, 0] == tip, 0] = length
    curved = CurvedEdges(mesh.curved.ends, there(mesh.curved.middles))
    mesh = divided(Mesh(points, mesh.tets, mesh.faces, curved, mesh.regions), curve, length)
    for name in cavities:
        if not mesh.enclosed_volume(name) > 0:
            raise DesignError(f"air.{name}", f"the surface of {name} encloses material, not air")
    return Placed(mesh, length, cavities, turned)


def doubt_of(content: FileMesh) -> str:
    """What may be wrong with a mesh of several parts or groups, for sentences."""
    parts, groups = count_components(Mesh(content.points, content.tets, {})), ", ".join(content.regions)
    if parts > 1:
        return f"; its {parts} parts share no nodes where they touch: mesh them in one step"
    return f"; if one of the groups {groups} is air, save the others alone" if groups else ""


def joined(content: FileMesh) -> FileMesh:
    """The content, with points at the same position as one where parts of the mesh or faces at one place share none.

    Some programs write the points of each part or element for themselves.
    """
    points, tets, mesh = content.points, content.tets, Mesh(content.points, content.tets, {})
    size = float(np.ptp(points, axis=0).max())
    _, first, same = np.unique(np.round(points / (1e-7 * size)), axis=0, return_index=True, return_inverse=True)
    same = same.reshape(-1)
    faces_at = row_keys(same[mesh.boundary], len(first))
    if count_components(mesh) == 1 and len(np.unique(faces_at)) == len(faces_at):
        return content
    points, tets = points[first], same[tets]
    # an edge that two parts have is curved in both of them or in none, whichever had it curved
    curved = content.curved.renumbered(same).usable(points, tets)
    faces = {name: same[triangles] for name, triangles in content.faces.items()}
    return replace(content, points=points, tets=tets, curved=curved, faces=faces)


def ends_of(points: Array, design: FileDesign, faces: Mapping[str, Index]) -> tuple[float, float]:
    """x of clamp and tip, mm: those that are given, those of flat faces (k, 3) of these names, or of the bounds.

    Raises `DesignError` where one lies outside the body or both are the same, `MeshError` for a face that is not flat.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    tolerance = FLAT * float((high - low).max())
    check_within({"clamp": design.clamp, "tip": design.tip, "curve": design.curve}, low, high, tolerance)
    named = {}
    for name, axis in (("sym", 2), ("clamp", 0), ("tip", 0)):
        if name in faces:
            at = points[np.unique(faces[name]), axis]
            named[name] = float(at.mean())
            if np.ptp(at) > tolerance:
                plane = f"it must be flat, in a plane {'xyz'[axis]} = const"
                raise MeshError(f"the face {name} reaches from {at.min():.4g} to {at.max():.4g} mm; {plane}")
    return design.ends_between(float(low[0]), float(high[0]), named.get("clamp"), named.get("tip"))


def check_beyond(points: Array, boundary: Index, ends: tuple[float, float], curve: float, half: bool) -> None:
    """Raise `DesignError` where the material goes on beyond the plane of an end at the height of the curve.

    points (n, 3), mm; boundary (k, 3); ends: x of clamp and tip, mm. Whether the curve leaves the material between the
    ends shows when the mesh is divided along it.
    """
    (low_y, low_z), (high_y, high_z) = points[:, 1:].min(axis=0), points[:, 1:].max(axis=0)
    z = 1e-3 * (high_z - low_z) if half else 0.0
    heights = [curve + side * 1e-4 * (high_y - low_y) for side in (1.0, -1.0)]
    step, corners = 1e-5 * (ends[1] - ends[0]), points[boundary]

    def is_inside(x: float, y: float) -> bool:
        return abs(windings(np.array([x, y, z]), corners)) > 0.5

    for name, x, outwards in (("clamp", ends[0], -step), ("tip", ends[1], step)):
        if any(is_inside(x - outwards, y) and is_inside(x + outwards, y) for y in heights):
            raise goes_on(name, x)


def check_across(points: Array, design: FileDesign, half: bool) -> None:
    """Raise `DesignError` unless z = 0 is within a whole body, and at the side of a half."""
    low, high = points.min(axis=0), points.max(axis=0)
    tolerance = FLAT * float((high - low).max())
    is_within = low[2] < -tolerance < tolerance < high[2]
    if half and is_within:
        ways = "leave out symmetric, and the face sym in the file"
        raise DesignError("symmetric", f"true is for a file that holds one half alone, z = 0 at its side: {ways}")
    if (half and abs(low[2]) > tolerance) or not (half or is_within):
        raise misplaced(low, high, design.middle, design.is_reoriented)


def divided(mesh: Mesh, curve_y: float, length: float) -> Mesh:
    """The mesh, with faces and regions, with the material curve along element edges; itself where it runs along edges
    already.

    Raises `DesignError` where the curve leaves the material, or elements would become flat.
    """
    if curve_in(mesh, curve_y, length)[1] is None:
        return mesh
    try:
        result = with_curve(mesh, curve_y, length)
    except MeshError as error:
        undivided = f"the elements around the line y = {curve_y:g} mm, z = 0 cannot be divided along it"
        raise DesignError("curve", f"{undivided}, because {error}; give another height") from error
    _, gap = curve_in(result, curve_y, length)
    if gap is not None:
        raise outside_material(curve_y, gap)
    return result


def _named(
    mesh: Mesh, design: FileDesign, ends: tuple[float, float], half: bool, given: Mapping[str, Index]
) -> tuple[tuple[str, ...], dict[str, Index]]:
    """Names of the cavities, and the triangles of all faces by name.

    ends: x of clamp and tip, mm; given: the triangles (k, 3) of faces by their names in the file. Raises `DesignError`
    and `MeshError`.
    """
    points, free = mesh.points, mesh.boundary
    faces: dict[str, Index] = {}
    if half:
        sym = lies_in(points, free, (2, 0.0), 1e-9 * float(np.ptp(points, axis=0).max()))
        faces["sym"], free = free[sym], free[~sym]
    if names := {name: given[name] for name in sorted(given) if name.startswith("cavity")}:
        cavities = _of_names(points, free, ends[0], names)
    else:
        cavities = walls_of_air(points, free, mesh.boundary, ends, design, half)
    outside = free[find_rows(free, np.vstack(list(cavities.values())), len(points)) < 0]
    for name, position in zip(("clamp", "tip"), ends, strict=True):
        flat = _flat(name, position, points, outside)
        faces[name], outside = outside[flat], outside[~flat]
    others = {name: triangles for name, triangles in given.items() if name not in {*names, *TAKEN}}
    for triangles in others.values():
        outside = outside[find_rows(outside, triangles, len(points)) < 0]
    faces |= {**cavities, **others, "outer": outside}
    return tuple(cavities), {name: triangles for name, triangles in faces.items() if len(triangles)}


def _of_names(points: Array, free: Index, clamp: float, names: Mapping[str, Index]) -> dict[str, Index]:
    """The triangles around the air of each cavity, by the name of the face to which some of them belong.

    clamp: x of its plane, in which cavities may be open, mm. Raises `MeshError` unless each cavity has one name.
    """
    named: dict[str, Index] = {}
    for plug in (None, clamp):
        _, inner = parts_of(points, free, plug, FLAT * float(np.ptp(points, axis=0).max()))
        found = {
            name: [k for k, walls in enumerate(inner) if (find_rows(face, walls, len(points)) >= 0).any()]
            for name, face in names.items()
        }
        if all(found.values()):
            break
    for name, parts in found.items():
        if len(parts) != 1:
            raise MeshError(f"the face {name} encloses no air: it must be the walls of one closed cavity")
        twin = next((other for other, walls in named.items() if walls is inner[parts[0]]), None)
        if twin is not None:
            raise MeshError(f"the faces {twin} and {name} are walls of the same cavity; join them")
        named[name] = inner[parts[0]]
    for walls in inner:
        if not any(walls is other for other in named.values()) and not opens_at(points, walls, [(0, clamp)]):
            where = position_text(middle_of(points, walls))
            raise MeshError(f"the mesh has one more cavity, around {where}; name its faces too, for example cavity2")
    return named


def walls_of_air(
    points: Array, free: Index, boundary: Index, ends: tuple[float, float], design: FileDesign, half: bool = False
) -> dict[str, Index]:
    """The triangles around the air of each cavity by its name; ends: x of clamp and tip, mm.

    free (k, 3): the boundary without the plane of symmetry of a half. Raises `DesignError`.
    """
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    _, inner = parts_of(points, free, ends[0] if design.plug is True else None, tolerance)
    if not inner:
        refuse_open(points, free, ends, design.plug, tolerance, fills=design.fills_inlets)
    mirrors = [(2, 0.0)] * half + [(0, ends[0])] * (design.plug is True)
    return named_cavities(points, inner, boundary, design.air, mirrors)


def _flat(name: str, position: float, points: Array, triangles: Index) -> Mask:
    """True for the triangles (k, 3) in the plane x = position (mm) of the end `name`, (k,).

    Raises `DesignError` where there is none.
    """
    flat = lies_in(points, triangles, (0, position), 1e-9 * float(np.ptp(points, axis=0).max()))
    if not flat.any():
        raise no_end_face(name, position)
    return flat
