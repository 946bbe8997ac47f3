"""Inlets of a CAD body that are filled with its material, in a session of `geometry.meshing.solid`.

The mouth of an inlet is a hole in a flat face, outside or in a cavity. The faces that meet its rim are removed and the
faces beside them extended until they meet (Gmsh's defeaturing). What is still open then is left to the CAD program:
mouths in round faces, stepped and countersunk bores, channels with a wall of the cavity.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from math import pi
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.files.cad.solids import CadBody, bounds, is_in_material
from geometry.files.shells import NEAR_MOUTH, WIDER, diagonal, holds, no_mouth, smallest_around
from geometry.meshing.shapes import Volume

#: openings that are listed
LISTED = 4


@dataclass(frozen=True)
class _Mouth:
    """A hole in a flat face of a solid."""

    solid: Volume
    walls: tuple[int, ...]  #: faces of the solid that meet its rim
    box: Array  #: corners (2, 3) of the box around its rim, mm
    rim: float  #: length, mm


def fill_cad_inlets(gmsh: Any, body: CadBody, solids: list[Volume]) -> tuple[list[Volume], dict[str, float]]:
    """The solids with their inlets filled, and how deep each plug is, mm.

    Of a symmetric body the mirror image of an inlet is filled as well. Raises `DesignError` with the key plug.NAME.
    """
    depths: dict[str, float] = {}
    filled: list[tuple[Array, float]] = []
    near = NEAR_MOUTH * diagonal(np.array(bounds(gmsh, solids))) if body.plugs else 0.0
    for name, (x, y, z) in body.plugs.items():
        points = dict.fromkeys([(x, y, z), (x, y, -z)] if body.half else [(x, y, z)])
        for point in points:
            mouth = smallest_around(_mouths(gmsh, solids), point, near)
            if mouth is not None and (result := _filled(gmsh, mouth)) is not None:
                solids = [result[0], *(solid for solid in solids if solid != mouth.solid)]
                filled.append((mouth.box, result[1]))
        found = [depth for box, depth in filled if any(holds(box, point, near) for point in points)]
        if not found:
            raise no_mouth(name, body.words(body.plugs[name]), hole_advice(gmsh, body, solids))
        depths[name] = found[0]
    return solids, depths


def _mouths(gmsh: Any, solids: Iterable[Volume]) -> Iterator[_Mouth]:
    """The holes in the flat faces of solids."""
    occ = gmsh.model.occ
    for solid in solids:
        faces = gmsh.model.getBoundary([solid], combined=False, oriented=False)
        curves = {face: {c for _, c in gmsh.model.getBoundary([face], oriented=False)} for face in faces}
        for face in faces:
            loops = occ.getCurveLoops(face[1])[1] if gmsh.model.getType(*face) == "Plane" else []
            lengths = [sum(float(occ.getMass(1, curve)) for curve in loop) for loop in loops]
            for loop, length in zip(loops, lengths, strict=True):
                if length == max(lengths):  # the edge of the face itself
                    continue
                walls = tuple(other[1] for other in faces if other != face and curves[other] & set(loop))
                boxes = np.array([occ.getBoundingBox(1, curve) for curve in loop])
                box = np.array([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])
                yield _Mouth(solid, walls, box, length)


def _filled(gmsh: Any, mouth: _Mouth) -> tuple[Volume, float] | None:
    """The solid with the inlet filled, in place of it, and the mean length of the walls, mm; None, and the solid as it
    was, where that fails."""
    occ = gmsh.model.occ
    depth = sum(float(occ.getMass(2, wall)) for wall in mouth.walls) / mouth.rim
    middle = np.mean([occ.getCenterOfMass(2, wall) for wall in mouth.walls], axis=0)
    largest = WIDER**2 * depth * mouth.rim**2 / (4 * pi)  # of a round prism with its rim and walls
    try:
        results = occ.defeature([mouth.solid[1]], list(mouth.walls), False)
    except Exception:  # Gmsh raises nothing more special
        results = []
    occ.synchronize()
    added = sum(float(occ.getMass(*result)) for result in results) - float(occ.getMass(*mouth.solid))
    is_filled = len(results) == 1 and added <= largest and is_in_material(gmsh, results, middle)
    occ.remove([mouth.solid] if is_filled else results, recursive=True)
    occ.synchronize()
    return ((3, int(results[0][1])), depth) if is_filled else None


def hole_advice(gmsh: Any, body: CadBody, solids: list[Volume]) -> str:
    """Where holes in flat faces are, as the end of a sentence, the largest first; empty where there is none."""
    mouths = sorted(_mouths(gmsh, solids), key=lambda mouth: -mouth.rim)
    centres = (mouth.box.mean(axis=0).round(6) for mouth in mouths)
    holes = (centre for centre in centres if not is_in_material(gmsh, solids, centre))  # no foot of another part
    listed = ", ".join(body.words((float(x), float(y), float(z)), ".6") for x, y, z in islice(holes, LISTED))
    return f"; holes in flat faces have their centres at {listed}" if listed else ""
