"""In which directions a body lies that is turned in its file: its longest way, and the normals of its flat faces."""

import numpy as np

from geometry.arrays import Array, Index
from geometry.files.frame import Directions, Point
from geometry.topology import cross

#: cosine of the largest angle between the longest way of a body, or across it, and the flat faces there; and between
#: triangles of one flat face
NEARLY, FLAT = 0.9, 1 - 1e-6
#: smallest part of the surface that is a flat face, and that tells that a body is rolled: not one facet of a round wall
PART, LARGE = 0.01, 0.1
#: sine of the smallest angle to a direction of the file that counts
ALIGNED = 1e-4


def oblique_directions(points: Array, triangles: Index) -> Directions | None:
    """Along and up of a body with the surface points (n, 3) and triangles (k, 3).

    Along is normal to a flat end; up is a principal direction in which the body is not symmetric. Both have their
    largest component positive. None where the body has no flat end or lies in directions of the file; if its length
    does, a large flat side has to tell that it is rolled about it.
    """
    corners = points[triangles]
    vectors = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    area = np.linalg.norm(vectors, axis=1)
    principal, skew = _principal(corners, area)
    along = _flat_face(vectors, area, principal[0])
    if along is None:
        return None
    order = (1, 2) if skew[1] < skew[2] else (2, 1)
    across = principal[order[0]] - (principal[order[0]] @ along) * along
    sides = np.abs(vectors @ along) < (1 - FLAT) ** 0.5 * area
    is_aligned = _off_axis(along) < ALIGNED
    part = LARGE if is_aligned else PART
    side, top = (_flat_face(vectors[sides], area[sides], each, part) for each in (across, np.cross(across, along)))
    if side is not None:
        across = side
    elif top is not None:
        across = np.cross(along, top)
    elif is_aligned:
        return None
    up = np.cross(across / np.linalg.norm(across), along)
    if is_aligned and min(_off_axis(up), _off_axis(principal[1])) < ALIGNED:
        return None
    return Directions(_upright(along), _upright(up))


def _principal(corners: Array, area: Array) -> tuple[Array, Array]:
    """Principal directions (3, 3) of a surface of triangles (k, 3, 3), the longest first, and how unequal its two sides
    are along each (3,)."""
    corners = corners - np.average(corners.mean(axis=1), axis=0, weights=area)
    total = corners.sum(axis=1)
    squares = np.einsum("kvi,kvj->kij", corners, corners) + total[:, :, None] * total[:, None, :]
    directions = np.linalg.eigh(np.einsum("k,kij->ij", area, squares))[1].T[::-1]
    a, b, c = (corners @ directions.T).transpose(1, 0, 2)
    cubes = a**3 + b**3 + c**3 + a * a * (b + c) + b * b * (c + a) + c * c * (a + b) + a * b * c
    return directions, np.abs(area @ cubes)


def _flat_face(vectors: Array, area: Array, towards: Array, part: float = PART) -> Array | None:
    """The unit normal (3,) of the largest flat face with a normal nearly in a direction, or in the opposite one.

    vectors (k, 3): normals of triangles with their areas (k,) as lengths; part: how much of their sum the face
    has at least. None where there is none.
    """
    cosine = vectors @ (towards / np.linalg.norm(towards))
    near = np.abs(cosine) > NEARLY * area
    if not near.any():
        return None
    normals = (vectors * np.sign(cosine)[:, None])[near]
    largest = normals[int(np.argmax(area[near]))]
    same = normals[normals @ largest > FLAT * area[near] * np.linalg.norm(largest)].sum(axis=0)
    size = float(np.linalg.norm(same))
    return same / size if size > part * area.sum() else None


def _off_axis(direction: Array) -> float:
    """Sine of the angle between a unit vector (3,) and the nearest direction of the file."""
    return float(np.linalg.norm(np.sort(np.abs(direction))[:2]))


def _upright(direction: Array) -> Point:
    """With its largest component positive."""
    x, y, z = (float(part) for part in direction * np.sign(direction[int(np.argmax(np.abs(direction)))]))
    return x, y, z
