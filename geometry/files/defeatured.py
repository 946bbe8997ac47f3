"""Closed surfaces of triangles without the short edges and narrow strips that other programs leave where parts meet.

A short edge is contracted to one of its ends where the surface stays a closed surface: its ends must have no other
common neighbours than the two corners opposite to it (the link condition; T. K. Dey et al., "Topology preserving edge
contraction", Publ. Inst. Math. 66 (1999) 23). The end is kept that is nearer to the planes of all triangles of the file
that were around either of them, so that corners stay and surfaces do not drift (quadrics; M. Garland and P. S.
Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997). A triangle that is flat although its
sides are long passes its longest side to the other two corners around it.
"""

import heapq
from collections import defaultdict
from math import dist, hypot, sqrt
from operator import add
from typing import TypeAlias, final

import numpy as np

from geometry.arrays import Array, Index
from geometry.files.cad_import import Point
from geometry.files.surface import Surface

#: numbers of the three corners
Triangle: TypeAlias = tuple[int, int, int]
#: sum over planes n x + d = 0 of their weight times n n, n d, d d, and the sum of the weights: xx, xy, xz, yy, yz, zz,
#: x, y, z, 1, weights
Quadric: TypeAlias = tuple[float, ...]

#: smallest cosine of the angle by which a triangle that is not flat may turn
LARGEST_TURN = 0.2
#: height of a triangle, over the length of the edges that are contracted, below which none is made lower
FLAT = 0.01
#: rounds of contractions and exchanged sides
ROUNDS = 10
#: fewest triangles of a closed part, those of a tetrahedron
FEWEST = 4


def defeatured(surface: Surface, length: float) -> Surface:
    """The surface without edges and triangles that are shorter or flatter than `length`, where it stays closed.

    No point moves by much more than `length`, and no part of the surface vanishes.
    """
    parts = [_Triangles(surface.points, part, length).simplified() for part in surface.parts]
    used, numbers = np.unique(np.vstack(parts), return_inverse=True)
    ends = np.cumsum([len(part) for part in parts])[:-1]
    renumbered = np.split(numbers.reshape(-1, 3).astype(np.int64), ends)
    return Surface(surface.points[used], tuple(renumbered))


@final
class _Triangles:
    """The triangles of a closed part while they change; those that have vanished are None."""

    def __init__(self, points: Array, part: Index, length: float) -> None:
        # single points are looked at, for which tuples are faster than arrays
        self.points: list[Point] = [(x, y, z) for x, y, z in points.tolist()]
        self.length = length
        self.corners: list[Triangle | None] = [(a, b, c) for a, b, c in part.tolist()]
        self.left = len(part)
        self.around: defaultdict[int, set[int]] = defaultdict(set)  #: numbers of the triangles at each vertex
        for number, triangle in enumerate(self.corners):
            for vertex in triangle or ():
                self.around[vertex].add(number)
        self.quadrics = {vertex: self._quadric(vertex) for vertex in self.around}

    def simplified(self) -> Index:
        """(k, 3) the triangles that are left, after `ROUNDS` at most."""
        for _ in range(ROUNDS):
            if not self._contract_short_edges() + self._exchange_long_sides():
                break
        return np.array([triangle for triangle in self.corners if triangle is not None], dtype=np.int64)

    def _contract_short_edges(self) -> int:
        """Contract edges shorter than `length`, the shortest first; how many."""
        edges = {(min(a, b), max(a, b)) for triangle in self.corners if triangle for a, b, _ in _sides(triangle)}
        queue = [(size, *edge) for edge in edges if (size := self._size(*edge)) < self.length]
        heapq.heapify(queue)
        count = 0
        while queue and self.left > FEWEST:
            _, a, b = heapq.heappop(queue)
            shared = self.around[a] & self.around[b]
            if len(shared) != 2 or len(self._neighbours(a) & self._neighbours(b)) != 2:
                continue
            both = tuple(map(add, self.quadrics[a], self.quadrics[b]))
            for away, kept, gone in sorted((self._distance(both, kept), kept, a + b - kept) for kept in (a, b)):
                if away <= self.length and self._may_move(gone, kept, shared):
                    self.quadrics[kept] = both
                    self._move(gone, kept, shared)
                    count += 1
                    for other in self._neighbours(kept):
                        if (size := self._size(kept, other)) < self.length:
                            heapq.heappush(queue, (size, min(kept, other), max(kept, other)))
                    break
        return count

    def _exchange_long_sides(self) -> int:
        """Exchange the longest side of triangles lower than `length` for that between the corners opposite to it; how
        many."""
        count = 0
        for number, triangle in enumerate(self.corners):
            if triangle is None or self._height(triangle) >= self.length:
                continue
            a, b, apex = max(_sides(triangle), key=lambda side: self._size(side[0], side[1]))
            shared = self.around[a] & self.around[b]
            if len(shared) != 2:
                continue
            other = next(iter(shared - {number}))
            across = next(vertex for vertex in self.corners[other] or () if vertex not in (a, b))
            if across in self._neighbours(apex):
                continue
            new = ((apex, across, b), (apex, a, across))
            opposite = self.corners[other]
            assert opposite is not None
            lowest = min(self._height(triangle), self._height(opposite))
            if min(map(self._height, new)) <= lowest or any(self._turns(opposite, corners) for corners in new):
                continue
            self._replace(number, new[0])
            self._replace(other, new[1])
            count += 1
        return count

    def _may_move(self, gone: int, kept: int, shared: set[int]) -> bool:
        """Whether no triangle around the vertex `gone` turns over, or becomes flat, where it moves to `kept`."""
        for number in self.around[gone] - shared:
            before = self.corners[number]
            assert before is not None
            after = _replaced(before, gone, kept)
            flat = self._height(after) < min(FLAT * self.length, self._height(before))
            if flat or (self._height(before) >= self.length and self._turns(before, after)):
                return False
        return True

    def _move(self, gone: int, kept: int, shared: set[int]) -> None:
        for number in shared:
            self._replace(number, None)
        for number in list(self.around[gone]):
            triangle = self.corners[number]
            assert triangle is not None
            self._replace(number, _replaced(triangle, gone, kept))

    def _replace(self, number: int, triangle: Triangle | None) -> None:
        for vertex in self.corners[number] or ():
            self.around[vertex].discard(number)
        self.left -= triangle is None
        self.corners[number] = triangle
        for vertex in triangle or ():
            self.around[vertex].add(number)

    def _quadric(self, vertex: int) -> Quadric:
        """Of the planes of the triangles around a vertex, weighted with their areas."""
        total = [0.0] * 11
        for number in self.around[vertex]:
            triangle = self.corners[number]
            across = self._normal(triangle) if triangle else (0.0, 0.0, 0.0)
            if (weight := hypot(*across)) > 0.0:
                x, y, z = (component / weight for component in across)
                d = -_product((x, y, z), self.points[vertex])
                plane = (x * x, x * y, x * z, y * y, y * z, z * z, x * d, y * d, z * d, d * d, 1.0)
                total = [before + weight * entry for before, entry in zip(total, plane, strict=True)]
        return tuple(total)

    def _distance(self, quadric: Quadric, vertex: int) -> float:
        """Root of the mean square distance of a vertex from the planes."""
        x, y, z = self.points[vertex]
        xx, xy, xz, yy, yz, zz, xd, yd, zd, dd, weight = quadric
        linear = 2.0 * (xd * x + yd * y + zd * z) + dd
        square = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z) + linear
        return sqrt(max(square, 0.0) / weight) if weight else 0.0

    def _turns(self, before: Triangle, after: Triangle) -> bool:
        first, second = self._normal(before), self._normal(after)
        return _product(first, second) < LARGEST_TURN * hypot(*first) * hypot(*second)

    def _neighbours(self, vertex: int) -> set[int]:
        return {other for number in self.around[vertex] for other in self.corners[number] or ()} - {vertex}

    def _height(self, triangle: Triangle) -> float:
        """Height of a triangle on its longest side."""
        return hypot(*self._normal(triangle)) / max(self._size(first, second) for first, second, _ in _sides(triangle))

    def _normal(self, triangle: Triangle) -> Point:
        """Across the triangle, as long as twice its area."""
        a, b, c = (self.points[vertex] for vertex in triangle)
        (x, y, z), (u, v, w) = _difference(b, a), _difference(c, a)
        return y * w - z * v, z * u - x * w, x * v - y * u

    def _size(self, first: int, second: int) -> float:
        return dist(self.points[first], self.points[second])


def _sides(triangle: Triangle) -> tuple[Triangle, ...]:
    """The three sides and the corner opposite to each, in the direction of the triangle."""
    a, b, c = triangle
    return (a, b, c), (b, c, a), (c, a, b)


def _replaced(triangle: Triangle, gone: int, kept: int) -> Triangle:
    """The triangle with another vertex in the place of one."""
    a, b, c = triangle
    return (kept, b, c) if a == gone else (a, kept, c) if b == gone else (a, b, kept)


def _difference(first: Point, second: Point) -> Point:
    return first[0] - second[0], first[1] - second[1], first[2] - second[2]


def _product(first: Point, second: Point) -> float:
    return first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
