"""Contact search: pairs of a node and a triangle of walls that face each other at rest, and of walls that cross in a
crease; their signed gaps with derivatives."""

from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256

import numpy as np
from scipy.spatial import cKDTree

from fem.discretisation import Faces, pairs_within
from fem.kernels import contact as kernels
from geometry.arrays import Array, Index, Mask
from geometry.topology import cross

#: difference of two distances, over the size of a triangle, that is rounding
EQUALLY_NEAR = 1e-6
#: largest distance from a ray to the centre of a triangle that it may face, over the size of the triangles
BESIDE = 2.0
#: largest cosine of the angle between a ray and the normal of a triangle that it may face
OPPOSITE = -0.7
#: smallest distance at rest of a node from the plane of a triangle, over its size, in a pair of a crease: below it both
#: begin at the common edge
OFF_PLANE = 0.1
#: largest distance at rest of walls that cross in a crease, over the size of a triangle or the length of an edge; about
#: three quadratic elements
FARTHEST = 6.0
#: surfaces whose pairs a process keeps, because it solves several load cases on one mesh
KEPT = 4
#: what positions are multiplied by at the plane of symmetry z = 0
MIRROR = np.array([1.0, 1.0, -1.0])
NO_NODES = np.empty(0, dtype=np.int64)


@dataclass(frozen=True)
class FacingPairs:
    """Nodes of a surface with the triangle that each one faces, at rest or where walls cross in a crease.

    The gap is signed: it turns negative when a wall has passed through the other, which a distance would not show.
    """

    nodes: Index  #: (k,) nodes that face a triangle; one that faces several triangles is repeated for each
    triangles: Index  #: (k, 3) the triangle that each node faces
    #: (k,) the node's part of the surface at rest, mm2, divided among its triangles of the same search
    area: Array
    #: (k,) whether it faces the mirror image of the triangle at the plane of symmetry z = 0 of half a body; then the
    #: triangle may be one of its own
    is_mirrored: Mask

    @classmethod
    def of(cls, surface: Faces, points: Array, in_plane: Index = NO_NODES) -> "FacingPairs":
        """Pairs of a node and the first triangle of opposite normal in front of it; points (n, 3) at rest, mm.

        in_plane: nodes on the plane of symmetry z = 0 of half a body. They look along it, as in the whole body; the
        triangles of their half alone would turn them off it. The other nodes may face the mirror images of triangles.

        Where triangles are equally near (walls that mirror each other, planes of symmetry) the node faces all of them:
        to choose one would make the contact of a symmetric body unsymmetric.
        """
        key = b"".join(sha256(array.tobytes()).digest() for array in (surface.nodes, points, in_plane))
        if key not in _kept:
            _kept[key] = pairs = cls._searched(surface, points, in_plane)
            for array in (pairs.nodes, pairs.triangles, pairs.area, pairs.is_mirrored):
                array.flags.writeable = False  # several models share them
            if len(_kept) > KEPT:
                del _kept[next(iter(_kept))]
        return _kept[key]

    @classmethod
    def _searched(cls, surface: Faces, points: Array, in_plane: Index) -> "FacingPairs":
        triangles = surface.triangles
        vectors = cross(*_edges(points, triangles))
        normal = np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
        angle, area = _angles(points, triangles), _node_areas(points, triangles)
        of_node = np.zeros_like(points)
        for corner in range(3):
            np.add.at(of_node, triangles[:, corner], angle[:, corner, None] * normal)
        of_node[in_plane, 2] = 0.0
        nodes = surface.unique_nodes
        facing = of_node[nodes] / np.linalg.norm(of_node[nodes], axis=1, keepdims=True)
        centre, size = points[triangles].mean(axis=1), float(np.sqrt(_doubled_areas(points, triangles).mean()))
        targets = _Triangles(centre, normal, size)
        if in_plane.size:
            targets = _Triangles(
                np.append(centre, centre * MIRROR, axis=0), np.append(normal, normal * MIRROR, axis=0), size
            )
        node, triangle = targets.in_front_of(points[nodes], facing)
        node, is_mirrored, triangle = nodes[node], triangle >= len(triangles), triangle % len(triangles)
        is_needed = ~(is_mirrored & np.isin(node, in_plane))  # nodes in the plane are their own mirror images
        node, is_mirrored, triangle = node[is_needed], is_mirrored[is_needed], triangle[is_needed]
        count = np.bincount(node, minlength=points.shape[0])
        return cls(node, triangles[triangle], area[node] / count[node], is_mirrored)

    @classmethod
    def of_crossings(cls, edges: Index, triangles: Index, surface: Faces, rest: Array) -> "FacingPairs":
        """Pairs of the ends of edges (m, 2) with the triangles (m, 3) that the edges pass through in a crease.

        rest (n, 3): positions at rest, mm. Both ends are paired, because behind the other the wall is folded. Walls
        that are far apart at rest are left out, and ends on the plane of the triangle, where both walls begin.
        """
        node, triangle = edges.ravel(), np.repeat(triangles, 2, axis=0)
        both = np.unique(np.column_stack([node, triangle]), axis=0)
        node, triangle = both[:, 0], both[:, 1:]
        size = np.sqrt(_doubled_areas(rest, triangle))
        is_mirrored = np.zeros(node.shape, dtype=bool)
        gap = cls(node, triangle, size, is_mirrored).gaps(rest)
        distance = np.linalg.norm(rest[node] - rest[triangle].mean(axis=1), axis=1)
        is_crease = (gap > OFF_PLANE * size) & (distance < FARTHEST * size)
        node, triangle = node[is_crease], triangle[is_crease]
        count = np.bincount(node, minlength=rest.shape[0])
        return cls(node, triangle, _node_areas(rest, surface.triangles)[node] / count[node], is_mirrored[is_crease])

    def without(self, others: "FacingPairs") -> "FacingPairs":
        """The pairs that are not among the others."""
        theirs = set(map(tuple, np.column_stack([others.nodes, others.triangles, others.is_mirrored]).tolist()))
        mine = np.column_stack([self.nodes, self.triangles, self.is_mirrored]).tolist()
        return self.taken(np.flatnonzero([tuple(pair) not in theirs for pair in mine]))

    def joined(self, others: "FacingPairs") -> "FacingPairs":
        """These pairs and the others."""
        nodes, triangles = np.append(self.nodes, others.nodes), np.concatenate([self.triangles, others.triangles])
        is_mirrored = np.append(self.is_mirrored, others.is_mirrored)
        return FacingPairs(nodes, triangles, np.append(self.area, others.area), is_mirrored)

    def taken(self, which: Index) -> "FacingPairs":
        """The pairs with these numbers."""
        return FacingPairs(self.nodes[which], self.triangles[which], self.area[which], self.is_mirrored[which])

    @property
    def node_pairs(self) -> tuple[Index, Index]:
        """For the ten pairs of the four nodes of each gap, the smaller and the larger node (10 k,)."""
        return pairs_within(self.corners)[:2]

    def gaps(self, x: Array) -> Array:
        """Signed gap (k,) in mm of each pair at the positions x (n, 3), along the triangle's normal."""
        gap = np.empty(self.nodes.shape)
        kernels.facing_gaps(self.corners, self._sign, x, gap)
        return gap

    def gaps_after(self, x: Array, dx: Array) -> tuple[Array, Array]:
        """Gaps (k,) at x (n, 3) and their changes (k,) with a motion dx (n, 3) to first order, mm."""
        gap, change = np.empty((2, *self.nodes.shape))
        kernels.facing_motion(self.corners, self._sign, x, dx, gap, change)
        return gap, change

    def local(self, x: Array, which: Index | None = None) -> "LocalPairs":
        """The gaps at positions x (n, 3) with their derivatives, of all pairs or of those with the numbers (m,)."""
        corners, sign = (self.corners, self._sign) if which is None else (self.corners[which], self._sign[which])
        count = corners.shape[0]
        gap, normal, shape = np.empty(count), np.empty((count, 3)), np.empty((count, 4))
        slope, first = np.empty((2, count, 4, 3))
        kernels.facing_derivatives(corners, sign, x, gap, normal, shape, slope, first)
        return LocalPairs(corners, normal, shape, slope, sign, gap, first)

    @cached_property
    def corners(self) -> Index:
        """(k, 4) the node and the triangle of each pair."""
        return np.column_stack([self.nodes, self.triangles])

    @cached_property
    def _sign(self) -> Array:
        """(k,) what z of each node is multiplied by where its mirror image faces the triangle."""
        return np.where(self.is_mirrored, -1.0, 1.0)


NO_PAIRS = FacingPairs(NO_NODES, np.empty((0, 3), np.int64), np.empty(0), np.empty(0, dtype=bool))

#: pairs by the nodes of the surface and the positions, the oldest first
_kept: dict[bytes, FacingPairs] = {}


@dataclass(frozen=True)
class LocalPairs:
    """The gap of pairs near a configuration: g = n . (x_0 - foot), the node being number 0 and the triangle 1 to 3.

    Where the mirror image of the node faces the triangle, x_0 is that of the image.
    """

    nodes: Index  #: (m, 4)
    normal: Array  #: (m, 3)
    shape: Array  #: (m, 4) 1 for the node, minus the barycentric coordinates of its foot point for the triangle
    slope: Array  #: (m, 4, 3) in-plane gradients of the barycentric coordinates, 0 for the node
    sign: Array  #: (m,) what z of the node is multiplied by: -1 for mirror images
    gap: Array  #: (m,) mm
    first: Array  #: (m, 4, 3) derivative of g by the positions of the nodes, d g / d x_k = shape_k n

    @property
    def outside(self) -> Array:
        """How far outside of its triangle each foot lies, (m,): minus the smallest barycentric coordinate."""
        return np.asarray(self.shape[:, 1:].max(axis=1))

    def blocks(self, curvature: Array, slope: Array) -> tuple[Index, Index, Array]:
        """Rows <= columns (10 m,) and blocks (10 m, 3, 3) of curvature (m,) times dg dg plus slope (m,) times d2g."""
        rows, columns = np.empty((2, 10 * self.gap.shape[0]), dtype=np.int64)
        values = np.empty((rows.shape[0], 3, 3))
        local = self.gap, self.normal, self.shape, self.slope, self.first
        kernels.gap_blocks(self.nodes, self.sign, local, np.stack([curvature, slope]), rows, columns, values)
        return rows, columns, values


@dataclass(frozen=True)
class _Triangles:
    """The triangles of a surface that its nodes may face."""

    centre: Array  #: (m, 3), mm
    normal: Array  #: (m, 3)
    size: float  #: about the length of their edges, mm

    def in_front_of(self, start: Array, facing: Array) -> tuple[Index, Index]:
        """Which of the points `start` (k, 3) face which triangles in their directions `facing` (k, 3).

        Two lists of the same length, numbers of points and of triangles. Points march ahead in steps of the triangles'
        size until a triangle of opposite normal lies beside their ray, or they have left the surface's box: what is
        nearest in space may be the wall they are on.
        """
        size, tree = self.size, cKDTree(self.centre)
        low, high = self.centre.min(axis=0) - size, self.centre.max(axis=0) + size
        searching, pairs = np.arange(start.shape[0]), [np.empty((2, 0), dtype=np.int64)]
        for step in range(1, int(np.linalg.norm(high - low) / size) + 2):
            probe = start[searching] + (step - 0.5) * size * facing[searching]
            searching = searching[((probe > low) & (probe < high)).all(axis=1)]
            if searching.size == 0:
                break
            probe = start[searching] + step * size * facing[searching]
            # the ball holds the ray's cylinder of radius BESIDE from one size before the probe to one size after it
            near = tree.query_ball_point(probe, np.hypot(1.0, BESIDE) * size)
            ray = np.repeat(np.arange(searching.size), [len(triangles) for triangles in near])
            triangle = np.concatenate(near).astype(np.int64)
            ray, triangle = self._first(start[searching], facing[searching], ray, triangle, step * size)
            pairs.append(np.stack([searching[ray], triangle]))
            searching = np.delete(searching, ray)
        both = np.concatenate(pairs, axis=1)
        points, triangles = both[:, np.lexsort(both[::-1])]
        return points, triangles

    def _first(self, start: Array, facing: Array, ray: Index, triangle: Index, limit: float) -> tuple[Index, Index]:
        """Of the candidates (ray, triangle) those that a ray meets first, not beyond the distance `limit` in mm.

        Among the triangles that are at most their size behind the first one a ray faces the one that lies least beside
        it.
        """
        along, normal, reach = facing[ray], self.normal[triangle], self.centre[triangle] - start[ray]
        ahead = np.einsum("ki,ki->k", along, reach)
        beside = np.linalg.norm(reach - ahead[:, None] * along, axis=1)
        candidate = (np.einsum("ki,ki->k", along, normal) < OPPOSITE) & (np.einsum("ki,ki->k", reach, normal) < 0)
        candidate &= (ahead > 0) & (beside < BESIDE * self.size)
        ray, triangle, ahead, beside = (values[candidate] for values in (ray, triangle, ahead, beside))
        nearest = _least(ahead, ray, start.shape[0])
        first = (nearest[ray] <= limit) & (ahead < nearest[ray] + self.size)
        ray, triangle, beside = ray[first], triangle[first], beside[first]
        chosen = beside <= _least(beside, ray, start.shape[0])[ray] + EQUALLY_NEAR * self.size
        return ray[chosen], triangle[chosen]


def _least(values: Array, of: Index, count: int) -> Array:
    """The smallest of the values with each number `of`, (count,); infinity where there is none."""
    least = np.full(count, np.inf)
    np.minimum.at(least, of, values)
    return least


def _edges(x: Array, triangles: Index) -> tuple[Array, Array]:
    return x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]]


def _doubled_areas(x: Array, triangles: Index) -> Array:
    """(m,), mm2; its root is about the length of the edges."""
    return np.asarray(np.linalg.norm(cross(*_edges(x, triangles)), axis=1))


def _node_areas(x: Array, triangles: Index) -> Array:
    """The part of the triangles that belongs to each node, (n,) mm2."""
    part, area = _doubled_areas(x, triangles) / 6, np.zeros(x.shape[0])
    for corner in range(3):
        np.add.at(area, triangles[:, corner], part)
    return area


def _angles(x: Array, triangles: Index) -> Array:
    """The angle of each triangle at its corners, (m, 3)."""
    corners = x[triangles]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    area = np.linalg.norm(cross(ahead, behind), axis=2)
    return np.asarray(np.arctan2(area, np.einsum("mki,mki->mk", ahead, behind)))
