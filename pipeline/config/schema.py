"""The shape of a configuration: which keys there are, their units and what each may be. The only door to pydantic."""

import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from itertools import pairwise
from typing import Annotated, Any, Literal, get_type_hints

import pydantic
from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from fem.elements import ELEMENTS
from fem.materials import LAWS, Constant
from geometry import FAMILIES, GRADINGS, CadFile, MeshFile
from pipeline.config.config import CavityPressure
from pipeline.config.document import Document
from pipeline.config.units import ACCELERATION, DENSITY, FORCE, LENGTH, PRESSURE, STRESS, Dimension, convert
from pipeline.errors import quoted


def _in(dimension: Dimension) -> BeforeValidator:
    return BeforeValidator(lambda value: convert(value, dimension))


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{quoted(value)} is not a plain number; write it without a unit, for example 0.495")
    return float(value)


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{quoted(value)} is not a whole number; write it without a unit, for example 11")
    return value


def _yes_or_no(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{quoted(value)} is neither true nor false")
    return value


def _above_zero(value: float) -> float:
    if not value > 0.0:
        raise ValueError(f"{value:g} is not allowed; allowed: above zero")
    return value


def _above_one(value: float) -> float:
    if not value > 1.0:
        raise ValueError(f"{value:g} is not coarser; allowed: above 1, for example 1.5")
    return value


def _poisson_ratio(value: float) -> float:
    if not -1.0 < value < 0.5:
        raise ValueError(f"{value:g} is not a Poisson ratio a body can have here; allowed: above -1 and below 0.5")
    return value


def _ascending(values: tuple[float, ...]) -> tuple[float, ...]:
    if not values:
        raise ValueError("is empty; give at least one pressure, for example [17 kPa, 37 kPa]")
    if min(values) <= 0.0:
        raise ValueError(f"{min(values):g} kPa is not above zero; give pressures above 0 kPa in ascending order")
    if any(later <= earlier for earlier, later in pairwise(values)):
        listed = ", ".join(f"{value:g} kPa" for value in values)
        raise ValueError(f"[{listed}] is not in ascending order; list every pressure once, the lowest first")
    return values


def _three(example: str) -> Callable[[tuple[float, ...]], tuple[float, ...]]:
    def check(values: tuple[float, ...]) -> tuple[float, ...]:
        if len(values) != 3:
            raise ValueError(f"has {len(values)} numbers instead of x, y and z; for example {example}")
        return values

    return check


def _pair(values: tuple[float, ...]) -> tuple[float, ...]:
    if len(values) != 2:
        raise ValueError(f"has {len(values)} numbers instead of the force along x and y; for example [0 N, 0.05 N]")
    return values


def _not_below_zero(value: int) -> int:
    if value < 0:
        raise ValueError(f"{quoted(value)} is not allowed; allowed: 0 or more")
    return value


STATES = ("auto", "on", "off")


def _state(value: Any) -> Any:
    """auto, on or off; YAML 1.1 reads a bare on as true."""
    state = {True: "on", False: "off"}[value] if isinstance(value, bool) else value
    if state not in STATES:
        raise ValueError(f"{quoted(value)} is not allowed; allowed: auto, on or off")
    return state


def _names(value: Any) -> Any:
    """One name, or several."""
    return value if isinstance(value, list) and value else [value]


def _effect(value: Any) -> Any:
    """A bare state is an effect with the usual parameters; parameters without a state switch the effect on."""
    return {"state": "on", **value} if isinstance(value, Mapping) else {"state": _state(value)}


def _fraction_or_pressure(value: Any) -> CavityPressure:
    """A plain number is a fraction of the pressure of the run, one with a unit is a constant pressure."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return CavityPressure(float(value), 0.0)
    try:
        return CavityPressure(0.0, convert(value, PRESSURE))
    except ValueError:
        raise ValueError(
            f"{quoted(value)} is neither a fraction of the pressure, for example 0.5, nor a pressure, for example "
            "'10 kPa'"
        ) from None


Length = Annotated[float, _in(LENGTH), Field(examples=[LENGTH.example])]
PositiveLength = Annotated[Length, AfterValidator(_above_zero)]
Stress = Annotated[float, _in(STRESS), Field(examples=[STRESS.example])]
PositiveStress = Annotated[float, _in(STRESS), AfterValidator(_above_zero), Field(examples=[STRESS.example])]
PositiveDensity = Annotated[float, _in(DENSITY), AfterValidator(_above_zero), Field(examples=[DENSITY.example])]
Pressure = Annotated[float, _in(PRESSURE)]
Pressures = Annotated[tuple[Pressure, ...], AfterValidator(_ascending), Field(strict=False)]
Acceleration = Annotated[
    tuple[Annotated[float, _in(ACCELERATION)], ...],
    AfterValidator(_three("[0 m/s^2, -9.81 m/s^2, 0 m/s^2]")),
    Field(strict=False),
]
Point = Annotated[
    tuple[Length, ...], AfterValidator(_three("[56 mm, 8 mm, 0 mm]")), Field(strict=False, examples=["[56 mm, ...]"])
]
Force = Annotated[tuple[Annotated[float, _in(FORCE)], ...], AfterValidator(_pair), Field(strict=False)]
Points = Annotated[dict[str, Point], Field(examples=["{cavity: [56 mm, 8 mm, 0 mm]}"])]
Coarser = Annotated[float, BeforeValidator(_number), AfterValidator(_above_one), Field(examples=["1.5"])]
PoissonRatio = Annotated[float, BeforeValidator(_number), AfterValidator(_poisson_ratio), Field(examples=["0.495"])]
Count = Annotated[int, BeforeValidator(_count), Field(examples=["11"])]
YesNo = Annotated[bool, BeforeValidator(_yes_or_no), Field(examples=["true"])]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", examples=["pneunet"])]
Text = Annotated[str, Field(min_length=1)]
FaceNames = Annotated[tuple[Text, ...], BeforeValidator(_names), Field(strict=False, examples=["[gap, cavity]"])]
State = Annotated[Literal[STATES], BeforeValidator(_state)]  # type: ignore[valid-type]
OneCavity = Annotated[Any, BeforeValidator(_fraction_or_pressure)]

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


def _grading(value: Any) -> Any:
    """A name of a grading; YAML 1.1 reads a bare off as false."""
    return "off" if value is False else value


def _small(value: float) -> float:
    if not 0.0 < value <= 1e-2:
        raise ValueError(f"{value:g} is not allowed; allowed: above 0 and at most 0.01")
    return value


def _percentage(value: Any) -> Any:
    """2 % as 0.02."""
    matched = re.fullmatch(r"\s*(\d+\.?\d*)\s*%\s*", value) if isinstance(value, str) else None
    if matched is None or not 0.0 < float(matched[1]) <= 20.0:
        raise ValueError(f"{quoted(value)} is no accuracy; write a percentage above 0 and at most 20, for example 2 %")
    return float(matched[1]) / 100.0


def _size(value: Any) -> Any:
    return None if value == "auto" else _above_zero(convert(value, LENGTH))


class _Mesh(_Section):
    size: Annotated[float | None, BeforeValidator(_size), Field(examples=[LENGTH.example])]
    formulation: Annotated[Literal[tuple(ELEMENTS)] | None, Field(examples=["p2p0"])] = None  # type: ignore[valid-type]
    grading: Annotated[
        Literal[tuple(GRADINGS)],  # type: ignore[valid-type]
        BeforeValidator(_grading),
        Field(examples=["walls"]),
    ] = "off"
    coarser: Coarser | None = None


class _ReadyMesh(_Section):
    formulation: Annotated[Literal[tuple(ELEMENTS)] | None, Field(examples=["p2p0"])] = None  # type: ignore[valid-type]


class _End(_Section):
    y: Length = 0.0


class _Validation(_Section):
    pressures: Annotated[Pressures | None, Field(examples=["[24 kPa]"])] = None
    end_y: Annotated[tuple[Length, ...], Field(strict=False, examples=["[10 mm, -10 mm]"])] = ()
    forces: Annotated[tuple[Force, ...], Field(strict=False, examples=["[[0 N, 0.05 N]]"])] = ()


class _Switch(_Section):
    state: State = "auto"


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
    pressure: Annotated[_Pressure, BeforeValidator(_effect)] = _Pressure()
    self_contact: Annotated[_SelfContact, BeforeValidator(_effect)] = _SelfContact()
    symmetry: Annotated[_Switch, BeforeValidator(_effect)] = _Switch()
    incompressibility: Annotated[_Switch, BeforeValidator(_effect)] = _Switch()
    gravity: Annotated[_Gravity, BeforeValidator(_effect)] = _Gravity()
    strain_limiting_layer: Annotated[_Layer, BeforeValidator(_effect)] = _Layer()


EFFECTS = tuple(_Effects.model_fields)


class _Newton(_Section):
    tolerance: Annotated[float, BeforeValidator(_number), AfterValidator(_small), Field(examples=["0.000001"])] = 1e-6


class _Document(_Section):
    name: Name
    pressures: Pressures = (5.0, 17.0, 31.0, 45.0)
    end: _End = _End()
    added_pressures: Annotated[Count, AfterValidator(_not_below_zero)] = 0
    validation: _Validation = _Validation()
    newton: _Newton = _Newton()
    accuracy: Annotated[float | None, BeforeValidator(_percentage), Field(examples=["2 %"])] = None
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
