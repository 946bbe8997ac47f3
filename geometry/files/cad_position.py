"""Whether the solids of a CAD file lie where an arm has to lie: unit, clamp, tip, curve, and symmetry about z = 0."""

from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.errors import DesignError
from geometry.files.cad_import import STEP, CadBody, Point, has_splines
from geometry.files.cad_mirror import difference
from geometry.files.orientation import UNEQUAL, Lying
from geometry.meshing.shapes import Volume

#: A body smaller or larger than this (mm) is refused: its file is likely in another unit.
SMALLEST, LARGEST = 1.0, 3000.0
#: A body smaller than this (mm) may be in inches or cm.
USUAL = 10.0
#: Part of the volume of a symmetric body in which both halves together may differ.
DIFFERENT = 2e-6
#: A face all of which is nearer to the plane of an end than this, over the length, may lie in it: the CAD kernel draws
#: boxes wider than faces, by more in files in metres.
NEAR_END = 1e-3


def check_dimensions(sides: Array, unit: float | None) -> None:
    """Raise `DesignError` unless the sides (3,) of a body, mm, are those of an arm.

    unit: mm per unit of its file; None for a file that stores its unit.
    """
    if SMALLEST <= sides.max() <= LARGEST:
        return
    measures = " x ".join(f"{side:.4g}" for side in sides)
    if unit is None:
        raise DesignError("file", f"the body measures {measures} mm; scale it in the CAD program")
    raise DesignError(
        ("file", "unit"), f"the body measures {measures} mm; is its file in another unit than {unit:g} mm?"
    )


def doubt_of_unit(sides: Array, remedy: str = "give the unit of its file, geometry.unit") -> str:
    """The end of a sentence on a position outside of a body with the sides (3,), mm, that is small; else empty."""
    if sides.max() >= USUAL:
        return ""
    measures = " x ".join(f"{side:.4g}" for side in sides)
    return f"; the body measures {measures} mm: if that is too small, {remedy}"


def _stores_unit(body: CadBody) -> bool:
    return body.source.path.suffix.lower() in STEP


def _doubt(body: CadBody, sides: Array) -> str:
    if _stores_unit(body):
        return doubt_of_unit(sides, "scale it in the CAD program, because STEP files store their unit")
    return doubt_of_unit(sides)


def check_position(gmsh: Any, body: CadBody, solids: list[Volume], low: Point, high: Point) -> None:
    """Raise `DesignError` unless the unit is plausible and clamp, tip, curve and symmetry fit the bounds (mm)."""
    signs = np.array([-1.0, 1.0, -1.0]) if body.turned else np.ones(3)
    corners = np.sort(np.array([low, high]) * signs, axis=0) + 0.0  # as in the file, which has no -0
    sides = corners[1] - corners[0]
    check_dimensions(sides, None if _stores_unit(body) else body.source.unit)
    tolerance = 1e-6 * sides.max()
    for key, axis in (("clamp", 0), ("tip", 0), ("curve", 1)):
        position, (first, last) = getattr(body, key) * signs[axis] + 0.0, corners[:, axis]
        if not first - tolerance <= position <= last + tolerance:
            raise DesignError(
                key,
                f"{'xyz'[axis]} = {position:g} mm lies outside the body, "
                f"which reaches from {first:.4g} to {last:.4g} mm{_doubt(body, sides)}",
            )

    def lying() -> Lying:
        return Lying(corners[0], corners[1], body.middle, body.source.has_axes, not has_splines(gmsh, solids))

    near, far = corners[:, 2]
    at_side = min(abs(near), abs(far)) <= tolerance
    if body.half and np.argmax(sides) == 2 and at_side:
        raise DesignError(
            ("symmetric", "axes"),
            f"the body would be one half of an arm that is wider than it is long; {lying().turn}",
        )
    is_beside = at_side and not body.says_half if body.half else not near < -tolerance < tolerance < far
    if is_beside:
        raise DesignError(("symmetric", "middle"), lying().beside(halves=True))
    if body.half and not at_side and abs(near + far) > UNEQUAL * sides.max():
        lies = lying()
        advice = (
            f"{lies.whole}, if the file holds the whole arm; for one half write symmetric: true and the z of its plane "
            f"of symmetry, middle: {lies.sides}; for a whole arm that is not symmetric write symmetric: false"
        )
        raise DesignError(
            ("symmetric", "middle"),
            f"{lies.reach}: z = 0 is neither in the middle of the body nor at its side; {lies.turned_or(advice)}",
        )


def check_ends(gmsh: Any, body: CadBody, solids: list[Volume]) -> None:
    """Raise `DesignError` unless solids have a face near the plane of the clamp, and one near that of the tip.

    Whether it lies in the plane shows once it is meshed.
    """
    faces = gmsh.model.getBoundary(solids, combined=False, oriented=False)
    reach = np.array([gmsh.model.getBoundingBox(*face) for face in faces])[:, [0, 3]]
    for name in ("clamp", "tip"):
        away = np.abs(reach - getattr(body, name)).max(axis=1)
        if away.min() > NEAR_END * (body.tip - body.clamp):
            raise no_end_face(body, name)


def no_end_face(body: CadBody, name: str) -> DesignError:
    """The refusal of a body without a face in the plane of the end `name`."""
    position = getattr(body, name) * (-1 if body.turned else 1)
    return DesignError(
        name,
        f"the body has no face in the plane x = {position:g} mm; clamp and tip are flat faces across x: cut a "
        "rounded end off in the CAD program, or turn the body with axes",
    )


def goes_on(name: str, x: float) -> DesignError:
    """The refusal of a body with material on both sides of the plane of the end `name`; x: as the user gave it, mm."""
    return DesignError(
        name,
        f"the body goes on beyond x = {x:g} mm at the height of the material curve, which ends there; give the x of "
        "the face where the body ends at this height, another height (curve), or cut the rest off in the CAD program",
    )


def check_symmetric(gmsh: Any, solids: list[Volume]) -> None:
    """Raise `DesignError` unless solids of one material and their mirror images at z = 0 fill the same space."""
    fraction = difference(gmsh, solids, solids, 2, 0.0, DIFFERENT).fraction
    gmsh.model.occ.synchronize()
    if fraction > DIFFERENT:
        raise DesignError(
            "symmetric",
            f"the halves of the body about z = 0 differ ({50 * fraction:.2g} % of its volume); write false",
        )
