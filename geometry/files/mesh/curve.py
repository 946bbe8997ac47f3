"""The material curve as a row of element edges in a mesh that was made without it.

Elements that the curve passes through are divided at the planes y = curve and z = 0, and so are those at the tip that
the line y = curve crosses there. Vertices close to such a plane are moved into it instead, where that keeps the surface
of the body; at last vertices inside the body are moved where that makes poor elements beside the curve better.
"""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import CurvedEdges
from geometry.mesh import Mesh
from geometry.quality import radius_ratios
from geometry.topology import EDGES, OUTWARD, normals, row_keys, signed_volumes

#: a vertex is moved into a plane if it lies within this part of an edge that crosses it
NEAR = 0.45
#: smallest radius ratio that moving a vertex may leave, unless there was a smaller one before
LEAST_RATIO = 0.12
#: elements of a smaller radius ratio are made better where that can be done
POOR = 0.2
#: how many times it is tried
PASSES = 6
#: parts of the way to the middle of its neighbours that a vertex is moved
STEPS = (1.0, 0.5, 0.25, 0.1)


@dataclass(frozen=True)
class _Line:
    """Where the material curve lies."""

    curve_y: float  #: mm
    length: float  #: mm
    tolerance: float  #: mm

    def passes(self, points: Array, tets: Index) -> Mask:
        """True for tetrahedra (m, 4) that the material curve passes through or touches, (m,)."""
        corners = points[tets]
        low, high = corners.min(axis=1), corners.max(axis=1)
        target = np.array([self.curve_y, 0.0])
        near = (low[:, 0] < self.length + self.tolerance) & (high[:, 0] > -self.tolerance)
        near &= ((low[:, 1:] <= target + self.tolerance) & (high[:, 1:] >= target - self.tolerance)).all(axis=1)
        across = corners[near][:, :, 1:] - target
        inside = np.zeros(len(across), dtype=bool)
        for face in OUTWARD:
            a, b, c = (across[:, i] for i in face)
            turns = np.stack([_cross(a, b), _cross(b, c), _cross(c, a)], axis=1)
            room = self.tolerance * np.abs(across).max(axis=(1, 2))[:, None]
            inside |= (turns >= -room).all(axis=1) | (turns <= room).all(axis=1)
        passed = np.zeros(len(tets), dtype=bool)
        passed[np.flatnonzero(near)[inside]] = True
        return passed

    def holds(self, points: Array) -> Mask:
        """True for points (n, 3) on the material curve, beyond its ends too, (n,)."""
        return np.asarray((np.abs(points[:, 1:] - [self.curve_y, 0.0]) <= self.tolerance).all(axis=1))


@dataclass
class _Divided:
    """A mesh that is being divided."""

    line: _Line
    points: Array  #: (n, 3), mm
    tets: Index  #: (m, 4)
    parts: Index  #: (m,) number of the part of the body, as its regions divide it, of each
    triangles: Index  #: (k, 3) of the boundary and of named faces
    names: Index  #: (k,) number of the name of each, 0 for the boundary
    curved: CurvedEdges

    def crossings(self, axis: int, position: float) -> Index:
        """The edges (e, 2) to be divided at the plane x[axis] = position."""
        pairs = self.tets[self.line.passes(self.points, self.tets)][:, EDGES].reshape(-1, 2)
        if axis == 1:
            walls = self.triangles[self.names == 0]
            at_tip = (np.abs(self.points[walls][:, :, 0] - self.line.length) <= self.line.tolerance).all(axis=1)
            pairs = np.vstack([pairs, walls[at_tip][:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2)])
        else:
            in_plane = np.abs(self.points[:, 1] - self.line.curve_y) <= self.line.tolerance
            pairs = pairs[in_plane[pairs].all(axis=1)]
        pairs = np.unique(np.sort(pairs, axis=1), axis=0)
        height = self.points[pairs][:, :, axis] - position
        return np.asarray(pairs[height.prod(axis=1) < -(self.line.tolerance**2)])

    def divide(self, axis: int, position: float) -> None:
        """Move vertices into the plane x[axis] = position and divide the edges that cross it along the line."""
        self._move_into_plane(axis, position)
        for a, b in self.crossings(axis, position):
            height = self.points[[a, b], axis] - position
            part = height[0] / (height[0] - height[1])
            middle = (1 - part) * self.points[a] + part * self.points[b]
            middle[axis] = position
            self._bisect(int(a), int(b), middle)

    def _move_into_plane(self, axis: int, position: float) -> None:
        """Move vertices that are near the plane into it where their elements and the surface allow it."""
        pairs = self.crossings(axis, position)
        height = np.abs(self.points[pairs][:, :, axis] - position)
        near = np.unique(pairs[height / height.sum(axis=1, keepdims=True) < NEAR])
        walls = np.vstack([self.triangles[self.names == 0], self._between_parts()])
        across = normals(self.points[walls])
        slanted = np.abs(across[:, axis]) > 1e-6 * np.linalg.norm(across, axis=1)
        free = np.setdiff1d(near, np.union1d(walls[slanted], self.curved.ends))  # the surface stays as it is
        for vertex in sorted(free, key=lambda v: abs(self.points[v, axis] - position)):
            place = self.points[vertex].copy()
            place[axis] = position
            self._move(int(vertex), place, LEAST_RATIO)

    def _between_parts(self) -> Index:
        """The triangles (k, 3) between elements of different parts of the body."""
        triangles, part = self.tets[:, OUTWARD].reshape(-1, 3), np.repeat(self.parts, len(OUTWARD))
        keys = row_keys(triangles, len(self.points))
        order = np.argsort(keys, kind="stable")
        first, second = order[:-1], order[1:]
        return np.asarray(triangles[first[(keys[first] == keys[second]) & (part[first] != part[second])]])

    def _move(self, vertex: int, place: Array, enough: float) -> bool:
        """Move a vertex to a place (3,) where no element becomes flatter there than the flattest, unless `enough`."""
        star = self.tets[(self.tets == vertex).any(axis=1)]
        before, old = float(radius_ratios(self.points, star).min()), self.points[vertex].copy()
        self.points[vertex] = place
        if signed_volumes(self.points, star).min() > 0:
            ratio = float(radius_ratios(self.points, star).min())
            if ratio > before or ratio >= enough:
                return True
        self.points[vertex] = old
        return False

    def _bisect(self, a: int, b: int, middle: Array) -> None:
        """Put a vertex at `middle` (3,) on the edge from a to b, and divide the elements and triangles around it."""
        new = len(self.points)
        self.points = np.vstack([self.points, middle])
        self.tets, origin = _halves(self.tets, a, b, new)
        self.parts = self.parts[origin]
        self.triangles, origin = _halves(self.triangles, a, b, new)
        self.names = self.names[origin]
        if len(self.curved):
            kept = ~((self.curved.ends == a).any(axis=1) & (self.curved.ends == b).any(axis=1))
            self.curved = CurvedEdges(self.curved.ends[kept], self.curved.middles[kept])

    def improve(self, first_new: int) -> None:
        """Make poor elements beside the line better: their vertices are moved, those that division has made go away.

        The surface and the line stay as they are.

        first_new: number of the first vertex that division has put into the mesh.
        """
        beside = np.unique(self.tets[self.line.passes(self.points, self.tets)])
        beside = np.union1d(beside, np.arange(first_new, len(self.points)))
        fixed = np.unique(np.concatenate([cells.ravel() for cells in (self.triangles, self.curved.ends)]))
        fixed = np.union1d(fixed, self._between_parts())
        for _ in range(PASSES):
            poor = self.tets[np.isin(self.tets, beside).any(axis=1)]
            poor = poor[radius_ratios(self.points, poor) < POOR]
            free = [int(vertex) for tet in poor for vertex in np.setdiff1d(tet, fixed)]
            if not sum((v >= first_new and self._collapse(v)) or self._centre(v) for v in free):
                return

    def _collapse(self, vertex: int) -> bool:
        """Draw a vertex inside the body into that neighbour with which its elements are best, if better than now."""
        around = (self.tets == vertex).any(axis=1)
        star, best = self.tets[around], np.empty((0, 4), dtype=np.int64)
        if not len(star):
            return False
        volume, ratio = signed_volumes(self.points, star).sum(), radius_ratios(self.points, star).min()
        others = np.setdiff1d(star, [vertex])
        if self.line.holds(self.points[[vertex]])[0]:
            others = others[self.line.holds(self.points[others])]
        for other in others:
            left = star[~(star == other).any(axis=1)]
            drawn = np.where(left == vertex, other, left)
            volumes = signed_volumes(self.points, drawn)
            fills = volumes.min() > 0 and abs(volumes.sum() - volume) < 1e-9 * volume
            if fills and (now := radius_ratios(self.points, drawn).min()) > ratio:
                best, ratio = drawn, now
        if len(best):
            self.tets = np.vstack([self.tets[~around], best])
            self.parts = np.append(self.parts[~around], np.full(len(best), self.parts[around][0]))
        return len(best) > 0

    def _centre(self, vertex: int) -> bool:
        """Move a vertex towards the middle of its neighbours, if its elements become better."""
        neighbours = np.setdiff1d(self.tets[(self.tets == vertex).any(axis=1)], [vertex])
        if not len(neighbours):
            return False
        step = self.points[neighbours].mean(axis=0) - self.points[vertex]
        if self.line.holds(self.points[[vertex]])[0]:
            step[1:] = 0.0
        return any(self._move(vertex, self.points[vertex] + part * step, np.inf) for part in STEPS)


def with_curve(mesh: Mesh, curve_y: float, length: float) -> Mesh:
    """The mesh, with its faces and regions, with the lines y = curve_y, z = 0 (from x = 0 to `length`, mm) and
    y = curve_y (in the plane x = length) along edges.

    The regions have no element in common. Where no material is around the curve nothing is divided there.
    """
    size = float(np.ptp(mesh.points, axis=0).max())
    points = mesh.points.copy()
    for axis, position in ((1, curve_y), (2, 0.0)):
        points[np.abs(points[:, axis] - position) < 1e-6 * size, axis] = position
    faces = {"": mesh.boundary, **mesh.faces}
    names = np.repeat(np.arange(len(faces)), [len(triangles) for triangles in faces.values()])
    parts = np.zeros(len(mesh.tets), dtype=np.int64)
    for k, rows in enumerate(mesh.regions.values(), start=1):
        parts[rows] = k
    line = _Line(curve_y, length, 1e-9 * size)
    divided = _Divided(line, points, mesh.tets, parts, np.vstack(list(faces.values())), names, mesh.curved)
    divided.divide(1, curve_y)
    divided.divide(2, 0.0)
    divided.improve(len(points))
    named = {name: divided.triangles[divided.names == k] for k, name in enumerate(faces) if name}
    regions = {name: np.flatnonzero(divided.parts == k) for k, name in enumerate(mesh.regions, start=1)}
    return Mesh(divided.points, divided.tets, named, divided.curved.usable(divided.points, divided.tets), regions)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _halves(cells: Index, a: int, b: int, new: int) -> tuple[Index, Index]:
    """The cells (m, c), those with the edge from a to b in two parts; of which cell each is."""
    around = np.flatnonzero((cells == a).any(axis=1) & (cells == b).any(axis=1))
    if not len(around):
        return cells, np.arange(len(cells))
    halves = cells[around]
    cells = cells.copy()
    cells[around] = np.where(halves == b, new, halves)
    return np.vstack([cells, np.where(halves == a, new, halves)]), np.concatenate([np.arange(len(cells)), around])
