"""The shape of a configuration: which keys there are and of what kind each is (`pipeline.config.kinds`)."""

from dataclasses import MISSING, fields
from typing import Annotated, Any, get_type_hints

import pydantic
from pydantic import ConfigDict, Field

from fem.materials import LAWS, Constant
from geometry import FAMILIES, CadFile, MeshFile
from pipeline.config.document import Document
from pipeline.config.kinds import (
    FROM_STATE,
    Acceleration,
    Coarser,
    Count,
    CountFromZero,
    FaceNames,
    Force,
    Formulation,
    Grading,
    LawChoice,
    Length,
    MeshSize,
    Name,
    OneCavity,
    Percentage,
    Points,
    PoissonRatio,
    PositiveDensity,
    PositiveLength,
    PositiveStress,
    Pressures,
    State,
    Stress,
    Text,
    Tolerance,
    YesNo,
)

#: how the constants of a law are written
CONSTANTS: dict[Constant, Any] = {
    Constant.STRESS: Stress,
    Constant.POSITIVE_STRESS: PositiveStress,
    Constant.POISSON_RATIO: PoissonRatio,
}
#: The family of a body that the user has drawn.
OWN = "own"


class _Section(pydantic.BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class _Mesh(_Section):
    size: MeshSize
    formulation: Formulation | None = None
    grading: Grading = "off"
    coarser: Coarser | None = None


class _ReadyMesh(_Section):
    formulation: Formulation | None = None


class _End(_Section):
    y: Length = 0.0


class _Switch(_Section):
    state: State = "auto"


class _Validation(_Switch):
    pressures: Annotated[Pressures | None, Field(examples=["[24 kPa]"])] = None
    end_y: Annotated[tuple[Length, ...], Field(strict=False, examples=["[10 mm, -10 mm]"])] = ()
    forces: Annotated[tuple[Force, ...], Field(strict=False, examples=["[[0 N, 0.05 N]]"])] = ()


class _SelfContact(_Switch):
    dhat: PositiveLength | None = None
    faces: FaceNames | None = None


class _Gravity(_Switch):
    acceleration: Acceleration = (0.0, -9810.0, 0.0)


class _Layer(_Switch):
    thickness: PositiveLength = 0.1
    E: PositiveStress = 6500.0
    nu: PoissonRatio = 0.2


class _Pressure(_Switch):
    cavities: dict[str, OneCavity] = {}


class _Effects(_Section):
    pressure: Annotated[_Pressure, FROM_STATE] = _Pressure()
    self_contact: Annotated[_SelfContact, FROM_STATE] = _SelfContact()
    symmetry: Annotated[_Switch, FROM_STATE] = _Switch()
    incompressibility: Annotated[_Switch, FROM_STATE] = _Switch()
    gravity: Annotated[_Gravity, FROM_STATE] = _Gravity()
    strain_limiting_layer: Annotated[_Layer, FROM_STATE] = _Layer()


EFFECTS = tuple(_Effects.model_fields)


class _Newton(_Section):
    tolerance: Tolerance = 1e-6


class _Document(_Section):
    name: Name
    pressures: Pressures = (5.0, 17.0, 31.0, 45.0)
    end: _End = _End()
    added_pressures: CountFromZero = 0
    validation: Annotated[_Validation, FROM_STATE] = _Validation()
    law: LawChoice = "both"
    newton: _Newton = _Newton()
    accuracy: Percentage = None
    effects: _Effects = _Effects()


def checked(document: Document) -> tuple[Any, str, str]:
    """What `document` says, by keys with the numbers in mm, N, MPa and kPa; the family of its body and its law.

    Raises InputError.
    """
    family = document.choice(("geometry", "family"), (*FAMILIES, OWN))
    law = document.choice(("material", "law"), tuple(LAWS))
    model = _model(_design(family, document), law)
    try:
        return model.model_validate(document.content), family, law
    except pydantic.ValidationError as refused:
        raise document.refusal(refused.errors(), model) from None


def _design(family: str, document: Document) -> Any:
    """The class of designs with the keys of `family`; a user's own file is a mesh or a drawing by its suffix."""
    if family != OWN:
        return FAMILIES[family]
    file = document.content["geometry"].get("file", "")
    return MeshFile if str(file).lower().endswith(".msh") else CadFile


def _model(design: Any, law: str) -> type[pydantic.BaseModel]:
    """The shape of a document about a body of the class `design` made of a solid that obeys `law`."""
    geometry: Any = pydantic.create_model("Geometry", __base__=_Section, family=(str, ...), **_geometry_fields(design))
    constants: dict[str, Any] = {name: (CONSTANTS[kind], ...) for name, kind in LAWS[law].constants().items()}
    material: Any = pydantic.create_model(
        "Material",
        __base__=_Section,
        law=(str, ...),
        density=(PositiveDensity, ...),
        **constants,
    )
    mesh: Any = (_ReadyMesh, _ReadyMesh()) if design is MeshFile else (_Mesh, ...)
    return pydantic.create_model(
        "Document", __base__=_Document, geometry=(geometry, ...), material=(material, ...), mesh=mesh
    )


def _geometry_fields(design: Any) -> dict[str, Any]:
    """The fields of a design as pydantic takes them: counts are plain numbers, floats are lengths."""
    kinds = {int: Count, float: Length, str: Text, bool: YesNo}
    types = get_type_hints(design)
    optional = {field.name: ... if field.default is MISSING else field.default for field in fields(design)}
    return {name: (kinds.get(types[name], Points), default) for name, default in optional.items()}
