"""Which parts of a surface look at each other, and how far apart they are."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fem.discretisation import Faces
from geometry.arrays import Array, Index

#: difference of two distances, over the size of a triangle, that is rounding
EQUALLY_NEAR = 1e-6
#: triangles asked for at every step of the look ahead: two walls with all that meet in a node
BESIDE = 32


@dataclass(frozen=True)
class FacingPairs:
    """Nodes of a surface with the triangle each one looks at, found once at rest.

    The gap is signed: it turns negative when a wall has passed through the other, which a distance would not show.
    """

    nodes: Index  #: (k,) nodes that have something before them; one that looks at several triangles stands for each
    triangles: Index  #: (k, 3) the triangle each node looks at
    area: Array  #: (k,) the node's share of the surface at rest, divided among its triangles, mm2

    @classmethod
    def of(cls, surface: Faces, points: Array) -> "FacingPairs":
        """Pairs of a node and the first triangle of opposite normal before it; points (n, 3) at rest, mm.

        Where triangles are equally near (walls that mirror each other, planes of symmetry) the node looks at all of
        them: to choose one would make the contact of a symmetric body unsymmetric.
        """
        triangles = surface.triangles
        normal = _normals(points, triangles)
        doubled = np.linalg.norm(np.cross(*_edges(points, triangles)), axis=1)
        of_node = np.zeros_like(points)
        share = np.zeros(points.shape[0])
        for corner in range(3):
            np.add.at(of_node, triangles[:, corner], normal)
            np.add.at(share, triangles[:, corner], doubled / 6)
        nodes = surface.unique_nodes
        facing = of_node[nodes] / np.linalg.norm(of_node[nodes], axis=1, keepdims=True)
        who, seen = _seen(points[nodes], facing, points[triangles].mean(axis=1), normal, float(np.sqrt(doubled.mean())))
        often = np.bincount(who, minlength=nodes.shape[0])
        return cls(nodes[who], triangles[seen], share[nodes[who]] / often[who])

    def gaps(self, x: Array) -> Array:
        """Signed gap (k,) in mm of each pair at the positions x (n, 3), along the triangle's normal."""
        normal = _normals(x, self.triangles)
        return np.einsum("ki,ki->k", x[self.nodes] - x[self.triangles].mean(axis=1), normal)

    def local(self, x: Array) -> "LocalPairs":
        """First and second derivatives of the gaps at the positions x (n, 3)."""
        node, triangle = self.nodes, self.triangles
        normal = _normals(x, triangle)
        first, second = _edges(x, triangle)
        reach = x[node] - x[triangle[:, 0]]
        g11, g12, g22 = (np.einsum("ki,ki->k", u, v) for u, v in ((first, first), (first, second), (second, second)))
        det = g11 * g22 - g12**2
        slope = np.zeros((node.shape[0], 4, 3))
        slope[:, 2] = (g22[:, None] * first - g12[:, None] * second) / det[:, None]
        slope[:, 3] = (g11[:, None] * second - g12[:, None] * first) / det[:, None]
        slope[:, 1] = -slope[:, 2] - slope[:, 3]
        share = np.zeros((node.shape[0], 4))
        share[:, 2:] = -np.einsum("kai,ki->ka", slope[:, 2:], reach)
        share[:, 0], share[:, 1] = 1.0, -1.0 - share[:, 2] - share[:, 3]
        gap = np.einsum("ki,ki->k", reach, normal)
        return LocalPairs(np.column_stack([node, triangle]), normal, share, slope, gap)


@dataclass(frozen=True)
class LocalPairs:
    """The gap of pairs near a configuration: g = n . (x_0 - foot), the node being number 0 and the triangle 1 to 3."""

    nodes: Index  #: (m, 4)
    normal: Array  #: (m, 3)
    share: Array  #: (m, 4) 1 for the node, minus the barycentric coordinates of its foot point for the triangle
    slope: Array  #: (m, 4, 3) in-plane gradients of the barycentric coordinates, 0 for the node
    gap: Array  #: (m,) mm

    @property
    def first(self) -> Array:
        """d g / d x_k = share_k n, (m, 4, 3)."""
        return self.share[:, :, None] * self.normal[:, None, :]

    def second(self, a: Index, b: Index) -> Array:
        """d2 g / d x_a d x_b for index lists a, b (p,): (m, p, 3, 3).

        From dn = -sum_k slope_k (n . dx_k) and d2g = 2 dn . w - g |dn|^2, with w = sum_k share_k dx_k the motion at the
        foot.
        """
        n = self.normal[:, None, :]
        across = np.einsum("mpi,mpj->mpij", self.share[:, b, None] * n, self.slope[:, a])
        along = self.share[:, a, None, None] * self.slope[:, b, :, None] * n[:, :, None, :]
        turn = self.gap[:, None] * np.einsum("mpi,mpi->mp", self.slope[:, a], self.slope[:, b])
        return -across - along - turn[:, :, None, None] * (n[..., :, None] * n[..., None, :])


def _seen(start: Array, facing: Array, centre: Array, normal: Array, size: float) -> tuple[Index, Index]:
    """Which of the points `start` (k, 3) look along `facing` at which triangles: two lists of the same length.

    The triangles have centres and normals (m, 3) and edges of about `size`. Points walk ahead in steps of that size
    until a triangle of opposite normal lies beside their way, or they have left the surface's box: what is nearest in
    space may be the wall they stand on.
    """
    tree, low, high = cKDTree(centre), centre.min(axis=0) - size, centre.max(axis=0) + size
    count = min(BESIDE, centre.shape[0])
    waiting, found = np.arange(start.shape[0]), [np.empty((2, 0), dtype=np.int64)]
    for step in range(int(np.linalg.norm(high - low) / size) + 1):
        probe = start[waiting] + (step + 0.5) * size * facing[waiting]
        inside = ((probe > low) & (probe < high)).all(axis=1)
        waiting, probe = waiting[inside], probe[inside]
        if waiting.size == 0:
            break
        near = tree.query(probe, k=count)[1].reshape(waiting.size, count)
        reach = centre[near] - start[waiting][:, None, :]
        ahead = np.einsum("ki,kmi->km", facing[waiting], reach)
        beside = np.linalg.norm(reach - ahead[..., None] * facing[waiting][:, None, :], axis=2)
        opposite = np.einsum("ki,kmi->km", facing[waiting], normal[near]) < -0.7
        before = opposite & (ahead > 0) & (beside < 2 * size)
        before &= np.einsum("kmi,kmi->km", reach, normal[near]) < 0
        first = before & (ahead < np.where(before, ahead, np.inf).min(axis=1, keepdims=True) + size)
        misfit = np.where(first, beside, np.inf)
        who, which = np.nonzero(first & (misfit <= misfit.min(axis=1, keepdims=True) + EQUALLY_NEAR * size))
        found.append(np.stack([waiting[who], near[who, which]]))
        waiting = np.delete(waiting, who)
    both = np.concatenate(found, axis=1)
    who, seen = both[:, np.argsort(both[0], kind="stable")]
    return who, seen


def _edges(x: Array, triangles: Index) -> tuple[Array, Array]:
    return x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]]


def _normals(x: Array, triangles: Index) -> Array:
    normal = np.cross(*_edges(x, triangles))
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
