"""A body from one end piece and one half cell, repeated as mirror images so that equal cells have equal meshes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index
from geometry.mesh import Mesh
from geometry.meshing.face_names import name_faces
from geometry.meshing.solid import SolidMesh


@dataclass(frozen=True)
class _Region:
    """One region of a meshed solid, with point numbers of its own."""

    points: Array  #: (n, 3), mm
    tets: Index  #: (m, 4)
    walls: Mapping[str, Index]  #: name of the air -> (k, 3)
    original: Index  #: (n,) number of each point in the meshed solid


def repeat(solid: SolidMesh, middle: float, edge: float, half_cells: int) -> Mesh:
    """The body made of `end`, `half_cells` times `cell` and `end` again, each the mirror image of its neighbour.

    `solid` holds the regions `end` (x from 0 to `middle`) and, unless half_cells is 0, `cell` (x from `middle` to
    `edge`), which share the vertices of the plane x = middle (mm). Because each copy touches only its own mirror image,
    neighbours share their vertices by number and no coordinates have to be compared. Raises `ValueError` when
    half_cells is odd or negative.
    Boundary faces: the walls of the solid's air by their names, `clamp` (x = 0), `tip` (the far end), `sym` (z = 0),
    and `outer` for all others.
    """
    if half_cells % 2 or half_cells < 0:
        raise ValueError(f"the number of half cells must be even, not {half_cells}")
    end = _cut(solid, "end")
    length = 2 * middle + half_cells * (edge - middle)
    points, tets = [end.points], [end.tets]
    walls = {name: [triangles] for name, triangles in end.walls.items()}
    count = len(end.points)
    latest = np.full(len(solid.points), -1)  # point numbers of the latest copy, by point of the meshed solid
    latest[end.original] = np.arange(count)
    copies = [(end, -1)]
    if half_cells:
        cell = _cut(solid, "cell")
        copies = [(cell, k) for k in range(half_cells)] + copies
    for region, k in copies:
        interface = edge if k % 2 and k >= 0 else middle  # where this copy touches the one before it
        new = np.abs(region.points[:, 0] - interface) > 1e-9 * length
        numbers = latest[region.original]
        numbers[new] = count + np.arange(new.sum())
        count += int(new.sum())
        latest[region.original] = numbers
        points.append(_copied(region.points[new], k, middle, edge, length))
        tets.append(numbers[region.tets])
        for name, triangles in region.walls.items():
            walls[name].append(numbers[triangles])
    planes = {"clamp": (0, 0.0), "tip": (0, length), "sym": (2, 0.0)}
    joined = {name: np.vstack(triangles) for name, triangles in walls.items()}
    return name_faces(np.vstack(points), np.vstack(tets), joined, planes)


def slices(length: float, nominal: float) -> tuple[int, float]:
    """Number and length (mm) of the equal slices of `length` that are closest to `nominal` (mm)."""
    count = max(1, round(length / nominal))
    return count, length / count


def _copied(points: Array, k: int, middle: float, edge: float, length: float) -> Array:
    """The points (n, 3) mirrored and shifted to the k-th half cell; k = -1 stands for the far end piece."""
    copied = points.copy()
    if k < 0:
        copied[:, 0] = length - points[:, 0]
    else:
        shift = 2 * (edge - middle) * (k // 2)
        copied[:, 0] = shift + (2 * edge - points[:, 0] if k % 2 else points[:, 0])
    return copied


def _cut(solid: SolidMesh, region: str) -> _Region:
    """One region of the solid with the walls that belong to it."""
    tets = solid.regions[region]
    used, local = np.unique(tets, return_inverse=True)
    new = np.full(len(solid.points), -1)
    new[used] = np.arange(len(used))
    walls = {name: new[triangles] for name, triangles in solid.walls.items()}
    return _Region(
        solid.points[used],
        local.reshape(tets.shape),
        {name: triangles[(triangles >= 0).all(axis=1)] for name, triangles in walls.items()},
        used,
    )
