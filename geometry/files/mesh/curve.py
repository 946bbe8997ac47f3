"""The material curve as a row of element edges in a mesh that was made without it.

Elements that the curve passes through are divided at the planes y = curve and z = 0, and so are those at the tip that
the line y = curve crosses there. Vertices close to such a plane are moved into it instead, where that keeps the surface
of the body; all other elements stay as they are.
"""

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import CurvedEdges
from geometry.files.mesh.divided import DividedMesh, Line, improve
from geometry.mesh import Mesh
from geometry.quality import radius_ratios
from geometry.topology import OUTWARD, normals, row_keys, signed_volumes

#: a vertex is moved into a plane if it lies within this part of an edge that crosses it
NEAR = 0.35
#: smallest radius ratio that moving a vertex may leave, unless there was a smaller one before
LEAST_RATIO = 0.15


def with_curve(mesh: Mesh, curve_y: float, length: float) -> Mesh:
    """The mesh, with its faces and regions, with the lines y = curve_y, z = 0 (from x = 0 to `length`, mm) and
    y = curve_y (in the plane x = length) along edges.

    The regions have no element in common. Where no material is around the curve nothing is divided there.
    """
    size = float(np.ptp(mesh.points, axis=0).max())
    points, tets, line = mesh.points.copy(), mesh.tets, Line(curve_y, length, 1e-9 * size)
    for axis, position in ((1, curve_y), (2, 0.0)):
        points[np.abs(points[:, axis] - position) < 1e-6 * size, axis] = position
    faces = {"": np.empty((0, 3), dtype=np.int64), **mesh.faces}
    names = np.concatenate([np.full(len(triangles), k, dtype=np.int64) for k, triangles in enumerate(faces.values())])
    parts = np.zeros(len(tets), dtype=np.int64)
    for k, rows in enumerate(mesh.regions.values(), start=1):
        parts[rows] = k
    near = _around(points, tets, line)
    fixed = np.unique(tets[~near])
    triangles, walls = np.vstack(list(faces.values())), _boundary(tets, len(points))
    part = DividedMesh(points, tets[near], parts[near], triangles, names, walls, mesh.curved, fixed)
    if _divide(part, line, 1, curve_y) + _divide(part, line, 2, 0.0):
        improve(part, line, len(points))
    tets, parts = np.vstack([tets[~near], part.tets]), np.concatenate([parts[~near], part.parts])
    named = {name: part.triangles[part.names == k] for k, name in enumerate(faces) if name}
    regions = {name: np.flatnonzero(parts == k) for k, name in enumerate(mesh.regions, start=1)}
    return Mesh(part.points, tets, named, part.curved.usable(part.points, tets), regions)


def _between(tets: Index, parts: Index, count: int) -> Index:
    """The triangles (k, 3) between elements of different parts of the body."""
    triangles, part = tets[:, OUTWARD].reshape(-1, 3), np.repeat(parts, len(OUTWARD))
    keys = row_keys(triangles, count)
    order = np.argsort(keys, kind="stable")
    first, second = order[:-1], order[1:]
    return np.asarray(triangles[first[(keys[first] == keys[second]) & (part[first] != part[second])]])


def _around(points: Array, tets: Index, line: Line) -> Mask:
    """True for the elements (m, 4) at the material curve and at the tip, and two rows of elements around them, (m,)."""
    near = line.passes(points, tets) | (np.abs(points[tets, 0] - line.length) <= line.tolerance).any(axis=1)
    for _ in range(2):
        inside = np.zeros(len(points), dtype=bool)
        inside[tets[near]] = True
        near = inside[tets].any(axis=1)
    return np.asarray(near)


def _boundary(tets: Index, count: int) -> Index:
    triangles = tets[:, OUTWARD].reshape(-1, 3)
    _, first, counts = np.unique(row_keys(triangles, count), return_index=True, return_counts=True)
    return np.asarray(triangles[first[counts == 1]])


def _divide(mesh: DividedMesh, line: Line, axis: int, position: float) -> int:
    """Move vertices into the plane and divide the edges that cross it along the line; number of both."""
    moved = _move_into_plane(mesh, line, axis, position)
    pairs = line.crossings(mesh, axis, position)
    for a, b in pairs:
        height = mesh.points[[a, b], axis] - position
        part = height[0] / (height[0] - height[1])
        middle = (1 - part) * mesh.points[a] + part * mesh.points[b]
        middle[axis] = position
        _bisect(mesh, int(a), int(b), middle)
    return moved + len(pairs)


def _move_into_plane(mesh: DividedMesh, line: Line, axis: int, position: float) -> int:
    """Move vertices that are near the plane into it where their elements and the surface allow it; their number."""
    pairs = line.crossings(mesh, axis, position)
    height = np.abs(mesh.points[pairs][:, :, axis] - position)
    part = height / height.sum(axis=1, keepdims=True)
    near = np.unique(pairs[part < NEAR])
    free = _movable(mesh, near, axis)
    count = 0
    for vertex in sorted(near[free], key=lambda v: abs(mesh.points[v, axis] - position)):
        star = mesh.tets[(mesh.tets == vertex).any(axis=1)]
        before, old = radius_ratios(mesh.points, star).min(), mesh.points[vertex, axis]
        mesh.points[vertex, axis] = position
        least = min(before, LEAST_RATIO)
        if signed_volumes(mesh.points, star).min() > 0 and radius_ratios(mesh.points, star).min() >= least:
            count += 1
            continue
        mesh.points[vertex, axis] = old
    return count


def _movable(mesh: DividedMesh, vertices: Index, axis: int) -> Mask:
    """Whether vertices (k,) may be moved along the axis: inside the body, or within flat walls, or flat boundaries
    between its parts, along it, (k,)."""
    walls = np.vstack([mesh.walls, _between(mesh.tets, mesh.parts, len(mesh.points))])
    across = normals(mesh.points[walls])
    slanted = np.abs(across[:, axis]) > 1e-6 * np.linalg.norm(across, axis=1)
    fixed = np.union1d(np.union1d(walls[slanted], mesh.curved.ends), mesh.fixed)
    return ~np.isin(vertices, fixed)


def _bisect(mesh: DividedMesh, a: int, b: int, middle: Array) -> None:
    """Put a vertex at `middle` (3,) on the edge from a to b, and divide the elements and triangles around it."""
    new = len(mesh.points)
    mesh.points = np.vstack([mesh.points, middle])
    mesh.tets, origin = _halves(mesh.tets, a, b, new)
    mesh.parts = mesh.parts[origin]
    mesh.walls, _ = _halves(mesh.walls, a, b, new)
    mesh.triangles, origin = _halves(mesh.triangles, a, b, new)
    mesh.names = mesh.names[origin]
    if len(mesh.curved):
        kept = ~((mesh.curved.ends == a).any(axis=1) & (mesh.curved.ends == b).any(axis=1))
        mesh.curved = CurvedEdges(mesh.curved.ends[kept], mesh.curved.middles[kept])


def _halves(cells: Index, a: int, b: int, new: int) -> tuple[Index, Index]:
    """The cells (m, c), those with the edge from a to b in two parts; of which cell each is."""
    around = np.flatnonzero((cells == a).any(axis=1) & (cells == b).any(axis=1))
    if not len(around):
        return cells, np.arange(len(cells))
    halves = cells[around]
    first, second = np.where(halves == b, new, halves), np.where(halves == a, new, halves)
    cells = cells.copy()
    cells[around] = first
    return np.vstack([cells, second]), np.concatenate([np.arange(len(cells)), around])
