"""Whether the solids of a CAD file lie where an arm has to lie; in a session of `geometry.meshing.solid`."""

from typing import Any

import numpy as np

from geometry.errors import DesignError, position_text
from geometry.files.cad.inlets import hole_advice
from geometry.files.cad.mirror import difference
from geometry.files.cad.solids import CadBody, is_in_material
from geometry.files.frame import (
    UNEQUAL,
    Point,
    check_dimensions,
    check_within,
    goes_on,
    misplaced,
    no_end_face,
    outside_material,
)
from geometry.meshing.shapes import Volume

#: difference of the moments of both halves of a symmetric body, over its volume and extent, that is rounding
DIFFERENT = 2e-6
#: a face all of which is nearer to the plane of an end than this, over the length, may lie in it: the CAD kernel draws
#: boxes wider than faces, by more in files in metres
AT_END = 1e-3
#: distance of the curve from the surface, over the height of the body, and from the ends, over the length, that is
#: rounding
ROUNDING, NEAR_END = 1e-4, 1e-5
#: name of the material outside of all parts
BODY = ""


def check_position(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point) -> None:
    """Raise `DesignError` unless the unit is plausible and clamp, tip, curve and symmetry fit the bounds (mm)."""
    signs = np.array([-1.0, 1.0, -1.0]) if body.turned else np.ones(3)
    first, last = np.sort(np.array([low, high]) * signs, axis=0) + 0.0  # as in the file, which has no -0
    sides = last - first
    check_dimensions(sides)
    tolerance = 1e-6 * sides.max()
    check_within(
        {"clamp": body.clamp * signs[0], "tip": body.tip * signs[0], "curve": body.curve}, first, last, tolerance
    )
    near, far = first[2], last[2]
    at_side = min(abs(near), abs(far)) <= tolerance
    if not body.half:
        is_misplaced = not near < -tolerance < tolerance < far
    elif at_side:
        is_misplaced = not body.says_half or np.argmax(sides) == 2  # one half is not wider than long
    else:
        is_misplaced = abs(near + far) > UNEQUAL * sides.max()
    if is_misplaced:
        has_axes = not np.array_equal(np.abs(body.source.turn), np.eye(3))
        raise misplaced(first, last, body.middle, has_axes)


def check_ends(gmsh: Any, body: CadBody, solids: list[Volume]) -> None:
    """Raise `DesignError` unless solids have a face near the plane of the clamp, and one near that of the tip.

    Whether it lies in the plane shows once it is meshed.
    """
    faces = gmsh.model.getBoundary(solids, combined=False, oriented=False)
    reach = np.array([gmsh.model.getBoundingBox(*face) for face in faces])[:, [0, 3]]
    for name in ("clamp", "tip"):
        if np.abs(reach - getattr(body, name)).max(axis=1).min() > AT_END * (body.tip - body.clamp):
            raise no_end_face(name, body.x_in_file(name))


def check_symmetric(gmsh: Any, solids: list[Volume]) -> None:
    """Raise `DesignError` unless solids of one material and their mirror images at z = 0 fill the same space."""
    if (found := difference(gmsh, solids, solids, 2, 0.0, DIFFERENT)).exists:
        around = f" around {position_text(np.round(found.centre, 3), 'g')}" if found.centre else ""
        raise DesignError("symmetric", f"the halves of the body about z = 0 differ{around}; write false")


def check_curve(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point) -> None:
    """Raise `DesignError` where the curve leaves the material between the ends, or the material goes on beyond one.

    low, high: bounds of the body, mm.
    """
    across = body.within_half((0.0, 0.0, 0.0), low, high)[2]
    rounding = ROUNDING * (high[1] - low[1])

    def gap(y: float) -> tuple[float, float] | None:
        return _first_gap(gmsh, body, solids, y, across)

    inside = [y for side in (1.0, -1.0) if gap(y := body.curve + side * rounding) is None]
    if inside:
        beyond = NEAR_END * (body.tip - body.clamp)
        for name, x in (("clamp", body.clamp - beyond), ("tip", body.tip + beyond)):
            if any(is_in_material(gmsh, solids, (x, y, across)) for y in inside):
                raise goes_on(name, body.x_in_file(name))
        return
    start, stop = gap(body.curve) or (body.clamp, body.tip)
    holes = hole_advice(gmsh, body, solids)
    through = f"; if it crosses an inlet, fill that with plug: {{inlet: [x, y, z]}}{holes}" if holes else ""
    raise outside_material(body.curve, (start - body.clamp, stop - body.clamp), through)


def _first_gap(gmsh: Any, body: CadBody, solids: list[Volume], y: float, across: float) -> tuple[float, float] | None:
    """From where to where (x, mm) the line at the height y between the ends lies outside the solids for the first time;
    None where it lies in them."""
    occ = gmsh.model.occ
    ends = [occ.addPoint(x, y, across) for x in (body.clamp, body.tip)]
    pieces, _ = occ.intersect([(1, occ.addLine(*ends))], solids, removeObject=True, removeTool=False)
    boxes = sorted(occ.getBoundingBox(*piece)[::3] for piece in pieces if piece[0] == 1)
    occ.remove(pieces, recursive=True)
    rounding, reached = NEAR_END * (body.tip - body.clamp), body.clamp
    for start, stop in boxes:
        if start > reached + rounding:
            return reached, start
        reached = max(reached, stop)
    return None if reached > body.tip - rounding else (reached, body.tip)


def named_parts(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point) -> dict[Volume, str]:
    """The name of the part of each solid, `BODY` for those without; of a symmetric body that of its mirror image too.

    Raises `DesignError` for a point in no solid, between two or in one that has a name already, and where all solids
    have one.
    """
    named = dict.fromkeys(solids, BODY)
    for name, point in body.parts.items():
        given, inner = f"the point {body.words(point)} lies", body.within_half(point, low, high)
        holders = [solid for solid in solids if gmsh.model.isInside(3, solid[1], list(inner))]
        if len(holders) != 1:
            where = "in the boundary of several solids" if holders else "in no solid of the file"
            raise DesignError(f"parts.{name}", f"{given} {where}; give a point inside one")
        if body.half:
            holders += [solid for solid in solids if _are_images(gmsh, solid, holders[0])]
        if taken := [named[solid] for solid in holders if named[solid] != BODY]:
            raise DesignError(f"parts.{name}", f"{given} in the same solid as that of {taken[0]}")
        named |= dict.fromkeys(holders, name)
    if body.parts and BODY not in named.values():
        raise DesignError("parts", f"all {len(solids)} solids are named; leave out that with the walls of the cavity")
    return named


def _are_images(gmsh: Any, first: Volume, second: Volume) -> bool:
    """Whether two solids have the same volume and centres that are mirror images of each other at z = 0."""
    volumes = [float(gmsh.model.occ.getMass(*solid)) for solid in (first, second)]
    centres = [np.array(gmsh.model.occ.getCenterOfMass(*solid)) for solid in (first, second)]
    apart = float(np.abs(centres[0] - centres[1] * [1, 1, -1]).max())
    same = abs(volumes[0] - volumes[1]) <= 1e-6 * volumes[0] and apart <= 1e-6 * volumes[0] ** (1 / 3)
    return first != second and same
