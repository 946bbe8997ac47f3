"""Which parts of a surface look at each other, and how far apart they are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fem.discretisation import Faces

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True)
class FacingPairs:
    """Nodes of a surface with the triangle each one looks at, found once at rest.

    The gap is signed: it turns negative when a wall has passed through the other, which a distance would not show.
    """

    nodes: Index  #: (k,) nodes that have something before them
    triangles: Index  #: (k, 3) the triangle each node looks at

    @classmethod
    def of(cls, surface: Faces, points: Array) -> "FacingPairs":
        """Pairs of a node and the nearest triangle of opposite normal that lies before it; points (n, 3) at rest, mm."""
        triangles = surface.triangles
        centre, normal = points[triangles].mean(axis=1), _normals(points, triangles)
        of_node = np.zeros_like(points)
        for corner in range(3):
            np.add.at(of_node, triangles[:, corner], normal)
        nodes = surface.unique_nodes
        facing = of_node[nodes] / np.linalg.norm(of_node[nodes], axis=1, keepdims=True)
        count = min(64, triangles.shape[0])
        near = cKDTree(centre).query(points[nodes], k=count)[1].reshape(nodes.shape[0], count)
        reach = centre[near] - points[nodes][:, None, :]
        ahead = np.einsum("ki,kmi->km", facing, reach)
        beside = np.linalg.norm(reach - ahead[..., None] * facing[:, None, :], axis=2)
        opposite = np.einsum("ki,kmi->km", facing, normal[near]) < -0.7
        misfit = np.where(opposite & (ahead > 0), beside, np.inf)
        best = np.argmin(misfit, axis=1)
        size = np.sqrt(np.linalg.norm(np.cross(*_edges(points, triangles)), axis=1).mean())
        seen = misfit[np.arange(nodes.shape[0]), best] < 2 * size
        return cls(nodes[seen], triangles[near[seen, best[seen]]])

    def gaps(self, x: Array) -> Array:
        """Signed gap (k,) in mm of each pair at the positions x (n, 3), along the triangle's normal."""
        normal = _normals(x, self.triangles)
        return np.einsum("ki,ki->k", x[self.nodes] - x[self.triangles].mean(axis=1), normal)


def _edges(x: Array, triangles: Index) -> tuple[Array, Array]:
    return x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]]


def _normals(x: Array, triangles: Index) -> Array:
    normal = np.cross(*_edges(x, triangles))
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
