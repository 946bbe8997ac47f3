"""The air at the plane of a piece that leaves z = 0: forces on the rims of its cavities there.

The volume of the air is the flux of the field z e_z through the walls (`fem.cell.air`), to which the plane adds nothing
as long as it contains the direction z. A plane that tilts or warps by u along its normal n, while the rim moves by v
within it, adds the flux of second order

    tilt b about e2 (u = b z):   -b int z v . nu dl,
    turn w about n:              -w int u (eta nu_z + z nu_eta) dl,       translation d along z:   -d int u nu_z dl

with eta and z the positions in the plane, nu its normal out of the air, and integrals over the rim.
"""

from collections.abc import Callable, Iterator

import numpy as np

from fem.cell.piece import BendingPiece, PieceState
from fem.effects.loads import PressureTerm
from geometry.arrays import Array, Index
from geometry.topology import cross

#: vertices and middle of the edges of a face
EDGES = ((0, 1, 3), (1, 2, 4), (2, 0, 5))
#: points of the quadrature along an edge
POINTS = 4


def rim_forces(piece: BendingPiece, at: PieceState, field: Callable[[Array, Array], Array]) -> Array:
    """Nodal forces (n, 3) p int N field dl, N, on the rims of the plane at a pressure p.

    field: vectors (m, 3) times dl at positions (m, 3) and normals (m, 3) times dl.
    """
    forces = np.zeros_like(piece.space.points)
    for nodes, pressure, weight, shape, x, nu in _points(piece, at):
        values = field(x, nu)
        for column, part in enumerate(shape):
            np.add.at(forces, nodes[:, column], pressure * weight * part * values)
    return forces


def mouths(piece: BendingPiece, at: PieceState) -> Iterator[tuple[float, Array, Array]]:
    """Pressures in MPa, positions (m, 3) on the rims of the plane, and normals out of the air times lengths (m, 3)."""
    for _, pressure, weight, _, x, nu in _points(piece, at):
        yield pressure, x, weight * nu


def _points(piece: BendingPiece, at: PieceState) -> Iterator[tuple[Index, float, float, Array, Array, Array]]:
    """For points of the quadrature: nodes of edges, pressure, weight, shape functions, positions and normals."""
    x = piece.space.points + at.state.displacement
    normal = np.array([np.cos(at.angle), np.sin(at.angle), 0.0])
    places, weights = np.polynomial.legendre.leggauss(POINTS)
    for nodes, pressure in _rims(piece, at):
        for t, weight in zip((places + 1.0) / 2.0, weights / 2.0, strict=True):
            shape, slope = _edge_functions(float(t), nodes.shape[1])
            tangent = np.einsum("a,mai->mi", slope, x[nodes])
            there = np.einsum("a,mai->mi", shape, x[nodes])
            yield nodes, pressure, float(weight), shape, there, cross(tangent, normal)


def _rims(piece: BendingPiece, at: PieceState) -> Iterator[tuple[Index, float]]:
    """Nodes (m, 3 or 2) of the edges of each cavity in the plane, with its pressure in MPa."""
    on_plane = np.zeros(len(piece.space.points), dtype=bool)
    on_plane[piece.plane] = True
    for term in at.terms:
        if isinstance(term, PressureTerm):
            faces = term.faces.nodes
            for first, last, middle in EDGES:
                columns = [first, middle, last] if faces.shape[1] == 6 else [first, last]
                rows = on_plane[faces[:, first]] & on_plane[faces[:, last]]
                yield faces[rows][:, columns], term.value * term.scale(at.state.factor)


def _edge_functions(t: float, count: int) -> tuple[Array, Array]:
    """Shape functions of an edge at 0 <= t <= 1 and their slopes."""
    if count == 2:
        return np.array([1.0 - t, t]), np.array([-1.0, 1.0])
    return (
        np.array([(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)]),
        np.array([4.0 * t - 3.0, 4.0 - 8.0 * t, 4.0 * t - 1.0]),
    )
