"""Self-contact by incremental potential contact (the only door to ipctk).

Source: M. Li et al., "Incremental potential contact: intersection- and inversion-free, large-deformation dynamics",
ACM Trans. Graph. 39 (2020). The barrier acts between the linear triangles through all nodes of the quadratic faces.
"""

from dataclasses import dataclass
from time import perf_counter
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from fem.discretisation import Discretisation
from fem.effects import Blocks, Effect, Term
from fem.material import Material
from fem.surface import FacingPairs

Array = NDArray[np.float64]
Index = NDArray[np.int64]

#: barrier stiffness over Young's modulus; 3 mu stands for the modulus (near incompressibility)
STIFFNESS = 0.1
#: activation distance over the smallest gap at rest
ACTIVATION = 0.1


class ContactError(ValueError):
    """Faces that can never meet, or an activation distance that does not fit them."""


@final
@dataclass(frozen=True)
class SelfContact(Effect):
    """Faces that may touch but not cross. dhat: activation distance of the barrier in mm, default a tenth of the gap."""

    faces: str
    dhat: float | None = None

    def bind(self, space: Discretisation, material: Material) -> Term:
        """The barrier; raises `ContactError`."""
        surface = space.surface(self.faces)
        pairs = FacingPairs.of(surface, space.points)
        if pairs.nodes.size == 0:
            raise ContactError(f"self-contact on {self.faces!r}: no two parts of these faces look at each other")
        dhat = ACTIVATION * float(pairs.gaps(space.points).min()) if self.dhat is None else self.dhat
        if not dhat > 0:
            raise ContactError(f"self-contact on {self.faces!r}: dhat must be positive and the faces apart at rest")
        stiffness = 3 * STIFFNESS * material.shear_modulus
        return ContactTerm(surface.unique_nodes, surface.triangles, pairs, space.points, dhat, stiffness)


@final
class ContactTerm(Term):
    """The barrier potential of one set of faces."""

    def __init__(
        self, nodes: Index, triangles: Index, pairs: FacingPairs, rest: Array, dhat: float, stiffness: float
    ) -> None:
        import ipctk

        self._ipctk = ipctk
        self.nodes = nodes
        self.pairs = pairs
        faces = np.asfortranarray(np.searchsorted(nodes, triangles).astype(np.int32))
        self._mesh = ipctk.CollisionMesh(np.asfortranarray(rest[nodes]), ipctk.edges(faces), faces)
        self.dhat = self._fitting(dhat, rest)
        self._barrier = ipctk.BarrierPotential(self.dhat, stiffness, use_physical_barrier=True)
        self.seconds = 0.0

    def _fitting(self, dhat: float, rest: Array) -> float:
        """dhat, reduced where a fine mesh puts the triangles beside a corner closer together than that at rest."""
        collisions = self._collisions(rest, dhat)
        if len(collisions) == 0:
            return dhat
        nearest = float(np.sqrt(collisions.compute_minimum_distance(self._mesh, self._places(rest))))
        return 0.9 * nearest

    def _places(self, x: Array) -> Array:
        return np.asfortranarray(x[self.nodes])

    def _collisions(self, x: Array, dhat: float) -> Any:
        collisions = self._ipctk.NormalCollisions()
        collisions.use_area_weighting = True
        collisions.build(self._mesh, self._places(x), dhat)
        return collisions

    def energy(self, x: Array, factor: float) -> float:
        return float(self._barrier(self._collisions(x, self.dhat), self._mesh, self._places(x)))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        start = perf_counter()
        collisions = self._collisions(x, self.dhat)
        if len(collisions):
            out[self.nodes] += self._barrier.gradient(collisions, self._mesh, self._places(x)).reshape(-1, 3)
        self.seconds += perf_counter() - start

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        start = perf_counter()
        method = self._ipctk.PSDProjectionMethod.CLAMP if convex else self._ipctk.PSDProjectionMethod.NONE
        collisions = self._collisions(x, self.dhat)
        if len(collisions) == 0:
            self.seconds += perf_counter() - start
            return Blocks(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3, 3)))
        hessian = self._barrier.hessian(collisions, self._mesh, self._places(x), method).tobsr((3, 3))
        rows = np.repeat(np.arange(self.nodes.shape[0]), np.diff(hessian.indptr))
        columns = np.asarray(hessian.indices)
        upper = rows <= columns  # the surface's nodes are sorted, so this is the global order as well
        self.seconds += perf_counter() - start
        return Blocks(self.nodes[rows[upper]], self.nodes[columns[upper]], np.ascontiguousarray(hessian.data[upper]))

    def step_limit(self, x: Array, dx: Array) -> float:
        start = perf_counter()
        share = self._ipctk.compute_collision_free_stepsize(self._mesh, self._places(x), self._places(x + dx))
        self.seconds += perf_counter() - start
        return float(share)

    def gap(self, x: Array) -> float:
        """Smallest distance (mm) between the faces: exact within dhat, along the walls' normals beyond it."""
        collisions = self._collisions(x, self.dhat)
        if len(collisions):
            return float(np.sqrt(collisions.compute_minimum_distance(self._mesh, self._places(x))))
        return float(self.pairs.gaps(x).min())
