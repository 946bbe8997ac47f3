"""Inlets of a surface of triangles that are filled with the material of the body.

The mouth of an inlet is a hole in a flat face, outside or in a cavity. The walls that meet its rim are taken out of the
surface, and triangles span both of their ends. What is not closed then is left to the CAD program.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import cos, radians

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.errors import position_text
from geometry.files.frame import Point
from geometry.files.shells import NEAR_MOUTH, WIDER, diagonal, no_mouth, smallest_around
from geometry.files.surface.triangles import Surface, of_parts
from geometry.topology import normals, parts_of_graph, row_keys, triangle_edges

#: triangles that are turned against each other by less belong to one face
SMOOTH = cos(radians(30))


@dataclass(frozen=True, eq=False)
class _Mouth:
    """A hole in a flat patch of a surface."""

    rim: Index  #: (e,) rows of the edges of the patch around it, one after the other
    box: Array  #: corners (2, 3) of the box around its rim, mm


@dataclass(frozen=True, eq=False)
class _Patches:
    """The triangles of a closed surface, sorted into smooth patches."""

    points: Array  #: (n, 3)
    edges: Index  #: (3 k, 2) directed edges, triangle after triangle
    across: Index  #: (3 k,) the triangle on the other side of each edge
    number: Index  #: (k,) of the patch of each triangle
    normals: Array  #: (k, 3) twice the area long

    @staticmethod
    def of(surface: Surface) -> "_Patches":
        """The inlets of a surface."""
        points, triangles = surface.points, surface.triangles
        edges = triangle_edges(triangles)
        pairs = np.argsort(row_keys(edges, len(points)), kind="stable").reshape(-1, 2)
        across = np.empty(len(edges), dtype=np.int64)
        across[pairs] = pairs[:, ::-1] // 3
        own, facing = np.arange(len(edges)) // 3, normals(points[triangles])
        units = facing / np.maximum(np.linalg.norm(facing, axis=1), np.finfo(float).tiny)[:, None]
        smooth = np.einsum("ij,ij->i", units[own], units[across]) > SMOOTH
        number = parts_of_graph(len(triangles), np.column_stack([own[smooth], across[smooth]]))
        return _Patches(points, edges, across, number, facing)

    def triangles(self, chosen: Mask) -> Index:
        """Chosen triangles (k,) as vertices (c, 3)."""
        return np.asarray(self.edges.reshape(-1, 3, 2)[chosen, :, 0])

    def mouths(self, chosen: Mask) -> list[_Mouth]:
        """The closed rims of chosen triangles (k,), the largest last."""
        rows = np.flatnonzero(np.repeat(chosen, 3) & ~chosen[self.across])
        following = {int(self.edges[row, 0]): int(row) for row in rows}
        mouths = []
        while following:
            start, row = following.popitem()
            rim = [row]
            while (end := int(self.edges[rim[-1], 1])) != start and end in following:
                rim.append(following.pop(end))
            corners = self.points[self.edges[rim, 0]]
            mouths.append(_Mouth(np.array(rim), np.array([corners.min(axis=0), corners.max(axis=0)])))
        return sorted(mouths, key=lambda mouth: diagonal(mouth.box))

    def around(self, at: Point, near: float) -> Iterator[_Mouth]:
        """The holes in flat patches in whose plane a point lies, to a distance in mm."""
        for patch in range(int(self.number.max()) + 1):
            chosen = self.number == patch
            normal = self.normals[chosen].sum(axis=0)
            corners = self.points[self.triangles(chosen)].reshape(-1, 3)
            if np.abs((corners - at) @ normal).max() <= near * np.linalg.norm(normal):
                yield from self.mouths(chosen)[:-1]

    def filled(self, mouth: _Mouth) -> tuple[Surface, float] | None:
        """The surface without the walls behind a mouth, and their mean length, mm; None where it does not close."""
        walls = np.isin(self.number, np.unique(self.number[self.across[mouth.rim]]))
        ends = self.mouths(walls)
        if len(ends) != 2 or diagonal(ends[1].box) > WIDER * diagonal(mouth.box):
            return None
        points = np.vstack([self.points, *(self.points[self.edges[end.rim, 0]].mean(axis=0) for end in ends)])
        kept = [self.triangles(~walls)]
        for k, end in enumerate(ends):  # in the direction of the edges of the walls, which they replace
            kept.append(np.column_stack([self.edges[end.rim], np.full(len(end.rim), len(self.points) + k)]))
        start, stop = self.points[self.edges[mouth.rim].T]
        area = float(np.linalg.norm(self.normals[walls], axis=1).sum()) / 2
        return of_parts(points, np.vstack(kept)), area / float(np.linalg.norm(stop - start, axis=1).sum())


def fill_surface_inlets(surface: Surface, plugs: Mapping[str, Point]) -> tuple[Surface, dict[str, float]]:
    """The surface with the inlets filled in whose mouths the points (mm) lie, and how deep each plug is, mm.

    Raises `DesignError` with the key plug.NAME, and `MeshError` where what is left is no body.
    """
    depths = {}
    near = NEAR_MOUTH * float(np.ptp(surface.points, axis=0).max())
    for name, point in plugs.items():
        patches = _Patches.of(surface)
        mouth = smallest_around(patches.around(point, near), point, near)
        result = None if mouth is None else patches.filled(mouth)
        if result is None:
            raise no_mouth(name, position_text(point, "g"))
        surface, depths[name] = result
    return surface, depths
