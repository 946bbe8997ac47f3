"""The shape of a configuration: which keys there are and of what kind each is (`pipeline.config.kinds`)."""

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import pydantic
from pydantic import ConfigDict

from fem.materials import LAWS, Constant
from geometry import FAMILIES, MESH_SUFFIXES, SURFACE_SUFFIXES, Axes, CadFile, CellPlanes, MeshFile, Plug, SurfaceFile
from pipeline.config.config import USUAL_TOLERANCE, AlongAxis
from pipeline.config.document import Document
from pipeline.config.kinds import (
    FROM_STATE,
    Acceleration,
    ActivationDistance,
    Cavities,
    Cell,
    Coarser,
    Count,
    CountFromZero,
    Directions,
    Ends,
    Experiments,
    Exponents,
    FaceNames,
    Forces,
    Formulation,
    Grading,
    LawChoice,
    Length,
    Lengths,
    MeshSize,
    Name,
    OnEnd,
    OptionalLength,
    OptionalYesNo,
    Percentage,
    PlugAtClamp,
    Plugs,
    Points,
    PoissonRatio,
    PositiveDensity,
    PositiveForce,
    PositiveLength,
    PositiveStress,
    Pressures,
    PressuresBetween,
    State,
    Stress,
    Stresses,
    Stretches,
    Text,
    Tolerance,
    Unit,
    WeightOf,
    YesNo,
)
from pipeline.errors import InputError

#: how the constants of a law are written
CONSTANTS: dict[Constant, Any] = {
    Constant.STRESS: Stress,
    Constant.POSITIVE_STRESS: PositiveStress,
    Constant.POISSON_RATIO: PoissonRatio,
    Constant.STRESSES: Stresses,
    Constant.EXPONENTS: Exponents,
}
#: the constant of a rubber law for which Poisson's ratio may be given
BULK = "kappa"
#: the section of the regions that have a material of their own
MATERIALS = "materials"
#: The family of a body that the user has drawn.
OWN = "own"


class _Section(pydantic.BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class _Mesh(_Section):
    size: MeshSize = None  #: edge that Gmsh aims at; `auto`: from the drawing, or for a requested accuracy
    formulation: Formulation = None  #: [elements](theory.md#elements), `auto` [chooses](#the-mesh)
    grading: Grading = None  #: where elements are [smaller](accuracy.md#graded-meshes), `auto` is `walls`
    coarser: Coarser = "auto"  #: element size of the [second mesh](#the-mesh), as a multiple of `size`


class _FilledMesh(_Section):
    size: MeshSize = None  #: edge that Gmsh aims at; `auto`: from the surface, or for a requested accuracy
    formulation: Formulation = None  #: [elements](theory.md#elements), `auto` [chooses](#the-mesh)
    coarser: Coarser = "auto"  #: element size of the [second mesh](#the-mesh), as a multiple of `size`


class _ReadyMesh(_Section):
    formulation: Formulation = None  #: [elements](theory.md#elements), the only key with a mesh file


class _End(_Section):
    x: OnEnd = AlongAxis(None)  #: experiment III: [displacement of the end, or force on it](#the-end-in-experiment-iii)
    y: OnEnd = AlongAxis(0.0)  #: experiment III: the same across the arm, prescribed change of height relative to rest


class _Identification(_Section):
    d: PositiveLength | None = None  #: break of the two lines, [given](identification.md#a-given-d) instead of sought
    weight: PositiveForce | None = None  #: weight of the arm for M/(m g l) in [results](results.md); default: its own
    weight_of: WeightOf | None = None  #: name printed beside results made dimensionless with this weight


class _Switch(_Section):
    state: State = "auto"  #: whether it is simulated; `auto`: the program decides


class _Validation(_Section):
    state: State = "auto"  #: whether validation loads are solved; `auto`: the program decides
    pressures: PressuresBetween | None = None  #: within those of the run; II and III are solved at them too
    end_y: Ends = ()  #: other heights of the end than `end.y`
    forces: Forces = ()  #: dead forces on the end


class _SelfContact(_Switch):
    dhat: ActivationDistance | None = None  #: activation distance, below the smallest gap at rest; default: 1/50 of it
    faces: FaceNames | None = None  #: faces that can meet; default: `gap`, or `outer` without a `gap`


class _Gravity(_Switch):
    acceleration: Acceleration = (0.0, -9810.0, 0.0)  #: acceleration of gravity


class _Layer(_Switch):
    thickness: PositiveLength = 0.1  #: thickness of the layer
    E: PositiveStress = 6500.0  #: Young's modulus of the layer
    nu: PoissonRatio = 0.2  #: Poisson's ratio of the layer


class _Pressure(_Switch):
    cavities: Cavities = {}  #: fractions of the pressure of the run, or constant pressures, by cavity


class _Effects(_Section):
    pressure: Annotated[_Pressure, FROM_STATE] = _Pressure()
    self_contact: Annotated[_SelfContact, FROM_STATE] = _SelfContact()
    symmetry: Annotated[_Switch, FROM_STATE] = _Switch()
    incompressibility: Annotated[_Switch, FROM_STATE] = _Switch()
    gravity: Annotated[_Gravity, FROM_STATE] = _Gravity()
    strain_limiting_layer: Annotated[_Layer, FROM_STATE] = _Layer()


EFFECTS = tuple(_Effects.model_fields)


class _Newton(_Section):
    tolerance: Tolerance = USUAL_TOLERANCE  #: largest relative residual of an equilibrium


class _Document(_Section):
    name: Name  #: name of the design
    pressures: Pressures = (5.0, 17.0, 31.0, 45.0)  #: pressures of the run
    experiments: Experiments = ("I", "II", "III")  #: II and III give the parameters; I, the free body, may be left out
    end: _End = _End()
    identification: _Identification = _Identification()
    added_pressures: CountFromZero = 0  #: how many pressures the program may add between the given ones
    validation: Annotated[_Validation, FROM_STATE] = _Validation()
    law: LawChoice = "both"  #: of the rod, not of the material: five parameters, the [arm's own law](cell.md) or both
    newton: _Newton = _Newton()
    accuracy: Percentage = None  #: [largest error](accuracy.md#requested-accuracy) a run may have; also `--accuracy`
    effects: _Effects = _Effects()


def checked(document: Document) -> tuple[Any, str, dict[str, str]]:
    """What `document` says, by keys with the numbers in mm, N, MPa and kPa; the family of its body, and its laws by the
    region, that of the body with an empty name.

    Raises InputError.
    """
    refusals: list[str] = []
    family = _choice(document, ("geometry", "family"), (*FAMILIES, OWN), refusals)
    keys = {"": ("material", "law")} | {name: (MATERIALS, name, "law") for name in _regions(document, refusals)}
    laws = {name: _choice(document, key, tuple(LAWS), refusals) for name, key in keys.items()}
    model = _model(None if family is None else _design(family, document), laws)
    try:
        content = model.model_validate(document.content)
        chosen = {name: law for name, law in laws.items() if law is not None}
        if family is not None and len(chosen) == len(laws) and not refusals:
            return content, family, chosen
    except pydantic.ValidationError as refused:
        refusals += document.refusal(refused.errors(), model).sentences
    raise InputError(*refusals)


def _regions(document: Document, refusals: list[str]) -> list[str]:
    """The names of the regions with a material of their own; a refusal more where they are written in another way."""
    regions = document.content.get(MATERIALS, {})
    if isinstance(regions, Mapping) and all(isinstance(name, str) and name for name in regions):
        taken = [name for name in regions if name.startswith(("_", "model_")) or hasattr(pydantic.BaseModel, name)]
        for name in taken:
            refusals.append(
                document.sentence((MATERIALS, name), "has a name that cannot be used here; rename the group")
            )
        return [name for name in regions if name not in taken]
    example = "'materials: {base: {law: svk, E: 5 MPa, nu: 0.495}}'"
    refusals.append(document.sentence((MATERIALS,), f"must hold the names of regions, for example {example}"))
    return []


def _choice(document: Document, key: tuple[str, ...], allowed: tuple[str, ...], refusals: list[str]) -> str | None:
    """The name at a key; where it is none of those allowed, None and one more refusal."""
    try:
        return document.choice(key, allowed)
    except InputError as failure:
        refusals += failure.sentences
        return None


def _design(family: str, document: Document) -> Any:
    """The class of designs with the keys of `family`; a user's own file is a mesh or a drawing by its suffix."""
    if family != OWN:
        return FAMILIES[family]
    return own_design(str(document.content["geometry"].get("file", "")))


def own_design(file: str) -> type[CadFile] | type[MeshFile] | type[SurfaceFile]:
    """The class of designs that reads a user's own file, by its suffix."""
    suffix = Path(file).suffix.lower()
    if suffix in SURFACE_SUFFIXES:
        return SurfaceFile
    return MeshFile if suffix in MESH_SUFFIXES else CadFile


def _model(design: Any, laws: Mapping[str, str | None]) -> type[pydantic.BaseModel]:
    """The shape of a document about a body of the class `design` made of solids that obey `laws`, by region.

    Where one of them is None, anything may stand in its section.
    """
    geometry: Any = (Any, None) if design is None else (geometry_model(design), ...)
    kinds: dict[str, Any] = {
        name: (Any, None) if law is None else (material_model(law), ...) for name, law in laws.items()
    }
    material = kinds.pop("")
    regions: Any = (Any, None)
    if kinds:
        regions = (pydantic.create_model("Materials", __base__=_Section, **kinds), ...)
    section = {MeshFile: _ReadyMesh, SurfaceFile: _FilledMesh}.get(design, _Mesh)
    mesh: Any = (section, section())
    return pydantic.create_model(
        "Document", __base__=_Document, geometry=geometry, material=material, materials=regions, mesh=mesh
    )


def geometry_model(design: Any) -> Any:
    """The keys of the geometry of a class of designs."""
    return pydantic.create_model("Geometry", __base__=_Section, family=(str, ...), **_geometry_fields(design))


#: constants whose usual size is not that of other stresses
EXAMPLES = {"c10": "0.12 MPa", "c01": "0.08 MPa", "c20": "0 MPa", "c30": "0 MPa"}


def material_model(law: str) -> Any:
    """The keys of a material that obeys `law`; instead of its bulk modulus kappa nu may be given."""
    constants: dict[str, Any] = {
        name: (CONSTANTS[kind], pydantic.Field(examples=[EXAMPLES[name]]) if name in EXAMPLES else ...)
        for name, kind in LAWS[law].constants().items()
    }
    if BULK in constants:
        constants |= {BULK: (PositiveStress | None, None), "nu": (PoissonRatio | None, None)}
    return pydantic.create_model(
        "Material",
        __base__=_Section,
        law=(str, ...),
        **constants,
        density=(PositiveDensity | None, None),
        holds_between=(Stretches | None, None),
    )


def _geometry_fields(design: Any) -> dict[str, Any]:
    """The fields of a design as pydantic takes them: counts are plain numbers, floats are lengths."""
    kinds = {
        int: Count,
        float: Length,
        tuple[float, ...]: Lengths,
        float | None: OptionalLength,
        str: Text,
        bool: YesNo,
        bool | None: OptionalYesNo,
        Axes: Directions,
        float | CellPlanes | None: Cell,
        Plug: Plugs,
    }
    types = get_type_hints(design)
    named = {"unit": Unit} | ({"plug": PlugAtClamp} if types.get("plug") is bool else {})
    return {
        field.name: (named.get(field.name) or kinds.get(types[field.name], Points), default_of(field, ...))
        for field in fields(design)
    }


def default_of(field: Field[Any], required: Any) -> Any:
    """The default of a field of a design, or `required` where it has none."""
    if field.default_factory is not MISSING:
        return field.default_factory()
    return required if field.default is MISSING else field.default
