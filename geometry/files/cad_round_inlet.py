"""Inlets of a CAD file whose mouth is in a round face; in a session of `geometry.meshing.solid`.

The walls of such an inlet are removed, and the faces that they meet outside and in the cavity are extended until these
are whole again (Gmsh's defeaturing), so that the plug ends in both faces whatever their shapes are.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.files.cad_channel import LONG, plane_of
from geometry.files.cad_defeature import Faces, without_faces
from geometry.files.cad_import import Point, is_in_material
from geometry.meshing.shapes import Volume

#: faces of a solid that are tried as the first wall of an inlet, the smallest ones
TRIED = 4
#: how often neighbours of walls are taken for walls as well: ledges and bores of a stepped inlet, parts of a bore
ROUNDS = 5
#: size of a neighbour over that of the mouth, up to which it is a ledge or a part of a bore
LEDGE = 1.2
#: by how much the volume of a plug may exceed that of a bore as wide as its mouth with the same walls
EXCESS = 0.05


@dataclass(frozen=True)
class Closed:
    """A body of which an inlet was closed."""

    solids: list[Volume]
    depth: float  #: volume of the plug over the area of the mouth, mm
    box: Array  #: corners (2, 3) of the box around the inlet, mm


@dataclass(frozen=True)
class _Inlet:
    """Faces of a solid that may be all walls of an inlet."""

    faces: Faces
    walls: frozenset[int]
    point: Array  #: (3,) in its mouth
    near: float  #: mm, accuracy of the point
    is_half: bool  #: whether its solid is one half, z >= 0

    @cached_property
    def mouth(self) -> Array | None:
        """Corners (2, 3) of the smallest box around a closed line of the edge of the walls in which the point lies, mm;
        None without such a line, or where only flat faces meet it."""
        boxes = [self._box(line) for line in self._lines() if not self._is_flat(line)]
        around = [
            box for box in boxes if ((box[0] - self.near <= self.point) & (self.point <= box[1] + self.near)).all()
        ]
        return min(around, key=_size, default=None)

    @property
    def grown(self) -> "_Inlet":
        """With the neighbours that are no larger than the mouth, or with the smallest one where there are none."""
        beside = [face for face in self.faces.tags if face not in self.walls and self.faces.touch(face, self.walls)]
        size = 0.0 if self.mouth is None else LEDGE * _size(self.mouth)
        ledges = [face for face in beside if _size(self.faces.box(face)) <= size]
        more = ledges or sorted(beside, key=self.faces.area)[:1]
        return _Inlet(self.faces, self.walls.union(more), self.point, self.near, self.is_half)

    @property
    def is_plausible(self) -> bool:
        """Whether its walls are not larger than those of a bore as wide as the mouth and `LONG` times as long."""
        mouth = self.mouth
        return mouth is not None and self._area <= LONG * 4.0 * pi * _radius(mouth) ** 2

    @cached_property
    def _area(self) -> float:
        return sum(self.faces.area(wall) for wall in self.walls)

    def closed(self) -> Closed | None:
        """The solid with the walls removed, in place of it; None, and the solid as it was, where that fails, or leaves
        the inlet open, or closes more than an inlet."""
        if not self.is_plausible or (mouth := self.mouth) is None:
            return None
        gmsh, plugs = self.faces.gmsh, list[float]()
        radius, area, within = _radius(mouth), self._area, self._middle(mouth)
        boxes = np.array([self.faces.box(wall) for wall in self.walls])

        def is_closed(result: Volume) -> bool:
            plugs.append(_added(gmsh, result, self.faces.volume))
            most = (1.0 + EXCESS) * 0.5 * radius * area
            return 0.0 < plugs[-1] <= most and is_in_material(gmsh, [result], within)

        result = without_faces(self.faces, self.walls, is_closed)
        if result is None:
            return None
        depth = plugs[-1] / (pi * radius**2) * (2.0 if self._is_cut(mouth) else 1.0)
        return Closed([result], depth, np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)]))

    def _middle(self, mouth: Array) -> Point:
        """The centre of the walls: in the middle of a bore."""
        areas = [self.faces.area(wall) for wall in self.walls]
        x, y, z = np.average([self.faces.middle(wall) for wall in self.walls], axis=0, weights=areas)
        return (float(x), float(y), 1e-3 * _radius(mouth) if self._is_cut(mouth) else float(z))

    def _lines(self) -> Iterator[set[int]]:
        """Sets of connected curves between walls and other faces, outside of the plane of symmetry of a half."""
        curves = self.faces.curves
        others = {c for face in curves.keys() - self.walls if not self._in_middle(face) for c in curves[face]}
        left = {curve for wall in self.walls for curve in curves[wall]} & others
        while left:
            line, front = set[int](), {min(left)}
            while front:
                line |= front
                left -= front
                ends = {end for curve in front for end in self._ends(curve)}
                front = {curve for curve in left if ends & self._ends(curve)}
            yield line

    def _in_middle(self, face: int) -> bool:
        """Whether a face lies in the plane z = 0 of a half, which cuts mouths without being a part of their edges."""
        return self.is_half and bool(self.faces.box(face)[1, 2] <= self.near)

    def _ends(self, curve: int) -> set[int]:
        return {int(tag) for _, tag in self.faces.gmsh.model.getBoundary([(1, curve)], combined=False, oriented=False)}

    def _is_flat(self, line: set[int]) -> bool:
        """Whether only flat faces meet the walls at a line."""
        beside = [face for face in self.faces.tags if face not in self.walls and self.faces.curves[face].keys() & line]
        return all(plane_of(self.faces.gmsh, (2, face)) is not None for face in beside)

    def _box(self, line: set[int]) -> Array:
        boxes = np.array([self.faces.gmsh.model.occ.getBoundingBox(1, curve) for curve in line])
        box = np.array([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])
        box[0, 2] = -box[1, 2] if self._is_cut(box) else box[0, 2]
        return box

    def _is_cut(self, box: Array) -> bool:
        """Whether the other half of what is in a box (2, 3) lies in z < 0, where no solid is."""
        return self.is_half and bool(box[0, 2] <= self.near)


def close_round_inlet(gmsh: Any, solids: list[Volume], point: Point, near: float, is_half: bool) -> Closed | None:
    """The solids with the inlet filled in whose mouth a point lies, up to a distance `near` (mm) of the box around it.

    None where there is no such inlet in a round face, or none that Gmsh can close. is_half: whether they are z >= 0.
    """
    for solid in solids:
        faces = Faces(gmsh, solid)
        inlets = [_Inlet(faces, walls, np.array(point), near, is_half) for walls in _first_walls(faces)]
        inlets = [inlet for inlet in inlets if inlet.is_plausible]
        for inlet in sorted(inlets, key=lambda inlet: max(_size(faces.box(wall)) for wall in inlet.walls))[:TRIED]:
            for _ in range(ROUNDS):
                if (closed := inlet.closed()) is not None:
                    return Closed([*closed.solids, *(s for s in solids if s != solid)], closed.depth, closed.box)
                inlet = inlet.grown
    return None


def _added(gmsh: Any, result: Volume, before: Volume) -> float:
    """Volume of what a solid has in addition to what it was, mm3: the mass of mirrored solids, whose faces are splines,
    is not accurate enough for a difference."""
    occ = gmsh.model.occ
    parts, _ = occ.cut(occ.copy([result]), [before], removeObject=True, removeTool=False)
    volume = sum(float(occ.getMass(*part)) for part in parts if part[0] == 3)
    occ.remove(parts, recursive=True)
    return volume


def _first_walls(faces: Faces) -> Iterator[frozenset[int]]:
    """Each face alone, and all faces around each hole of a round face."""
    for face in faces.tags:
        yield frozenset([face])
        if plane_of(faces.gmsh, (2, face)) is None:
            for loop in faces.gmsh.model.occ.getCurveLoops(face)[1]:
                beside = (other for other in faces.tags if other != face and faces.curves[other].keys() & set(loop))
                yield frozenset(beside)


def _radius(box: Array) -> float:
    """Of a circle in a box (2, 3), mm: 8**-0.5 of the diagonal of the box, however the circle is turned."""
    return _size(box) / 8**0.5


def _size(box: Array) -> float:
    """Diagonal of a box (2, 3), mm."""
    return float(np.linalg.norm(box[1] - box[0]))
