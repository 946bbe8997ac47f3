"""Whether parts of a CAD body are mirror images of each other, in a session of `geometry.meshing.solid`.

Parts with plane and round faces are, if their moments and the centres and areas of all faces are. Other parts are
compared by random points, and so are those whose faces are divided otherwise: each point lies in both or in none. The
kernel's own differences are wrong for some round faces that coincide, its integrals over splines by a hundredth.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.files.frame import Point
from geometry.meshing.shapes import Face, Volume

#: kinds of faces over which the kernel integrates exactly
PLAIN = {"Plane", "Cylinder", "Cone", "Sphere", "Torus"}
#: distance of two centres of faces, and difference of the roots of their areas, over the extent, that is rounding
EQUAL = 1e-7
#: points in the box around a part; they show a difference of about a hundredth of its volume or more
POINTS = 1000
#: and where equal moments have shown most differences
FEW = 100


@dataclass(frozen=True)
class Difference:
    """Whether the material of two parts differs if one of them is mirrored."""

    exists: bool
    centre: Point | None = None  #: mm, of where it does; None where this is not known


def box(gmsh: Any, volumes: Collection[Volume]) -> Array:
    """Corners (2, 3) of the box around some volumes, mm."""
    boxes = np.array([gmsh.model.occ.getBoundingBox(*volume) for volume in volumes])
    return np.stack([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])


def moments(gmsh: Any, volumes: Collection[Volume], origin: Sequence[float]) -> Array:
    """(4, 4) volume, first and second moments about a point (mm): integrals of the products of (1, x, y, z)."""
    occ = gmsh.model.occ
    total = np.zeros((4, 4))
    for volume in volumes:
        mass = float(occ.getMass(*volume))
        centre = np.array(occ.getCenterOfMass(*volume)) - origin
        inertia = np.array(occ.getMatrixOfInertia(*volume)).reshape(3, 3)
        total[0, 0] += mass
        total[0, 1:] += mass * centre
        total[1:, 0] = total[0, 1:]
        total[1:, 1:] += 0.5 * np.trace(inertia) * np.eye(3) - inertia + mass * np.outer(centre, centre)
    return total


def are_same(gmsh: Any, first: Collection[Volume], second: Collection[Volume], allowed: float) -> bool:
    """Whether two parts are the same, as `difference` compares one with a mirror image, in less time.

    Parts whose faces are divided otherwise are compared by few points, beside their moments; others than plain ones
    are taken as different.
    """
    _, same_moments, same_faces = _compared(gmsh, first, second, None, 0.0, allowed)
    return same_faces or (same_moments and not len(_points_in_one(gmsh, first, second, None, 0.0, FEW)))


def difference(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float, allowed: float
) -> Difference:
    """Between first and the mirror image of second at the plane where the coordinate `axis` (0 to 2) is `at` (mm).

    allowed: difference of the moments over the volume and the extent that is rounding.
    """
    is_plain, same_moments, same_faces = _compared(gmsh, first, second, axis, at, allowed)
    if same_faces:
        return Difference(False)
    apart = _points_in_one(gmsh, first, second, axis, at)
    if len(apart):
        x, y, z = apart.mean(axis=0).tolist()
        return Difference(True, (x, y, z))
    return Difference(is_plain and not same_moments)


def _compared(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int | None, at: float, allowed: float
) -> tuple[bool, bool, bool]:
    """Whether all faces are plain, whether the moments are then equal, and whether the faces are then equal too."""
    gmsh.model.occ.synchronize()
    faces, others = (gmsh.model.getBoundary(list(of), combined=True, oriented=False) for of in (first, second))
    is_plain = all(gmsh.model.getType(*face) in PLAIN for face in (*faces, *others))
    same_moments = is_plain and _largest_deviation(gmsh, first, second, axis, at) <= allowed
    return is_plain, same_moments, same_moments and _are_equal(gmsh, faces, others, axis, at)


def _mirrored(points: Array, axis: int | None, at: float) -> Array:
    """Points (n, 3), mirrored at a plane, or as they are where there is none."""
    images = points.copy()
    if axis is not None:
        images[:, axis] = 2.0 * at - images[:, axis]
    return images


def _are_equal(gmsh: Any, first: Collection[Face], second: Collection[Face], axis: int | None, at: float) -> bool:
    """Whether faces have the centres and areas of the mirror images of others."""
    occ = gmsh.model.occ
    centres, other = (np.array([occ.getCenterOfMass(*face) for face in faces]) for faces in (first, second))
    sizes, others = (np.sqrt([occ.getMass(*face) for face in faces]) for faces in (first, second))
    away = np.abs(centres[:, None] - _mirrored(other, axis, at)).max(axis=2) + np.abs(sizes[:, None] - others)
    same = away <= EQUAL * np.ptp(centres, axis=0).max()
    return bool(same.any(axis=0).all() and same.any(axis=1).all())


def _points_in_one(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int | None, at: float, count: int = POINTS
) -> Array:
    """Random points (n, 3), mm, that lie in first and not in the mirror image of second, or the other way round."""
    corners = np.vstack([box(gmsh, first), _mirrored(box(gmsh, second), axis, at)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    points = low + (high - low) * np.random.default_rng(0).random((count, 3))
    inside = [
        np.array([any(gmsh.model.isInside(*volume, point) for volume in volumes) for point in placed])
        for placed, volumes in ((points, first), (_mirrored(points, axis, at), second))
    ]
    return points[inside[0] != inside[1]]


def _largest_deviation(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int | None, at: float
) -> float:
    """Of the moments of the mirror image of second from those of first, over the volume and powers of the extent."""
    low, high = box(gmsh, first)
    origin = 0.5 * (low + high)
    mirrored = np.ones(4)
    if axis is not None:
        origin[axis], mirrored[1 + axis] = at, -1.0
    expected = moments(gmsh, first, origin)
    deviation = moments(gmsh, second, origin) * np.outer(mirrored, mirrored) - expected
    scale = np.array([1.0, *(high - low)])
    return float((np.abs(deviation) / np.outer(scale, scale)).max() / expected[0, 0])
