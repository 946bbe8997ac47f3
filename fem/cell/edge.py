"""The edge of the arm's free end on the material curve: what a support does that holds it.

The edge bows where the end bulges under pressure. A support that holds it at a height, as in experiment III, keeps all
its nodes at that height and leaves them free along the other direction of the plane and across. With e the unit vector
along which the support acts, x_i the nodes of the free end, G_ij their displacement by forces, and f_i e the forces of
the support,

    e . (x_i + sum_j G_ij e f_j) = c   for all nodes,      sum_i f_i = F,

with the unknown height c: linear equations for each direction e and each resultant force F. The direction matters,
because the end bows both along and across itself. The bow that is left along the support gives the forces a couple
about z. It is there without a resultant force as well, and is of first order in F.
"""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.cell.piece import BendingPiece, PieceState
from fem.supports import Line, nodes_at
from geometry.arrays import Array


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class HeldEdge:
    """The end of the piece while a support holds its edge at a height; couple and lever are those of the whole body."""

    couple: float  #: N mm about z, of the support without a resultant force
    lever: float  #: mm from the end of the curve, along the support, of the line of action of a resultant force
    curve: Array  #: (m, 2) nodes of the material curve without a resultant force, mm


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class FreeEdge:
    """The edge of a free end in equilibrium, and its displacement by forces on its nodes, to first order."""

    positions: Array  #: (k, 2) of the nodes of the edge, mm
    weights: Array  #: (k,) of a force that is spread evenly over it; they sum to 1
    by_force: Array  #: (k, 2, k, 2) displacement of the nodes by forces on the whole body, mm/N
    curve: Array  #: (m, 2) of the nodes of the material curve, which begins at the edge, mm
    curve_by_force: Array  #: (m, 2, k, 2) mm/N

    @property
    def middle(self) -> Array:
        """(2,) mm, through which a force spread evenly over the edge acts."""
        return np.asarray(self.weights @ self.positions)

    def held(self, angle: float) -> HeldEdge:
        """The edge held along (-sin a, cos a), and free along (cos a, sin a), for the angle a in rad."""
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        k = len(self.positions)
        stiff = np.einsum("iajb,a,b->ij", self.by_force, across, across)
        ones = np.ones((k, 1))
        matrix = np.block([[stiff, -ones], [ones.T, np.zeros((1, 1))]])
        right = np.zeros((k + 1, 2))
        right[:k, 0] = -self.positions @ across
        right[k, 1] = 1.0
        forces, by_resultant = np.linalg.solve(matrix, right)[:k].T
        slide = np.einsum("iajb,a,b->ij", self.by_force, along, across)  # along the support by forces across it
        end_slide = np.einsum("ajb,a,b->j", self.curve_by_force[0], along, across)
        bow = (self.positions - self.curve[0]) @ along + (slide - end_slide) @ forces
        return HeldEdge(
            couple=float(bow @ forces),
            lever=float(bow @ by_resultant + ((slide - end_slide) @ by_resultant) @ forces),
            curve=self._moved(forces[:, None] * across),
        )

    def pinned(self) -> tuple[Array, Array]:
        """(m, 2) mm: the material curve where all nodes of the edge are held in one point, without a resultant force;
        and (m, 2) mm/N: its displacement by a force on that point along x, the normal of the plane.

        Forces on nodes in one point have no couple.
        """
        k = len(self.positions)
        common = np.tile(np.eye(2), (k, 1))
        matrix = np.block([[self.by_force.reshape(2 * k, 2 * k), -common], [common.T, np.zeros((2, 2))]])
        right = np.zeros((2 * k + 2, 2))
        right[: 2 * k, 0] = -self.positions.ravel()
        right[2 * k, 1] = 1.0
        together, pulled = np.linalg.solve(matrix, right)[: 2 * k].T.reshape(2, k, 2)
        return self._moved(together), self._moved(pulled) - self.curve

    def _moved(self, forces: Array) -> Array:
        """The curve (m, 2) under forces (k, 2) on the edge."""
        return self.curve + np.einsum("iajb,jb->ia", self.curve_by_force, forces)


def free_edge(piece: BendingPiece, at: PieceState) -> FreeEdge:
    """The edge of a piece whose start is free; one factorization.

    Raises `fem.equations.linear.SingularMatrix` at a limit point.
    """
    line = Line(piece.body.edge("clamp"))
    nodes = nodes_at(line, piece.space)
    x = (piece.space.points + at.state.displacement)[:, :2]
    _, tangent = piece.linearise(at, np.zeros_like(piece.space.points))
    edge, curve = (np.empty((len(which), 2, len(nodes), 2)) for which in (nodes, piece.curve))
    loads = np.zeros((2 * len(nodes), *piece.space.points.shape))
    for row, node in enumerate(nodes):
        for k in range(2):
            loads[2 * row + k, node, k] = -1.0 / piece.whole
    for number, change in enumerate(tangent.solve_each([(load, None) for load in loads])):
        row, k = divmod(number, 2)
        edge[:, :, row, k], curve[:, :, row, k] = change.displacement[nodes, :2], change.displacement[piece.curve, :2]
    return FreeEdge(x[nodes], line.nodal_weights(piece.space), edge, x[piece.curve], curve)
