"""Elements, grading and size of a mesh where the configuration leaves them to the program, each with its reason.

The constants are measured (docs/accuracy.md, "Elements chosen by the program").
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import floor, log10, sqrt

from fem.elements import MOST_ACCURATE, NEARLY_INCOMPRESSIBLE
from geometry import Design
from geometry.families.design import expected_tets

#: size without grading over that with it, because the walls are coarser there: the deflection of the finger of
#: docs/how_to/own_bodies_tried.md from an STL file is off by 2.0 % with 0.9 and by 3.5 % with 1.2, its end force by 2.0
#: and 3.8 % (20 kPa, against a mesh of 1.6 mm)
WITHOUT_GRADING = 0.9
#: largest size over the smallest side of a body
COARSEST = 0.4
#: the same by family. Without gaps an arm bends by the small difference of what its two sides stretch, and where the
#: walls are thick the error of the mesh is a large part of that; it is largest with flat walls, which meet in sharp
#: re-entrant edges, and with a single cavity
COARSEST_OF_FAMILY = {"pneunet": COARSEST, "semicircular_single": 0.15, "rectangular": 0.12}
#: the same of other families, and of bodies from files
COARSEST_OF_OTHERS = 0.18
#: most elements of a chosen mesh, about 500 000 unknowns: minutes per pressure
MOST_CHOSEN_TETS = 100_000
#: size of the second mesh over that of the first, by which the error of a chosen mesh is estimated
COARSER = 1.5


@dataclass(frozen=True)
class GivenMesh:
    """What a configuration says about its mesh; None is left to the program."""

    size_mm: float | None
    formulation: str | None
    grading: str | None


@dataclass(frozen=True)
class ChosenMesh:
    """The mesh to make, and why for everything that was left to the program."""

    size_mm: float
    formulation: str
    grading: str
    reasons: Mapping[str, str]  #: by key of the configuration


def chosen_mesh(design: Design, law: str, nu: float, against_locking: bool | None, given: GivenMesh) -> ChosenMesh:
    """The mesh of a design of a solid with the named law and Poisson's ratio `nu`.

    against_locking: whether an element that does not lock was requested; None decides by nu. A size of a mesh file is
    that of its elements and has to be given.
    """
    reasons: dict[str, str] = {}
    formulation, grading, size = given.formulation, given.grading, given.size_mm
    if formulation is None:
        formulation, reasons["formulation"] = _formulation(design, law, nu, against_locking)
    if grading is None:
        grading = "walls" if design.has_drawing else "off"
        if grading == "walls":
            reasons["grading"] = "most of the error of the mesh arises where thin walls bend"
    if size is None:
        size, reasons["size"] = _size(design, grading)
    return ChosenMesh(size, formulation, grading, reasons)


def _formulation(design: Design, law: str, nu: float, against_locking: bool | None) -> tuple[str, str]:
    """The element and why."""
    if against_locking is False:
        return "p2", "effects.incompressibility is off"
    if against_locking is None and nu < NEARLY_INCOMPRESSIBLE:
        return "p2", f"with a Poisson ratio of {nu:.3g} nothing locks"
    if law == "svk" and design.outer_corners:
        return "p2p0", (
            "mixed elements, though more accurate, end early in the corner at the clamp, with fillets too: a surface "
            "of the St. Venant-Kirchhoff law buckles where it is compressed to 0.66 of its length, other laws bear more"
        )
    return MOST_ACCURATE, f"it does not lock at a Poisson ratio of {nu:.3g} and its error falls fastest with the mesh"


def _size(design: Design, grading: str) -> tuple[float, str]:
    """The size (mm) and why."""
    wall, side = design.thinnest_wall, min(design.extent)
    part = COARSEST_OF_FAMILY.get(design.family, COARSEST_OF_OTHERS)
    suits = sqrt(wall * side / 2) * (WITHOUT_GRADING if grading == "off" else 1.0)  # over that length walls bend
    reason = f"walls of {wall:.3g} mm in a body {side:.3g} mm across need it"
    if suits > part * side:
        suits = part * side
        kind = "bodies from files" if design.is_from_file else design.family
        reason = f"that is {part:g} times the smallest side, the most for {kind}"
    size = not_too_many(design, suits)
    if size > suits:
        reason = f"{suits:.2g} mm would be right, but the body would then have more than {MOST_CHOSEN_TETS} elements"
    return two_digits_down(size), reason


def not_too_many(design: Design, size: float) -> float:
    """The size (mm), or a larger one with which a body has about MOST_CHOSEN_TETS elements."""
    while expected_tets(size, design.extent, design.meshed_volume) > MOST_CHOSEN_TETS:
        size *= 1.05
    return size


def two_digits_down(value: float) -> float:
    """A positive number rounded down to two digits."""
    digits = 1 - floor(log10(value))
    return round(floor(value * 10**digits + 1e-9) / 10**digits, digits)
