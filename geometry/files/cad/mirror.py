"""Whether parts of a CAD body are mirror images of each other, in a session of `geometry.meshing.solid`.

Parts are mirror images of each other if all faces and edges around them are, which shows in a tenth of a second.
Otherwise, also where the same faces are divided in other ways, the difference decides: what one part has and the image
of the other has not. Open CASCADE takes seconds for it, and computes it wrongly for some round faces that coincide;
where it does so obviously, moments and points within the parts decide. It turns the faces of an image into splines,
whose volume is off by 1e-3 and more, so that volumes are those of the parts themselves.
"""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.meshing.shapes import Volume

#: part of the volume by which difference and intersection with an image add up to another one if they are right
NOT_ADDED = 0.01
#: part of the volume above which a difference that leaves all moments the same is checked by points
SUSPICIOUS = 0.05
#: deviation of the moments of an image, over volume and extent, that is due to their integration
BY_MOMENTS = 1e-4
#: deviation above which points decide although the kernel finds no difference: integrals over splines are off by more
DOUBTFUL = 5e-4
#: kinds of edges (1) and faces (2) that a few numbers describe
PLAIN = {1: {"Line", "Circle"}, 2: {"Plane", "Cylinder", "Cone", "Sphere", "Torus"}}
#: distance between two that are the same, and difference of their sizes, over the largest side of the box around the
#: part; and between the numbers of other kinds, whose integrals are less exact
EQUAL, NEAR = 1e-7, 1e-3
#: points of an edge of another kind, and along both directions of a face, that are compared
SAMPLED = 9
#: points in the box around a part; they show a difference of about a hundredth of its volume or more
POINTS = 1000

#: dimension and number of an edge or a face
Entity: TypeAlias = tuple[int, int]


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
    deviation = largest_deviation(gmsh, first, second, axis, at)
    if abs(fraction) > allowed:
        common, _ = occ.intersect(larger, smaller, removeObject=False, removeTool=False)
        missing = abs(_volume(gmsh, rest) + _volume(gmsh, common) - max(volumes)) / volumes[0]
        if fraction < 0.0 or missing > NOT_ADDED or (fraction > SUSPICIOUS and deviation < BY_MOMENTS):
            occ.synchronize()
            by_moments = deviation if deviation > BY_MOMENTS else 0.0
            told = Difference(max(by_moments, _by_points(gmsh, first, second, axis, at)))
        else:
            x, y, z = occ.getCenterOfMass(*max(rest, key=lambda part: float(occ.getMass(*part))))
            told = Difference(fraction, (x, y, z))
    elif deviation > DOUBTFUL:
        occ.synchronize()
        told = Difference(_by_points(gmsh, first, second, axis, at))
    occ.remove([*rest, *common, *image], recursive=True)
    return told


def have_equal_boundaries(
    gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float
) -> bool:
    """Whether each face and edge of first has an equal one in the mirror image of second, and the other way round.

    Edges of the kinds in `PLAIN`, and faces with such edges alone, are the same if their centres, sizes, moments of
    inertia and the middles between the ends of edges are; of others points must lie on each other. Faces between two
    volumes of a group are inside of it and do not count. False where this is not certain.
    """
    gmsh.model.occ.synchronize()
    low, high = box(gmsh, first)
    origin = 0.5 * (low + high)
    origin[axis] = at
    extent = float((high - low).max())
    groups = [_faces_and_edges(gmsh, volumes, EQUAL * extent) for volumes in (first, second)]
    for here, there in zip(*groups, strict=True):
        own, other = (_described(gmsh, entities, origin, extent) for entities in (here, there))
        image = other * _signs_of_image(axis)
        plain, plain_there = (
            np.array([_is_plain(gmsh, entity) for entity in group], dtype=bool) for group in (here, there)
        )
        if not _have_equal_rows(own[plain], image[plain_there]):
            return False
        pairs = [
            (here[i], there[k])
            for i in np.flatnonzero(~plain)
            for k in np.flatnonzero(~plain_there)
            if np.abs(own[i] - image[k]).max() < NEAR
        ]
        same = [pair for pair in pairs if _lies_on(gmsh, *pair, axis, at, EQUAL * extent)]
        if len({i for i, _ in same}) < (~plain).sum() or len({k for _, k in same}) < (~plain_there).sum():
            return False
    return largest_deviation(gmsh, first, second, axis, at) < BY_MOMENTS


def _faces_and_edges(gmsh: Any, volumes: Collection[Volume], shortest: float) -> tuple[list[Entity], list[Entity]]:
    """The faces around a group of volumes and their edges, without those shorter than a length (mm), such as the pole
    of a sphere, and without seams of round faces, which may lie anywhere on them."""
    faces = sorted(gmsh.model.getBoundary(list(volumes), combined=True, oriented=False))
    edges: set[Entity] = set()
    for face in faces:
        around = Counter(gmsh.model.getBoundary([face], combined=False, oriented=False))
        edges |= {edge for edge, count in around.items() if count == 1}
    return faces, sorted(edge for edge in edges if float(gmsh.model.occ.getMass(*edge)) > shortest)


def _described(gmsh: Any, entities: Sequence[Entity], origin: Array, extent: float) -> Array:
    """(n, 13) of faces or edges: centre, middle between the ends of an edge that is open and else the centre, size, and
    moments of inertia (xx, yy, zz, xy, xz, yz); lengths from the origin (mm) over the extent (mm).

    Moments are those of the entity with size 1, and multiplied by 0.1 for edges and 0.01 for faces: they tell
    directions, the others where an entity lies.
    """
    occ = gmsh.model.occ
    rows = np.empty((len(entities), 13))
    for row, (dim, tag) in zip(rows, entities, strict=True):
        measure = float(occ.getMass(dim, tag))  # length or area
        size = measure ** (1.0 / dim)
        inertia = np.array(occ.getMatrixOfInertia(dim, tag)).reshape(3, 3) * (0.1**dim / (measure * size**2))
        centre = (np.array(occ.getCenterOfMass(dim, tag)) - origin) / extent
        ends = gmsh.model.getBoundary([(dim, tag)], combined=False, oriented=False) if dim == 1 else []
        middle = centre
        if len(set(ends)) == 2:
            middle = (np.mean([gmsh.model.getValue(*end, []) for end in ends], axis=0) - origin) / extent
        row[:] = [*centre, *middle, size / extent, *inertia.diagonal(), *inertia[np.triu_indices(3, 1)]]
    return rows


def _is_plain(gmsh: Any, entity: Entity) -> bool:
    """Whether an edge, or a face and the edges around it, are of the kinds in `PLAIN`."""
    if gmsh.model.getType(*entity) not in PLAIN[entity[0]]:
        return False
    edges = gmsh.model.getBoundary([entity], combined=False, oriented=False) if entity[0] == 2 else []
    # the pole of a sphere is an edge without length
    return all(gmsh.model.getType(*edge) in PLAIN[1] or gmsh.model.occ.getMass(*edge) <= 0.0 for edge in edges)


def _have_equal_rows(first: Array, second: Array) -> bool:
    """Whether the rows are the same but for their order."""
    if len(first) == 0 or len(second) == 0:
        return len(first) == len(second)
    from scipy.spatial import cKDTree  # here: what reads no CAD file does not wait for its import

    trees = cKDTree(first), cKDTree(second)
    near = [tree.query_ball_point(np.vstack([first, second]), EQUAL, p=np.inf, return_length=True) for tree in trees]
    return np.array_equal(*near)


def _lies_on(gmsh: Any, first: Entity, second: Entity, axis: int, at: float, tolerance: float) -> bool:
    """Whether points of an edge or face lie on the mirror image of another, to a tolerance in mm."""
    images = _mirrored(_points_of(gmsh, first), axis, at)
    if not len(images):
        return False
    closest = np.reshape(gmsh.model.getClosestPoint(*second, images.ravel())[0], (-1, 3))
    return bool(np.linalg.norm(closest - images, axis=1).max() < tolerance)


def _points_of(gmsh: Any, entity: Entity) -> Array:
    """(n, 3) points of an edge or a face, mm, with unequal distances."""
    dim, tag = entity
    low, high = (np.array(ends) for ends in gmsh.model.getParametrizationBounds(dim, tag))
    parts = 0.5 - 0.5 * np.cos(np.pi * (np.arange(SAMPLED) + 0.5) / SAMPLED)
    grid = np.stack(np.meshgrid(*[parts] * dim), axis=-1).reshape(-1, dim)
    parameters = low + grid * (high - low)
    if dim == 2:
        inside = [gmsh.model.isInside(dim, tag, list(pair), parametric=True) for pair in parameters]
        parameters = parameters[np.array(inside, dtype=bool)]
    return np.reshape(gmsh.model.getValue(dim, tag, parameters.ravel()), (-1, 3))


def _signs_of_image(axis: int) -> Array:
    """(13,) what the numbers of `_described` are multiplied by in the mirror image at the origin."""
    signs = np.ones(3)
    signs[axis] = -1.0
    return np.array([*signs, *signs, *np.ones(4), *np.outer(signs, signs)[np.triu_indices(3, 1)]])


def _mirrored(points: Array, axis: int, at: float) -> Array:
    images = points.copy()
    images[:, axis] = 2.0 * at - images[:, axis]
    return images


def _by_points(gmsh: Any, first: Collection[Volume], second: Collection[Volume], axis: int, at: float) -> float:
    """Fraction of the points in first that are not in the mirror image of second, or the other way round."""
    low, high = box(gmsh, first)
    points = low + (high - low) * np.random.default_rng(0).random((POINTS, 3))
    images = _mirrored(points, axis, at)
    inside = [
        np.array([any(gmsh.model.isInside(*volume, point) for volume in volumes) for point in placed])
        for placed, volumes in ((points, first), (images, second))
    ]
    return float((inside[0] != inside[1]).sum() / max(1, inside[0].sum()))


def _volume(gmsh: Any, volumes: Collection[Volume]) -> float:
    return sum(float(gmsh.model.occ.getMass(*volume)) for volume in volumes if volume[0] == 3)
