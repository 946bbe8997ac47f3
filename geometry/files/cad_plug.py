"""Inlets of a CAD file that are filled with the material of the body; in a session of `geometry.meshing.solid`.

The mouth of an inlet is a hole in a flat face of the solids, and its plug is the air behind it, up to where the channel
becomes wider (`geometry.files.cad_channel`); or it is in a round face (`geometry.files.cad_round_inlet`).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.errors import DesignError
from geometry.files.cad_channel import FLAT, Channel, Face, Mouth, in_front, plane_of
from geometry.files.cad_import import CadBody, Point, bounds, is_in_material
from geometry.files.cad_round_inlet import Closed, close_round_inlet
from geometry.meshing.shapes import Volume

#: distance of a point from the plane of its mouth, over the size of the body: points are read off the screen
NEAR = 1e-3
#: change of volume by uniting a plug with the solid around it that is rounding, over that of the solid
ROUNDING = 1e-4
#: why a point is refused
NO_OPENING = "lies in no opening of a flat face, nor in one of a round face that can be closed"
#: holes in flat faces that are listed
LISTED = 4


def plugged(gmsh: Any, body: CadBody, solids: list[Volume]) -> tuple[list[Volume], dict[str, float]]:
    """The solids with their inlets filled, and the depth of each plug, mm.

    An inlet beside the plane z = 0 of a symmetric body is filled on both sides of it. Raises `DesignError` with the key
    plug.NAME for a point that lies in no mouth, and for an inlet that is wider at once.
    """
    depths: dict[str, float] = {}
    filled: dict[str, Array] = {}
    images: dict[str, Array] = {}
    if not body.plugs:
        return solids, depths
    extent = _Extent(body, *bounds(gmsh, solids))
    for name, point in body.plugs.items():
        if known := _around(images, point):
            depths[name] = depths[known]
            continue
        channel = _channel(gmsh, extent, solids, point)
        if channel is None and extent.has_image and not _around(filled, point):
            # of an arm that is turned to its larger x the inlet may lie on the other side of z = 0
            channel = _channel(gmsh, extent, solids, _mirrored(point))
            point = point if channel is None else _mirrored(point)
        if channel is None:
            if known := _around(filled, point):
                raise _refusal(body, name, f"lies in the inlet that plug.{known} has filled; leave it out")
            if (closed := _closed(gmsh, extent, solids, point)) is None:
                raise _refusal(body, name, f"{NO_OPENING}{hole_advice(gmsh, body, solids)}")
            solids, depths[name], filled[name] = closed.solids, closed.depth, closed.box
            image = _closed(gmsh, extent, solids, _mirrored(point)) if extent.has_image else None
            if image is not None:
                solids, images[name] = image.solids, image.box
            continue
        if not channel.is_filled:
            raise _refusal(
                body, name, "lies in an opening behind which the air is wider at once; close it in the CAD program"
            )
        depths[name] = channel.depth
        solids, filled[name] = _filled(gmsh, body, name, channel)
        beside = _channel(gmsh, extent, solids, _mirrored(point)) if extent.has_image else None
        if beside is not None and beside.is_filled:
            solids, images[name] = _filled(gmsh, body, name, beside)
    return solids, depths


@dataclass(frozen=True)
class _Extent:
    """What a body reaches, which its plugs do not change."""

    body: CadBody
    low: Point  #: mm
    high: Point  #: mm

    @property
    def size(self) -> float:
        """mm"""
        return float(np.linalg.norm(np.subtract(self.high, self.low)))

    @property
    def is_half(self) -> bool:
        """Whether the file itself holds one half."""
        return self.body.half and self.low[2] > -FLAT * self.size

    @property
    def has_image(self) -> bool:
        """Whether an inlet has a mirror image in the file."""
        return self.body.half and not self.is_half

    def located(self, point: Point) -> Point:
        """A point of the user, in the half that the file holds."""
        return self.body.within_half(point, self.low, self.high) if self.is_half else point


def _closed(gmsh: Any, extent: _Extent, solids: list[Volume], point: Point) -> Closed | None:
    """The solids without the inlet in a round face in whose mouth a point lies; None where there is none."""
    return close_round_inlet(gmsh, solids, extent.located(point), NEAR * extent.size, extent.is_half)


def _mirrored(point: Point) -> Point:
    x, y, z = point
    return (x, y, -z)


def _around(boxes: Mapping[str, Array], point: Point) -> str:
    """The name of the first box (2, 3) in which a point lies; empty where there is none."""
    return next((name for name, (low, high) in boxes.items() if ((low <= point) & (point <= high)).all()), "")


def _refusal(body: CadBody, name: str, sentence: str) -> DesignError:
    return DesignError(f"plug.{name}", f"the point {body.words(body.plugs[name])} {sentence}")


def hole_advice(gmsh: Any, body: CadBody, solids: list[Volume]) -> str:
    """Where openings in flat faces are, as the end of a sentence; empty where there is none.

    Those in faces with the whole body behind them come first, because inlets are there, then the largest.
    """

    def is_foot(length: float, centre: Point, normal: Point) -> bool:
        """Whether a part of the body stands on the face there: it has material on both sides."""
        sides = (np.add(centre, side * 1e-3 * length * np.array(normal)) for side in (1, -1))
        return all(is_in_material(gmsh, solids, side) for side in sides)

    occ, edges = gmsh.model.occ, []
    corners = np.array([gmsh.model.getValue(*point, []) for point in gmsh.model.getBoundary(solids, recursive=True)])
    near = NEAR * float(np.linalg.norm(np.ptp(corners, axis=0)))
    is_half = body.half and corners[:, 2].min() > -near  # of the file itself
    for face in gmsh.model.getBoundary(solids, combined=False, oriented=False):
        plane = plane_of(gmsh, face)
        if plane is None or (is_half and abs(plane[1][2]) > 0.5 and plane[0][2] < near):  # the plane of symmetry
            continue
        heights = (corners - plane[0]) @ plane[1]
        is_outside = min(heights.max(), -heights.min()) < near
        measured = []
        for loop in occ.getCurveLoops(face[1])[1]:
            lengths = np.array([float(occ.getMass(1, curve)) for curve in loop])
            centres = np.array([occ.getCenterOfMass(1, curve) for curve in loop])
            centre = np.round(lengths @ centres / lengths.sum(), 6)
            measured.append((is_outside, float(lengths.sum()), tuple(centre), tuple(plane[1])))
        edges += sorted(measured)[:-1]  # the longest is the edge of the face itself
    openings = (body.words(at, ".6") for _, size, at, n in sorted(edges, reverse=True) if not is_foot(size, at, n))
    first = list(islice(openings, LISTED))  # looking for material takes the longest
    return f"; openings in flat faces, those outside first, have their centres at {', '.join(first)}" if first else ""


def _channel(gmsh: Any, extent: _Extent, solids: list[Volume], point: Point) -> Channel | None:
    """The deepest channel behind a mouth in which a point lies; None where it lies in none."""
    channels = [
        Channel(gmsh, solids, mouth, side * mouth.normal).followed
        for mouth in _mouths(gmsh, extent, solids, point)
        for side in (1, -1)
    ]
    return max(channels, key=lambda channel: channel.depth, default=None)


def _mouths(gmsh: Any, extent: _Extent, solids: list[Volume], point: Point) -> Iterator[Mouth]:
    """The openings of flat faces in which a point lies: at most one for each plane near it, those nearest first."""
    occ = gmsh.model.occ
    size, is_half, given = extent.size, extent.is_half, np.array(extent.located(point))
    for on, normal, flat in _planes_near(gmsh, solids, given, NEAR * size):
        if is_half and abs(normal[2]) > 0.5 and on[2] < NEAR * size:
            continue  # the plane of symmetry
        at = given - ((given - on) @ normal) * normal
        sheet = [(2, occ.addDisk(*at, 2 * size, 2 * size, zAxis=list(normal)))]
        if is_half:
            sheet = in_front(gmsh, sheet, at, 3 * size)
        holes, _ = occ.cut(sheet, flat, removeObject=True, removeTool=False)
        (hole,), (away,), _ = occ.getClosestEntities(*at, holes, 1) if holes else ([None], [np.inf], None)
        box = np.reshape(occ.getBoundingBox(*hole), (2, 3)) if hole else np.zeros((2, 3))
        area = float(occ.getMass(*hole)) if hole else 0.0
        occ.remove(holes, recursive=True)
        occ.synchronize()
        if away < FLAT * size and np.ptp(box, axis=0).max() < size:  # else the air around the body
            is_cut = is_half and box[0, 2] < FLAT * size
            box[0, 2] = -box[1, 2] if is_cut else box[0, 2]
            middle = box.mean(axis=0)
            reach = 0.5 * float(np.linalg.norm(box[1] - box[0]))
            yield Mouth(at, normal, middle, reach, area * (2 if is_cut else 1), is_cut)


def _planes_near(gmsh: Any, solids: list[Volume], point: Array, near: float) -> list[tuple[Array, Array, list[Face]]]:
    """The planes within a distance (mm) of a point that contain flat faces, the nearest first: a point (3,), the unit
    normal (3,) and the faces of each."""
    planes: list[tuple[Array, Array, list[Face]]] = []
    for face in gmsh.model.getBoundary(solids, combined=False, oriented=False):
        plane = plane_of(gmsh, face)
        if plane is None or abs(plane[1] @ (point - plane[0])) > near:
            continue
        for on, normal, faces in planes:
            if abs(normal @ plane[1]) > 1 - FLAT and abs((on - plane[0]) @ normal) < FLAT * near / NEAR:
                faces.append(face)
                break
        else:
            planes.append((*plane, [face]))
    return sorted(planes, key=lambda entry: abs((point - entry[0]) @ entry[1]))


def _filled(gmsh: Any, body: CadBody, name: str, channel: Channel) -> tuple[list[Volume], Array]:
    """The solids, one of them united with the plug of a channel, and the corners (2, 3) of the box around it, mm.

    Of several solids it is the one that has most of the surface of the plug. Raises `DesignError`.
    """
    occ, solids = gmsh.model.occ, channel.solids
    unfilled = _refusal(body, name, "lies in an opening that Gmsh cannot fill; close it in the CAD program")
    plug = channel.plug()
    if plug is None:
        raise unfilled
    box = np.reshape(occ.getBoundingBox(*plug), (2, 3))
    owner = max(solids, key=lambda solid: _shared(gmsh, plug, solid)) if len(solids) > 1 else solids[0]
    expected = sum(float(occ.getMass(*part)) for part in (owner, plug))
    united = [part for part in occ.fuse([owner], [plug])[0] if part[0] == 3]
    if len(united) != 1 or abs(float(occ.getMass(*united[0])) - expected) > ROUNDING * expected:
        raise unfilled
    occ.synchronize()
    return [*united, *(solid for solid in solids if solid != owner)], box


def _shared(gmsh: Any, plug: Volume, solid: Volume) -> float:
    """Area of the surface of a plug that is one of a solid too, mm2."""
    occ = gmsh.model.occ
    faces = [(2, tag) for loop in occ.getSurfaceLoops(plug[1])[1] for tag in loop]
    common = occ.intersect(occ.copy(faces), [solid], removeObject=True, removeTool=False)[0]
    area = sum(float(occ.getMass(*face)) for face in common if face[0] == 2)
    occ.remove(common, recursive=True)
    return area
