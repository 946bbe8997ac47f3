"""How deep a channel behind a hole in a flat face is filled; in a session of `geometry.meshing.solid`.

The channel is followed by its sections with planes parallel to the hole, in a cylinder around it.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import pi, sqrt
from typing import Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.meshing.shapes import Volume

#: (2, tag), as Gmsh identifies a face
Face: TypeAlias = tuple[int, int]

#: length of a channel that is filled up to where it becomes wider, over the width of its mouth, and of one that has a
#: bottom, which may be the cavity itself
LONG, LONG_WITH_BOTTOM = 10.0, 2.0
#: sections in each part of a channel that is as long as wide
SECTIONS = 8
#: area of a section over the smallest before it from which the channel has become wider
WIDER = 3.0
#: reach of a section about the middle of the mouth, over that of the mouth, from which it has as well
REACH = 1.6
#: radius of the cylinder in which it is followed, over that reach
AROUND = 2.0
#: way of the middle of the sections aside, over the reach of the mouth, from which a channel may run obliquely
ASIDE = 0.3
#: accuracy of the depth, and distance from a plane parallel to the mouth within which a plug ends there, over the width
ACCURACY, AT_PLANE = 1e-4, 1e-3
#: smallest depth of a plug, over the width
SHALLOWEST = 1e-3
#: what is left open before a ceiling that is not parallel to the mouth, over the width: without it elements are flat
RECESS = 0.1
#: distance from a plane of points that lie in it, over their distance from each other
FLAT = 1e-5


@dataclass(frozen=True)
class Mouth:
    """A hole in a flat face; lengths in mm."""

    at: Array  #: a point (3,) in it
    normal: Array  #: unit vector (3,) across it
    middle: Array  #: of its bounding box, (3,)
    reach: float  #: half the diagonal of this box
    area: float  #: mm2
    is_half: bool  #: whether its other half lies in z < 0, where no body is; measures are those of both

    @property
    def width(self) -> float:
        """Diameter of the circle with its area."""
        return 2 * sqrt(self.area / pi)


@dataclass(frozen=True)
class _Section:
    depth: float  #: mm
    faces: list[Face]  #: one, or several where the channel divides
    area: float  #: mm2, of half of it where the mouth is a half
    is_wide: bool  #: whether it reaches far beyond the mouth
    centre: Array  #: of its area, (3,)


@dataclass(frozen=True)
class Channel:
    """What is behind a mouth."""

    gmsh: Any
    solids: list[Volume]
    mouth: Mouth
    inward: Array  #: unit vector (3,), across the mouth
    #: way of its middle along the mouth, over the depth, (3,)
    aside: Array = field(default_factory=lambda: np.zeros(3))

    @cached_property
    def followed(self) -> "Channel":
        """The same, followed obliquely where it leads farther so."""
        _, _, _, aside = self._ends
        if not aside.any():
            return self
        oblique = replace(self, aside=aside)
        return oblique if oblique.depth > self.depth else self

    @cached_property
    def depth(self) -> float:
        """Of the plug, mm: up to where the channel becomes wider or has its bottom, or as deep as wide in a long one; 0
        where it is wider at once."""
        width, (inside, outside, has_bottom, _) = self.mouth.width, self._ends
        if outside is None or (has_bottom and outside > LONG_WITH_BOTTOM * width):
            return width
        near = self._planes[np.abs(self._planes - inside) < AT_PLANE * width]
        if len(near):
            return max(float(near[0]), 0.0)
        if has_bottom:
            return outside + AT_PLANE * width
        return inside - RECESS * width if inside > 2 * RECESS * width else 0.0

    @property
    def is_filled(self) -> bool:
        """Whether it has a plug."""
        return self.depth > SHALLOWEST * self.mouth.width

    def plug(self) -> Volume | None:
        """The air in it, as deep as its plug; None where there is none."""
        occ, mouth = self.gmsh.model.occ, self.mouth
        drawn = self._half([self._cylinder(self.depth)])
        pieces = occ.cut(drawn, self.solids, removeObject=True, removeTool=False)[0]
        at = mouth.at + min(0.5 * self.depth, 0.05 * mouth.width) * self.inward
        plug: Volume | None = occ.getClosestEntities(*at, pieces, 1)[0][0] if pieces else None
        occ.remove([piece for piece in pieces if piece != plug], recursive=True)
        return plug

    @cached_property
    def _planes(self) -> Array:
        """How deep the flat faces of the solids lie that are parallel to the mouth, mm."""
        faces = self.gmsh.model.getBoundary(self.solids, combined=False, oriented=False)
        planes = [plane for face in faces if (plane := plane_of(self.gmsh, face)) is not None]
        return np.array([(on - self.mouth.at) @ self.inward for on, n in planes if abs(n @ self.inward) > 1 - FLAT])

    @cached_property
    def _ends(self) -> tuple[float, float | None, bool, Array]:
        """As `_end`."""
        occ, around = self.gmsh.model.occ, self._around()
        ends = self._end(around)
        occ.remove(around, recursive=True)
        occ.synchronize()
        return ends

    @property
    def _way(self) -> Array:
        """(3,) of its middle, over the depth."""
        return self.inward + self.aside

    def _cylinder(self, depth: float) -> Volume:
        occ, along, radius = self.gmsh.model.occ, depth * self._way, AROUND * self.mouth.reach
        if not self.aside.any():
            return (3, occ.addCylinder(*self.mouth.middle, *along, radius))
        disk = occ.addDisk(*self.mouth.middle, radius, radius, zAxis=list(self.inward))
        return next(part for part in occ.extrude([(2, disk)], *along) if part[0] == 3)

    def _around(self) -> list[Volume]:
        """What of the solids lies around the channel: fewer faces to be cut than all of theirs."""
        occ = self.gmsh.model.occ
        parts = occ.intersect(occ.copy(self.solids), [self._cylinder((LONG + 1) * self.mouth.width)])[0]
        return [part for part in parts if part[0] == 3]

    def _half(self, entities: list[tuple[int, int]]) -> list[tuple[int, int]]:
        """What of them is in z > 0, where the mouth is a half."""
        if not self.mouth.is_half:
            return entities
        return in_front(self.gmsh, entities, self.mouth.middle, 4 * (LONG + AROUND) * self.mouth.reach)

    def _end(self, around: list[Volume]) -> tuple[float, float | None, bool, Array]:
        """The last depth (mm) at which the channel is open and not wider, the first at which it is wider or closed, and
        whether it is closed there; None for a long channel. And the way of its middle aside, over the depth, (3,), zero
        where that is small."""
        width, planes = self.mouth.width, self._planes
        last, smallest = self._section(around, AT_PLANE * width, None), self.mouth.area
        if last is None or self._is_wider(last, smallest):
            self._remove(last)
            return 0.0, 0.0, False, np.zeros(3)
        first = last
        steps = width * (np.arange(LONG * SECTIONS) + 0.637) / SECTIONS  # not in planes of the drawing
        beyond = planes[planes > AT_PLANE * width] + 2 * AT_PLANE * width
        outside, has_bottom = None, False
        for depth in sorted([*steps, *beyond[beyond < LONG * width]]):
            section = self._section(around, float(depth), last)
            if section is None or self._is_wider(section, smallest):
                outside, has_bottom = float(depth), section is None
                self._remove(section)
                break
            self._remove(last)
            last, smallest = section, min(smallest, self._whole(section))
        while outside is not None and outside - last.depth > ACCURACY * width:
            middle = 0.5 * (last.depth + outside)
            section = self._section(around, middle, last)
            if section is None or self._is_wider(section, smallest):
                outside, has_bottom = middle, section is None
                self._remove(section)
            else:
                self._remove(last)
                last = section
        self._remove(last)
        return last.depth, outside, has_bottom, self._aside(first, last)

    def _aside(self, first: _Section, last: _Section) -> Array:
        """The way of the middle from one section to another along the mouth, over the depth between them, (3,); zero
        where that is small."""
        way = last.centre - first.centre
        way = way - (way @ self.inward) * self.inward
        if self.mouth.is_half:
            way[2] = 0.0
        is_small = np.linalg.norm(way) < ASIDE * self.mouth.reach
        return np.zeros(3) if is_small else np.asarray(way / (last.depth - first.depth))

    def _whole(self, section: _Section) -> float:
        """Its area on both sides of z = 0, mm2."""
        return section.area * (2 if self.mouth.is_half else 1)

    def _is_wider(self, section: _Section, smallest: float) -> bool:
        return section.is_wide or self._whole(section) > WIDER * smallest

    def _remove(self, section: _Section | None) -> None:
        self.gmsh.model.occ.remove([] if section is None else section.faces, recursive=True)

    def _section(self, around: list[Volume], depth: float, before: _Section | None) -> _Section | None:
        """The section at a depth that continues the one before, or the mouth; None where the channel is closed."""
        occ, mouth = self.gmsh.model.occ, self.mouth
        middle, radius = mouth.middle + depth * self._way, AROUND * mouth.reach
        pieces = self._half([(2, occ.addDisk(*middle, radius, radius, zAxis=list(self.inward)))])
        if around:
            pieces = list(occ.cut(pieces, around, removeObject=True, removeTool=False)[0])
        if before is None:
            at = mouth.at + depth * self._way
            faces = list(occ.getClosestEntities(*at, pieces, 1)[0]) if pieces else []
        else:
            moved = occ.copy(before.faces)
            occ.translate(moved, *((depth - before.depth) * self._way))
            faces = [piece for piece in pieces if any(self._touch(piece, face) for face in moved)]
            occ.remove(moved, recursive=True)
        occ.remove([piece for piece in pieces if piece not in faces], recursive=True)
        if not faces:
            return None
        boxes = np.array([occ.getBoundingBox(*face) for face in faces]).reshape(-1, 2, 3) - middle
        corners = np.maximum(np.abs(boxes[:, 0]).max(axis=0), np.abs(boxes[:, 1]).max(axis=0))
        across = corners - (corners @ np.abs(self.inward)) * np.abs(self.inward)
        is_wide = bool(np.linalg.norm(across) > REACH * mouth.reach)
        areas = np.array([float(occ.getMass(*face)) for face in faces])
        centre = areas @ np.array([occ.getCenterOfMass(*face) for face in faces]) / areas.sum()
        return _Section(depth, faces, float(areas.sum()), is_wide, centre)

    def _touch(self, first: Face, second: Face) -> bool:
        return float(self.gmsh.model.occ.getDistance(*first, *second)[0]) < ACCURACY * self.mouth.width


def in_front(gmsh: Any, entities: list[tuple[int, int]], at: Array, size: float) -> list[tuple[int, int]]:
    """What of them has z > 0; they lie within `size` mm of the point (3,)."""
    occ = gmsh.model.occ
    behind = occ.addBox(at[0] - size, at[1] - size, -2 * size, 2 * size, 2 * size, 2 * size)
    return list(occ.cut(entities, [(3, behind)])[0])


def plane_of(gmsh: Any, face: Face) -> tuple[Array, Array] | None:
    """A point (3,), mm, and the unit normal (3,) of a flat face; None for a curved one."""
    low, high = (np.array(end) for end in gmsh.model.getParametrizationBounds(*face))
    parts = np.linspace(0.05, 0.95, 4)
    at = np.array([low + (high - low) * [u, v] for u in parts for v in parts])
    points = np.reshape(gmsh.model.getValue(*face, at.ravel()), (-1, 3))
    normal = np.array(gmsh.model.getNormal(face[1], at[0]))
    away = np.abs((points - points[0]) @ normal).max()
    return (points[0], normal) if away < FLAT * np.ptp(points, axis=0).max() else None
