"""What acts on the body, as a configuration says it, and two choices of the model that are switched like effects."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Literal, final

#: whether an effect acts; auto leaves it to the program
State = Literal["auto", "on", "off"]


@dataclass(frozen=True)
class Effect:
    """An effect, or a choice of the model that is switched like one: symmetry, incompressibility."""

    state: State

    @property
    def on(self) -> bool:
        """Whether it is switched on; gravity and the layer act only then."""
        return self.state == "on"

    @property
    def off(self) -> bool:
        """Whether it is switched off."""
        return self.state == "off"


@dataclass(frozen=True)
class CavityPressure:
    """The pressure of one cavity: a fraction of the pressure of the run plus a constant."""

    fraction: float
    constant_kPa: float


@dataclass(frozen=True)
class PressureEffect(Effect):
    """The pressures of the cavities."""

    cavities: Mapping[str, CavityPressure]  #: in the order of the design

    @property
    def following(self) -> tuple[str, ...]:
        """The cavities that have a fraction of the pressure of the run."""
        return tuple(name for name, cavity in self.cavities.items() if cavity.fraction)

    @property
    def acts(self) -> bool:
        """Whether the pressure of the run acts on a cavity."""
        return not self.off and bool(self.following)


@dataclass(frozen=True)
class SelfContact(Effect):
    """Contact of the body with itself."""

    dhat_mm: float | None  #: activation distance; None for a fiftieth of the smallest gap
    faces: tuple[str, ...] | None  #: names of faces that can meet; None: `gap`, or `outer` without a `gap`


@dataclass(frozen=True)
class RequestedEffect(Effect, ABC):
    """An effect that acts only where it is switched on: auto leaves it out, as the paper does."""

    @property
    @abstractmethod
    def reason(self) -> str:
        """Why it acts or not, and with which values, for effects.json."""


@final
@dataclass(frozen=True)
class Gravity(RequestedEffect):
    """The weight of the body."""

    acceleration_mm_s2: tuple[float, float, float]

    @property
    def reason(self) -> str:
        """The acceleration, and what it means for the rod."""
        if not self.on:
            return "not requested; in the experiments of the paper the arm lies on its side"
        x, y, z = (component / 1000 for component in self.acceleration_mm_s2)
        return (
            f"({x:g}, {y:g}, {z:g}) m/s2 at every pressure; the five parameters are those of the body, and the rod "
            "carries the weight, spread evenly along it; experiment I is not simulated, because nothing holds the "
            "weight of a free body"
        )

    @property
    def breaks_symmetry(self) -> bool:
        """Whether it acts across the plane of symmetry z = 0."""
        return self.on and self.acceleration_mm_s2[2] != 0.0


@final
@dataclass(frozen=True)
class StrainLimitingLayer(RequestedEffect):
    """A sheet of paper or fabric in the plane of the material curve."""

    thickness_mm: float
    E_MPa: float
    nu: float

    @property
    def reason(self) -> str:
        """Thickness and constants of the sheet."""
        if not self.on:
            return "not requested"
        constants = f"E = {self.E_MPa:g} MPa, nu = {self.nu:g}"
        return f"{self.thickness_mm:g} mm thick, {constants}, in the plane of the material curve"


@dataclass(frozen=True)
class Effects:
    """What acts on the body, and two choices of the model that are written beside it."""

    pressure: PressureEffect
    self_contact: SelfContact
    symmetry: Effect  #: whether one half of a symmetric body is solved
    incompressibility: Effect  #: whether the element does something against locking
    gravity: Gravity
    strain_limiting_layer: StrainLimitingLayer

    @property
    def straight_without_pressure(self) -> bool:
        """Whether nothing bends the arm but the pressure of the run: no weight, no constant pressure in a cavity."""
        constant = not self.pressure.off and any(cavity.constant_kPa for cavity in self.pressure.cavities.values())
        return not (self.gravity.on or constant)

    @property
    def requested(self) -> dict[str, RequestedEffect]:
        """The effects that act only where they are switched on, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, RequestedEffect)}
