"""Closed surfaces of triangles from a file: which faults are named, and how thick the walls are."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array, Index
from geometry.errors import MeshError
from geometry.files.obj import read_obj
from geometry.files.shells import outside_first, shells, windings
from geometry.files.welded import welded
from geometry.mesh_content import read_content
from geometry.topology import normals, open_edges, row_keys, triangle_edges

#: what a file of a surface may end with
SUFFIXES = (".stl", ".ply", ".obj", ".off")
#: vertices nearer to each other than this, over the size of the body, are one
SAME = 1e-6
#: vertices of open edges nearer to each other than this, over the size of the body, are one: files have six digits, the
#: last of which is 1e-5 of a length of 100 mm
ROUNDED = 2e-5
#: but never vertices farther apart than this part of the shortest side of the triangles at the open edges
SHORTER = 1 / 3
#: at most this many places are measured for the thickness of the walls
PLACES = 300


@dataclass(frozen=True)
class Surface:
    """A closed surface, its outside and the walls around its air."""

    points: Array  #: (n, 3)
    parts: tuple[Index, ...]  #: triangles (k, 3) of each closed part, facing out of the material; the outside first

    @property
    def triangles(self) -> Index:
        """(k, 3) all of them."""
        return np.vstack(self.parts)

    @property
    def volume(self) -> float:
        """Volume of the material, in the cube of the unit of the points."""
        return enclosed(self.points, self.triangles)


def read_surface(path: Path) -> Surface:
    """Read a closed surface. Raises `MeshError` where it is missing, has a hole, or is not that of one body."""
    points, faces = read_obj(path) if path.suffix.lower() == ".obj" else _read_with_meshio(path)
    blocks = []
    for block in faces:
        corners = block.shape[1]
        if corners not in (3, 4):
            raise MeshError(f"the surface file {path} has faces with {corners} corners; save it with triangles")
        blocks += [block] if corners == 3 else [block[:, [0, 1, 2]], block[:, [0, 2, 3]]]
    if not sum(map(len, blocks)):
        raise MeshError(f"the surface file {path} has no triangles")
    points, triangles = _merged(points, np.vstack(blocks))
    if not len(triangles):
        raise MeshError(f"the surface file {path} has no triangle with three different corners")
    return of_parts(points, triangles)


def of_parts(points: Array, triangles: Index) -> Surface:
    """The surface of triangles (k, 3) in any order and direction. Raises `MeshError` unless it is that of one body."""
    _check_closed(points, triangles)
    return _oriented(points, triangles)


def _read_with_meshio(path: Path) -> tuple[Array, list[Index]]:
    """Points (n, 3) and faces, those with equally many corners together, (k, corners). Raises `MeshError`."""
    content = read_content(path)
    blocks = [block.data for block in content.cells if block.type in ("triangle", "quad", "polygon")]
    return np.asarray(content.points, dtype=np.float64), [np.asarray(block, dtype=np.int64) for block in blocks]


def enclosed(points: Array, triangles: Index) -> float:
    """Volume inside triangles (k, 3) that face outward, closed by planes through the origin; negative if they face
    inward."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def _merged(points: Array, triangles: Index) -> tuple[Array, Index]:
    """Points at the same position as one, and the triangles that still have three."""
    if not np.isfinite(points).all():
        raise MeshError("a point of the surface is not a finite number")
    size = float(np.ptp(points, axis=0).max())
    if not size > 0:
        raise MeshError("all points of the surface are the same")
    _, first, same = np.unique(np.round(points / (SAME * size)), axis=0, return_index=True, return_inverse=True)
    points, triangles = _compact(points[first], same.reshape(-1)[triangles])
    if not len(triangles):
        return points, triangles
    rim = np.unique(open_edges(triangles, len(points)))
    if not len(rim):
        return points, triangles
    same = np.arange(len(points))
    same[rim] = rim[welded(points[rim], min(ROUNDED * size, SHORTER * _shortest_side(points, triangles, rim)))]
    return _compact(points, same[triangles])


def _shortest_side(points: Array, triangles: Index, vertices: Index) -> float:
    """Length of the shortest side of the triangles (k, 3) that have one of the vertices (v,)."""
    ends = points[triangle_edges(triangles[np.isin(triangles, vertices).any(axis=1)])]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).min())


def _compact(points: Array, triangles: Index) -> tuple[Array, Index]:
    """The triangles (k, 3) with three different vertices, each once, and the points that they use."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (a != c)]
    _, kept = np.unique(row_keys(triangles, len(points)), return_index=True)
    used, numbers = np.unique(triangles[np.sort(kept)], return_inverse=True)
    return points[used], numbers.reshape(-1, 3).astype(np.int64)


def _check_closed(points: Array, triangles: Index) -> None:
    """Raise `MeshError` with a position unless every edge belongs to two triangles."""
    pairs = triangle_edges(triangles)
    _, first, counts = np.unique(row_keys(pairs, len(points)), return_index=True, return_counts=True)
    for wrong, sentence in (
        (counts == 1, "has a hole: {count} edges belong to one triangle only, such as that"),
        (counts > 2, "is not manifold: {count} edges belong to three or more triangles, such as that"),
    ):
        if wrong.any():
            where = ", ".join(f"{x:.4g}" for x in points[pairs[first[wrong][0]]].mean(axis=0))
            text = sentence.format(count=int(wrong.sum()))
            raise MeshError(
                f"the surface {text} near ({where}) in the file's own frame; close and repair it in the program that "
                "wrote it"
            )


def _oriented(points: Array, triangles: Index) -> Surface:
    """The closed parts, the outside facing outward and the others towards the air inside it. Raises `MeshError`."""
    outside, *inner = [_consistent(part) for part in outside_first(points, shells(triangles, len(points)))]
    if enclosed(points, outside) < 0:
        outside = outside[:, ::-1]
    corners = points[outside].reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    faced = []
    for part in inner:
        at = points[part[0]].mean(axis=0)
        if windings(at, points[outside]) < 0.5:
            where = ", ".join(f"{x:.4g}" for x in at)
            raise MeshError(
                f"the surface has a part near ({where}) outside of the largest one; it must be that of one body: join "
                "the parts, or save the body alone"
            )
        if (points[part] < low).any() or (points[part] > high).any():
            where = ", ".join(f"{x:.4g}" for x in points[part].reshape(-1, 3).mean(axis=0))
            raise MeshError(f"the walls around ({where}) in the surface pass through its outside; repair it")
        around = [k for k, other in enumerate(inner) if other is not part and abs(windings(at, points[other])) > 0.5]
        if around:
            where = ", ".join(f"{x:.4g}" for x in at)
            raise MeshError(
                f"the surface has a part near ({where}) that lies in a cavity or overlaps one; remove it, or save the "
                "body alone"
            )
        faced.append(part[:, ::-1] if enclosed(points, part) > 0 else part)
    return Surface(points, (outside, *faced))


def _consistent(part: Index) -> Index:
    """The triangles (k, 3) of a closed part, turned so that neighbours pass their edge in opposite directions.

    Raises `MeshError` where that cannot be done.
    """
    count = int(part.max()) + 1
    pairs = triangle_edges(part)
    if len(np.unique(pairs[:, 0] * count + pairs[:, 1])) == len(pairs):
        return part
    order = np.argsort(row_keys(pairs, count), kind="stable")
    neighbours = np.empty(len(pairs), dtype=np.int64)
    neighbours[order[::2]], neighbours[order[1::2]] = order[1::2], order[::2]
    same = pairs[:, 0] == pairs[neighbours, 0]  # both pass the edge in the same direction
    turned = np.full(len(part), -1)
    turned[0], waiting = 0, [0]
    while waiting:
        at = waiting.pop()
        for edge in range(3 * at, 3 * at + 3):
            other = int(neighbours[edge] // 3)
            orientation = turned[at] ^ int(same[edge])
            if turned[other] < 0:
                turned[other] = orientation
                waiting.append(other)
            elif turned[other] != orientation:
                raise MeshError("the surface has one side only, as a Moebius strip has; save the body as a solid")
    return np.where(turned[:, None] == 1, part[:, ::-1], part)


def thinnest(surface: Surface) -> float:
    """Thickness of the thinnest wall, from the middles of up to PLACES triangles straight through the material."""
    triangles = surface.triangles
    corners = surface.points[triangles]
    across = normals(corners)
    area = np.linalg.norm(across, axis=1)
    chosen = np.argsort(-area, kind="stable")[:: max(1, len(area) // PLACES)]
    thicknesses = []
    for k in chosen:
        if area[k] > 0:
            thicknesses.append(_through(corners[k].mean(axis=0), -across[k] / area[k], corners))
    return float(min(thicknesses, default=np.inf))


def _through(start: Array, direction: Array, corners: Array) -> float:
    """Distance from `start` along `direction` to the first triangle of corners (k, 3, 3) that is met (T. Moeller and B.
    Trumbore, J. Graphics Tools 2 (1997) 21)."""
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    a, along, aside = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, aside)
    determinant = np.einsum("ij,ij->i", along, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", start - a, across) / determinant
        second = np.cross(start - a, along)
        v = second @ direction / determinant
        distance = np.einsum("ij,ij->i", aside, second) / determinant
        met = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 1e-6 * size)
    return float(distance[met].min(initial=np.inf))
