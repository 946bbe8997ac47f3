"""A strain-limiting layer: thin paper or fabric in the body, as a membrane on faces of the mesh.

The membrane shares the nodes of the tetrahedra beside it and adds no degree of freedom. It obeys the St. Venant-
Kirchhoff law in plane stress, W = t/2 E : C : E per area at rest with the Green-Lagrange strain E of the surface, and
resists bending (`fem.effects.layer_bending`). Without that a compressed layer in soft material would wrinkle at
wavelengths of the mesh, under the less compression the finer it is. Newton carries the membrane's stress as it does
that of the solid (`fem.path.newton`), without which a layer a thousand times stiffer than the body takes many small
steps.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.effect import Blocks, Effect, StressCarryingTerm
from fem.effects.layer_bending import BendingForm, bending_form
from fem.kernels.membrane import (
    MembraneArrays,
    membrane_force,
    membrane_linearised_strain,
    membrane_strain,
    membrane_tangent,
)
from fem.materials.material import Material, check_moduli
from geometry import PneurodError
from geometry.arrays import Array, Index, Mask

#: Barycentric coordinates (q, 3) of the stress points of a triangle, all of equal weight. One point, as for the
#: volumetric part of the solid: three strains at three points would be more conditions than a triangle has
#: displacements, and a nearly inextensible layer could not bend either (with three points the semicircular arm bends a
#: fifth less on a mesh of 4 mm).
POINTS = np.full((1, 3), 1 / 3)

#: the face of half a body in its plane of symmetry, and how far nodes of that plane may be off, over the body's size
SYMMETRY, NEAR = "sym", 1e-9


class LayerError(PneurodError, ValueError):
    """A layer without faces of the mesh or without thickness."""


@final
@dataclass(frozen=True)
class StrainLimitingLayer(Effect):
    """Paper or fabric on flat triangles of the mesh, inside the body or on its surface; E in MPa, thickness in mm.

    triangles (f, 3) are vertex numbers of the mesh, each triangle a face of a tetrahedron, as `geometry.Mesh.plane`
    gives them. Raises `LayerError` and `fem.materials.material.MaterialError`.
    """

    triangles: Index
    thickness: float
    E: float
    nu: float

    def __post_init__(self) -> None:
        check_moduli(self.E, self.nu)
        if not 0 < self.thickness < np.inf:
            raise LayerError(
                f"strain-limiting layer: its thickness must be positive and finite, not {self.thickness:g} mm"
            )
        if self.triangles.shape[0] == 0:
            raise LayerError("strain-limiting layer: the mesh has no face in the plane of the layer")

    def bind(self, space: Discretisation, material: Material) -> "LayerTerm":
        """The membrane; raises `LayerError` where a triangle is not a face of the mesh."""
        nodes = _nodes(space, self.triangles)
        gradients, area = _gradients(space.points[nodes])
        weight = self.thickness * area / POINTS.shape[0]
        plane = np.array([[1.0, self.nu, 0.0], [self.nu, 1.0, 0.0], [0.0, 0.0, (1 - self.nu) / 2]])
        arrays, law = MembraneArrays(nodes, gradients, weight), self.E / (1 - self.nu**2) * plane
        mirror = _in_plane_of_symmetry(space)
        bending = bending_form(space.points, nodes, self._rigidity, self.nu, mirror)
        return LayerTerm(arrays, law, self._rigidity, mirror, bending, _Pairs.of(nodes, bending), None)

    @property
    def _rigidity(self) -> float:
        """D, N mm."""
        return self.E * self.thickness**3 / (12 * (1 - self.nu**2))


@final
@dataclass(frozen=True, eq=False)
class _Pairs:
    """Node pairs of the second derivative, those of stretching and behind them those of bending."""

    rows: Index  #: (m,)
    columns: Index  #: (m,)
    swapped: Mask  #: (k,) of those of stretching whether the nodes were swapped, so that rows <= columns
    bending: Array  #: (m - k, 3, 3) second derivative of bending, N/mm

    @staticmethod
    def of(nodes: Index, bending: BendingForm) -> "_Pairs":
        """Of the faces with nodes (f, a)."""
        a, b = np.triu_indices(nodes.shape[1])
        first, second = nodes[:, a].ravel(), nodes[:, b].ravel()
        rows, columns, values = bending.blocks
        all_rows = np.concatenate([np.minimum(first, second), rows])
        return _Pairs(all_rows, np.concatenate([np.maximum(first, second), columns]), first > second, values)


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class LayerTerm(StressCarryingTerm):
    """The energy of stretching and bending of a layer."""

    effect = "strain_limiting_layer"

    arrays: MembraneArrays
    law: Array  #: (3, 3) tangent in plane stress, MPa
    rigidity: float  #: D of bending, N mm
    mirror: Mask  #: (n,) whether a node is in the plane of symmetry
    bending: BendingForm
    pairs: _Pairs
    carried: Array | None  #: (f, q, 3) stress of the geometric stiffness, MPa; None where it is that of the strain

    @property
    def nu(self) -> float:
        """Poisson's ratio."""
        return float(self.law[0, 1] / self.law[0, 0])

    def energy(self, x: Array, factor: float) -> float:
        strain = self._strain(x)
        stretching = 0.5 * float(np.einsum("fq,fqv,vw,fqw", self.arrays.weight, strain, self.law, strain))
        return stretching + self.bending.energy(x)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        membrane_force(self.arrays, x, self.stress(x), out)
        out += self.bending.force(x)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        stress = self.stress(x) if self.carried is None else self.carried
        faces, pairs = self.arrays.nodes.shape[0], self.pairs
        values = np.empty((faces, pairs.swapped.shape[0] // faces, 3, 3))
        membrane_tangent(self.arrays, x, stress, self.law, values)
        values = values.reshape(-1, 3, 3)
        values[pairs.swapped] = values[pairs.swapped].transpose(0, 2, 1)
        return Blocks(pairs.rows, pairs.columns, np.concatenate([values, pairs.bending]))

    def advanced(self, x: Array, dx: Array) -> "LayerTerm":
        change = np.empty((*self.arrays.weight.shape, 3))
        membrane_linearised_strain(self.arrays, x, dx, change)
        return replace(self, carried=self.stress(x) + change @ self.law)

    def settled(self) -> "LayerTerm":
        return replace(self, carried=None)

    def moved(self, before: Array, after: Array) -> "LayerTerm":
        """The same layer in a body whose nodes at rest (n, 3) lie elsewhere."""
        nodes = self.arrays.nodes
        (_, area), (gradients, moved) = _gradients(before[nodes]), _gradients(after[nodes])
        arrays = MembraneArrays(nodes, gradients, self.arrays.weight * moved / area)
        bending = bending_form(after, nodes, self.rigidity, self.nu, self.mirror)
        pairs = _Pairs.of(nodes, bending)
        return replace(self, arrays=arrays, bending=bending, pairs=pairs, carried=None)

    def sideways(self) -> "LayerTerm":
        """The same for motions that are antisymmetric about the plane of symmetry, in which they make no crease."""
        mirror = np.zeros_like(self.mirror)
        bending = bending_form(self.bending.rest, self.arrays.nodes, self.rigidity, self.nu, mirror)
        return replace(self, mirror=mirror, bending=bending, pairs=_Pairs.of(self.arrays.nodes, bending))

    def stress(self, x: Array) -> Array:
        """Second Piola-Kirchhoff stress (f, q, 3) at the positions x (n, 3), MPa."""
        return np.asarray(self._strain(x) @ self.law)

    def _strain(self, x: Array) -> Array:
        strain = np.empty((*self.arrays.weight.shape, 3))
        membrane_strain(self.arrays, x, strain)
        return strain


def _gradients(positions: Array) -> tuple[Array, Array]:
    """Gradients (f, q, a, 2) of the shape functions on flat triangles with a = 6 or 3 nodes at `positions` (f, a, 3),
    in an orthonormal frame of each, and areas per point (f, q)."""
    edge, other = positions[:, 1] - positions[:, 0], positions[:, 2] - positions[:, 0]
    first = edge / np.linalg.norm(edge, axis=1)[:, None]
    across = other - np.einsum("fi,fi->f", other, first)[:, None] * first
    frame = np.stack([first, across / np.linalg.norm(across, axis=1)[:, None]], axis=1)
    linear = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])  # gradients of the barycentric coordinates
    reference = np.repeat(linear[None], POINTS.shape[0], axis=0)
    if positions.shape[1] == 6:
        vertex = (4 * POINTS - 1)[:, :, None] * linear
        a, b = np.array([0, 1, 0]), np.array([1, 2, 2])
        middle = 4 * (POINTS[:, a, None] * linear[b] + POINTS[:, b, None] * linear[a])
        reference = np.concatenate([vertex, middle], axis=1)
    jacobian = np.einsum("fdi,fai,qak->fqdk", frame, positions, reference)
    gradients = np.einsum("qak,fqkd->fqad", reference, np.linalg.inv(jacobian))
    return np.ascontiguousarray(gradients), np.abs(np.linalg.det(jacobian)) / 2


def _in_plane_of_symmetry(space: Discretisation) -> Mask:
    """(n,) whether a node is on the face `sym`, in the plane z = 0."""
    mirror = np.zeros(space.points.shape[0], dtype=bool)
    if SYMMETRY in space.surfaces:
        mirror[space.surface(SYMMETRY).unique_nodes] = True
    return mirror & (np.abs(space.points[:, 2]) < NEAR * np.ptp(space.points, axis=0).max())


def _nodes(space: Discretisation, triangles: Index) -> Index:
    """Nodes (f, 6) or (f, 3) of the triangles with the vertices (f, 3)."""
    a, b = np.array([0, 1, 0, 0, 1, 2]), np.array([1, 2, 2, 3, 3, 3])
    count = space.points.shape[0]

    def keys(first: Index, second: Index) -> Index:
        return np.minimum(first, second) * count + np.maximum(first, second)

    mesh_edges, first_use = np.unique(keys(space.nodes[:, a], space.nodes[:, b]), return_index=True)
    edges = keys(triangles[:, [0, 1, 0]], triangles[:, [1, 2, 2]])
    position = np.minimum(np.searchsorted(mesh_edges, edges), mesh_edges.shape[0] - 1)
    if not np.array_equal(mesh_edges[position], edges):
        raise LayerError("strain-limiting layer: one of its triangles is not a face of the mesh")
    if not space.element.quadratic:
        return triangles
    return np.concatenate([triangles, space.nodes[:, 4:].ravel()[first_use][position]], axis=1)
