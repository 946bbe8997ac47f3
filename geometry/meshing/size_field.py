"""The field of element sizes that Gmsh follows when a mesh is graded.

Works in the Gmsh session of `geometry.meshing.solid` on what is meshed: a half body, or the end piece and half cell of
one that are repeated.
"""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.grading import OFF, Grading

#: True if a point (3,) lies in the material.
Inside: TypeAlias = Callable[[Array], bool]
#: Gmsh's name for curves or for faces, and their tags.
Graded: TypeAlias = tuple[str, Sequence[int]]

#: Number of points around an edge that are tested for material.
AROUND = 8
#: Distance of these points from the edge, and of points just under a face, over the length of what is meshed.
NEAR = 1e-3
#: Largest depth at which the far side of a wall is searched, over the smallest side of what is meshed.
DEEPEST = 0.25
#: Number of depths that are tested.
STEPS = 40
#: A wall is thin if it is at most this many times as thick as the thinnest one.
THIN = 1.6
#: Number of samples per curve, or per side of a face, from which Gmsh measures the distance.
SAMPLES = 40
#: Increase of the size per distance from faces that are finer whatever the grading.
AWAY_FROM_FINER = 0.7


def set_size_field(
    gmsh: Any, size: float, grading: Grading, graded: Graded, finer: Mapping[int, float] = MappingProxyType({})
) -> None:
    """Give the solid in the session a field of element sizes, `size` (mm) being the largest.

    graded: what `find_graded` says; finer: sizes (mm) at some faces by their tags, whatever the grading.
    """
    fields = [_field(gmsh, *graded, grading.fraction * size, grading.growth)] if graded[1] else []
    for face, smallest in finer.items():
        fields.append(_field(gmsh, "SurfacesList", [face], smallest, AWAY_FROM_FINER))
    if fields:
        lowest = gmsh.model.mesh.field.add("Min")
        gmsh.model.mesh.field.setNumbers(lowest, "FieldsList", fields)
        gmsh.model.mesh.field.setAsBackgroundMesh(lowest)


def find_graded(gmsh: Any, grading: Grading, half: bool = True, mirrored: bool = True) -> Graded:
    """The curves or faces of the solid in the session at which a grading has smaller elements; none without a grading.

    half: the body continues beyond z = 0 as its mirror image; mirrored: also beyond its largest x.
    """
    if grading == OFF:
        return "", ()
    model = gmsh.model
    inside, near = _material_test(model, half, mirrored)
    if grading.at == "edges":
        curves = (tag for _, tag in model.getEntities(1))
        return "CurvesList", [tag for tag in curves if _is_reentrant(model, tag, inside, near)]
    deepest = DEEPEST * float(_sides(model).min())
    return "SurfacesList", sorted(_thicknesses(model, inside, near, deepest, THIN))


def _field(gmsh: Any, kind: str, tags: Sequence[int], smallest: float, growth: float) -> int:
    """Tag of the field smallest + growth times the distance (mm) from some curves or faces."""
    field = gmsh.model.mesh.field
    distance, sizes = field.add("Distance"), field.add("MathEval")
    field.setNumbers(distance, kind, tags)
    field.setNumber(distance, "Sampling", SAMPLES)
    field.setString(sizes, "F", f"{smallest:.9g} + {growth:.9g} * F{distance}")
    return int(sizes)


def _material_test(model: Any, half: bool, mirrored: bool) -> tuple[Inside, float]:
    """The test whether a point lies in the solid or its mirror images, and the distance (mm) that counts as near."""
    box = model.getBoundingBox(-1, -1)
    end, near = box[3], NEAR * (box[3] - box[0])
    boxes = {tag: np.array(model.getBoundingBox(3, tag)).reshape(2, 3) for _, tag in model.getEntities(3)}

    def inside(point: Array) -> bool:
        x, y, z = point
        at = np.array([2 * end - x if mirrored and x > end else x, y, abs(z) if half else z])
        near_it = (tag for tag, (low, high) in boxes.items() if (low - near < at).all() and (at < high + near).all())
        return any(model.isInside(3, tag, at) for tag in near_it)

    return inside, near


def _is_reentrant(model: Any, curve: int, inside: Inside, near: float) -> bool:
    """True if more than a half space around the middle of a curve is material, but not all of it."""
    low, high = model.getParametrizationBounds(1, curve)
    middle = [(low[0] + high[0]) / 2]
    position, tangent = np.array(model.getValue(1, curve, middle)), np.array(model.getDerivative(1, curve, middle))
    tangent /= np.linalg.norm(tangent)
    normal = np.cross(tangent, np.eye(3)[np.argmin(np.abs(tangent))])
    normal /= np.linalg.norm(normal)
    binormal = np.cross(tangent, normal)
    angles = (np.arange(AROUND) + 0.5) * 2 * np.pi / AROUND
    filled = sum(inside(position + near * (np.cos(a) * normal + np.sin(a) * binormal)) for a in angles)
    return AROUND / 2 < filled < AROUND


def thinnest_wall(gmsh: Any, half: bool = True) -> float:
    """Thickness of the thinnest wall of the solid in the session, mm; walls thicker than `DEEPEST` are as thick as
    that."""
    model = gmsh.model
    deepest = DEEPEST * float((_sides(model) * [1.0, 1.0, 2.0 if half else 1.0]).min())
    thickness = _thicknesses(model, *_material_test(model, half, mirrored=False), deepest, 1.0)
    return min(thickness.values(), default=deepest)


def _sides(model: Any) -> Array:
    """(3,) mm, of the box around the solid that is meshed."""
    box = np.array(model.getBoundingBox(-1, -1))
    return box[3:] - box[:3]


def _thicknesses(model: Any, inside: Inside, near: float, deepest: float, times: float) -> dict[int, float]:
    """Thickness (mm) of the material behind the middle of each face, by tag, the smallest first; those above `deepest`
    are left out, and those above `times` the smallest one."""
    step = (DEEPEST * float(_sides(model).min()) - near) / (STEPS - 1)
    thickness: dict[int, float] = {}
    ways = _ways_into(model, inside, near)
    for depth in near + step * np.arange(1, round((deepest - near) / step) + 1):
        if depth > times * min(thickness.values(), default=np.inf):
            break
        for face, (start, inward, (enters, leaves)) in list(ways.items()):
            at_face = ((enters <= depth) & (leaves >= depth - step)).any()  # a test of a point takes a millisecond
            if at_face and not inside(start + depth * inward):
                thickness[face] = float(depth)
                del ways[face]
    return thickness


def _ways_into(model: Any, inside: Inside, near: float) -> dict[int, tuple[Array, Array, Array]]:
    """By tag of each face between material and air: its middle (3,), mm, the direction into the material, and between
    which depths (2, n), mm, the way into it is in the box around a face or its mirror image."""
    faces = model.getEntities(2)
    boxes = np.array([model.getBoundingBox(*face) for face in faces]).reshape(-1, 2, 3) + np.array([[-near], [near]])
    mirrored = [2.0 * model.getBoundingBox(-1, -1)[3], 0.0, 0.0] + boxes * [-1.0, 1.0, 1.0]
    boxes = np.concatenate([boxes, mirrored, boxes * [1.0, 1.0, -1.0], mirrored * [1.0, 1.0, -1.0]])
    ways = {}
    for _, face in faces:
        low, high = model.getParametrizationBounds(2, face)
        middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
        position, normal = np.array(model.getValue(2, face, middle)), np.array(model.getNormal(face, middle))
        behind, before = inside(position - near * normal), inside(position + near * normal)
        if behind == before:  # between two regions of the material, or in a hole of the face
            continue
        inward = -normal if behind else normal
        at = (boxes - position) / np.where(np.abs(inward) < 1e-12, 1e-12, inward)
        enters, leaves = at.min(axis=1).max(axis=1), at.max(axis=1).min(axis=1)
        ways[int(face)] = position, inward, np.array([enters, leaves])[:, enters <= leaves]
    return ways
