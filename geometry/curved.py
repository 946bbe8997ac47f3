"""Curved edges: the middle of a quadratic element's edge lies on a round wall, not halfway between its ends."""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index
from geometry.topology import EDGES, find_rows

#: smallest Jacobian determinant of an element with curved edges over that with straight ones; below it the edges of the
#: element stay straight
LEAST_DETERMINANT = 0.1
#: distance of a middle from the straight edge, over the length of the edge, from which the edge counts as curved
STRAIGHT = 1e-7
#: barycentric coordinates (q, 3) and weights (q,) of a rule on triangles that is exact for polynomials of degree 4
#: (D. A. Dunavant, Int. J. Numer. Meth. Engng 21 (1985) 1129-1148)
_OUTER, _INNER = 0.091576213509770743, 0.445948490915964886
TRIANGLE_RULE: tuple[Array, Array] = (
    np.array([np.roll([1 - 2 * a, a, a], k) for a in (_OUTER, _INNER) for k in range(3)]),
    np.array([0.109951743655321868] * 3 + [0.223381589678011466] * 3),
)


@dataclass(frozen=True)
class CurvedEdges:
    """Edges whose middle is not halfway between their ends; all others are straight."""

    ends: Index  #: (k, 2) vertices, the smaller first
    middles: Array  #: (k, 3) position of the middle, mm

    def __post_init__(self) -> None:
        ends, first = np.unique(
            np.sort(np.reshape(self.ends, (-1, 2)).astype(np.int64), axis=1), axis=0, return_index=True
        )
        middles = np.reshape(self.middles, (-1, 3)).astype(np.float64)[first]
        for name, array in (("ends", ends), ("middles", middles)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.ends)

    def renumbered(self, new: Index) -> "CurvedEdges":
        """The edges whose ends have a number in `new` (n,), with it; -1 stands for a vertex that is left out."""
        ends = new[self.ends]
        kept = (ends >= 0).all(axis=1)
        return CurvedEdges(ends[kept], self.middles[kept])

    def joined(self, *others: "CurvedEdges") -> "CurvedEdges":
        """These edges and those of others."""
        every = (self, *others)
        return CurvedEdges(np.vstack([e.ends for e in every]), np.vstack([e.middles for e in every]))

    def middles_of(self, pairs: Index, points: Array) -> Array:
        """Middles (k, 3) of the edges between vertices pairs (k, 2) of `points` (n, 3), straight ones too."""
        middles: Array = points[pairs].mean(axis=1)
        if len(self):
            row = find_rows(pairs, self.ends, len(points))
            middles[row >= 0] = self.middles[row[row >= 0]]
        return middles

    def usable(self, points: Array, tets: Index) -> "CurvedEdges":
        """The edges without those of elements that they would fold or nearly flatten (`LEAST_DETERMINANT`)."""
        edges = self
        while len(edges):
            bent = find_rows(tets[:, EDGES].reshape(-1, 2), edges.ends, len(points)).reshape(-1, len(EDGES))
            touched = (bent >= 0).any(axis=1)
            poor = np.flatnonzero(touched)[_least_determinant(points, tets[touched], edges) < LEAST_DETERMINANT]
            if not len(poor):
                break
            kept = np.ones(len(edges), dtype=bool)
            kept[bent[poor][bent[poor] >= 0]] = False
            edges = CurvedEdges(edges.ends[kept], edges.middles[kept])
        return edges


#: A mesh with straight edges has these.
NO_CURVED_EDGES = CurvedEdges(np.empty((0, 2), dtype=np.int64), np.empty((0, 3)))


def curved_edges(points: Array, pairs: Index, middles: Array) -> CurvedEdges:
    """The curved ones of the edges between vertices pairs (k, 2) of `points` (n, 3) with `middles` (k, 3)."""
    a, b = points[pairs[:, 0]], points[pairs[:, 1]]
    away = np.linalg.norm(middles - (a + b) / 2, axis=1) > STRAIGHT * np.linalg.norm(b - a, axis=1)
    return CurvedEdges(pairs[away], middles[away])


def flux(points: Array, triangles: Index, edges: CurvedEdges) -> Array:
    """Integral of x . n / 3 over each triangle (k, 3) with curved edges, n by the right-hand rule, (k,), mm3.

    Their sum over a closed surface is the volume inside (divergence theorem).
    """
    position, normal, weight = _surface(points, triangles, edges)
    return np.asarray(np.einsum("q,kqi,kqi->k", weight, position, normal) / 6)


def areas(points: Array, triangles: Index, edges: CurvedEdges) -> Array:
    """Area of each triangle (k, 3) with curved edges, (k,), mm2."""
    _, normal, weight = _surface(points, triangles, edges)
    return np.asarray(np.linalg.norm(normal, axis=2) @ weight / 2)


def _surface(points: Array, triangles: Index, edges: CurvedEdges) -> tuple[Array, Array, Array]:
    """Positions (k, q, 3) and normals (k, q, 3), twice the area long, at the points of `TRIANGLE_RULE`; weights."""
    where, weight = TRIANGLE_RULE
    pairs = triangles[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2)
    nodes = np.concatenate([points[triangles], edges.middles_of(pairs, points).reshape(-1, 3, 3)], axis=1)
    a, b, c = where.T
    shape = np.column_stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c])
    zero = np.zeros_like(a)
    by_b = np.column_stack([1 - 4 * a, 4 * b - 1, zero, 4 * (a - b), 4 * c, -4 * c])
    by_c = np.column_stack([1 - 4 * a, zero, 4 * c - 1, -4 * b, 4 * b, 4 * (a - c)])
    position, along, across = (np.einsum("qn,kni->kqi", values, nodes) for values in (shape, by_b, by_c))
    return position, np.cross(along, across), weight


def _least_determinant(points: Array, tets: Index, edges: CurvedEdges) -> Array:
    """Smallest Jacobian determinant of each element (m, 4) at its ten nodes, over that with straight edges, (m,)."""
    corners = points[tets]
    middles = edges.middles_of(tets[:, EDGES].reshape(-1, 2), points).reshape(-1, len(EDGES), 3)
    bary = np.vstack([np.eye(4), np.eye(4)[EDGES].mean(axis=1)])
    slope = np.vstack([-np.ones(3), np.eye(3)])  # (4, 3) of the barycentric coordinates
    least = np.full(len(tets), np.inf)
    straight = np.linalg.det(np.einsum("av,ead->edv", slope, corners))
    for at in bary:
        vertex = (4 * at - 1)[:, None] * slope
        middle = 4 * (at[EDGES[:, 0], None] * slope[EDGES[:, 1]] + at[EDGES[:, 1], None] * slope[EDGES[:, 0]])
        jacobian = np.einsum("av,ead->edv", vertex, corners) + np.einsum("av,ead->edv", middle, middles)
        least = np.minimum(least, np.linalg.det(jacobian) / straight)
    return least
