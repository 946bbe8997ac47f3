"""What acts on the body, as a configuration says it, and two choices of the model that are switched like effects."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isfinite
from typing import Annotated, Any, Literal, final

from geometry import Design
from pipeline.config import kinds
from pipeline.config.section import Field, Kind, Section, section
from pipeline.config.units import PRESSURE, convert
from pipeline.values.errors import quoted
from rod.weight import gravity_direction

#: whether an effect acts; auto leaves it to the program
State = Literal["auto", "on", "off"]
STATES_OF_EFFECT = ("auto", "on", "off")
STATES = kinds.one_of(STATES_OF_EFFECT)
#: m/s2
STANDARD = 9.81


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
        """Whether it is switched on; gravity and the layer act only then."""
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

    @property
    def reason(self) -> str:
        """Thickness and constants of the sheet."""
        if not self.on:
            return "not requested"
        constants = f"E = {self.E_MPa:g} MPa, nu = {self.nu:g}"
        return f"{self.thickness_mm:g} mm thick, {constants}, in the plane of the material curve"


@section(frozen=True)
class Effects(Section):
    """What acts on the body, and two choices of the model that are written beside it."""

    pressure: PressureEffect = PressureEffect()
    self_contact: SelfContact = SelfContact()
    symmetry: Effect = Effect()  #: whether one half of a symmetric body is solved
    incompressibility: Effect = Effect()  #: whether the element does something against locking
    gravity: Gravity = Gravity()
    strain_limiting_layer: StrainLimitingLayer = StrainLimitingLayer()

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
    def requested(self) -> dict[str, RequestedEffect]:
        """The effects that act only where they are switched on, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, RequestedEffect)}


#: names of all effects
EFFECTS = tuple(field.name for field in fields(Effects))
