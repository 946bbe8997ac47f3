"""A strain-limiting layer at planes that it meets at a right angle, where bodies are mirrored or clamped.

An edge of the layer in a plane of mirror symmetry has the mirror image of its triangle beside it, so that the part of
its slope along the plane is half a jump (`fem.effects.layer_bending`). A clamp holds the slope in the same way. With
the direction T of the plane in the plane z = 0 and the matrix A of one component, the energy is

    W = 1/2 (x T) . A (x T).

The plane is parallel to the z axis and may turn. N follows from the positions of two of its nodes a and b, which are d
apart across z: with T = (cos theta, sin theta, 0) along d, N = (T_y, -T_x, 0), so that dN = T dtheta
and dT = -N dtheta.
"""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.effect import Blocks, Effect, Term
from fem.effects.layer_bending import mirror_form
from fem.effects.membrane import LayerTerm, Membrane, StrainLimitingLayer
from fem.materials.material import Material
from geometry.arrays import Array, Index


@final
@dataclass(frozen=True)
class MirroredLayer(Effect):
    """What a layer adds at the face `plane`, a plane of mirror symmetry or a clamp."""

    layer: StrainLimitingLayer
    plane: str

    def bind(self, space: Discretisation, material: Material) -> "MirroredLayerTerm":
        """The energy of its edges in the plane."""
        plane = space.surface(self.plane).unique_nodes
        height = space.points[plane, 1]
        ends = plane[[int(np.argmin(height)), int(np.argmax(height))]]
        return MirroredLayerTerm.of(self.layer.bind(space, material), plane, ends, space.points)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class MirroredLayerTerm(Term):
    """The energy of bending of the edges of a layer in a plane that it meets at a right angle."""

    effect = "strain_limiting_layer"

    layer: LayerTerm
    plane: Index  #: (p,) nodes of the plane
    ends: Index  #: (2,) two nodes of it, the second one higher
    nodes: Index  #: (m,) nodes that take part, sorted, the ends among them
    matrix: Array  #: (m, m) A, N/mm
    pairs: tuple[Index, Index]  #: numbers in `nodes` of the node pairs of the second derivative, (k,) and (k,)
    rows: Index  #: (k,) the first nodes of these pairs
    columns: Index  #: (k,)

    @staticmethod
    def of(layer: LayerTerm, plane: Index, ends: Index, points: Array) -> "MirroredLayerTerm":
        """The mirrored image of a bound layer; points (n, 3) at rest, mm."""
        mirror = np.zeros(points.shape[0], dtype=bool)
        mirror[plane] = True
        form = mirror_form(points, layer.arrays.nodes, *layer.sheet.bending, mirror)
        nodes = np.union1d(form.tocoo().row, ends).astype(np.int64)
        matrix = form[nodes][:, nodes].toarray()
        is_end = np.isin(nodes, ends)
        together = (matrix != 0.0) | is_end[:, None] | is_end[None, :]
        first, second = np.nonzero(np.triu(together))
        return MirroredLayerTerm(layer, plane, ends, nodes, matrix, (first, second), nodes[first], nodes[second])

    @property
    def sheet(self) -> Membrane:
        """What bends."""
        return self.layer.sheet

    def changed(self, sheet: Membrane, points: Array) -> "MirroredLayerTerm":
        """Another sheet on the same faces, whose nodes at rest (n, 3) may lie elsewhere."""
        return self.of(self.layer.changed(sheet, points), self.plane, self.ends, points)

    def energy(self, x: Array, factor: float) -> float:
        y = x[self.nodes] @ self._frame(x)[0]
        return 0.5 * float(y @ self.matrix @ y)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        along, normal, distance = self._frame(x)
        y = x[self.nodes]
        force = self.matrix @ y
        out[self.nodes] += np.outer(force @ along, along)
        turning = (
            float(along @ (y.T @ force) @ normal) / distance * normal
        )  # dW/dtheta = -T . S N, dtheta = -N . dd / d
        out[self.ends[1]] += turning
        out[self.ends[0]] -= turning

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        along, normal, distance = self._frame(x)
        y = x[self.nodes]
        force = self.matrix @ y
        squares = y.T @ force
        second = np.einsum("ij,cd->icjd", self.matrix, np.outer(along, along))
        by_angle = -(np.outer(force @ along, normal) + np.outer(force @ normal, along))
        angle = np.zeros_like(y)  # derivative of theta by the positions
        angle[self._local_ends] = np.array([[1.0], [-1.0]]) * normal / distance
        mixed = np.einsum("ic,jd->icjd", by_angle, angle)
        second += mixed + mixed.transpose(2, 3, 0, 1)
        stiffness = normal @ squares @ normal - along @ squares @ along
        second += stiffness * np.einsum("ic,jd->icjd", angle, angle)
        torque = -float(along @ squares @ normal)
        of_angle = torque * (np.outer(normal, along) + np.outer(along, normal)) / distance**2
        signs = np.zeros(len(self.nodes))
        signs[self._local_ends] = -1.0, 1.0
        second += np.einsum("i,j,cd->icjd", signs, signs, of_angle)
        first, last = self.pairs
        return Blocks(self.rows, self.columns, second.transpose(0, 2, 1, 3)[first, last])

    @property
    def _local_ends(self) -> Index:
        return np.searchsorted(self.nodes, self.ends)

    def _frame(self, x: Array) -> tuple[Array, Array, float]:
        """T and N (3,), and the distance of the ends across z, mm."""
        apart = (x[self.ends[1]] - x[self.ends[0]]) * [1.0, 1.0, 0.0]
        distance = float(np.linalg.norm(apart))
        along = apart / distance
        return along, np.array([along[1], -along[0], 0.0]), distance
