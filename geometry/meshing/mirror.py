"""A body from one end piece and one half cell, repeated as mirror images so that equal cells have equal meshes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from geometry.mesh import Mesh
from geometry.meshing.face_names import name_faces
from geometry.meshing.solid import SolidMesh
from geometry.topology import Array


@dataclass(frozen=True)
class _Piece:
    """A part of a meshed solid with its own numbering."""

    points: Array  #: (n, 3), mm
    tets: Array  #: (m, 4)
    walls: Mapping[str, Array]  #: name -> (k, 3)
    original: Array  #: (n,) index of each point in the solid it was cut from


def repeat(solid: SolidMesh, middle: float, edge: float, half_cells: int) -> Mesh:
    """The body made of `end`, `half_cells` times `cell` and `end` again, each the mirror image of its neighbour.

    `solid` holds the regions `end` (x from 0 to `middle`) and, unless half_cells is 0, `cell` (x from `middle` to
    `edge`), which share the vertices of the plane x = middle (mm). Because a piece meets only its own mirror image,
    neighbours share their vertices by number and no coordinates have to be compared. half_cells must be even.
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
    numbers = np.full(len(solid.points), -1)  # of the latest copy, by the numbering of the solid
    numbers[end.original] = np.arange(count)
    pieces = [(end, -1)]
    if half_cells:
        cell = _cut(solid, "cell")
        pieces = [(cell, k) for k in range(half_cells)] + pieces
    for piece, k in pieces:
        at = edge if k % 2 and k >= 0 else middle  # where this copy touches the one before it
        new = np.abs(piece.points[:, 0] - at) > 1e-9 * length
        here = numbers[piece.original]
        here[new] = count + np.arange(new.sum())
        count += int(new.sum())
        numbers[piece.original] = here
        points.append(_placed(piece.points[new], k, middle, edge, length))
        tets.append(here[piece.tets])
        for name, triangles in piece.walls.items():
            walls[name].append(here[triangles])
    planes = {"clamp": (0, 0.0), "tip": (0, length), "sym": (2, 0.0)}
    joined = {name: np.vstack(parts) for name, parts in walls.items()}
    return name_faces(np.vstack(points), np.vstack(tets), joined, planes)


def slices(length: float, nominal: float) -> tuple[int, float]:
    """How many equal slices, each as near to `nominal` as can be, make up `length`, and how long one is (mm)."""
    count = max(1, round(length / nominal))
    return count, length / count


def _placed(points: Array, k: int, middle: float, edge: float, length: float) -> Array:
    """Points (n, 3) of the k-th half cell where it belongs; k = -1 stands for the far end piece."""
    placed = points.copy()
    if k < 0:
        placed[:, 0] = length - points[:, 0]
    else:
        shift = 2 * (edge - middle) * (k // 2)
        placed[:, 0] = shift + (2 * edge - points[:, 0] if k % 2 else points[:, 0])
    return placed


def _cut(solid: SolidMesh, region: str) -> _Piece:
    """One region of the solid with the walls that belong to it."""
    tets = solid.regions[region]
    used, local = np.unique(tets, return_inverse=True)
    new = np.full(len(solid.points), -1)
    new[used] = np.arange(len(used))
    walls = {name: new[triangles] for name, triangles in solid.walls.items()}
    return _Piece(
        solid.points[used],
        local.reshape(tets.shape),
        {name: triangles[(triangles >= 0).all(axis=1)] for name, triangles in walls.items()},
        used,
    )
