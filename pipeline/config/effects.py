"""What acts on the body, as a configuration says it, and two choices of the model that are switched like effects."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import isfinite
from typing import Annotated, Any, Literal, final

from geometry import Design
from pipeline.config import kinds
from pipeline.config.section import Field, Kind, Section, key_of, section
from pipeline.config.units import ANGLE, FORCE, LENGTH, PRESSURE, STRESS, Dimension, convert
from pipeline.values.errors import quoted
from rod.weight import gravity_direction

#: whether an effect acts; auto leaves it to the program
State = Literal["auto", "on", "off"]
STATES_OF_EFFECT = ("auto", "on", "off")
STATES = kinds.one_of(STATES_OF_EFFECT)
#: m/s2
STANDARD = 9.81
#: effects that lie on faces
LAYER, HOOPS = "strain_limiting_layer", "hoops"
#: fields of layers by which the arm's own law has derivatives, and what they measure
CONSTANTS = {"thickness_mm": LENGTH, "E_MPa": STRESS, "EA_N": FORCE, "pitch_mm": LENGTH}


@section(frozen=True)
class Switched(Section):
    """A section that may be written as its state alone; other keys without a state switch it on."""

    state: Annotated[State, STATES] = Field(
        default="auto", description="whether it is simulated; `auto`: the program decides"
    )

    @classmethod
    def mapping(cls, value: Any) -> Any:
        return {"state": "on", **value} if isinstance(value, Mapping) else {"state": STATES.read(value)}


@section(frozen=True)
class Effect(Switched):
    """An effect, or a choice of the model that is switched like one: symmetry, incompressibility."""

    @property
    def on(self) -> bool:
        """Whether it is switched on; gravity, layer and hoops act only then."""
        return self.state == "on"

    @property
    def off(self) -> bool:
        """Whether it is switched off."""
        return self.state == "off"

    @property
    def decided(self) -> bool | None:
        """Whether it is switched on or off; None where the program decides."""
        return None if self.state == "auto" else self.on


@dataclass(frozen=True)
class CavityPressure:
    """The pressure of one cavity: a fraction of the pressure of the run plus a constant."""

    fraction: float
    constant_kPa: float


def _cavity_pressure(value: Any) -> CavityPressure:
    """A plain kinds.number is a fraction of the pressure of the run, one with a unit is a constant pressure."""
    if isinstance(value, int | float) and not isinstance(value, bool) and isfinite(fraction := kinds.number(value)):
        return CavityPressure(fraction, 0.0)
    try:
        return CavityPressure(0.0, convert(value, PRESSURE))
    except ValueError:
        allowed = "a fraction of the pressure, for example 0.5, or a pressure, for example '10 kPa'"
        raise ValueError(f"{quoted(value)} is not allowed; allowed: {allowed}") from None


def _helix(value: Any) -> float:
    """Degrees from 0 to below 90."""
    if isinstance(value, list) or (angle := convert(value, ANGLE)) < 0.0:
        twists = "one family of helices alone twists the arm, which then has no plane of symmetry"
        raise ValueError(f"{twists}; give one angle from 0 deg on, which winds both families")
    if angle >= 90.0:
        raise ValueError(f"{angle:g} deg does not wind about the arm; give an angle to its sections below 90 deg")
    return angle


_Named = Annotated[str, Kind("a name of faces", "outer", read=kinds.text("outer"))]
_CAVITIES = Kind("a number or a pressure for each", "{cavity: 1}", "1 or kPa")
_FACES = kinds.one_or_more(kinds.list_of("names of faces", "[gap, cavity]"))


@section(frozen=True)
class PressureEffect(Effect):
    """The pressures of the cavities."""

    #: in the order of the design
    cavities: Annotated[dict[str, Annotated[CavityPressure, Kind("", "", read=_cavity_pressure)]], _CAVITIES] = Field(
        default_factory=dict,
        description="fractions of the pressure of the run, or constant pressures, by cavity",
    )

    @property
    def following(self) -> tuple[str, ...]:
        """The cavities that have a fraction of the pressure of the run."""
        return tuple(name for name, cavity in self.cavities.items() if cavity.fraction)

    @property
    def acts(self) -> bool:
        """Whether the pressure of the run acts on a cavity."""
        return not self.off and bool(self.following)


@section(frozen=True)
class SelfContact(Effect):
    """Contact of the body with itself."""

    dhat_mm: kinds.PositiveLength | None = Field(
        default=None,
        examples=["0.04 mm"],
        description="activation distance, below the smallest gap at rest; default: 1/50 of it",
    )
    faces: Annotated[tuple[Annotated[str, Kind("", "", read=kinds.text(_FACES.example))], ...], _FACES] | None = Field(
        default=None, description="faces that can meet; default: `gap`, or `outer` without a `gap`"
    )


@section(frozen=True)
class RequestedEffect(Effect, ABC):
    """An effect that acts only where it is switched on: auto leaves it out, as the paper does."""

    @property
    @abstractmethod
    def reason(self) -> str:
        """Why it acts or not, and with which values, for effects.json."""


@final
@section(frozen=True)
class Gravity(RequestedEffect):
    """The weight of the body."""

    acceleration_mm_s2: kinds.Acceleration = Field(
        default=(0.0, -9810.0, 0.0),
        description="acceleration of gravity; `gravity: hanging`, `lying`, `standing` or `30 deg`, by which the arm "
        "rises to its end, is the same with 9.81 m/s²",
    )

    @classmethod
    def mapping(cls, value: Any) -> Any:
        if not isinstance(value, str) or value in STATES_OF_EFFECT:
            return super().mapping(value)
        x, y = (f"{STANDARD * component:.12g} m/s^2" for component in gravity_direction(value))
        return {"state": "on", "acceleration": [x, y, "0 m/s^2"]}

    @property
    def reason(self) -> str:
        """The acceleration, and what it means for the rod."""
        if not self.on:
            return "not requested; in the experiments of the paper the arm lies on its side"
        x, y, z = (component / 1000 for component in self.acceleration_mm_s2)
        rod = "the parameters are those under this weight, which the rod carries; no experiment I, whose body is free"
        return f"({x:g}, {y:g}, {z:g}) m/s2 at every pressure; {rod}"

    @property
    def breaks_symmetry(self) -> bool:
        """Whether it acts across the plane of symmetry z = 0."""
        return self.on and self.acceleration_mm_s2[2] != 0.0


@final
@section(frozen=True)
class StrainLimitingLayer(RequestedEffect):
    """A sheet of paper or fabric in the plane of the material curve."""

    thickness_mm: kinds.PositiveLength = Field(default=0.1, description="thickness of the layer")
    E_MPa: kinds.PositiveStress = Field(default=6500.0, description="Young's modulus of the layer")
    nu: kinds.PoissonRatio = Field(default=0.2, description="Poisson's ratio of the layer")
    faces: _Named | None = Field(
        default=None,
        examples=["bottom"],
        description="faces to lie on: `bottom`, or as those of `hoops`; default: the plane of the material curve",
    )

    @property
    def reason(self) -> str:
        """Thickness and constants of the sheet."""
        if not self.on:
            return "not requested"
        constants = f"E = {self.E_MPa:g} MPa, nu = {self.nu:g}"
        where = f"on the faces {self.faces}" if self.faces else "in the plane of the material curve"
        return f"{self.thickness_mm:g} mm thick, {constants}, {where}"


@final
@section(frozen=True)
class Threads(Section):
    """A thread and how it is wound."""

    EA_N: kinds.PositiveForce = Field(description="axial rigidity of a thread")
    pitch_mm: kinds.PositiveLength = Field(description="distance of its windings, across them")


@final
@section(frozen=True)
class Hoops(RequestedEffect):
    """Threads wound about the arm, as a layer of faces that is stiff along them alone."""

    faces: _Named = Field(
        default="outer", description="faces to lie on: `outer`, `inner` (the walls of all cavities) or another name"
    )
    thickness_mm: kinds.PositiveLength = Field(default=0.1, description="thickness of the layer of threads")
    E_MPa: kinds.PositiveStress = Field(default=1000.0, description="modulus of this layer along the threads")
    threads: Annotated[Threads | None, Kind("`EA` and `pitch`", "{EA: 40 N, pitch: 2 mm}", "N, mm")] = Field(
        default=None, description="in place of `thickness` and `E`: axial rigidity of a thread over its pitch"
    )
    angle_deg: Annotated[float, Kind("0 to below 90", "30 deg", "deg", _helix)] = Field(
        default=0.0, description="of the threads to the sections; above 0 both families of helices are wound"
    )

    @classmethod
    def mapping(cls, value: Any) -> Any:
        if isinstance(value, Mapping) and "threads" in value and (both := {"thickness", "E"} & value.keys()):
            raise ValueError(f"threads stand in place of thickness and E; leave {' and '.join(sorted(both))} out")
        return super().mapping(value)

    @property
    def modulus_MPa(self) -> float:
        """E of a layer of this thickness that is as stiff as the threads."""
        threads = self.threads
        return self.E_MPa if threads is None else threads.EA_N / threads.pitch_mm / self.thickness_mm

    @property
    def reason(self) -> str:
        """What is wound, where and how."""
        if not self.on:
            return "not requested"
        threads = self.threads
        what = f"{self.thickness_mm:g} mm thick, E = {self.E_MPa:g} MPa"
        if threads is not None:
            what = f"threads of {threads.EA_N:g} N every {threads.pitch_mm:g} mm"
        how = f"helices at ±{self.angle_deg:g} degrees to the sections" if self.angle_deg else "loops"
        return f"{what}, {how}, on the faces {self.faces}"


@section(frozen=True)
class Effects(Section):
    """What acts on the body, and two choices of the model that are written beside it."""

    pressure: PressureEffect = PressureEffect()
    self_contact: SelfContact = SelfContact()
    symmetry: Effect = Effect()  #: whether one half of a symmetric body is solved
    incompressibility: Effect = Effect()  #: whether the element does something against locking
    gravity: Gravity = Gravity()
    strain_limiting_layer: StrainLimitingLayer = StrainLimitingLayer()
    hoops: Hoops = Hoops()

    @property
    def straight_without_pressure(self) -> bool:
        """Whether nothing bends the arm but the pressure of the run: no weight, no constant pressure in a cavity."""
        constant = not self.pressure.off and any(cavity.constant_kPa for cavity in self.pressure.cavities.values())
        return not (self.gravity.on or constant)

    def why_no_arm_law(self, design: Design) -> str:
        """Why an arm with these effects has no law of its own, a clause; empty where it may have one."""
        cavities, faces = self.pressure.cavities, self.self_contact.faces or ()
        if not design.repeats:
            return design.why_no_cell
        if self.gravity.breaks_symmetry:
            return "the weight bends the arm out of its plane, and its own law is one of bending in it"
        if any(cavity.constant_kPa for cavity in cavities.values()):
            return "a cavity has a constant pressure, and the arm's own law has one pressure that all follow"
        if not self.pressure.acts:
            return "no cavity is pressurised, so the arm's own law has nothing to depend on"
        if not self.self_contact.off and (len(faces) > 1 or any(face in cavities for face in faces)):
            return "the arm's own law has contact on one outer face alone, not on all those the user names"
        return ""

    @property
    def constants(self) -> dict[str, tuple[float, Dimension]]:
        """Constants of the layer and the hoops that act, with what they measure, by key: effects.hoops.threads.EA."""
        found = {}
        for name in (LAYER, HOOPS):
            layer = getattr(self, name)
            threads = getattr(layer, "threads", None)
            for field, measured in CONSTANTS.items() if layer.on else ():
                if (value := getattr(threads or layer, field, None)) is not None:
                    found[f"effects.{name}.{'threads.' * bool(threads)}{key_of(field)}"] = value, measured
        return found

    def with_constant(self, key: str, value: float) -> "Effects":
        """These effects with one of the constants changed."""
        _, name, *inside, last = key.split(".")
        layer = getattr(self, name)
        (field,) = (field for field in CONSTANTS if key_of(field) == last)
        changed = {"threads": replace(layer.threads, **{field: value})} if inside else {field: value}
        return replace(self, **{name: replace(layer, **changed)})

    @property
    def requested(self) -> dict[str, RequestedEffect]:
        """The effects that act only where they are switched on, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, RequestedEffect)}


#: names of all effects
EFFECTS = tuple(field.name for field in fields(Effects))
