"""Elements, grading and size of a mesh where the configuration leaves them to the program, each with its reason.

The constants are measured (studies/accuracy.md).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import sqrt
from typing import Annotated, Any, Literal

from fem.elements import ELEMENTS, MOST_ACCURATE, NEARLY_INCOMPRESSIBLE
from geometry import GRADINGS, Design, DesignError, MeshFile, SurfaceFile
from geometry.families.design import expected_tets
from pipeline.config.body import design_conflicts
from pipeline.config.kinds import number, one_of
from pipeline.config.section import Field, Kind, ReadContext, Section, conflict, raise_all, section, wrong
from pipeline.config.units import LENGTH, convert
from pipeline.values.formatting import round_down

#: size without grading over that with it, because the walls are coarser there: the deflection of the finger of
#: studies/own_bodies.md from an STL file is off by 2.0 % with 0.9 and by 3.5 % with 1.2, its end force by 2.0
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
#: size of the coarsest mesh of a cell over the length over which walls bend
OF_CELL = 1.4
#: most elements of a chosen mesh, about 500 000 unknowns: minutes per pressure
MOST_CHOSEN_TETS = 100_000
#: size of the second mesh over that of the first, by which the error of a chosen mesh is estimated
COARSER = 1.5


_EDGE = Kind(
    "above 0, or `auto`",
    LENGTH.example,
    "mm",
    read=lambda value: None if value == "auto" else convert(value, LENGTH),
    test=lambda size: size is None or size > 0.0,
)


def _coarser(value: Any) -> Any:
    """auto, off (YAML 1.1 reads a bare off as false) or a number above 1."""
    return value or "off" if value is False or value in ("auto", "off") else number(value)


@section(frozen=True)
class GivenMesh(Section):
    """What a configuration says about its mesh; "auto", and None as a size, are left to the program."""

    size_mm: Annotated[float | None, _EDGE] = Field(
        default=None, description="edge that Gmsh aims at; `auto`: from the drawing"
    )
    formulation: Annotated[str, one_of((*ELEMENTS, "auto"))] = Field(
        default="auto", description="[elements](theory.md#elements), `auto` [chooses](#the-mesh)", examples=["mixed"]
    )
    grading: Annotated[str, one_of((*GRADINGS, "auto"))] = Field(
        default="auto", description="where elements are [smaller](accuracy.md#graded-meshes), `auto` is `walls`"
    )
    coarser: Annotated[
        float | Literal["auto", "off"],
        Kind(
            "1.1 to 5, `auto` or `off`",
            "1.5",
            "1",
            _coarser,
            lambda factor: isinstance(factor, str) or 1.1 <= factor <= 5.0,
        ),
    ] = Field(default="auto", description="element size of the [second mesh](#the-mesh), as a multiple of `size`")


#: keys of the mesh that a body from a file does not have
NO_KEYS: dict[Any, tuple[str, ...]] = {MeshFile: ("size", "grading", "coarser"), SurfaceFile: ("grading",)}


@dataclass(frozen=True)
class MeshSettings:
    """How fine the mesh is and which elements it has."""

    size_mm: float
    formulation: str  #: one of fem.elements.ELEMENTS
    coarser: float | None = None  #: size of a second mesh over that, for the mesh error of the parameters
    grading: str = "off"  #: one of geometry.GRADINGS
    #: why, by key, for what was left to the program
    chosen: Mapping[str, str] = field(default_factory=dict)


def read_mesh(given: GivenMesh, beside: ReadContext) -> MeshSettings:
    """The mesh as given, and as the program chooses it where it is not."""
    (effects,) = beside.known("effects")
    against_locking, formulation = effects.incompressibility.decided, given.formulation
    if formulation != "auto" and against_locking == ELEMENTS[formulation].fully_integrated:
        sentence = f"incompressibility {effects.incompressibility.state} and formulation {formulation} contradict each"
        keys = ("effects", "incompressibility"), ("mesh", "formulation")
        raise_all([conflict(f"{sentence} other; leave one of them out", *keys)])
    design, material, materials = beside.known("design", "material", "materials")
    allowed = [key for key in GivenMesh.key_fields() if key not in NO_KEYS.get(type(design), ())]
    written = beside.document.content.get("mesh")
    unknown = [key for key in written if key not in allowed] if isinstance(written, Mapping) else []
    raise_all(wrong(f"unknown key; allowed here: {', '.join(allowed)}", (key,)) for key in unknown)
    is_ready, coarser = not design.is_resizable, given.coarser
    nu = max(solid.built().poisson_ratio for solid in (material, *materials.values()))
    try:
        if is_ready:
            given, coarser = replace(given, size_mm=design.given_element_size), "off"
        chosen = chosen_mesh(design, material.law, nu, against_locking, given)
        if not is_ready:
            design.check_size(chosen.size_mm)
    except DesignError as refused:
        raise_all(design_conflicts(refused, {}))
    factor = COARSER if coarser == "auto" else None if coarser == "off" else coarser
    return replace(chosen, coarser=factor)


def chosen_mesh(design: Design, law: str, nu: float, against_locking: bool | None, given: GivenMesh) -> MeshSettings:
    """The mesh of a design of a solid with the named law and Poisson's ratio `nu`.

    against_locking: whether an element that does not lock was requested; None decides by nu. A size of a mesh file is
    that of its elements and has to be given.
    """
    reasons: dict[str, str] = {}
    formulation, grading, size = given.formulation, given.grading, given.size_mm
    if formulation == "auto":
        formulation, reasons["formulation"] = _formulation(design, law, nu, against_locking)
    if grading == "auto":
        grading = "walls" if design.has_drawing else "off"
        if grading == "walls":
            reasons["grading"] = "most of the error of the mesh arises where thin walls bend"
    if size is None:
        size, reasons["size"] = _size(design, grading)
    return MeshSettings(size, formulation, None, grading, reasons)


def cell_mesh(design: Design, law: str, nu: float, against_locking: bool | None) -> MeshSettings:
    """The mesh from which the law of a cell can be corrected to its limit; arguments as those of `chosen_mesh`.

    Surfaces of the St. Venant-Kirchhoff law buckle in `mixed` elements, so that a cell of `pneunet_coarse` does not
    reach the moments of experiment III at 30 kPa. `p2p0` elements bear them, and need to be smaller.
    """
    formulation, _ = _formulation(design, law, nu, against_locking)
    grading = "walls" if design.has_drawing else "off"
    part = OF_CELL if formulation == MOST_ACCURATE else 1.0
    return MeshSettings(round_down(part * _for_walls(design, grading), 2), formulation, None, grading)


def _formulation(design: Design, law: str, nu: float, against_locking: bool | None) -> tuple[str, str]:
    """The element and why."""
    if against_locking is False:
        return "p2", "effects.incompressibility is off"
    if against_locking is None and nu < NEARLY_INCOMPRESSIBLE:
        return "p2", f"with a Poisson ratio of {nu:.6g} nothing locks"
    if law == "svk" and design.outer_corners:
        return "p2p0", (
            "mixed elements, though more accurate, end early in the corner at the clamp, with fillets too: a surface "
            "of the St. Venant-Kirchhoff law buckles where it is compressed to 0.66 of its length, other laws bear more"
        )
    return MOST_ACCURATE, f"it does not lock at a Poisson ratio of {nu:.6g} and its error falls fastest with the mesh"


def _size(design: Design, grading: str) -> tuple[float, str]:
    """The size (mm) and why."""
    wall, side = design.thinnest_wall, min(design.extent)
    part = COARSEST_OF_FAMILY.get(design.family, COARSEST_OF_OTHERS)
    suits = _for_walls(design, grading)
    reason = f"walls of {wall:.3g} mm in a body {side:.3g} mm across need it"
    if suits > part * side:
        suits = part * side
        kind = "bodies from files" if design.is_from_file else design.family
        reason = f"that is {part:g} times the smallest side, the most for {kind}"
    size = suits
    while expected_tets(size, design.extent, design.meshed_volume) > MOST_CHOSEN_TETS:
        size *= 1.05
    if size > suits:
        reason = f"{suits:.2g} mm would be right, but the body would then have more than {MOST_CHOSEN_TETS} elements"
    return round_down(size, 2), reason


def _for_walls(design: Design, grading: str) -> float:
    """The length (mm) over which walls bend, as far as a grading resolves them."""
    length = sqrt(design.thinnest_wall * min(design.extent) / 2)
    return length * (WITHOUT_GRADING if grading == "off" else 1.0)
