"""A body from one end piece and one half cell, repeated as mirror images so that equal cells have equal meshes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import NO_CURVED_EDGES, CurvedEdges
from geometry.mesh import Mesh
from geometry.meshing.solid import SolidMesh
from geometry.topology import find_rows


@dataclass(frozen=True)
class _Region:
    """One region of a meshed solid, with point numbers of its own."""

    points: Array  #: (n, 3), mm
    tets: Index  #: (m, 4)
    walls: Mapping[str, Index]  #: name of the air -> (k, 3)
    original: Index  #: (n,) number of each point in the meshed solid
    curved: CurvedEdges


@final
@dataclass(frozen=True)
class Repetition:
    """A meshed end piece and a meshed half cell, of which a body is put together as mirror images.

    `solid` holds the regions `end` (x from 0 to `middle`) and, unless half_cells is 0, `cell` (x from `middle` to
    `edge`), which share the vertices of the plane x = middle (mm). Because each copy touches only its own mirror image,
    neighbours share their vertices by number and no coordinates have to be compared.
    The far end of the body is the mirror image of `end`, unless `last` is given: then it is the region `far`, which
    begins with a half cell and shares the vertices of the plane x = edge with `cell`.
    Boundary faces of what is put together: the walls of the solid's air by their names, `clamp` (x = 0), `tip` (the far
    end), `sym` (z = 0), and `outer` for all others.
    """

    solid: SolidMesh
    middle: float  #: where the end piece ends, mm
    edge: float  #: where the half cell ends, mm
    half_cells: int  #: between the two end pieces of the body, even
    last: float | None = None  #: length of the far end beyond its half cell, mm; None where it mirrors the end piece
    half: bool = True  #: only z >= 0 is meshed
    #: cavities each of which comes to the place of the next one, the last to that of the first, with the whole body on
    #: itself, where the body is turned about its material curve from y to z; empty where no such turn is known
    turned: tuple[str, ...] = ()

    @property
    def length(self) -> float:
        """Length of the body, mm."""
        return self.middle + self.beyond + self.half_cells * self.half_pitch

    @property
    def beyond(self) -> float:
        """Length of the far end without any half cell, mm."""
        return self.middle if self.last is None else self.last

    @property
    def half_pitch(self) -> float:
        """Length of the half cell, mm."""
        return self.edge - self.middle

    def mesh(self) -> Mesh:
        """The body: `end`, `half_cells` times `cell`, and `end` again."""
        return self._joined(self.half_cells, self.length, far_end=True)

    def end_piece(self, half_cells: int) -> Mesh:
        """The end piece with that many half cells; its face `tip` is the mirror plane at their far end."""
        return self._joined(half_cells, self.middle + half_cells * self.half_pitch, far_end=False)

    def tip_piece(self, half_cells: int) -> Mesh:
        """The far end with that many half cells, an odd number, as its mirror image: `clamp` is the end of the body,
        `tip` the mirror plane."""
        if self.last is None:
            return self.end_piece(half_cells)
        end = self.edge + self.half_pitch + self.last
        regions = {"end": self.solid.regions["far"], "cell": self.solid.regions["cell"]}
        points, middles = (
            np.array([end, 0.0, 0.0]) + x * [-1.0, 1.0, 1.0] for x in (self.solid.points, self.solid.curved.middles)
        )
        image = SolidMesh(points, regions, self.solid.walls, CurvedEdges(self.solid.curved.ends, middles))
        mirrored = Repetition(image, end - self.edge, end - self.middle, 0, half=self.half)
        return mirrored.end_piece(half_cells - 1)

    def half_cell(self) -> Mesh:
        """The half cell from x = 0 to x = half_pitch, both of which are mirror planes of the body: the faces `clamp`
        and `tip`."""
        cell = _cut(self.solid, "cell")
        points = cell.points - np.array([self.middle, 0.0, 0.0])
        for plane in (0.0, self.half_pitch):  # what is within rounding of it is exactly on it
            points[np.abs(points[:, 0] - plane) < 1e-9 * self.half_pitch, 0] = plane
        middles = cell.curved.middles - np.array([self.middle, 0.0, 0.0])
        curved = CurvedEdges(cell.curved.ends, middles)
        return name_faces(points, cell.tets, cell.walls, self._planes(self.half_pitch), curved)

    def _joined(self, half_cells: int, length: float, far_end: bool) -> Mesh:
        end = _cut(self.solid, "end")
        points, tets, curved = [end.points], [end.tets], [end.curved]
        walls = {name: [triangles] for name, triangles in end.walls.items()}
        count = len(end.points)
        latest = np.full(len(self.solid.points), -1)  # point numbers of the latest copy, by point of the meshed solid
        latest[end.original] = np.arange(count)
        for region, k, interface in self._copies(end, half_cells, far_end):
            new = np.abs(region.points[:, 0] - interface) > 1e-9 * length
            numbers = latest[region.original]
            numbers[new] = count + np.arange(new.sum())
            count += int(new.sum())
            latest[region.original] = numbers
            points.append(_copied(region.points[new], k, self.middle, self.edge, length))
            tets.append(numbers[region.tets])
            middles = _copied(region.curved.middles, k, self.middle, self.edge, length)
            curved.append(CurvedEdges(numbers[region.curved.ends], middles))
            for name, triangles in region.walls.items():
                walls[name].append(numbers[triangles])
        joined = {name: np.vstack(triangles) for name, triangles in walls.items()}
        every = curved[0].joined(*curved[1:])
        return name_faces(np.vstack(points), np.vstack(tets), joined, self._planes(length), every)

    def _copies(self, end: _Region, half_cells: int, far_end: bool) -> list[tuple[_Region, int, float]]:
        """What is joined to the end piece: each region, which copy it is, and the plane x (mm) of the solid where it
        touches the one before it."""
        copies: list[tuple[_Region, int, float]] = []
        if far_end and self.last is None:
            copies = [(end, -1, self.middle)]
        elif far_end:  # it is the last half cell as well, shifted as the one before
            half_cells -= 1
            copies = [(_cut(self.solid, "far"), half_cells - 1, self.edge)]
        if not half_cells:
            return copies
        cell = _cut(self.solid, "cell")
        return [(cell, k, self.edge if k % 2 else self.middle) for k in range(half_cells)] + copies

    def _planes(self, length: float) -> dict[str, tuple[int, float]]:
        return {"clamp": (0, 0.0), "tip": (0, length)} | ({"sym": (2, 0.0)} if self.half else {})


def slices(length: float, nominal: float) -> tuple[int, float]:
    """Number and length (mm) of the equal slices of `length` that are closest to `nominal` (mm)."""
    count = max(1, round(length / nominal))
    return count, length / count


def _copied(points: Array, k: int, middle: float, edge: float, length: float) -> Array:
    """The points (n, 3) mirrored and shifted to the k-th half cell; k = -1 stands for the far end piece."""
    copied = points.copy()
    if k < 0:
        copied[:, 0] = length - points[:, 0]
    else:
        shift = 2 * (edge - middle) * (k // 2)
        copied[:, 0] = shift + (2 * edge - points[:, 0] if k % 2 else points[:, 0])
    return copied


def _cut(solid: SolidMesh, region: str) -> _Region:
    """One region of the solid with the walls that belong to it."""
    tets = solid.regions[region]
    used, local = np.unique(tets, return_inverse=True)
    new = np.full(len(solid.points), -1)
    new[used] = np.arange(len(used))
    walls = {name: new[triangles] for name, triangles in solid.walls.items()}
    return _Region(
        solid.points[used],
        local.reshape(tets.shape),
        {name: triangles[(triangles >= 0).all(axis=1)] for name, triangles in walls.items()},
        used,
        solid.curved.renumbered(new),
    )


def name_faces(
    points: Array,
    tets: Index,
    walls: Mapping[str, Index],
    planes: Mapping[str, tuple[int, float]],
    curved: CurvedEdges = NO_CURVED_EDGES,
) -> Mesh:
    """The mesh whose boundary triangles are named by the air they touch, else by the plane they lie in, else `outer`.

    points (n, 3), mm; tets (m, 4); walls: name of the air -> (k, 3) triangles, interior ones are ignored; planes:
    name -> (axis, position in mm). A name without triangles is left out.
    """
    boundary = Mesh(points, tets, {}).boundary
    free = np.ones(len(boundary), dtype=bool)
    tolerance = 1e-9 * np.ptp(points, axis=0).max()
    air: dict[str, Index] = {}
    for name, triangles in walls.items():
        rows = find_rows(triangles, boundary, len(points))
        rows = rows[rows >= 0]
        air[name] = boundary[rows]
        free[rows] = False
    flat: dict[str, Index] = {}
    for name, (axis, position) in planes.items():
        on_plane = (np.abs(points[boundary][:, :, axis] - position) < tolerance).all(axis=1) & free
        flat[name] = boundary[on_plane]
        free &= ~on_plane
    faces = flat | air | {"outer": boundary[free]}
    return Mesh(points, tets, {name: triangles for name, triangles in faces.items() if len(triangles)}, curved)
