"""Which parts of a surface look at each other, and how far apart they are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fem.discretisation import Faces

Array = NDArray[np.float64]
Index = NDArray[np.int64]

#: difference of two distances, over the size of a triangle, that is rounding
EQUALLY_NEAR = 1e-6


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
        """Pairs of a node and the nearest triangle of opposite normal before it; points (n, 3) at rest, mm.

        Where triangles are equally near (walls that mirror each other, planes of symmetry) the node looks at all of
        them: to choose one would make the contact of a symmetric body unsymmetric.
        """
        triangles = surface.triangles
        centre, normal = points[triangles].mean(axis=1), _normals(points, triangles)
        of_node = np.zeros_like(points)
        share = np.zeros(points.shape[0])
        doubled = np.linalg.norm(np.cross(*_edges(points, triangles)), axis=1)
        for corner in range(3):
            np.add.at(of_node, triangles[:, corner], normal)
            np.add.at(share, triangles[:, corner], doubled / 6)
        nodes = surface.unique_nodes
        facing = of_node[nodes] / np.linalg.norm(of_node[nodes], axis=1, keepdims=True)
        count = min(64, triangles.shape[0])
        near = cKDTree(centre).query(points[nodes], k=count)[1].reshape(nodes.shape[0], count)
        reach = centre[near] - points[nodes][:, None, :]
        ahead = np.einsum("ki,kmi->km", facing, reach)
        beside = np.linalg.norm(reach - ahead[..., None] * facing[:, None, :], axis=2)
        opposite = np.einsum("ki,kmi->km", facing, normal[near]) < -0.7
        misfit = np.where(opposite & (ahead > 0), beside, np.inf)
        size = np.sqrt(doubled.mean())
        nearest = misfit.min(axis=1, keepdims=True)
        who, which = np.nonzero((misfit <= nearest + EQUALLY_NEAR * size) & (misfit < 2 * size))
        often = np.bincount(who, minlength=nodes.shape[0])
        return cls(nodes[who], triangles[near[who, which]], share[nodes[who]] / often[who])

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


def _edges(x: Array, triangles: Index) -> tuple[Array, Array]:
    return x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]]


def _normals(x: Array, triangles: Index) -> Array:
    normal = np.cross(*_edges(x, triangles))
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
