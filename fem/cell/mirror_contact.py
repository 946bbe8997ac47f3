"""Contact of a wall with its own mirror image beyond a plane of symmetry, and of walls in a state of a piece."""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.discretisation import Discretisation, Faces
from fem.effects.barrier import OVERLAP, FacingTerm
from fem.effects.contact import STIFFNESS, ContactError
from fem.effects.effect import Effect, Term, Terms
from fem.effects.facing_pairs import FacingPairs
from fem.effects.mirror_layer import MirroredLayerTerm
from fem.materials.material import Material
from fem.path.newton import StepFailed
from geometry.arrays import Array, Index
from geometry.topology import cross

#: cosine of the largest angle between the normals of a wall and of the plane it faces
FACING = 0.9


@final
@dataclass(frozen=True)
class MirrorContact(Effect):
    """The walls `faces` may touch their mirror images beyond the plane of the face `plane`, but not cross them.

    dhat: activation distance in mm between a wall and its image, as in `fem.SelfContact`. A wall and its image 2 g
    apart press on each other as the wall does on the plane g away, with half the activation distance and twice the
    stiffness. Walls that face another wall of the piece are left to `fem.SelfContact`.
    """

    faces: str
    plane: str
    dhat: float

    def bind(self, space: Discretisation, material: Material) -> FacingTerm:
        """The barrier; raises `fem.ContactError` where no wall faces the plane."""
        pairs = self._pairs(space)
        if pairs.nodes.size == 0:
            raise ContactError(f"no wall of {self.faces!r} faces the plane {self.plane!r}")

        stiffness = 2.0 * STIFFNESS * 3.0 * material.shear_modulus
        return FacingTerm(pairs, self.dhat / 2.0, stiffness, OVERLAP, starts_inactive=False)

    def has_walls(self, space: Discretisation) -> bool:
        """Whether a wall faces the plane."""
        return self._pairs(space).nodes.size > 0

    def _pairs(self, space: Discretisation) -> FacingPairs:
        return plane_pairs(space.surface(self.faces), space.surface(self.plane), space.points)


def gap_and_touch(terms: Terms, x: Array, plane: Index) -> tuple[float, bool]:
    """Smallest gap between walls in mm at positions x (n, 3), and whether they touch.

    plane: nodes (k,) of the plane of symmetry; a wall is half as far from it as from its mirror image.
    """
    gap, touches = np.inf, False
    for term in terms:
        if isinstance(term, FacingTerm):
            gap = min(gap, (2.0 if is_with_images(term, plane) else 1.0) * term.gap(x))
            touches = touches or term.touching(x)
    return gap, touches


def is_with_images(term: Term, plane: Index) -> bool:
    """Whether a term is contact of walls with their mirror images beyond the plane of the nodes (k,), or the bending of
    a layer at such a plane."""
    if isinstance(term, MirroredLayerTerm):
        return True
    return isinstance(term, FacingTerm) and bool(np.isin(term.pairs.triangles, plane).all())


def tightened(term: Term, x: Array) -> Term:
    """A stiffer barrier where walls overlap, the term itself where they do not. Raises `StepFailed`."""
    if not isinstance(term, FacingTerm) or term.gap(x) > 0.0:
        return term
    if not term.stiffenings:
        raise StepFailed(*filter(None, [term.violation(x)]))
    return term.tightened(x)


def plane_pairs(walls: Faces, plane: Faces, points: Array) -> FacingPairs:
    """The nodes of the walls that face a plane with nothing between, each with one large triangle of the plane.

    points: (n, 3) positions at rest, mm. The signed gap of a pair is the distance of the node from the plane.
    """
    corner = _large_triangle(plane, points)
    normal = _area_vectors(points, corner[None])[0]
    normal /= np.linalg.norm(normal)
    triangles = walls.triangles
    vectors = _area_vectors(points, triangles)
    area = np.linalg.norm(vectors, axis=1)
    facing = triangles[vectors @ normal < -FACING * area]
    nodal = np.zeros(points.shape[0])
    for k in range(3):
        np.add.at(nodal, facing[:, k], area[vectors @ normal < -FACING * area] / 3.0)
    behind = FacingPairs.of(walls, points).nodes
    nodes = np.setdiff1d(np.unique(facing), behind)
    return FacingPairs(nodes, np.tile(corner, (nodes.shape[0], 1)), nodal[nodes], np.zeros(nodes.shape, dtype=bool))


def _large_triangle(plane: Faces, points: Array) -> Index:
    """Three nodes (3,) of a plane face that span a large triangle, its normal into the body."""
    nodes = plane.unique_nodes
    x = points[nodes]
    first = int(np.argmax(np.linalg.norm(x - x.mean(axis=0), axis=1)))
    second = int(np.argmax(np.linalg.norm(x - x[first], axis=1)))
    height = np.linalg.norm(cross(x - x[first], x[second] - x[first]), axis=1)
    corner = nodes[[first, second, int(np.argmax(height))]]
    outward = _area_vectors(points, plane.triangles).sum(axis=0)
    return corner if _area_vectors(points, corner[None])[0] @ outward < 0.0 else corner[[0, 2, 1]]


def _area_vectors(points: Array, triangles: Index) -> Array:
    """Normals (f, 3) of triangles (f, 3) with their areas as lengths."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.asarray(cross(b - a, c - a) / 2.0)
