"""A mesh with a line of element edges in it, and better elements around that line."""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import CurvedEdges
from geometry.quality import radius_ratios
from geometry.topology import EDGES, OUTWARD, signed_volumes

#: elements of a smaller radius ratio are made better where that can be done
POOR = 0.2
#: how many times it is tried
PASSES = 6


@dataclass
class DividedMesh:
    """The part of a mesh that is being divided."""

    points: Array  #: (n, 3), mm
    tets: Index  #: (m, 4) those that may change
    parts: Index  #: (m,) number of the part of the body, as its regions divide it, of each
    triangles: Index  #: (k, 3) named ones
    names: Index  #: (k,) number of the name of each
    walls: Index  #: (b, 3) triangles of the boundary, outward
    curved: CurvedEdges
    fixed: Index  #: vertices of elements outside of these


@dataclass(frozen=True)
class Line:
    """Where the curve and the edge of the tip lie."""

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
        away = np.abs(points[:, 1:] - [self.curve_y, 0.0])
        return np.asarray((away <= self.tolerance).all(axis=1))

    def edge_holds(self, points: Array) -> Mask:
        """True for points (n, 3) in the plane of the tip at the height of the curve, (n,)."""
        away = np.abs(points[:, :2] - [self.length, self.curve_y])
        return np.asarray((away <= self.tolerance).all(axis=1))

    def crossings(self, mesh: DividedMesh, axis: int, position: float) -> Index:
        """The edges (e, 2) to be divided at the plane x[axis] = position."""
        if axis == 1:
            pairs = mesh.tets[self.passes(mesh.points, mesh.tets)][:, EDGES].reshape(-1, 2)
            at_tip = (np.abs(mesh.points[mesh.walls][:, :, 0] - self.length) <= self.tolerance).all(axis=1)
            tip = mesh.walls[at_tip][:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2)
            pairs = np.vstack([pairs, tip])
        else:
            in_plane = np.abs(mesh.points[:, 1] - self.curve_y) <= self.tolerance
            pairs = mesh.tets[self.passes(mesh.points, mesh.tets)][:, EDGES].reshape(-1, 2)
            pairs = pairs[in_plane[pairs].all(axis=1)]
        pairs = np.unique(np.sort(pairs, axis=1), axis=0)
        height = mesh.points[pairs][:, :, axis] - position
        return np.asarray(pairs[height.prod(axis=1) < -(self.tolerance**2)])


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def improve(mesh: DividedMesh, line: Line, first_new: int) -> None:
    """Make the elements beside the line better: vertices that division has put there are drawn into a neighbour or
    moved, those of the mesh that lie inside the body are moved. The surface and the line stay as they are.

    first_new: number of the first vertex that division has put into the mesh.
    """
    beside = np.unique(mesh.tets[line.passes(mesh.points, mesh.tets)])
    beside = np.union1d(beside, np.arange(first_new, len(mesh.points)))
    for _ in range(PASSES):
        poor = mesh.tets[np.isin(mesh.tets, beside).any(axis=1)]
        poor = poor[radius_ratios(mesh.points, poor) < POOR]
        if not len(poor):
            return
        changes = 0
        for tet in poor:
            changes += any(_collapse(mesh, line, int(v)) for v in tet if v >= first_new)
            changes += sum(_move(mesh, line, int(v)) for v in tet)
        if not changes:
            return


def _collapse(mesh: DividedMesh, line: Line, vertex: int) -> bool:
    """Draw a vertex into that neighbour with which its elements are best, if they are better than now."""
    around = _cells_with(mesh.tets, vertex)
    if not len(around) or (mesh.curved.ends == vertex).any() or len(np.unique(mesh.parts[around])) > 1:
        return False
    star = mesh.tets[around]
    best, volume = float(radius_ratios(mesh.points, star).min()), float(signed_volumes(mesh.points, star).sum())
    chosen = -1
    position = mesh.points[[vertex]]
    for other in np.setdiff1d(star, [vertex]):
        at = mesh.points[[other]]
        if (line.holds(position)[0] and not line.holds(at)[0]) or (
            line.edge_holds(position)[0] and not line.edge_holds(at)[0]
        ):
            continue
        left = star[~(star == other).any(axis=1)]
        moved = np.where(left == vertex, other, left)
        volumes = signed_volumes(mesh.points, moved)
        if not len(moved) or abs(float(volumes.sum()) - volume) > 1e-9 * volume:
            continue
        if volumes.min() <= 0 or not _keeps_links(mesh, vertex, int(other)):
            continue
        ratio = float(radius_ratios(mesh.points, moved).min())
        if ratio > best:
            best, chosen = ratio, int(other)
    if chosen < 0:
        return False
    gone = around[(star == chosen).any(axis=1)]
    mesh.tets = np.delete(np.where(mesh.tets == vertex, chosen, mesh.tets), gone, axis=0)
    mesh.parts = np.delete(mesh.parts, gone)
    mesh.walls, _ = _without(mesh.walls, vertex, chosen)
    mesh.triangles, kept = _without(mesh.triangles, vertex, chosen)
    mesh.names = mesh.names[kept]
    return True


def _keeps_links(mesh: DividedMesh, vertex: int, other: int) -> bool:
    """Whether the neighbours that both vertices have are those around their edge, in the body and on its surface; else
    the body would be pinched."""
    for cells in (mesh.tets, mesh.walls, mesh.triangles):
        first, second = (cells[_cells_with(cells, end)] for end in (vertex, other))
        between = first[_cells_with(first, other)]
        common = set(first.ravel().tolist()) & set(second.ravel().tolist())
        if common - {vertex, other} != set(between.ravel().tolist()) - {vertex, other}:
            return False
    of_wall = mesh.walls[_cells_with(mesh.walls, vertex)]
    return not len(of_wall) or bool(len(_cells_with(of_wall, other)))


def _cells_with(cells: Index, vertex: int) -> Index:
    """The numbers of the cells (m, c), none of which has a vertex twice, that have this one."""
    return np.flatnonzero(cells == vertex) // cells.shape[1]


def _without(cells: Index, vertex: int, other: int) -> tuple[Index, Mask]:
    """The cells with `other` instead of `vertex`, without those that had both; which of them were kept."""
    kept = ~((cells == vertex).any(axis=1) & (cells == other).any(axis=1))
    return np.where(cells == vertex, other, cells)[kept], kept


def _move(mesh: DividedMesh, line: Line, vertex: int) -> bool:
    """Move a vertex towards the middle of its neighbours, along the line if it lies on it, if its elements become
    better."""
    around = _cells_with(mesh.tets, vertex)
    star = mesh.tets[around]
    if not len(star) or len(np.unique(mesh.parts[around])) > 1:
        return False
    if any((cells == vertex).any() for cells in (mesh.walls, mesh.curved.ends, mesh.fixed)):
        return False
    old, before = mesh.points[vertex].copy(), radius_ratios(mesh.points, star).min()
    step = mesh.points[np.setdiff1d(star, [vertex])].mean(axis=0) - old
    if line.holds(old[None])[0]:
        step[1:] = 0.0
    for part in (1.0, 0.5, 0.25, 0.1):
        mesh.points[vertex] = old + part * step
        if signed_volumes(mesh.points, star).min() > 0 and radius_ratios(mesh.points, star).min() > before:
            return True
    mesh.points[vertex] = old
    return False
