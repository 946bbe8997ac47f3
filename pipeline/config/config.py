"""A design and what is to be computed for it, as checked values in mm, N, MPa and tonne/mm3, nested as in the YAML.

`pipeline.config.load` reads them from a file; `pipeline.config.schema` holds the keys that a file may have.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, is_dataclass, replace
from enum import Enum
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, get_args

import fem.materials
from fem.elements import automatic_element
from fem.materials import LAWS
from geometry import CellPlanes, Design, DesignError, MeshError
from pipeline.config.effects import Effects, State
from pipeline.errors import InputError
from pipeline.store.json_values import Json, JsonObject

#: the laws of the rod: five parameters and the law from one cell, or one of them
Laws = Literal["both", "five", "cell"]
LAW_CHOICES: tuple[Laws, ...] = get_args(Laws)
#: mm/s2, of the weight m g in dimensionless numbers
STANDARD_GRAVITY = 9810.0


class Auto(Enum):
    """The type of AUTO."""

    AUTO = "auto"


#: a value that is chosen by the program
AUTO = Auto.AUTO


@dataclass(frozen=True)
class Material:
    """The law of the solid and its constants."""

    law: str  #: as in the YAML: svk
    constants: Mapping[str, float | tuple[float, ...]]  #: stresses in MPa
    density_tonne_mm3: float | None  #: None where it is not given; only gravity and the mass of the arm need it
    holds_between: tuple[float, float] | None = None  #: stretches between which the law describes the solid, if known

    def built(self) -> fem.materials.Material:
        """The law with its constants. Raises `fem.materials.MaterialError` where it cannot have them together."""
        return LAWS[self.law](**self.constants)

    def record(self) -> JsonObject:
        """The law, its constants, the density and between which stretches it holds, ready for JSON."""
        constants = {name: _record(value) for name, value in self.constants.items()}
        known = {} if self.holds_between is None else {"holds_between": list(self.holds_between)}
        return {"law": self.law, **constants, "density_tonne_mm3": self.density_tonne_mm3, **known}


@dataclass(frozen=True)
class AlongAxis:
    """What the end has along one axis in experiment III: a displacement, or a force where it is free."""

    displacement_mm: float | None
    force_N: float = 0.0  #: zero where the displacement is prescribed

    def __str__(self) -> str:
        """As it is written in YAML."""
        return f"{self.force_N:g} N" if self.displacement_mm is None else f"{self.displacement_mm:g} mm"


@dataclass(frozen=True)
class End:
    """The end of the arm in experiment III: along each axis a displacement or a force of constant direction."""

    x_mm: float | None = None  #: its displacement u_x; None where it is free
    y_mm: float | None = 0.0  #: its displacement u_y; None where it is free
    force_N: tuple[float, float] = (0.0, 0.0)  #: zero along an axis whose displacement is prescribed


@dataclass(frozen=True)
class IdentificationSettings:
    """How the five parameters are identified, and with which weight they are made dimensionless."""

    d_mm: float | None = None  #: the break of the two lines; None: it is sought
    weight_N: float | None = None  #: m g of the reference arm; None: of this arm, if its density is known
    weight_of: str = ""  #: what that arm is called; empty for this one


@dataclass(frozen=True)
class Validation:
    """Loads at which the rod is compared with the finite elements without being fitted to them."""

    pressures_kPa: tuple[float, ...]  #: ascending; those of the run and others between them
    end_y_mm: tuple[float, ...]  #: displacements u_y of the end in III
    forces_N: tuple[tuple[float, float], ...]  #: dead forces on the end
    #: whether II and III are solved at the pressures between as well; not for the one load that the program chooses
    with_experiments: bool = True

    def among(self, reached_kPa: Sequence[float]) -> "Validation":
        """The same loads, or the one that the program chooses at a pressure among those (ascending) that were reached.

        Empty where that load has no such pressure.
        """
        if self.with_experiments or (reached_kPa and self.pressures_kPa[-1] <= reached_kPa[-1]):
            return self
        if not reached_kPa:
            return Validation((), (), ())
        return replace(self, pressures_kPa=(middle_of_widest(reached_kPa),))

    def beyond(self, held_mm: float, *, is_held_down: bool) -> "Validation":
        """The same loads, or the end that the program chooses on the other side of its height u_y in III.

        The chosen end is above that height, farther from the free end than in III if that is below; of the mirror image
        of such an arm, whose end III holds down, it has to be below.
        """
        if self.with_experiments or not is_held_down:
            return self
        return replace(self, end_y_mm=tuple(float(f"{2.0 * held_mm - y:.12g}") for y in self.end_y_mm))

    def up_to(self, highest_kPa: float) -> "Validation":
        """The same loads at the pressures up to this one; empty where there is none."""
        pressures = tuple(pressure for pressure in self.pressures_kPa if pressure <= highest_kPa)
        return replace(self, pressures_kPa=pressures) if pressures else Validation((), (), ())


def middle_of_widest(pressures_kPa: Sequence[float]) -> float:
    """The middle of the widest interval between pressures (ascending), or the only one, kPa."""
    intervals = list(pairwise(pressures_kPa))
    low, high = max(intervals, key=lambda interval: interval[1] - interval[0], default=(pressures_kPa[0],) * 2)
    return float(f"{0.5 * (low + high):.12g}")


@dataclass(frozen=True)
class MeshSettings:
    """How fine the mesh is and which elements it has."""

    size_mm: float | Auto  #: AUTO until a size is planned for the requested accuracy
    formulation: str  #: one of fem.elements.ELEMENTS
    coarser: float | None = None  #: size of a second mesh over size_mm, for the mesh error of the parameters
    grading: str = "off"  #: one of geometry.GRADINGS
    #: why, by key, for what was left to the program
    chosen: Mapping[str, str] = field(default_factory=dict)

    @property
    def element_size_mm(self) -> float:
        """The size as a number. Raises ValueError where it is AUTO."""
        if isinstance(self.size_mm, Auto):
            raise ValueError("the mesh size is still to be planned")
        return self.size_mm

    def given_unlike(self, **others: str) -> tuple[str, ...]:
        """What the configuration gives and `others` have otherwise, as it is written there."""
        given = {key: getattr(self, key) for key in others if key not in self.chosen}
        return tuple(f"mesh.{key}: {value}" for key, value in given.items() if value != others[key])


#: Newton's tolerance where none is given
USUAL_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Newton:
    """When Newton's method stops."""

    tolerance: float  #: residual over internal forces


@dataclass(frozen=True)
class Config:
    """A design and what is to be computed for it, checked."""

    name: str
    family: str
    design: Design
    material: Material  #: of the body, but for the regions below
    materials: Mapping[str, Material]  #: of the regions that have one of their own, by name
    pressures_kPa: tuple[float, ...]  #: ascending
    experiments: tuple[str, ...]  #: II, III, and I where it is solved
    end: End
    identification: IdentificationSettings
    added_pressures: int  #: how many may be added where alpha(p) or kappa_0(p) is not straight
    validation: Validation
    law: Laws
    mesh: MeshSettings
    newton: Newton
    accuracy: float | None  #: requested relative error of kappa_0(l/2), alpha2 and F
    effects: Effects
    source: str  #: the file it was read from, for messages

    def record(self) -> JsonObject:
        """Everything that decides the results, ready for JSON, with the keys of the YAML and their units."""
        special: dict[str, Json] = {
            "geometry": {"family": self.family, **_dimensions(self.design)},
            "material": self.material.record(),
        }
        if self.materials:
            special["materials"] = {name: material.record() for name, material in self.materials.items()}
        sections = {key: _record(getattr(self, key)) for key in _SECTIONS}
        mesh = {key: value for key, value in asdict(self.mesh).items() if key != "chosen"}
        return {"name": self.name, **special, **sections, "mesh": _record(mesh)}

    @property
    def reference_weight(self) -> tuple[float, str] | None:
        """The weight m g (N) with which moments are made dimensionless, and whose it is; None where none is known."""
        given, mass = self.identification.weight_N, self.mass_tonne
        if given is not None:
            return given, self.identification.weight_of or "a reference arm"
        return None if mass is None else (mass * STANDARD_GRAVITY, "this arm")

    def unmeshable(self, failure: DesignError | MeshError) -> InputError:
        """The refusal of a body that cannot be meshed, with the keys of the configuration."""
        if isinstance(failure, MeshError):
            return InputError(f"{self.source}: {failure}")
        sentences, dimensions = [], vars(self.design)
        for error in (failure, *failure.others):
            keys = (f"geometry.{key}" if key.split(".")[0] in dimensions else key for key in error.keys)
            sentences.append(f"{self.source}: {', '.join(keys)}: {error.sentence}")
        return InputError(*sentences)

    @property
    def hash(self) -> str:
        """sha256 of the record: equal for equal values, however they were written."""
        canonical = json.dumps(self.record(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()

    @property
    def mass_tonne(self) -> float | None:
        """Mass of the solid; None without a density, also of one region."""
        total, rest = 0.0, self.design.solid_volume
        for name, material in self.materials.items():
            if material.density_tonne_mm3 is None:
                return None
            total += material.density_tonne_mm3 * self.design.region_volumes[name]
            rest -= self.design.region_volumes[name]
        density = self.material.density_tonne_mm3
        return None if density is None else density * rest + total

    @property
    def poisson_ratio(self) -> float:
        """The largest one of all materials at small strain, which decides about locking."""
        return max(material.built().poisson_ratio for material in (self.material, *self.materials.values()))

    def with_effect(self, effect: str, state: State) -> "Config":
        """The same with one effect switched; the element follows incompressibility."""
        switched = replace(getattr(self.effects, effect), state=state)
        config = replace(self, effects=replace(self.effects, **{effect: switched}))
        if effect != "incompressibility":
            return config
        element = automatic_element(self.poisson_ratio, None if state == "auto" else state == "on")
        chosen = {key: why for key, why in self.mesh.chosen.items() if key != "formulation"}
        return replace(config, mesh=replace(self.mesh, formulation=element.name, chosen=chosen))

    def with_contact_distance(self, dhat_mm: float | None) -> "Config":
        """The same with another activation distance of contact; None for the default."""
        contact = replace(self.effects.self_contact, dhat_mm=dhat_mm)
        return replace(self, effects=replace(self.effects, self_contact=contact))

    def with_mesh_size(self, size_mm: float) -> "Config":
        """The same with another mesh size."""
        return replace(self, mesh=replace(self.mesh, size_mm=size_mm))


_SPECIAL = ("name", "family", "design", "material", "materials", "source")
_SECTIONS = tuple(field.name for field in fields(Config) if field.name not in _SPECIAL)


def _record(value: Any) -> Json:
    """A value as JSON: sections become objects with the names of their fields."""
    if is_dataclass(value):
        return {field.name: _record(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(name): _record(entry) for name, entry in value.items()}
    if isinstance(value, tuple):
        return [_record(entry) for entry in value]
    return str(value.value) if isinstance(value, Enum) else value


def _dimensions(design: Any) -> dict[str, Json]:
    """The keys of a design as in the YAML; a file stands there with the digest of what is in it."""
    values: dict[str, Any] = {field.name: getattr(design, field.name) for field in fields(design)}
    values = {name: list(v) if isinstance(v, tuple) else v for name, v in values.items() if v != ()}
    if design.is_from_file:
        values |= {"file": Path(design.file).name, "sha256": design.digest}
    if not values.get("parts"):
        values.pop("parts", None)
    for key in ("air", "parts", "plug"):
        if isinstance(values.get(key), Mapping):
            values[key] = {name: list(point) for name, point in values[key].items()}
    if isinstance(cell := values.get("cell"), CellPlanes):
        values["cell"] = {"from": cell.start, "to": cell.stop}
    return values
