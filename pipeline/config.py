"""One design as a user writes it (YAML with units) and as the program reads it (mm, N, MPa, tonne/mm3).

The only door to pydantic. Every refusal is one sentence: `FILE: key: what is wrong; what is allowed`.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, asdict, dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

import pydantic
from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from geometry import FAMILIES, Design, DesignError
from geometry.design import check_size
from pipeline.document import Document, read_document
from pipeline.units import DENSITY, LENGTH, PRESSURE, STRESS, Dimension, convert

__all__ = ["EFFECTS", "FORMULATIONS", "LAWS", "Config", "Material", "MeshChoice", "load_config"]


def _in(dimension: Dimension) -> BeforeValidator:
    return BeforeValidator(lambda value: convert(value, dimension))


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{value!r} is not a plain number; write it without a unit, for example 0.495")
    return float(value)


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{value!r} is not a whole number; write it without a unit, for example 11")
    return value


def _above_zero(value: float) -> float:
    if not value > 0.0:
        raise ValueError(f"{value:g} is not allowed; allowed: above zero")
    return value


def _poisson_ratio(value: float) -> float:
    if not -1.0 < value < 0.5:
        raise ValueError(f"{value:g} is not a Poisson ratio a body can have here; allowed: above -1 and below 0.5")
    return value


def _on_or_off(value: Any) -> Any:
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else value  # YAML 1.1 reads on as true


def _ascending(values: tuple[float, ...]) -> tuple[float, ...]:
    if not values:
        raise ValueError("is empty; give at least one pressure, for example [17 kPa, 37 kPa]")
    if min(values) <= 0.0:
        raise ValueError(f"{min(values):g} kPa is not above zero; give pressures above 0 kPa in ascending order")
    if any(later <= earlier for earlier, later in pairwise(values)):
        listed = ", ".join(f"{value:g} kPa" for value in values)
        raise ValueError(f"[{listed}] is not in ascending order; list every pressure once, the lowest first")
    return values


Length = Annotated[float, _in(LENGTH), Field(examples=[LENGTH.example])]
PositiveLength = Annotated[Length, AfterValidator(_above_zero)]
PositiveStress = Annotated[float, _in(STRESS), AfterValidator(_above_zero), Field(examples=[STRESS.example])]
PositiveDensity = Annotated[float, _in(DENSITY), AfterValidator(_above_zero), Field(examples=[DENSITY.example])]
Pressure = Annotated[float, _in(PRESSURE)]
Pressures = Annotated[tuple[Pressure, ...], AfterValidator(_ascending), Field(strict=False)]
PoissonRatio = Annotated[float, BeforeValidator(_number), AfterValidator(_poisson_ratio), Field(examples=["0.495"])]
Count = Annotated[int, BeforeValidator(_count), Field(examples=["11"])]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", examples=["pneunet"])]
Text = Annotated[str, Field(min_length=1)]
Switch = Annotated[Literal["auto", "on", "off"], BeforeValidator(_on_or_off), Field(examples=["auto"])]

#: the elements that `fem` offers
FORMULATIONS = ("p2p0", "p2")
#: law in the YAML -> the class that `fem` offers under that law, and its constants
LAWS: dict[str, tuple[str, dict[str, Any]]] = {
    "svk": ("StVenantKirchhoff", {"E": PositiveStress, "nu": PoissonRatio}),
}
EFFECTS = ("self_contact", "symmetry")


class _Section(pydantic.BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class _Mesh(_Section):
    size: PositiveLength
    formulation: Annotated[Literal[FORMULATIONS], Field(examples=["p2p0"])] = "p2p0"  # type: ignore[valid-type]


class _End(_Section):
    y: Length = 0.0


class _Effects(_Section):
    self_contact: Switch = "auto"
    symmetry: Switch = "auto"


class _Document(_Section):
    name: Name
    pressures: Pressures = (5.0, 17.0, 31.0, 45.0)
    end: _End = _End()
    mesh: _Mesh
    effects: _Effects = _Effects()


@dataclass(frozen=True)
class Material:
    """The law of the solid and its constants."""

    law: str  #: as in the YAML: svk
    model: str  #: the name of the class in `fem`: StVenantKirchhoff
    constants: Mapping[str, float]  #: its arguments; stresses in MPa
    density_tonne_mm3: float


@dataclass(frozen=True)
class MeshChoice:
    """How fine and with which elements."""

    size_mm: float
    formulation: str  #: one of FORMULATIONS


@dataclass(frozen=True)
class Config:
    """A design and what is asked of it, checked. Lengths in mm, stresses in MPa."""

    name: str
    family: str
    design: Design
    material: Material
    pressures_kPa: tuple[float, ...]  #: ascending
    end_y_mm: float  #: the displacement u_y of the end in experiment III
    mesh: MeshChoice
    effects: Mapping[str, str]  #: effect -> auto, on or off
    source: str  #: the file it was read from, for messages

    @property
    def pressures_MPa(self) -> tuple[float, ...]:
        return tuple(float(f"{pressure / 1000.0:.12g}") for pressure in self.pressures_kPa)

    def record(self) -> dict[str, Any]:
        """Everything that decides the results, ready for JSON; lengths in mm, constants of the law in MPa."""
        return {
            "name": self.name,
            "geometry": {"family": self.family, **_dimensions(self.design)},
            "material": {
                "law": self.material.law,
                **self.material.constants,
                "density_tonne_mm3": self.material.density_tonne_mm3,
            },
            "pressures_kPa": list(self.pressures_kPa),
            "end_y_mm": self.end_y_mm,
            "mesh": asdict(self.mesh),
            "effects": dict(self.effects),
        }

    @property
    def hash(self) -> str:
        """sha256 of the record: equal for equal values, however they were written."""
        canonical = json.dumps(self.record(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()


def load_config(path: Path | str, overrides: Sequence[str] = ()) -> Config:
    """The configuration in the YAML file `path` with `overrides` ("mesh.size=4 mm") applied.

    Raises InputError with one sentence that names the file (or the override), the key and what is allowed.
    """
    document = read_document(Path(path), overrides)
    family = document.choice(("geometry", "family"), tuple(FAMILIES))
    law = document.choice(("material", "law"), tuple(LAWS))
    try:
        checked: Any = _model(family, law).model_validate(document.content)
    except pydantic.ValidationError as refused:
        raise document.refusal(refused.errors(), _model(family, law)) from None
    return _config(document, checked, family, law)


def _config(document: Document, checked: Any, family: str, law: str) -> Config:
    values = checked.geometry.model_dump(exclude={"family"})
    try:
        design = FAMILIES[family](**values)
        check_size(checked.mesh.size, design.extent, design.solid_volume / 2)
    except DesignError as refused:
        keys = tuple(("geometry", key) if key in values else tuple(key.split(".")) for key in refused.keys)
        raise document.wrong_together(keys, refused.sentence) from None
    constants = {name: getattr(checked.material, name) for name in LAWS[law][1]}
    return Config(
        name=checked.name,
        family=family,
        design=design,
        material=Material(law, LAWS[law][0], constants, checked.material.density),
        pressures_kPa=checked.pressures,
        end_y_mm=checked.end.y,
        mesh=MeshChoice(checked.mesh.size, checked.mesh.formulation),
        effects=checked.effects.model_dump(),
        source=str(document.path),
    )


def _model(family: str, law: str) -> type[pydantic.BaseModel]:
    """The shape of a document about a body of `family` made of a solid that obeys `law`."""
    geometry: Any = pydantic.create_model(
        "Geometry", __base__=_Section, family=(str, ...), **_geometry_fields(FAMILIES[family])
    )
    constants: dict[str, Any] = {name: (kind, ...) for name, kind in LAWS[law][1].items()}
    material: Any = pydantic.create_model(
        "Material",
        __base__=_Section,
        law=(str, ...),
        density=(PositiveDensity, ...),
        **constants,
    )
    return pydantic.create_model("Document", __base__=_Document, geometry=(geometry, ...), material=(material, ...))


def _geometry_fields(design: Any) -> dict[str, Any]:
    """The fields of a design as pydantic takes them: counts are plain numbers, floats are lengths."""
    kinds = get_type_hints(design)
    optional = {field.name: ... if field.default is MISSING else field.default for field in fields(design)}
    return {name: ({int: Count, float: Length, str: Text}[kinds[name]], default) for name, default in optional.items()}


def _dimensions(design: Any) -> dict[str, Any]:
    return {field.name: getattr(design, field.name) for field in fields(design)}
