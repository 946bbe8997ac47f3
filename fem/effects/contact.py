"""Self-contact (the only door to ipctk).

The potential between facing walls is `fem.effects.barrier.FacingTerm`. ipctk answers for its results: a converged state
is accepted only if no triangle crosses another, and where the facing walls alone cannot keep the body from crossing
itself, the step is solved again with the barrier of incremental potential contact, whose distances know no pairs.
Source of the latter: M. Li et al., "Incremental potential contact: intersection- and inversion-free, large-deformation
dynamics", ACM Trans. Graph. 39 (2020).
"""

from dataclasses import dataclass
from functools import cache
from typing import Any, final

import numpy as np

from fem.discretisation import Discretisation, Faces
from fem.effects.barrier import BEHIND, FacingTerm
from fem.effects.effect import Blocks, Effect, Term
from fem.effects.facing_pairs import FacingPairs
from fem.materials.material import Material
from geometry.arrays import Array, Index

#: stiffness of the barrier over Young's modulus, for which 3 mu stands (near incompressibility), where a part of it
#: lies behind the wall, and where none does. With dhat = 0.04 mm, before contact woke early, on the coarse arm (a):
#: factorizations of I, II and III, error of F at 17 and 37 kPa, smallest gap: 0.1, a fifth before the wall: 67, 1.3 and
#: 0.9 %, 0.011 mm; 0.05, the same: 62, 1.1 and 0.6 %, 0.000 mm; 0.025, three tenths: 54, 1.1 and 0.7 %, 0.001 mm
STIFFNESS, FIRM = 0.025, 0.1
#: activation distance over the smallest gap at rest, where a part of the barrier lies behind the wall, and where none
ACTIVATION, WIDTH = 0.02, 0.1


class ContactError(ValueError):
    """Faces that can never meet, or an activation distance that does not fit them."""


@final
@dataclass(frozen=True)
class SelfContact(Effect):
    """Faces that may touch but not cross.

    dhat: activation distance of the barrier in mm, by default a fiftieth of the smallest gap at rest. waits: the effect
    stays out until a state without it comes within dhat; a scene that never touches is then the scene without contact,
    and faces that can never meet are none too many. behind: part of the barrier's width that lies behind the wall; with
    0 walls rest further apart, nearly dhat, but no pressure on a small spot lets them pass through each other, and dhat
    is a tenth of the gap by default.
    """

    faces: str
    dhat: float | None = None
    waits: bool = False
    behind: float = BEHIND

    def bind(self, space: Discretisation, material: Material) -> Term:
        """The barrier; raises `ContactError`."""
        surface = space.surface(self.faces)
        pairs = FacingPairs.of(surface, space.points)
        dhat = self._reach(pairs, space)
        E = 3 * material.shear_modulus
        exact = cache(lambda: BarrierTerm(surface, space.points, dhat, FIRM * E))
        stiffness = (STIFFNESS if self.behind else FIRM) * E
        return FacingTerm(pairs, dhat, stiffness, self.behind, self.waits, exact)

    def activation_distance(self, space: Discretisation) -> float:
        """dhat, or its default for these faces, mm; raises `ContactError`."""
        return self._reach(FacingPairs.of(space.surface(self.faces), space.points), space)

    def _reach(self, pairs: FacingPairs, space: Discretisation) -> float:
        if pairs.nodes.size == 0 and not self.waits:
            raise ContactError(f"self-contact on {self.faces!r}: no two parts of these faces look at each other")
        gap = float(pairs.gaps(space.points).min(initial=np.inf))
        dhat = (ACTIVATION if self.behind else WIDTH) * gap if self.dhat is None else self.dhat
        if not dhat > 0:
            raise ContactError(f"self-contact on {self.faces!r}: dhat must be positive and the faces apart at rest")
        return dhat


def triangles_cross(rest: Array, now: Array, triangles: Index) -> bool:
    """Whether any two triangles (m, 3) without a common vertex cross at the positions now (n, 3), by exact tests."""
    import ipctk

    faces = np.asfortranarray(triangles.astype(np.int32))
    mesh = ipctk.CollisionMesh(np.asfortranarray(rest), ipctk.edges(faces), faces)
    return bool(ipctk.has_intersections(mesh, np.asfortranarray(now)))


@final
class BarrierTerm(Term):
    """The barrier of incremental potential contact between the triangles through all nodes of quadratic faces."""

    effect = "self_contact"
    forgiving = False

    def __init__(self, surface: Faces, rest: Array, dhat: float, stiffness: float) -> None:
        import ipctk

        self._ipctk = ipctk
        self.nodes = surface.unique_nodes
        faces = np.asfortranarray(np.searchsorted(self.nodes, surface.triangles).astype(np.int32))
        self._mesh = ipctk.CollisionMesh(np.asfortranarray(rest[self.nodes]), ipctk.edges(faces), faces)
        self.dhat = self._fitting(dhat, rest)
        self._barrier = ipctk.BarrierPotential(self.dhat, stiffness, use_physical_barrier=True)

    def _fitting(self, dhat: float, rest: Array) -> float:
        """dhat, reduced where a fine mesh puts the triangles beside a corner closer together than that at rest."""
        collisions = self._collisions(rest, dhat)
        if len(collisions) == 0:
            return dhat
        return 0.9 * float(np.sqrt(collisions.compute_minimum_distance(self._mesh, self._places(rest))))

    def _places(self, x: Array) -> Array:
        return np.asfortranarray(x[self.nodes])

    def _collisions(self, x: Array, dhat: float) -> Any:
        collisions = self._ipctk.NormalCollisions()
        collisions.use_area_weighting = True
        # the plain set counts walls that mirror each other 6.4 times, shifted ones 2.5 times; this one 1.6 and 1.5
        collisions.collision_set_type = self._ipctk.NormalCollisions.IMPROVED_MAX_APPROX
        collisions.build(self._mesh, self._places(x), dhat)
        return collisions

    def energy(self, x: Array, factor: float) -> float:
        return float(self._barrier(self._collisions(x, self.dhat), self._mesh, self._places(x)))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        collisions = self._collisions(x, self.dhat)
        if len(collisions):
            out[self.nodes] += self._barrier.gradient(collisions, self._mesh, self._places(x)).reshape(-1, 3)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        method = self._ipctk.PSDProjectionMethod.CLAMP if convex else self._ipctk.PSDProjectionMethod.NONE
        collisions = self._collisions(x, self.dhat)
        if len(collisions) == 0:
            return Blocks(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3, 3)))
        hessian = self._barrier.hessian(collisions, self._mesh, self._places(x), method).tobsr((3, 3))
        rows = np.repeat(np.arange(self.nodes.shape[0]), np.diff(hessian.indptr))
        columns = np.asarray(hessian.indices)
        upper = rows <= columns  # the surface's nodes are sorted, so this is the global order as well
        return Blocks(self.nodes[rows[upper]], self.nodes[columns[upper]], np.ascontiguousarray(hessian.data[upper]))

    def step_limit(self, x: Array, dx: Array) -> float:
        start, end = self._places(x), self._places(x + dx)
        return float(self._ipctk.compute_collision_free_stepsize(self._mesh, start, end))

    def wanted(self, x: Array) -> bool:
        return True

    def objection(self, x: Array) -> str:
        if self._ipctk.has_intersections(self._mesh, self._places(x)):
            return "two walls pass through each other"
        return ""

    def at(self, share: float) -> Term:
        return self

    def advanced(self, x: Array, dx: Array) -> Term:
        return self

    def stricter(self, x: Array) -> Term:
        return self

    def gap(self, x: Array) -> float:
        """Exact within dhat, infinity beyond it."""
        collisions = self._collisions(x, self.dhat)
        if len(collisions) == 0:
            return np.inf
        return float(np.sqrt(collisions.compute_minimum_distance(self._mesh, self._places(x))))

    def touching(self, x: Array) -> bool:
        return len(self._collisions(x, self.dhat)) > 0
