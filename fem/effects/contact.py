"""Self-contact (the only door to ipctk).

The potential between facing walls is `fem.effects.barrier.FacingTerm`. Its results are checked with ipctk: a converged
state is accepted only if no triangle crosses another. Walls that cross in a crease get pairs of their own; where that
is not enough, the increment is solved again with the barrier of incremental potential contact, whose distances are
those between all triangles.
Source of the latter: M. Li et al., "Incremental potential contact: intersection- and inversion-free, large-deformation
dynamics", ACM Trans. Graph. 39 (2020).
"""

from dataclasses import dataclass
from functools import cache
from typing import Any, final

import numpy as np

from fem.discretisation import Discretisation, Faces
from fem.effects.barrier import OVERLAP, FacingTerm
from fem.effects.effect import NO_BLOCKS, Blocks, Effect, UnilateralTerm
from fem.effects.facing_pairs import FARTHEST, NO_PAIRS, FacingPairs
from fem.effects.tightening import Tightening
from fem.materials.material import Material
from fem.reasons import position_of
from geometry import PneurodError, Reason
from geometry.arrays import Array, Index
from geometry.topology import passes_through

#: stiffness of the barrier over Young's modulus, for which 3 mu stands (near incompressibility): with an overlap, and
#: without one. A soft barrier costs fewer factorizations; a table of both is in studies/solver.md
STIFFNESS, STIFFNESS_NO_OVERLAP = 0.025, 0.1
#: activation distance over the smallest gap at rest, with an overlap, and without one
ACTIVATION, ACTIVATION_NO_OVERLAP = 0.02, 0.1
#: activation distance over the gap at rest of a pair that is taken up because its walls cross in a crease
ACTIVATION_IN_CREASE = 0.2
#: gap over the smallest one at rest below which a pair of walls takes part in the pattern of the matrix
NEAR = 0.5


class ContactError(PneurodError, ValueError):
    """Faces that can never meet, or an activation distance that does not fit them."""


@final
@dataclass(frozen=True)
class SelfContact(Effect):
    """Faces that may touch but not cross.

    dhat: activation distance of the barrier in mm, below the smallest gap at rest, so that walls do not press on each
    other without load; by default a fiftieth of that gap. starts_inactive:
    the effect is left out until a state without it comes within dhat; a scene that never touches is then the scene
    without contact, and faces that can never meet do no harm. overlap: fraction of the barrier's width that lies behind
    the wall; with 0 walls rest further apart, nearly dhat, but no pressure on a small spot pushes them through each
    other, and dhat is a tenth of the gap by default.

    near: gap, over the smallest one at rest, below which a pair of walls takes part in the pattern of the matrix from
    the first contact on, because it may be the next to touch. Fewer pairs make a factorization cheaper; infinity stands
    for all pairs.

    Raises `ContactError` for an overlap outside 0 <= overlap < 1 and a dhat that is not positive and finite.
    """

    faces: str
    dhat: float | None = None
    starts_inactive: bool = False
    overlap: float = OVERLAP
    near: float = NEAR

    def __post_init__(self) -> None:
        if not 0 <= self.overlap < 1:
            raise ContactError(
                f"self-contact on {self.faces!r}: overlap = {self.overlap:g} must be at least 0 and below 1"
            )
        if self.dhat is not None and not 0 < self.dhat < np.inf:
            raise ContactError(f"self-contact on {self.faces!r}: dhat = {self.dhat:g} mm must be positive and finite")

    def bind(self, space: Discretisation, material: Material) -> FacingTerm:
        """The barrier; raises `ContactError`."""
        surface = space.surface(self.faces)
        pairs = self._pairs(space)
        dhat = self._dhat(pairs, space)
        E = 3 * material.shear_modulus
        stiffness = (STIFFNESS if self.overlap else STIFFNESS_NO_OVERLAP) * E

        @cache
        def exact(of_images: float) -> BarrierTerm:
            mirrored = pairs.taken(np.flatnonzero(pairs.is_mirrored))
            images = FacingTerm(mirrored, dhat, of_images, self.overlap, False) if mirrored.nodes.size else None
            return BarrierTerm(surface, space.points, dhat, STIFFNESS_NO_OVERLAP * E, images)

        near = self.near * _smallest_gap(pairs, space)

        def pairs_in_creases(x: Array, known: FacingPairs) -> tuple[FacingPairs, Array]:
            crossing = FacingPairs.of_crossings(*crossings(x, surface.triangles), surface, space.points).without(known)
            return crossing, np.minimum(dhat, ACTIVATION_IN_CREASE * crossing.gaps(space.points))

        return FacingTerm(pairs, dhat, stiffness, self.overlap, self.starts_inactive, near, exact, pairs_in_creases)

    def activation_distance(self, space: Discretisation) -> float:
        """dhat, or its default for these faces, mm; raises `ContactError`."""
        return self._dhat(self._pairs(space), space)

    def smallest_gap(self, space: Discretisation) -> float:
        """The smallest gap between these faces at rest, mm; infinity where no two parts of them face each other."""
        return _smallest_gap(self._pairs(space), space)

    def _pairs(self, space: Discretisation) -> FacingPairs:
        symmetric = [space.surfaces["sym"].unique_nodes] if "sym" in space.surfaces else []
        return FacingPairs.of(space.surface(self.faces), space.points, *symmetric)

    def _dhat(self, pairs: FacingPairs, space: Discretisation) -> float:
        if pairs.nodes.size == 0 and not self.starts_inactive:
            raise ContactError(f"self-contact on {self.faces!r}: no two parts of these faces face each other")
        gap = _smallest_gap(pairs, space)
        if not gap > 0:
            raise ContactError(
                f"self-contact on {self.faces!r}: the faces must be apart at rest; their smallest gap is {gap:.3g} mm"
            )
        if self.dhat is None:
            return (ACTIVATION if self.overlap else ACTIVATION_NO_OVERLAP) * gap
        if self.dhat >= gap:
            raise ContactError(
                f"self-contact on {self.faces!r}: dhat, {self.dhat:.3g} mm, must be below the smallest gap at rest, "
                f"{gap:.3g} mm, because walls would press on each other without load"
            )
        return self.dhat


def _smallest_gap(pairs: FacingPairs, space: Discretisation) -> float:
    """At rest, mm; infinity where nothing faces anything."""
    return float(pairs.gaps(space.points).min(initial=np.inf))


def triangles_cross(rest: Array, now: Array, triangles: Index) -> bool:
    """Whether any two triangles (m, 3) without a common vertex cross at the positions now (n, 3), by exact tests."""
    ipctk, faces = _ipctk(), np.asfortranarray(triangles.astype(np.int32))
    mesh = ipctk.CollisionMesh(np.asfortranarray(rest), ipctk.edges(faces), faces)
    return bool(ipctk.has_intersections(mesh, np.asfortranarray(now)))


def crossings(x: Array, triangles: Index) -> tuple[Index, Index]:
    """Edges (k, 2) and triangles (k, 3) of the triangles (m, 3) that pass through each other at the positions x (n, 3).

    Those with a common vertex are not told.
    """
    ipctk = _ipctk()
    nodes, local = np.unique(triangles, return_inverse=True)
    faces = np.asfortranarray(local.reshape(triangles.shape).astype(np.int32))
    edges = ipctk.edges(faces)
    broad = ipctk.HashGrid()
    broad.build(np.asfortranarray(x[nodes]), edges, faces)
    near = [(candidate.edge_id, candidate.face_id) for candidate in broad.detect_edge_face_candidates()]
    edge_id, face_id = np.array(sorted(near), dtype=np.int64).reshape(-1, 2).T
    edge, face = nodes[edges[edge_id]], nodes[faces[face_id]]
    is_apart = ~(edge[:, :, None] == face[:, None, :]).any(axis=(1, 2))
    crosses = is_apart & passes_through(x[edge], x[face])
    return edge[crosses], face[crosses]


def _ipctk() -> Any:
    """The library, which scenes without contact do not load."""
    import ipctk

    return ipctk


@final
class BarrierTerm(UnilateralTerm):
    """The barrier of incremental potential contact between the triangles through all nodes of quadratic faces.

    images: contact of half a body with its mirror image, by pairs. ipctk's barrier is not differentiable where a node
    meets a node, and a node always meets its own mirror image.
    """

    effect = "self_contact"
    starts_inactive = False
    is_infinite = True

    def __init__(
        self, surface: Faces, rest: Array, dhat: float, stiffness: float, images: FacingTerm | None = None
    ) -> None:
        self._images, self._rest = images, rest
        self._ipctk = ipctk = _ipctk()
        ipctk.set_num_threads(1)  # sums in a fixed order: near a loss of stability rounding decides the state
        self.nodes, self._triangles = surface.unique_nodes, surface.triangles
        faces = np.asfortranarray(np.searchsorted(self.nodes, surface.triangles).astype(np.int32))
        self._mesh = ipctk.CollisionMesh(np.asfortranarray(rest[self.nodes]), ipctk.edges(faces), faces)
        self.dhat = self._below_rest_distance(dhat, rest)
        self._barrier = ipctk.BarrierPotential(self.dhat, stiffness, use_physical_barrier=True)

    def _below_rest_distance(self, dhat: float, rest: Array) -> float:
        """dhat, reduced where a fine mesh puts the triangles beside a corner closer together than that at rest."""
        collisions = self._collisions(rest, dhat)
        if len(collisions) == 0:
            return dhat
        return 0.9 * float(np.sqrt(collisions.compute_minimum_distance(self._mesh, self._surface(rest))))

    def _surface(self, x: Array) -> Array:
        return np.asfortranarray(x[self.nodes])

    def _collisions(self, x: Array, dhat: float) -> Any:
        collisions = self._ipctk.NormalCollisions()
        collisions.use_area_weighting = True
        # the plain set counts the area of a wall several times; this one as `barrier.WEIGHT` says
        collisions.collision_set_type = self._ipctk.NormalCollisions.IMPROVED_MAX_APPROX
        collisions.build(self._mesh, self._surface(x), dhat)
        return collisions

    def energy(self, x: Array, factor: float) -> float:
        energy = float(self._barrier(self._collisions(x, self.dhat), self._mesh, self._surface(x)))
        return energy + (self._images.energy(x, factor) if self._images else 0.0)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        collisions = self._collisions(x, self.dhat)
        if len(collisions):
            out[self.nodes] += self._barrier.gradient(collisions, self._mesh, self._surface(x)).reshape(-1, 3)
        if self._images:
            self._images.gradient(x, factor, out)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        own = self._own_blocks(x, convex)
        if self._images is None:
            return own
        images = self._images.blocks(x, factor, convex)
        rows, columns = np.append(own.rows, images.rows), np.append(own.columns, images.columns)
        return Blocks(rows, columns, np.concatenate([own.values, images.values]))

    def _own_blocks(self, x: Array, convex: bool) -> Blocks:
        method = self._ipctk.PSDProjectionMethod.CLAMP if convex else self._ipctk.PSDProjectionMethod.NONE
        collisions = self._collisions(x, self.dhat)
        if len(collisions) == 0:
            return NO_BLOCKS
        hessian = self._barrier.hessian(collisions, self._mesh, self._surface(x), method).tobsr((3, 3))
        rows = np.repeat(np.arange(self.nodes.shape[0]), np.diff(hessian.indptr))
        columns = np.asarray(hessian.indices)
        upper = rows <= columns  # the surface's nodes are sorted, so this is the global order as well
        return Blocks(self.nodes[rows[upper]], self.nodes[columns[upper]], np.ascontiguousarray(hessian.data[upper]))

    def tightening(self, model: UnilateralTerm) -> Tightening:
        of_images = self._images.stiffness if self._images else 0.0
        return Tightening(of_images, 0, True, NO_PAIRS, NO_PAIRS.area)

    def step_limit(self, x: Array, dx: Array) -> float:
        start, end = self._surface(x), self._surface(x + dx)
        return float(self._ipctk.compute_collision_free_stepsize(self._mesh, start, end))

    def near_pairs(self, x: Array) -> tuple[Index, Index]:
        return self._images.near_pairs(x) if self._images else super().near_pairs(x)

    def violation(self, x: Array) -> Reason | None:
        if not self._ipctk.has_intersections(self._mesh, self._surface(x)):
            return self._images.violation(x) if self._images else None
        edges, triangles = crossings(x, self._triangles)  # with rounding, where the test above has none
        if not len(edges):
            return Reason("walls_cross")
        edge = edges[0]
        where = position_of(x[edge].mean(axis=0))
        distance = float(np.linalg.norm(self._rest[edge].mean(axis=0) - self._rest[triangles[0]].mean(axis=0)))
        if distance > FARTHEST * float(np.linalg.norm(self._rest[edge[1]] - self._rest[edge[0]])):
            return Reason("far_walls_cross", {"apart_mm": distance}, where)  # the ends of an arm that has curled up
        return Reason("walls_cross", where=where)

    def gap(self, x: Array) -> float:
        """Exact within dhat, infinity beyond it, or the smallest gap to a mirror image."""
        to_image = self._images.gap(x) if self._images else np.inf
        collisions = self._collisions(x, self.dhat)
        if len(collisions) == 0:
            return to_image
        return min(to_image, float(np.sqrt(collisions.compute_minimum_distance(self._mesh, self._surface(x)))))

    def touching(self, x: Array) -> bool:
        return len(self._collisions(x, self.dhat)) > 0 or bool(self._images and self._images.touching(x))
