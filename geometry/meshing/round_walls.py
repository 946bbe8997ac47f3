"""How round faces are divided, in the Gmsh session of `geometry.meshing.solid`."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from geometry.grading import OFF, Grading
from geometry.meshing.shapes import Face

#: Largest angle of a chord of a round wall, rad. Its middle lies 1.2 % of the radius inside the circle: with larger
#: angles curved edges fold elements in walls of 1/8 of the radius.
LARGEST_ARC = np.pi / 10
#: Largest angle of a chord of a fillet, rad. With 45 degrees curved edges fold elements at fillets of 0.7 mm and more.
LARGEST_FILLET_ARC = np.pi / 6
#: Length of a chord of a fillet over the smallest size of the mesh.
FILLET_CHORD = 0.35
#: Length of the elements along a fillet over that of a chord.
FILLET_ASPECT = 2.0


def divide_round_walls(gmsh: Any, size: float, grading: Grading) -> dict[int, float]:
    """Divide round faces into straight strips along their axis, all arcs of equal radius by the same angle.

    Returns the size of the elements at fillets (mm) by the tag of the face, from which the mesh should grow.
    """
    model = gmsh.model
    round_faces = [face for face in model.getEntities(2) if model.getType(*face) == "Cylinder"]
    fillets = [face for face in round_faces if not _is_along_x(model, face)]
    if not round_faces:
        return {}
    if fillets:
        return {face[1]: _divide_fillet(model, face, size * grading.fraction) for face in fillets}
    _divide_walls_along_x(model, round_faces, size * grading.fraction, everywhere=grading == OFF)
    return {}


def _divide_walls_along_x(model: Any, faces: Sequence[Face], size: float, everywhere: bool) -> None:
    """Divide round walls along x, so that the two sides of a wall face each other vertex to vertex.

    Freely meshed, coarse chords of one side can come near the other side. Round walls are thin and end in re-entrant
    edges: with a grading they get its smallest size, and only their sides are divided here.
    everywhere: divide all other edges of the body, too.
    """
    radii = _radii(model, [curve for _, curve in model.getEntities(1)])
    angle = min(size / max(radii.values()), LARGEST_ARC)
    sides = model.getBoundary(faces, combined=False, oriented=False)
    for _, curve in model.getEntities(1) if everywhere else sorted(set(sides)):
        length, step = model.occ.getMass(1, curve), size
        if curve in radii:
            length, step = length / radii[curve], angle  # of the arc in rad
        _divide(model, curve, length / step)
    for face in faces:
        _make_strips(model, face)


def _divide_fillet(model: Any, face: Face, size: float) -> float:
    """Divide a fillet, and return the size of the elements along it, mm."""
    sides = [curve for _, curve in model.getBoundary([face], oriented=False)]
    radii = _radii(model, sides)
    radius = max(radii.values())
    parts = np.ceil(np.pi / 2 / min(FILLET_CHORD * size / radius, LARGEST_FILLET_ARC) - 1e-6)
    along = FILLET_ASPECT * np.pi / 2 * radius / parts
    for curve in sides:
        _divide(model, curve, parts if curve in radii else model.occ.getMass(1, curve) / along)
    _make_strips(model, face)
    return float(along)


def _divide(model: Any, curve: int, parts: float) -> None:
    model.mesh.setTransfiniteCurve(curve, int(np.ceil(parts - 1e-6)) + 1)


def _make_strips(model: Any, face: Face) -> None:
    if len(model.getBoundary([face], oriented=False)) == 4:
        model.mesh.setTransfiniteSurface(face[1], "Alternate")


def _is_along_x(model: Any, face: Face) -> bool:
    """True if the axis of a round face is along x: its arcs lie in planes x = constant."""
    arcs = _radii(model, [curve for _, curve in model.getBoundary([face], oriented=False)])
    boxes = [model.getBoundingBox(1, arc) for arc in arcs]
    return all(box[3] - box[0] < 1e-3 * (box[5] - box[2]) for box in boxes)


def _radii(model: Any, curves: Sequence[int]) -> Mapping[int, float]:
    """Radius (mm) of those curves that are circular arcs."""
    arcs = [curve for curve in curves if model.getType(1, curve) == "Circle"]
    return {curve: _radius(model, curve) for curve in arcs}


def _radius(model: Any, arc: int) -> float:
    """Radius of a circular arc, mm."""
    middle = float(np.mean(model.getParametrizationBounds(1, arc)))
    return 1 / float(model.getCurvature(1, arc, [middle])[0])
