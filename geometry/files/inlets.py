"""Inlets that are filled with the material of the body.

The mouth of an inlet is a hole in a flat face, outside or in a cavity. The walls that meet its rim are taken out of the
boundary of the body, which is closed at both of their ends: in a drawing the faces beside them are extended (Gmsh's
defeaturing), in a surface triangles span the rims. What is not closed then (mouths in round faces, stepped and
countersunk bores, channels with a wall of the cavity) is left to the CAD program.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from math import cos, pi, radians
from typing import Any, Protocol, TypeVar

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.errors import DesignError, position_text
from geometry.files.cad_defeature import Faces, without_faces
from geometry.files.cad_import import CadBody, bounds, is_in_material
from geometry.files.frame import Point
from geometry.files.surface import Surface, of_parts
from geometry.meshing.shapes import Volume
from geometry.topology import normals, parts_of_graph, row_keys, triangle_edges

#: distance of a point from its mouth, over the size of the body: points are read off the screen
NEAR = 1e-3
#: distance from a plane of points that lie in it, over their distance from each other
FLAT = 1e-5
#: triangles that are turned against each other by less belong to one face
SMOOTH = cos(radians(30))
#: size of the other end of a channel over that of its mouth from which the channel is a part of the cavity
WIDER = 1.6
#: openings that are listed
LISTED = 4


class _Mouth(Protocol):
    @property
    def box(self) -> Array:
        """Corners (2, 3) of the box around the rim, mm."""


Mouth = TypeVar("Mouth", bound=_Mouth)


def _around(mouths: Iterable[Mouth], point: Point, near: float) -> Mouth | None:
    """The smallest mouth in whose box a point lies, to a distance in mm."""
    around = [mouth for mouth in mouths if _holds(mouth.box, point, near)]
    return min(around, key=lambda mouth: _size(mouth.box), default=None)


def _holds(box: Array, point: Point, near: float) -> bool:
    return bool(((box[0] - near <= point) & (point <= box[1] + near)).all())


def _size(box: Array) -> float:
    """Diagonal of a box (2, 3), mm."""
    return float(np.linalg.norm(box[1] - box[0]))


def _refusal(name: str, point: str, advice: str = "") -> DesignError:
    where = f"the point {point} is in no hole of a flat face behind which one wall leads to the air"
    return DesignError(f"plug.{name}", f"{where}; close it in CAD{advice}")


@dataclass(frozen=True)
class _CadMouth:
    """A hole in a flat face of a solid."""

    faces: Faces
    walls: frozenset[int]  #: faces of the solid that meet its rim
    box: Array
    rim: float  #: length, mm
    normal: Array  #: (3,) across the mouth

    def filled(self) -> tuple[Volume, float] | None:
        """The solid with the inlet filled, in place of it, and the mean length of the walls, mm; None, and the solid as
        it was, where that fails."""
        occ, volume = self.faces.gmsh.model.occ, self.faces.volume
        areas = [self.faces.area(wall) for wall in self.walls]
        middle = np.average([self.faces.middle(wall) for wall in self.walls], axis=0, weights=areas)
        depth = sum(areas) / self.rim
        largest = WIDER**2 * depth * self.rim**2 / (4 * pi)  # of a round prism with its rim and walls
        before = float(occ.getMass(*volume))

        def is_filled(result: Volume) -> bool:
            added = float(occ.getMass(*result)) - before
            return added <= largest and is_in_material(self.faces.gmsh, [result], middle)

        result = without_faces(self.faces, self.walls, is_filled)
        return None if result is None else (result, depth)


def _cad_mouths(gmsh: Any, solids: Iterable[Volume]) -> Iterator[_CadMouth]:
    occ = gmsh.model.occ
    for solid in solids:
        faces = Faces(gmsh, solid)
        for face in faces.tags:
            plane = plane_of(gmsh, face)
            loops = occ.getCurveLoops(face)[1] if plane else []
            if plane is None or len(loops) < 2:
                continue
            lengths = [sum(float(occ.getMass(1, curve)) for curve in loop) for loop in loops]
            for loop, length in zip(loops, lengths, strict=True):
                if length == max(lengths):  # the edge of the face itself
                    continue
                walls = frozenset(f for f in faces.tags if f != face and faces.curves[f].keys() & set(loop))
                boxes = np.array([occ.getBoundingBox(1, curve) for curve in loop])
                box = np.array([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])
                yield _CadMouth(faces, walls, box, length, plane[1])


def fill_cad_inlets(gmsh: Any, body: CadBody, solids: list[Volume]) -> tuple[list[Volume], dict[str, float]]:
    """The solids with their inlets filled, and how deep each plug is, mm.

    Of a symmetric body the mirror image of an inlet is filled as well. Raises `DesignError` with the key plug.NAME.
    """
    depths: dict[str, float] = {}
    filled: dict[str, list[Array]] = {}
    near = NEAR * _size(np.array(bounds(gmsh, solids))) if body.plugs else 0.0
    for name, (x, y, z) in body.plugs.items():
        for point in dict.fromkeys([(x, y, z), (x, y, -z)] if body.half else [(x, y, z)]):
            mouth = _around(_cad_mouths(gmsh, solids), point, near)
            if mouth is not None and (result := mouth.filled()) is not None:
                solids = [result[0], *(solid for solid in solids if solid != mouth.faces.volume)]
                depths[name] = result[1]
                filled.setdefault(name, []).append(mouth.box)
        known = (other for other, boxes in filled.items() if any(_holds(box, (x, y, z), near) for box in boxes))
        if name not in depths and (other := next(known, "")):
            depths[name] = depths[other]
        if name not in depths:
            raise _refusal(name, body.words(body.plugs[name]), hole_advice(gmsh, body, solids))
    return solids, depths


def hole_advice(gmsh: Any, body: CadBody, solids: list[Volume]) -> str:
    """Where holes in flat faces are, as the end of a sentence, the largest first; empty where there is none."""

    def is_open(mouth: _CadMouth) -> bool:
        """Whether no other part of the body stands on the face there."""
        aside = 1e-3 * mouth.rim * mouth.normal
        sides = (mouth.box.mean(axis=0) + side * aside for side in (1, -1))
        return not all(is_in_material(gmsh, solids, side) for side in sides)

    mouths = filter(is_open, sorted(_cad_mouths(gmsh, solids), key=lambda mouth: -mouth.rim))
    centres = (mouth.box.mean(axis=0).round(6) for mouth in islice(mouths, LISTED))
    listed = ", ".join(body.words((float(x), float(y), float(z)), ".6") for x, y, z in centres)
    return f"; holes in flat faces have their centres at {listed}" if listed else ""


def plane_of(gmsh: Any, face: int) -> tuple[Array, Array] | None:
    """A point (3,), mm, and the unit normal (3,) of a flat face; None for a curved one."""
    low, high = (np.array(end) for end in gmsh.model.getParametrizationBounds(2, face))
    parts = np.linspace(0.05, 0.95, 4)
    at = np.array([low + (high - low) * [u, v] for u in parts for v in parts])
    points = np.reshape(gmsh.model.getValue(2, face, at.ravel()), (-1, 3))
    normal = np.array(gmsh.model.getNormal(face, at[0]))
    away = np.abs((points - points[0]) @ normal).max()
    return (points[0], normal) if away < FLAT * np.ptp(points, axis=0).max() else None


@dataclass(frozen=True, eq=False)
class _SurfaceMouth:
    """A hole in a flat patch of a surface."""

    rim: Index  #: (e,) rows of the edges of the patch around it, one after the other
    box: Array


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
        """Those of a surface."""
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

    def rims(self, chosen: Mask) -> list[Index]:
        """The closed rims of chosen triangles (k,), each the rows of its edges one after the other."""
        rows = np.flatnonzero(np.repeat(chosen, 3) & ~chosen[self.across])
        following = {int(self.edges[row, 0]): int(row) for row in rows}
        rims = []
        while following:
            start, row = following.popitem()
            rim = [row]
            while (end := int(self.edges[rim[-1], 1])) != start and end in following:
                rim.append(following.pop(end))
            rims.append(np.array(rim))
        return rims

    def box(self, rim: Index) -> Array:
        """Corners (2, 3) of the box around a rim."""
        corners = self.points[self.edges[rim, 0]]
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    def mouths(self, at: Point, near: float) -> Iterator[_SurfaceMouth]:
        """The holes in flat patches in whose plane a point lies, to a distance in mm."""
        for patch in range(int(self.number.max()) + 1):
            chosen = self.number == patch
            normal = self.normals[chosen].sum(axis=0)
            corners = self.points[self.edges.reshape(-1, 3, 2)[chosen, :, 0]].reshape(-1, 3)
            if np.abs((corners - at) @ normal).max() <= near * np.linalg.norm(normal):
                rims = sorted(self.rims(chosen), key=lambda rim: _size(self.box(rim)))
                yield from (_SurfaceMouth(rim, self.box(rim)) for rim in rims[:-1])

    def filled(self, mouth: _SurfaceMouth) -> tuple[Surface, float] | None:
        """The surface without the walls behind a mouth, and their mean length, mm; None where it does not close."""
        walls = np.isin(self.number, np.unique(self.number[self.across[mouth.rim]]))
        area = float(np.linalg.norm(self.normals[walls], axis=1).sum()) / 2
        rims = self.rims(walls)
        for rim in rims if len(rims) == 2 else []:
            ring = np.isin(self.number, np.unique(self.number[self.across[rim]]))
            corners = self.points[self.edges.reshape(-1, 3, 2)[ring, :, 0]].reshape(-1, 3)
            if np.linalg.norm(np.ptp(corners, axis=0)) < (1 + NEAR) * _size(self.box(rim)):  # the ring of a step
                walls |= ring
        rims = self.rims(walls)
        if len(rims) != 2 or max(_size(self.box(rim)) for rim in rims) > WIDER * _size(mouth.box):
            return None
        points = np.vstack([self.points, *(self.points[self.edges[rim, 0]].mean(axis=0) for rim in rims)])
        kept = [self.edges.reshape(-1, 3, 2)[~walls, :, 0]]
        for k, rim in enumerate(rims):  # in the direction of the edges of the walls, which they replace
            kept.append(np.column_stack([self.edges[rim], np.full(len(rim), len(self.points) + k)]))
        start, stop = self.points[self.edges[mouth.rim].T]
        length = float(np.linalg.norm(stop - start, axis=1).sum())
        return of_parts(points, np.vstack(kept)), area / length


def fill_surface_inlets(surface: Surface, plugs: Mapping[str, Point]) -> tuple[Surface, dict[str, float]]:
    """The surface with the inlets filled in whose mouths the points (mm) lie, and how deep each plug is, mm.

    Raises `DesignError` with the key plug.NAME, and `MeshError` where what is left is no body.
    """
    depths = {}
    near = NEAR * float(np.ptp(surface.points, axis=0).max())
    for name, point in plugs.items():
        patches = _Patches.of(surface)
        mouth = _around(patches.mouths(point, near), point, near)
        result = None if mouth is None else patches.filled(mouth)
        if result is None:
            raise _refusal(name, position_text(point, "g"))
        surface, depths[name] = result
    return surface, depths
