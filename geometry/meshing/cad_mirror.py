"""Whether parts of a CAD body are mirror images of each other, in a session of `geometry.meshing.solid`.

Parts whose edges and faces are mirror images of each other are so themselves; this shows in milliseconds.
Otherwise, also where the same faces are divided in other ways, the difference decides: what one part has and the image
of the other has not. Open CASCADE takes seconds for it, and computes it wrongly for some round faces that coincide;
where it does so obviously, moments and points within the parts decide. It turns the faces of an image into splines,
whose volume is off by 1e-3 and more, so that volumes are those of the parts themselves.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from geometry.arrays import Array
from geometry.meshing.shapes import Volume

#: part of the volume by which difference and intersection with an image add up to another one if they are right
NOT_ADDED = 0.01
#: part of the volume above which a difference that leaves all moments the same is checked by points
SUSPICIOUS = 0.05
#: deviation of the moments of an image, over volume and extent, that is due to their integration
BY_MOMENTS = 1e-4
#: deviation of numbers that describe the same edge or face, as parts of the largest side of the box around the part
EQUAL = 1e-7
#: points in the box around a part; they show a difference of about a hundredth of its volume or more
POINTS = 1000


@dataclass(frozen=True)
class Difference:
    """Where the material of two parts differs if one of them is mirrored."""

    fraction: float  #: volume of that over the volume of the first part
    centre: tuple[float, float, float] | None = None  #: mm, of its largest piece; None where this is not known


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


def largest_deviation(gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float) -> float:
    """Of the moments of the mirror image of second from those of first, over the volume and powers of the extent."""
    low, high = box(gmsh, first)
    origin = 0.5 * (low + high)
    origin[axis] = at
    mirrored = np.ones(4)
    mirrored[1 + axis] = -1.0
    expected = moments(gmsh, first, origin)
    deviation = moments(gmsh, second, origin) * np.outer(mirrored, mirrored) - expected
    scale = np.array([1.0, *(high - low)])
    return float((np.abs(deviation) / np.outer(scale, scale)).max() / expected[0, 0])


def difference(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float, allowed: float
) -> Difference:
    """Between first and the mirror image of second at the plane where the coordinate `axis` (0 to 2) is `at` (mm).

    What is below the fraction `allowed` need not be told. Where the kernel is wrong, nothing is told that moments and
    points do not show.
    """
    if have_equal_boundaries(gmsh, first, second, axis, at):
        return Difference(0.0)
    occ = gmsh.model.occ
    image, plane = occ.copy(list(second)), [0.0, 0.0, 0.0, -at]
    plane[axis] = 1.0
    occ.mirror(image, *plane)
    volumes = [_volume(gmsh, parts) for parts in (first, second)]
    larger, smaller = (list(first), image) if volumes[0] >= volumes[1] else (image, list(first))
    rest = [part for part in occ.cut(larger, smaller, removeObject=False, removeTool=False)[0] if part[0] == 3]
    # of the smaller part less is outside of the larger one, by the difference of their volumes
    fraction = (2.0 * _volume(gmsh, rest) - abs(volumes[0] - volumes[1])) / volumes[0]
    common: list[Volume] = []
    told = Difference(max(fraction, 0.0))
    if abs(fraction) > allowed:
        common, _ = occ.intersect(larger, smaller, removeObject=False, removeTool=False)
        missing = abs(_volume(gmsh, rest) + _volume(gmsh, common) - max(volumes)) / volumes[0]
        deviation = largest_deviation(gmsh, first, second, axis, at)
        if fraction < 0.0 or missing > NOT_ADDED or (fraction > SUSPICIOUS and deviation < BY_MOMENTS):
            occ.synchronize()
            told = Difference(
                max(deviation if deviation > BY_MOMENTS else 0.0, _by_points(gmsh, first, second, axis, at))
            )
        else:
            x, y, z = occ.getCenterOfMass(*max(rest, key=lambda part: float(occ.getMass(*part))))
            told = Difference(fraction, (x, y, z))
    occ.remove([*rest, *common, *image], recursive=True)
    return told


def have_equal_boundaries(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float
) -> bool:
    """Whether each face and edge of first has an equal one in the mirror image of second, and the other way round.

    Faces and edges are equal if they have the same centre, area or length, and moments of inertia. Curved faces with
    the same edges may differ nevertheless, by a shape that changes none of these; no shape of a drawing does.
    """
    gmsh.model.occ.synchronize()
    low, high = box(gmsh, first)
    origin = 0.5 * (low + high)
    origin[axis] = at
    extent = float((high - low).max())
    for here, there in zip(*(_boundaries(gmsh, volumes, origin, extent) for volumes in (first, second)), strict=True):
        image = there * _signs(axis)
        trees = cKDTree(here), cKDTree(image)
        near = [tree.query_ball_point([*here, *image], EQUAL, p=np.inf, return_length=True) for tree in trees]
        if not np.array_equal(*near):
            return False
    return True


def _boundaries(gmsh: Any, volumes: Collection[Volume], origin: Array, extent: float) -> tuple[Array, Array]:
    """What describes each face (n, 10) and edge (n, 10) of some volumes: coordinates of the centre, size, and moments
    of inertia (xx, yy, zz, xy, xz, yz); lengths from the origin (mm) and over the extent (mm).

    Seams of round faces are left out: where a face begins and ends is no part of its shape.
    """
    occ = gmsh.model.occ
    faces = set(gmsh.model.getBoundary(list(volumes), combined=False, oriented=False))
    edges = set()
    for face in faces:
        around = gmsh.model.getBoundary([face], combined=False, oriented=False)
        edges |= {edge for edge in around if around.count(edge) == 1}

    def described(entity: tuple[int, int]) -> list[float]:
        mass = float(occ.getMass(*entity))
        inertia = np.array(occ.getMatrixOfInertia(*entity)).reshape(3, 3) / (mass * extent**2)
        centre = (np.array(occ.getCenterOfMass(*entity)) - origin) / extent
        return [*centre, mass ** (1.0 / entity[0]) / extent, *inertia.diagonal(), *inertia[np.triu_indices(3, 1)]]

    of_faces, of_edges = (
        np.array([described(entity) for entity in sorted(entities) if float(occ.getMass(*entity)) > 0.0])
        for entities in (faces, edges)
    )
    return of_faces, of_edges.reshape(-1, 10)


def _signs(axis: int) -> Array:
    """(10,) what the numbers of `_boundaries` are multiplied by in the mirror image at the origin."""
    of_centre = np.ones(3)
    of_centre[axis] = -1.0
    return np.array([*of_centre, *np.ones(4), *np.outer(of_centre, of_centre)[np.triu_indices(3, 1)]])


def _by_points(gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float) -> float:
    """Fraction of the points in first that are not in the mirror image of second, or the other way round."""
    low, high = box(gmsh, first)
    points = low + (high - low) * np.random.default_rng(0).random((POINTS, 3))
    images = points.copy()
    images[:, axis] = 2.0 * at - images[:, axis]
    inside = [
        np.array([any(gmsh.model.isInside(*volume, point) for volume in volumes) for point in placed])
        for placed, volumes in ((points, first), (images, second))
    ]
    return float((inside[0] != inside[1]).sum() / max(1, inside[0].sum()))


def _volume(gmsh: Any, volumes: Collection[Volume]) -> float:
    return sum(float(gmsh.model.occ.getMass(*volume)) for volume in volumes if volume[0] == 3)
