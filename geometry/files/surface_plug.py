"""Inlets of a surface that are filled with the material of the body.

The mouth of an inlet is a hole in a flat face of the surface. Its channel is the wall behind the rim of the hole, a
smooth one or all flat sides there. Where that ends at a flat ring the channel goes on with the wall behind the ring,
where the next wall does not lead outward with that, and at a bottom it has ended. Where all these are left out and the
ends are closed, the channel is filled up to where it becomes wider.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import cos, pi

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.errors import DesignError
from geometry.files.cad_import import Point
from geometry.files.cad_plug import NEAR
from geometry.files.fill import EDGE
from geometry.files.surface import Surface, of_parts
from geometry.topology import normals, parts_of_graph, row_keys, triangle_edges

#: cosine of the angle between triangles of one patch
SMOOTH = cos(EDGE)
#: cosine of the largest angle between the surface behind the end of a channel and the way outward from its middle at
#: which it becomes wider
OPENS = 0.3


def plugged(surface: Surface, plugs: Mapping[str, Point]) -> tuple[Surface, dict[str, float]]:
    """The surface with the inlets filled in whose mouths the points (mm) lie, and how deep each is, mm.

    Raises `DesignError` with the key plug.NAME for a point that lies in no mouth, `MeshError` where what is left is no
    body.
    """
    depths = {}
    for name, point in plugs.items():
        filled = _filled(surface.points, surface.triangles, np.array(point))
        if filled is None:
            coordinates = "(" + ", ".join(f"{x:g}" for x in point) + ") mm"
            raise DesignError(
                f"plug.{name}",
                f"the point {coordinates} lies in no hole of a flat face behind which a channel (of smooth walls or "
                "flat sides) goes to a bottom or to where all of it becomes wider; give a point in the mouth of the "
                "inlet, or close it in the CAD program",
            )
        points, triangles, depths[name] = filled
        surface = of_parts(points, triangles)
    return surface, depths


def _filled(points: Array, triangles: Index, at: Array) -> tuple[Array, Index, float] | None:
    """Points and triangles without the channel behind the mouth in which a point (3,) lies, and its depth."""
    patches = _Patches.of(points, triangles)
    for normal, rim in patches.mouths(at, NEAR * float(np.ptp(points, axis=0).max())):
        channel = patches.channel(rim)
        if channel is None:
            continue
        centres = np.array([points[patches.edges[end, 0]].mean(axis=0) for end in channel.ends])
        kept = [triangles[~channel.walls]]
        for k, end in enumerate(channel.ends):  # in the direction of the edges of the wall, which they replace
            kept.append(np.column_stack([patches.edges[end], np.full(len(end), len(points) + k)]))
        return np.vstack([points, centres]), np.vstack(kept), abs(float((channel.middle - centres[0]) @ normal))
    return None


@dataclass(frozen=True, eq=False)
class _Channel:
    """What is left out of a surface where an inlet is filled."""

    walls: Mask  #: (k,) of the triangles, whether they are left out
    ends: list[Index]  #: the rims of its walls that are to be closed
    middle: Array  #: (3,) of its end


@dataclass(frozen=True, eq=False)
class _Patches:
    """The triangles of a closed surface, sorted into smooth patches."""

    points: Array  #: (n, 3)
    edges: Index  #: (3 k, 2) directed edges, triangle after triangle
    across: Index  #: (3 k,) the triangle on the other side of each edge
    number: Index  #: (k,) of the patch of each triangle
    normals: Array  #: (k, 3), unit vectors

    @staticmethod
    def of(points: Array, triangles: Index) -> "_Patches":
        """Those of a surface in which each edge belongs to two triangles."""
        edges = triangle_edges(triangles)
        pairs = np.argsort(row_keys(edges, len(points)), kind="stable").reshape(-1, 2)
        across = np.empty(len(edges), dtype=np.int64)
        across[pairs] = pairs[:, ::-1] // 3
        facing = normals(points[triangles])
        facing /= np.maximum(np.linalg.norm(facing, axis=1), np.finfo(float).tiny)[:, None]
        own = np.arange(len(edges)) // 3
        smooth = np.einsum("ij,ij->i", facing[own], facing[across]) > SMOOTH
        number = parts_of_graph(len(triangles), np.column_stack([own[smooth], across[smooth]]))
        return _Patches(points, edges, across, number, facing)

    def rims(self, patch: int) -> list[Index]:
        """The closed rims of a patch, each the rows of its edges one after the other."""
        own = np.repeat(self.number, 3)
        rows = np.flatnonzero((own == patch) & (self.number[self.across] != patch))
        following = {int(self.edges[row, 0]): int(row) for row in rows}
        rims = []
        while following:
            start, row = following.popitem()
            rim = [row]
            while (end := int(self.edges[rim[-1], 1])) != start and end in following:
                rim.append(following.pop(end))
            rims.append(np.array(rim))
        return rims

    def mouths(self, at: Array, near: float) -> Iterator[tuple[Array, Index]]:
        """The normal (3,) of each flat patch in whose plane a point (3,) lies, and the rim of the hole around it."""
        for patch in np.unique(self.number):
            normal = self._normal_if_flat(int(patch), at, near)
            if normal is None:
                continue
            for rim in self.rims(int(patch)):
                if self._turn(rim, at, normal) < -pi:  # the rim of a hole runs clockwise
                    yield normal, rim

    def channel(self, rim: Index) -> _Channel | None:
        """The channel behind the rim of a mouth; None where it is not one wall after the other, each smooth or of flat
        sides, up to a bottom or to where all of it becomes wider."""
        patches, walls, ends = self, np.zeros(len(self.number), dtype=bool), list[Index]()
        mouth = self.points[self.edges[rim, 0]].mean(axis=0)
        while True:
            patches, wall = patches._with_one_wall(rim)
            if walls[patches.number == wall].any():
                return None
            here, others = patches._parted(wall, rim)
            if len(others) != 1:
                return None
            walls = walls | (patches.number == wall)
            ends = ends or [here]
            (rim,) = others
            middle = self.points[self.edges[rim, 0]].mean(axis=0)
            ring = patches._behind(rim)
            if ring is not None and patches._narrows(ring, rim, middle):
                walls = walls | (patches.number == ring)
                _, holes = patches._parted(ring, rim)
                if not holes:  # a bottom
                    return _Channel(walls, ends, middle)
                if len(holes) > 1:
                    return None
                (rim,) = holes
                continue
            opens = self._opens(rim, middle, middle - mouth)
            if opens.all():
                return _Channel(walls, [*ends, rim], middle)
            if opens.any():  # one of its sides goes on as a wall of the cavity
                return None

    def _with_one_wall(self, rim: Index) -> "tuple[_Patches, int]":
        """The same with the patches behind a rim as one, and its number."""
        sides = np.unique(self.number[self.across[rim]])
        number = np.where(np.isin(self.number, sides), sides[0], self.number)
        return (self if len(sides) == 1 else replace(self, number=number)), int(sides[0])

    def _opens(self, rim: Index, middle: Array, axis: Array) -> Mask:
        """Whether the surface behind each edge of a rim around a point (3,) turns away from the axis (3,), (e,)."""
        start, stop = (self.points[self.edges[rim, k]] for k in (0, 1))
        triangles = self.edges.reshape(-1, 3, 2)[self.across[rim], :, 0]
        third = self.points[triangles].sum(axis=1) - start - stop
        along = stop - start
        outward, behind = (start + stop) / 2 - middle, third - start
        outward = _without_part(outward, np.broadcast_to(axis, outward.shape))
        outward, behind = _without_part(outward, along), _without_part(behind, along)
        size = np.linalg.norm(outward, axis=1) * np.linalg.norm(behind, axis=1)
        return np.asarray(np.einsum("ij,ij->i", outward, behind) > OPENS * size)

    def _behind(self, rim: Index) -> int | None:
        """The patch on the other side of a rim; None where there are several."""
        behind = np.unique(self.number[self.across[rim]])
        return int(behind[0]) if len(behind) == 1 else None

    def _parted(self, patch: int, rim: Index) -> tuple[Index, list[Index]]:
        """The rim of a patch along the rim of its neighbour, and its other rims."""
        shared = set(map(tuple, self.edges[rim, ::-1].tolist()))
        rims = self.rims(patch)
        along = [other for other in rims if tuple(self.edges[other[0]].tolist()) in shared]
        return along[0], [other for other in rims if other is not along[0]]

    def _narrows(self, patch: int, rim: Index, middle: Array) -> bool:
        """Whether a patch is flat and lies within the rim of its neighbour: a bottom, or the ring of a step."""
        size = float(np.linalg.norm(self.points[self.edges[rim, 0]] - middle, axis=1).max())
        normal = self._normal_if_flat(patch, middle, NEAR * size)
        return normal is not None and self._turn(self._parted(patch, rim)[0], middle, normal) > pi

    def _normal_if_flat(self, patch: int, at: Array, near: float) -> Array | None:
        """The normal (3,) of a patch that lies in one plane with a point (3,)."""
        rows = np.flatnonzero(self.number == patch)
        normal = self.normals[rows].mean(axis=0)
        corners = self.points[self.edges.reshape(-1, 3, 2)[rows, :, 0]].reshape(-1, 3)
        return normal if np.abs((corners - at) @ normal).max() <= near else None

    def _turn(self, rim: Index, at: Array, normal: Array) -> float:
        """The angle by which a rim runs around a point (3,), seen against the normal, rad."""
        start, stop = self.points[self.edges[rim, 0]] - at, self.points[self.edges[rim, 1]] - at
        sine, cosine = np.cross(start, stop) @ normal, np.einsum("ij,ij->i", start, stop)
        return float(np.arctan2(sine, cosine).sum())


def _without_part(vectors: Array, directions: Array) -> Array:
    """Vectors (n, 3) without their parts along directions (n, 3)."""
    part = np.einsum("ij,ij->i", vectors, directions) / np.einsum("ij,ij->i", directions, directions)
    return np.asarray(vectors - part[:, None] * directions)
