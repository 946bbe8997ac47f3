"""Elements that grow smaller towards re-entrant edges, where stresses are singular, or towards the thinnest walls,
which bend most.

Works in the Gmsh session of `geometry.meshing.solid` on what is meshed: a half body, or the piece of one that is
repeated.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from geometry.topology import Array

#: whether a point (3,) lies in the material
Inside: TypeAlias = Callable[[Array], bool]

#: Places around an edge at which it is asked whether there is material.
AROUND = 8
#: Their distance from the edge, and that of places just under a face, over the length of what is meshed.
NEAR = 1e-3
#: How deep the far side of a wall is looked for, over the smallest side of what is meshed, and in how many steps.
DEEPEST, STEPS = 0.25, 40
#: Walls up to so many times as thick as the thinnest one are thin.
THIN = 1.6
#: Into how many pieces Gmsh divides a curve, or the side of a face, to measure the distance from it.
PIECES = 40


@dataclass(frozen=True)
class Grading:
    """Where elements are small, how small, and how fast they grow away from there."""

    at: Literal["nowhere", "edges", "walls"] = "nowhere"  #: re-entrant edges, or the thinnest walls
    share: float = 1.0  #: size there over the size of the mesh
    growth: float = 1.0  #: of the size with the distance


OFF = Grading()

#: The gradings by the name that a config gives them.
GRADINGS: dict[str, Grading] = {
    "off": OFF,
    "edges": Grading("edges", share=0.5, growth=0.5),
    "walls": Grading("walls", share=0.6),
}


def grade(gmsh: Any, size: float, grading: Grading, half: bool = True, piece: bool = True) -> None:
    """Give the solid in the session a field of sizes, `size` (mm) being the largest.

    half, piece: beyond z = 0, and beyond its largest x, the solid goes on as its mirror image.
    """
    if grading == OFF:
        return
    model, field = gmsh.model, gmsh.model.mesh.field
    inside, near = _inside(model, half, piece)
    if grading.at == "edges":
        what, tags = "CurvesList", [tag for _, tag in model.getEntities(1) if _is_reentrant(model, tag, inside, near)]
    else:
        what, tags = "SurfacesList", _thin_walls(model, inside, near)
    if not tags:
        return
    distance, sizes = field.add("Distance"), field.add("MathEval")
    field.setNumbers(distance, what, tags)
    field.setNumber(distance, "Sampling", PIECES)
    field.setString(sizes, "F", f"{grading.share * size:.9g} + {grading.growth:.9g} * F{distance}")
    field.setAsBackgroundMesh(sizes)


def _inside(model: Any, half: bool, piece: bool) -> tuple[Inside, float]:
    """Whether a point lies in the material of the solid or of its mirror images; and what is near, mm."""
    box = model.getBoundingBox(-1, -1)
    end, near = box[3], NEAR * (box[3] - box[0])
    volumes = [tag for _, tag in model.getEntities(3)]

    def inside(point: Array) -> bool:
        x, y, z = point
        place = [2 * end - x if piece and x > end else x, y, abs(z) if half else z]
        return any(model.isInside(3, tag, place) for tag in volumes)

    return inside, near


def _is_reentrant(model: Any, curve: int, inside: Inside, near: float) -> bool:
    """Whether there is more than a half space of material around the middle of a curve, and some air."""
    low, high = model.getParametrizationBounds(1, curve)
    middle = [(low[0] + high[0]) / 2]
    place, along = np.array(model.getValue(1, curve, middle)), np.array(model.getDerivative(1, curve, middle))
    along /= np.linalg.norm(along)
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    other = np.cross(along, across)
    angles = (np.arange(AROUND) + 0.5) * 2 * np.pi / AROUND
    filled = sum(inside(place + near * (np.cos(a) * across + np.sin(a) * other)) for a in angles)
    return AROUND / 2 < filled < AROUND


def _thin_walls(model: Any, inside: Inside, near: float) -> list[int]:
    """The faces behind which there is the least material."""
    box = np.array(model.getBoundingBox(-1, -1))
    depths = np.linspace(near, DEEPEST * float((box[3:] - box[:3]).min()), STEPS)
    thickness = {}
    for _, face in model.getEntities(2):
        low, high = model.getParametrizationBounds(2, face)
        middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
        place, normal = np.array(model.getValue(2, face, middle)), np.array(model.getNormal(face, middle))
        behind, before = inside(place - near * normal), inside(place + near * normal)
        if behind == before:  # between two regions of the material, or in a hole of the face
            continue
        inward = -normal if behind else normal
        through = next((float(depth) for depth in depths if not inside(place + depth * inward)), None)
        if through is not None:
            thickness[int(face)] = through
    return [face for face, depth in thickness.items() if depth <= THIN * min(thickness.values())]
