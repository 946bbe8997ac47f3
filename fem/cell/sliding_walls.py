"""Walls in contact with their mirror images, for displacements that turn their plane into one that warps.

A wall and its image beyond the plane of the normal n then have the same displacement u along n. Within the plane they
have opposite ones, v - r and r - v, with r the motion of the plane within itself. A gap does not change to first order.
Where the walls tilt, its second-order change is 2 grad u . (v - r), against which the contact force F of the wall does
the work

    Pi = -sum F grad u . (v - r)        (of one half cell),

so that forces turn with the walls on which they act.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations_with_replacement
from typing import final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.barrier import FacingTerm
from fem.effects.effect import Blocks, Term
from geometry.arrays import Array, Index

#: pairs a <= b of the nodes of a triangle of the wall and of one in the plane
PAIRS = tuple(combinations_with_replacement(range(6), 2))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SlidingWalls(Term):
    """The quadratic potential above, of displacements from given positions."""

    effect = "self_contact"

    at: Array  #: (n, 3) positions of the planar state, mm
    nodes: Index  #: (m, 6) of each triangle of the walls, and of one in the plane
    matrices: Array = field(repr=False)  #: (m, 6, 6, 3, 3) second derivatives, N/mm

    @staticmethod
    def of(term: FacingTerm, space: Discretisation, x: Array, normal: Array) -> "SlidingWalls":
        """From the contact of walls with their images at positions x (n, 3); normal: (3,) of the plane."""
        forces = np.zeros_like(x)
        term.gradient(x, 1.0, forces)
        walls, corner = space.triangles_between(term.pairs.nodes), term.pairs.triangles[0]
        double = np.cross(x[walls[:, 1]] - x[walls[:, 0]], x[walls[:, 2]] - x[walls[:, 0]]) @ normal
        around = np.bincount(walls.ravel(), np.repeat(np.abs(double), 3), minlength=len(x))  # each node
        share = (forces @ normal)[walls] * np.abs(double)[:, None] / around[walls]
        edges = np.stack([x[walls[:, k - 2]] - x[walls[:, k - 1]] for k in (0, 1, 2)], axis=1)
        slopes = np.zeros((len(walls), 6, 3))
        slopes[:, :3] = np.cross(normal, edges) / -double[:, None, None]
        on_plane = np.einsum("mk,mkb->mb", share, _weights(x, walls, corner))
        weights = np.concatenate([share, -on_plane], axis=1)
        one = -np.einsum("mc,i,maj->macij", weights, normal, slopes)
        matrices = one + one.transpose(0, 2, 1, 4, 3)
        return SlidingWalls(x, np.hstack([walls, np.tile(corner, (len(walls), 1))]), matrices)

    def energy(self, x: Array, factor: float) -> float:
        moved = (x - self.at)[self.nodes]
        return 0.5 * float(np.einsum("mai,macij,mcj->", moved, self.matrices, moved))

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        np.add.at(out, self.nodes, np.einsum("macij,mcj->mai", self.matrices, (x - self.at)[self.nodes]))

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        rows, columns, values = (np.concatenate(parts) for parts in zip(*self._pairs(), strict=True))
        return Blocks(rows, columns, np.ascontiguousarray(values))

    def _pairs(self) -> Iterator[tuple[Index, Index, Array]]:
        for a, b in PAIRS:
            first, second, values = self.nodes[:, a], self.nodes[:, b], self.matrices[:, a, b]
            swapped = first > second
            values = np.where(swapped[:, None, None], values.transpose(0, 2, 1), values)
            yield np.minimum(first, second), np.maximum(first, second), values


def _weights(x: Array, walls: Index, corner: Index) -> Array:
    """(m, 3, 3) of the nodes of a triangle (3,) in the plane for the points that face the nodes of the walls (m, 3)."""
    sides = np.stack([x[corner[1]] - x[corner[0]], x[corner[2]] - x[corner[0]]])
    within = (x[walls] - x[corner[0]]) @ np.linalg.pinv(sides)
    return np.concatenate([1.0 - within.sum(axis=2, keepdims=True), within], axis=2)
