"""Inlets of a CAD file that are filled with the material of the body; in a session of `geometry.meshing.solid`.

The mouth of an inlet is a hole in a flat face of the solids. Its plug is the air behind the mouth as far as the channel
keeps its width; in a channel longer than twice that width it is as deep as it is wide.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.design import DesignError
from geometry.meshing.cad_import import CadBody, Point, bounds
from geometry.meshing.shapes import Volume

#: (2, tag), as Gmsh identifies a face
Face: TypeAlias = tuple[int, int]

#: distance from a plane of points that lie in it, over the size of the body
IN_PLANE = 1e-5
#: how far beside the edge of a mouth there is material as deep as its plug reaches, over the width of the mouth
BESIDE = 0.02
#: points on each curve of that edge
SAMPLES = 12
#: length of a channel that is filled all along, over the width of its mouth
SHORT = 2.0
#: depths, up to this length, at which the material is looked for; the first is the smallest of a plug
DEPTHS = 40
#: distance from the end of a channel within which its plug ends there, over the width of the mouth
AT_END = 1e-3


@dataclass(frozen=True)
class _Mouth:
    """A hole in a flat face; lengths in mm."""

    face: Face  #: of the air in it
    inward: Array  #: unit vector (3,) across it, into the body
    depth: float  #: of its plug; 0 where the channel widens at once
    beside: Array  #: a point (3,) of the material around its plug


def plugged(gmsh: Any, body: CadBody, solids: list[Volume]) -> tuple[list[Volume], dict[str, float]]:
    """The solids with their inlets filled, and the depth of each plug, mm.

    Raises `DesignError` with the key plug.NAME for a point that lies in no mouth, and for an inlet that widens at once.
    """
    depths = {}
    for name, point in body.plugs.items():
        mouths = sorted(_mouths(gmsh, body, solids, point), key=lambda mouth: -mouth.depth)
        if not mouths:
            raise _refusal(body, name, f"lies in no hole of a flat face{hole_advice(gmsh, body, solids)}")
        if not mouths[0].depth:
            raise _refusal(
                body,
                name,
                "lies in an opening that is oblique to the flat face around it, or wider behind it; close it in the "
                "CAD program",
            )
        solids, depths[name] = _filled(gmsh, solids, mouths[0]), mouths[0].depth
    return solids, depths


def _refusal(body: CadBody, name: str, sentence: str) -> DesignError:
    return DesignError(f"plug.{name}", f"the point {body.words(body.plugs[name])} {sentence}")


def hole_advice(gmsh: Any, body: CadBody, solids: list[Volume]) -> str:
    """Where the largest three holes in flat faces are, as the end of a sentence; empty where there is none."""
    occ, holes = gmsh.model.occ, []
    for face in gmsh.model.getBoundary(solids, combined=False, oriented=False):
        _, loops = occ.getCurveLoops(face[1]) if _plane_of(gmsh, face) is not None else ([], [])
        measured = []
        for loop in loops:
            lengths = np.array([float(occ.getMass(1, curve)) for curve in loop])
            centres = np.array([occ.getCenterOfMass(1, curve) for curve in loop])
            measured.append((float(lengths.sum()), tuple(np.round(lengths @ centres / lengths.sum(), 6))))
        holes += sorted(measured)[:-1]  # the longest is the edge of the face itself
    largest = [body.words(centre, ".4") for _, centre in sorted(holes, reverse=True)[:3]]
    return f"; holes in flat faces are around {', '.join(largest)}" if largest else ""


def _mouths(gmsh: Any, body: CadBody, solids: list[Volume], point: Point) -> Iterator[_Mouth]:
    """The holes in flat faces in which a point lies: at most one for each plane through it."""
    occ = gmsh.model.occ
    low, high = bounds(gmsh, solids)
    size = float(np.linalg.norm(np.subtract(high, low)))
    is_half = body.half and low[2] > -IN_PLANE * size  # of the file itself; mouths end at z = 0 there
    if is_half:
        point = body.within_half(point, low, high)
    for normal, flat in _planes_at(gmsh, solids, np.array(point), IN_PLANE * size):
        sheet = [(2, occ.addDisk(*point, 2 * size, 2 * size, zAxis=list(normal)))]
        if is_half:
            beyond = occ.addBox(*np.subtract(point, 3 * size), 6 * size, 6 * size, 3 * size - point[2])  # z < 0
            sheet, _ = occ.cut(sheet, [(3, beyond)])
        holes, _ = occ.cut(sheet, flat, removeObject=True, removeTool=False)
        occ.synchronize()
        for hole in holes:
            reach = np.ptp(np.reshape(gmsh.model.getBoundingBox(*hole), (2, 3)), axis=0)
            if reach.max() < size and gmsh.model.isInside(*hole, list(point)):  # else the air around the body
                beside, width = _beside(gmsh, hole, normal, is_half)
                depths = [_depth(gmsh, solids, beside, side * normal, width) for side in (1, -1)]
                inward, depth = normal * (1 if depths[0] >= depths[1] else -1), max(depths)
                yield _Mouth(hole, inward, depth, beside[0] + 0.5 * depth * inward)


def _planes_at(gmsh: Any, solids: list[Volume], point: Array, tolerance: float) -> list[tuple[Array, list[Face]]]:
    """The planes through a point (mm) that contain flat faces: unit normal (3,) and faces of each."""
    planes: list[tuple[Array, list[Face]]] = []
    for face in gmsh.model.getBoundary(solids, combined=False, oriented=False):
        plane = _plane_of(gmsh, face)
        if plane is None or abs(plane[1] @ (point - plane[0])) > tolerance:
            continue
        same = [faces for normal, faces in planes if abs(normal @ plane[1]) > 1 - IN_PLANE]
        if same:
            same[0].append(face)
        else:
            planes.append((plane[1], [face]))
    return planes


def _plane_of(gmsh: Any, face: Face) -> tuple[Array, Array] | None:
    """A point (3,), mm, and the unit normal (3,) of a flat face; None for a curved one."""
    low, high = (np.array(end) for end in gmsh.model.getParametrizationBounds(*face))
    parts = np.linspace(0.05, 0.95, 4)
    at = np.array([low + (high - low) * [u, v] for u in parts for v in parts])
    points = np.reshape(gmsh.model.getValue(*face, at.ravel()), (-1, 3))
    normal = np.array(gmsh.model.getNormal(face[1], at[0]))
    away = np.abs((points - points[0]) @ normal).max()
    return (points[0], normal) if away < IN_PLANE * np.ptp(points, axis=0).max() else None


def _beside(gmsh: Any, hole: Face, normal: Array, is_half: bool) -> tuple[Array, float]:
    """Points (n, 3) of the flat face beside the edge of a hole in it, and the diameter of the circle with its area, mm.

    Of half a hole, that of the whole one.
    """
    area = float(gmsh.model.occ.getMass(*hole))
    on, along = [], []
    for curve in gmsh.model.getBoundary([hole], combined=False, oriented=False):
        (low,), (high,) = gmsh.model.getParametrizationBounds(*curve)
        at = low + (high - low) * (np.arange(SAMPLES) + 0.5) / SAMPLES
        points = np.reshape(gmsh.model.getValue(*curve, at), (-1, 3))
        if is_half and np.abs(points[:, 2]).max() < IN_PLANE * sqrt(area):  # the plane of symmetry
            area *= 2
            continue
        on.append(points)
        along.append(np.reshape(gmsh.model.getDerivative(*curve, at), (-1, 3)))
    width = 2 * sqrt(area / pi)
    across = np.cross(np.vstack(along), normal)
    across *= BESIDE * width / np.linalg.norm(across, axis=1)[:, None]
    points = np.vstack(on)
    inner = [gmsh.model.isInside(*hole, list(point)) for point in points + across]
    return points + np.where(np.array(inner)[:, None], -1, 1) * across, width


def _depth(gmsh: Any, solids: list[Volume], beside: Array, inward: Array, width: float) -> float:
    """The depth of a plug, mm: how deep there is material behind all points beside the edge of a mouth, or its width.

    A channel that ends near a plane parallel to its mouth ends in that plane.
    """

    def is_in_material(depth: float) -> bool:
        behind = list((beside + depth * inward).ravel())
        return sum(gmsh.model.isInside(*solid, behind) for solid in solids) >= len(beside)

    steps = SHORT * width * np.arange(1, DEPTHS + 1) / DEPTHS
    reached = next((k for k, depth in enumerate(steps) if not is_in_material(depth)), DEPTHS)
    if reached in (0, DEPTHS):
        return width if reached else 0.0
    inside, outside = steps[reached - 1], steps[reached]
    while outside - inside > 0.1 * AT_END * width:
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if is_in_material(middle) else (inside, middle)
    planes = [_plane_of(gmsh, face) for face in gmsh.model.getBoundary(solids, combined=False, oriented=False)]
    parallel = [plane[0] for plane in planes if plane is not None and abs(plane[1] @ inward) > 1 - IN_PLANE]
    ends = [float((point - beside[0]) @ inward) for point in parallel]
    return next((end for end in ends if abs(end - inside) < AT_END * width), float(inside))


def _filled(gmsh: Any, solids: list[Volume], mouth: _Mouth) -> list[Volume]:
    """The solids, the one around a mouth united with its plug."""
    occ = gmsh.model.occ
    drawn = [part for part in occ.extrude([mouth.face], *(mouth.depth * mouth.inward)) if part[0] == 3]
    plug = [part for part in occ.cut(drawn, solids, removeObject=True, removeTool=False)[0] if part[0] == 3]
    owner = next(solid for solid in solids if gmsh.model.isInside(*solid, list(mouth.beside)))
    united = [part for part in occ.fuse([owner], plug)[0] if part[0] == 3]
    occ.synchronize()
    solids = [*united, *(solid for solid in solids if solid != owner)]
    own = gmsh.model.getBoundary(solids, combined=False, oriented=False)
    occ.remove([face for face in gmsh.model.getEntities(2) if face not in own], recursive=True)  # of the search
    occ.synchronize()
    return solids
