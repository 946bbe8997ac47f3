"""Thin sheets and threads on faces of the mesh: a strain-limiting layer of paper or fabric, or hoops (`hoops`).

Such a membrane shares the nodes of the tetrahedra beside it and adds no degree of freedom. Its energy per area at rest
is W = t/2 E : C : E with the Green-Lagrange strain E of the surface and an elasticity C in its plane: that of the
St. Venant-Kirchhoff law in plane stress, or one along threads alone. A sheet resists bending as well
(`fem.effects.layer_bending`). Without that a compressed layer in soft material would wrinkle at wavelengths of the
mesh, under the less compression the finer it is. Newton carries the membrane's stress as it does that of the solid
(`fem.path.newton`), without which a layer a thousand times stiffer than the body takes many small steps.
"""

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from fem.discretisation import Discretisation, pairs_within
from fem.effects.effect import Blocks, Effect, Term
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

#: Barycentric coordinates (q, 3) of the stress points of a triangle, all of equal weight. One point for a sheet, as for
#: the volumetric part of the solid: three strains at three points would be more conditions than a triangle has
#: displacements, and a nearly inextensible layer could not bend either (with three points the semicircular arm bends a
#: fifth less on a mesh of 4 mm).
CENTROID = np.full((1, 3), 1 / 3)

#: the face of half a body in its plane of symmetry, and how far nodes of that plane may be off, over the body's size
SYMMETRY, NEAR = "sym", 1e-9


class LayerError(PneurodError, ValueError):
    """A layer without faces of the mesh or without thickness."""


@dataclass(frozen=True)
class Membrane(Effect):
    """A thin layer on triangles of the mesh, inside the body or on its surface; thickness in mm.

    triangles (f, 3) are vertex numbers of the mesh, each triangle a face of a tetrahedron, as `geometry.Mesh.plane`
    gives them. Raises `LayerError` and `fem.materials.material.MaterialError`.
    """

    name: ClassVar[str]  #: of the effect as in a config
    noun: ClassVar[str]  #: in sentences

    triangles: Index
    thickness: float

    def __post_init__(self) -> None:
        self.check()
        if not 0 < self.thickness < np.inf:
            raise LayerError(f"{self.noun}: its thickness must be positive and finite, not {self.thickness:g} mm")
        if self.triangles.shape[0] == 0:
            raise LayerError(f"{self.noun}: the mesh has no face for it")

    @abstractmethod
    def check(self) -> None:
        """Raise `LayerError` or `MaterialError` for constants that are not possible."""

    @property
    @abstractmethod
    def stress_points(self) -> Array:
        """Barycentric coordinates (q, 3) of the stress points of a triangle, all of equal weight."""

    @abstractmethod
    def law(self, frame: Array) -> Array:
        """Elasticity (f, q, 3, 3), MPa, in orthonormal frames (f, q, 2, 3) of the triangles."""

    @property
    @abstractmethod
    def bending(self) -> tuple[float, float]:
        """D of bending, N mm, and Poisson's ratio; zero for what bends freely."""

    @final
    def bind(self, space: Discretisation, material: Material) -> "LayerTerm":
        """The membrane; raises `LayerError` where a triangle is not a face of the mesh."""
        nodes = _nodes(space, self.triangles, self.noun)
        return LayerTerm.of(self, nodes, space.points, _in_plane_of_symmetry(space))


@final
@dataclass(frozen=True)
class StrainLimitingLayer(Membrane):
    """Paper or fabric; E in MPa."""

    name = "strain_limiting_layer"
    noun = "strain-limiting layer"

    E: float
    nu: float

    def check(self) -> None:
        """Raise `MaterialError` for moduli that are not possible."""
        check_moduli(self.E, self.nu)

    @property
    def stress_points(self) -> Array:
        return CENTROID

    def law(self, frame: Array) -> Array:
        plane = np.array([[1.0, self.nu, 0.0], [self.nu, 1.0, 0.0], [0.0, 0.0, (1 - self.nu) / 2]])
        return np.tile(self.E / (1 - self.nu**2) * plane, (*frame.shape[:2], 1, 1))

    @property
    def bending(self) -> tuple[float, float]:
        return self.E * self.thickness**3 / (12 * (1 - self.nu**2)), self.nu


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
        """The geometry of the faces with nodes (f, a)."""
        first, second, swapped = pairs_within(nodes)
        rows, columns, values = bending.blocks
        return _Pairs(np.concatenate([first, rows]), np.concatenate([second, columns]), swapped, values)


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class LayerTerm(Term):
    """The energy of stretching and bending of a membrane."""

    effect: str
    sheet: Membrane
    arrays: MembraneArrays
    mirror: Mask  #: (n,) whether a node is in the plane of symmetry
    bending: BendingForm
    pairs: _Pairs
    carried: Array | None = None  #: (f, q, 3) stress of the geometric stiffness, MPa; None: that of the strain

    @staticmethod
    def of(sheet: Membrane, nodes: Index, points: Array, mirror: Mask) -> "LayerTerm":
        """The membrane on faces with nodes (f, a) at rest at points (n, 3), mm."""
        gradients, area, frame = _geometry(points[nodes], sheet.stress_points)
        arrays = MembraneArrays(nodes, gradients, sheet.thickness * area, sheet.law(frame))
        rigidity, nu = sheet.bending
        bending = bending_form(points, nodes if rigidity else nodes[:0], rigidity, nu, mirror)
        return LayerTerm(sheet.name, sheet, arrays, mirror, bending, _Pairs.of(nodes, bending))

    def changed(self, sheet: Membrane, points: Array) -> "LayerTerm":
        """Another sheet on the same faces, whose nodes at rest (n, 3) may lie elsewhere."""
        return self.of(sheet, self.arrays.nodes, points, self.mirror)

    def energy(self, x: Array, factor: float) -> float:
        strain = self._strain(x)
        stretching = 0.5 * float(np.einsum("fq,fqv,fqv", self.arrays.weight, strain, self._stress(strain)))
        return stretching + self.bending.energy(x)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        membrane_force(self.arrays, x, self.stress(x), out)
        out += self.bending.force(x)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        stress = self.stress(x) if self.carried is None else self.carried
        faces, pairs = self.arrays.nodes.shape[0], self.pairs
        values = np.empty((faces, pairs.swapped.shape[0] // faces, 3, 3))
        membrane_tangent(self.arrays, x, stress, values)
        values = values.reshape(-1, 3, 3)
        values[pairs.swapped] = values[pairs.swapped].transpose(0, 2, 1)
        return Blocks(pairs.rows, pairs.columns, np.concatenate([values, pairs.bending]))

    def advanced(self, x: Array, dx: Array) -> "LayerTerm":
        change = np.empty((*self.arrays.weight.shape, 3))
        membrane_linearised_strain(self.arrays, x, dx, change)
        return replace(self, carried=self.stress(x) + self._stress(change))

    stressed = advanced

    def settled(self) -> "LayerTerm":
        return replace(self, carried=None)

    def sideways(self) -> "LayerTerm":
        """The tangent for motions that are antisymmetric about the plane of symmetry, in which they make no crease."""
        return self.of(self.sheet, self.arrays.nodes, self.bending.rest, np.zeros_like(self.mirror))

    def stress(self, x: Array) -> Array:
        """Second Piola-Kirchhoff stress (f, q, 3) at the positions x (n, 3), MPa."""
        return self._stress(self._strain(x))

    def _stress(self, strain: Array) -> Array:
        return np.einsum("fqvw,fqw->fqv", self.arrays.law, strain)

    def _strain(self, x: Array) -> Array:
        strain = np.empty((*self.arrays.weight.shape, 3))
        membrane_strain(self.arrays, x, strain)
        return strain


def _geometry(positions: Array, stress_points: Array) -> tuple[Array, Array, Array]:
    """Of triangles with a = 6 or 3 nodes at `positions` (f, a, 3), at their stress points (q, 3).

    Gradients (f, q, a, 2) of the shape functions in an orthonormal frame of each point, areas (f, q) and these frames
    (f, q, 2, 3).
    """
    linear = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])  # gradients of the barycentric coordinates
    reference = np.repeat(linear[None], stress_points.shape[0], axis=0)
    if positions.shape[1] == 6:
        vertex = (4 * stress_points - 1)[:, :, None] * linear
        a, b = np.array([0, 1, 0]), np.array([1, 2, 2])
        middle = 4 * (stress_points[:, a, None] * linear[b] + stress_points[:, b, None] * linear[a])
        reference = np.concatenate([vertex, middle], axis=1)
    edge, other = np.moveaxis(np.einsum("fai,qak->fqki", positions, reference), 2, 0)
    first = edge / np.linalg.norm(edge, axis=-1, keepdims=True)
    across = other - np.sum(other * first, axis=-1, keepdims=True) * first
    frame = np.stack([first, across / np.linalg.norm(across, axis=-1, keepdims=True)], axis=2)
    jacobian = np.einsum("fqdi,fai,qak->fqdk", frame, positions, reference)
    gradients = np.einsum("qak,fqkd->fqad", reference, np.linalg.inv(jacobian))
    area = np.abs(np.linalg.det(jacobian)) / (2 * stress_points.shape[0])
    return np.ascontiguousarray(gradients), area, frame


def _in_plane_of_symmetry(space: Discretisation) -> Mask:
    """(n,) whether a node is on the face `sym`, in the plane z = 0."""
    mirror = np.zeros(space.points.shape[0], dtype=bool)
    if SYMMETRY in space.surfaces:
        mirror[space.surface(SYMMETRY).unique_nodes] = True
    return mirror & (np.abs(space.points[:, 2]) < NEAR * np.ptp(space.points, axis=0).max())


def _nodes(space: Discretisation, triangles: Index, noun: str) -> Index:
    """Nodes (f, 6) or (f, 3) of the triangles with the vertices (f, 3)."""
    a, b = np.array([0, 1, 0, 0, 1, 2]), np.array([1, 2, 2, 3, 3, 3])
    count = space.points.shape[0]

    def keys(first: Index, second: Index) -> Index:
        return np.minimum(first, second) * count + np.maximum(first, second)

    mesh_edges, first_use = np.unique(keys(space.nodes[:, a], space.nodes[:, b]), return_index=True)
    edges = keys(triangles[:, [0, 1, 0]], triangles[:, [1, 2, 2]])
    position = np.minimum(np.searchsorted(mesh_edges, edges), mesh_edges.shape[0] - 1)
    if not np.array_equal(mesh_edges[position], edges):
        raise LayerError(f"{noun}: one of its triangles is not a face of the mesh")
    if not space.element.quadratic:
        return triangles
    return np.concatenate([triangles, space.nodes[:, 4:].ravel()[first_use][position]], axis=1)
