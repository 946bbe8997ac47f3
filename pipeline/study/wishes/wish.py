"""What is wanted of an arm, in which limits, and what may be changed for it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from json import dumps
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from geometry.arrays import Array, Mask
from pipeline.config import kinds, units
from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.config.section import Field, Kind, Section, read, section
from pipeline.values.json_values import JsonObject, Written
from rod.arm_law.quantities import QUANTITIES as ASKED
from rod.load import Loading

_BY_UNIT = {one.unit: one for one in (units.LENGTH, units.CURVATURE, units.FORCE, units.ANGLE, units.STIFFNESS)}
#: what can be wanted, by its key in a file
QUANTITIES: dict[str, units.Dimension] = {name: _BY_UNIT[one.unit] for name, one in ASKED.items() if one.wished}
#: how units are told where it is otherwise: a factor and the unit
SHOWN = {"1/mm": (1e3, "1/m"), "deg": (1.0, "°"), "N/mm": (1e3, "N/m")}
#: in front of the name of a free pressure, and of a dimension
PRESSURE, GEOMETRY = "pressure.", "geometry."
#: the key of the number of chambers
CHAMBERS = "geometry.chambers"
#: significant digits of dimensions and pressures
DIGITS = 6
#: what is made as small as possible, by its key; "" where wishes are met as nearly as possible
OBJECTIVES = ("pressure", "mass")


@dataclass(frozen=True)
class Free:
    """A dimension or a pressure that may be changed, in mm or kPa."""

    key: str  #: geometry.wall, or pressure.NAME
    low: float
    high: float
    start: float

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return "kPa" if self.key.startswith(PRESSURE) else "mm"


@dataclass(frozen=True)
class Wish:
    """One number, or place, that the arm is to have at a pressure."""

    quantity: str  #: one of QUANTITIES
    target: tuple[float, ...]  #: in the unit of the quantity; two numbers of a tip
    within: float  #: in the same unit
    at: float | str  #: kPa, or the name of a free pressure
    height_mm: float = 0.0  #: of the end that is held, of a force
    under: Loading = field(default_factory=Loading)  #: what acts besides the pressure
    load: str = ""  #: the same as it is written

    def pressure(self, values: Mapping[str, float]) -> float:
        """kPa; values: of what is free, by key."""
        return values[f"{PRESSURE}{self.at}"] if isinstance(self.at, str) else self.at

    @property
    def given(self) -> float:
        """The place or force that `rod.arm_law.quantities.Quantity.of` takes."""
        return self.height_mm if self.quantity == "force" else abs(self.target[0])

    @property
    def name(self) -> str:
        """Name of the wish in tables."""
        at = f"{self.at:g} kPa" if isinstance(self.at, float) else self.at
        held = f" with the end at {self.height_mm:g} mm" if self.quantity == "force" else ""
        return f"{self.quantity} at {at}{held}{self.load and f' under {self.load}'}"

    def stiffer(self, by: float) -> "Wish":
        """The wish under a load that walls whose moduli are larger by a factor feel as this one."""
        scaled = [tuple(value / by for value in given) for given in (self.under.force or (), [self.under.moment])]
        under = replace(self.under, force=scaled[0] or None, moment=scaled[1][0], tip_mass=self.under.tip_mass / by)
        return replace(self, under=under)

    def text(self, values: Any) -> str:
        """Values in words, with their unit."""
        unit = QUANTITIES[self.quantity].unit
        factor, unit = SHOWN.get(unit, (1.0, unit))
        shown = [f"{factor * float(value):.4g}" for value in np.atleast_1d(values)]
        joined = shown[0] if len(shown) == 1 else f"({', '.join(shown)})"
        return f"{joined}{unit}" if unit == "°" else f"{joined} {unit}"


_ABOVE_ONE = Kind("above 1", "1.4", "1", kinds.number, lambda value: value > 1.0)
_MASS = Kind("above 0", units.MASS.example, "g", kinds.in_unit(units.MASS), kinds.above_zero)


@section(frozen=True)
class Limits(Section):
    """What an arm must not exceed, as it is written; None where nothing is asked."""

    largest_stretch: Annotated[float | None, _ABOVE_ONE] = None  #: of a cell without moment, at the highest pressure
    mass_g: Annotated[float | None, _MASS] = Field(default=None, alias="mass")
    smallest_wall_mm: kinds.PositiveLength | None = None
    bears: Annotated[float | None, _ABOVE_ONE] = None  #: times the highest pressure, which the cell must bear


@dataclass(frozen=True)
class Wishes:
    """What the file of a wish says, complete."""

    free: tuple[Free, ...]
    wishes: tuple[Wish, ...]
    limits: Limits
    minimize: str  #: one of OBJECTIVES; "" for none
    starts: int  #: points from which is begun at most

    @property
    def dimensions(self) -> tuple[str, ...]:
        """The keys of the free dimensions."""
        return tuple(one.key for one in self.free if not one.key.startswith(PRESSURE))

    def values(self, point: Array) -> dict[str, float]:
        """A point (n,) by the keys of what is free."""
        return {one.key: float(value) for one, value in zip(self.free, point, strict=True)}

    def pressures_kPa(self, point: Array) -> tuple[float, ...]:
        """Pressures of all wishes, ascending, at a point (n,)."""
        values = self.values(point)
        return tuple(sorted({wish.pressure(values) for wish in self.wishes}))

    @property
    def bounds(self) -> Array:
        """(n, 2)"""
        return np.array([(one.low, one.high) for one in self.free])

    @property
    def start(self) -> Array:
        """(n,)"""
        return np.array([one.start for one in self.free])

    @property
    def targets(self) -> Array:
        """(m,) all wanted numbers, one after the other."""
        return np.concatenate([wish.target for wish in self.wishes])

    @property
    def within(self) -> Array:
        """(m,) their tolerances."""
        return np.concatenate([[wish.within] * len(wish.target) for wish in self.wishes])

    @property
    def powers(self) -> Mask:
        """(m,) whether a number follows a power of the dimensions."""
        return np.concatenate([[ASKED[wish.quantity].wished == "power"] * len(wish.target) for wish in self.wishes])

    def parts(self, numbers: Array) -> list[Array]:
        """The numbers (m, ..) of all wishes by wish."""
        ends = np.cumsum([len(wish.target) for wish in self.wishes])
        return np.split(numbers, ends[:-1])

    def misses(self, numbers: Array) -> Array:
        """(w,) how far each wish is missed, over what is allowed; numbers: (m,)."""
        away = self.parts((numbers - self.targets) / self.within)
        return np.array([np.linalg.norm(part) for part in away])


def exact_limits(wishes: Wishes, config: Config) -> dict[str, tuple[float, float]]:
    """Mass and wall of a design over their limits, each not above 1 where it is kept, with the value in g or mm."""
    limits, found = wishes.limits, {}
    if limits.mass_g is not None and config.mass_tonne is not None:
        mass = 1e6 * config.mass_tonne
        found["mass"] = mass / limits.mass_g, mass
    if limits.smallest_wall_mm is not None:
        wall = config.design.thinnest_wall
        found["smallest_wall"] = limits.smallest_wall_mm / wall, wall
    return found


@dataclass(frozen=True)
class WishFile:
    """What a file says, with the configurations that follow from it."""

    source: Path
    name: str
    base: Document  #: with the values of `set`
    wishes: Wishes
    counts: tuple[int, ...] = ()  #: numbers of chambers that are tried, that of the base first; none: as in the base
    draft: bool = False  #: whether laws of the search keep the error of the mesh of the base, as drafts do

    def with_chambers(self, count: int) -> "WishFile":
        """This file for one number of chambers. Raises InputError."""
        return replace(self, base=self.base.with_values([(CHAMBERS, count)], lambda _: str(self.source)), counts=())

    def record(self) -> JsonObject:
        """Everything that decides the result."""
        base = sha256(dumps(self.base.content, sort_keys=True, default=str).encode()).hexdigest()
        return {"name": self.name, "base_hash": base, "wishes": repr(self.wishes)}

    @property
    def hash(self) -> str:
        """sha256 of the record."""
        return sha256(dumps(self.record(), sort_keys=True).encode()).hexdigest()

    def document(self, point: Array) -> Document:
        """The base with the dimensions and pressures of a point (n,), and how the end is held."""
        values = self.wishes.values(point)
        found: dict[str, Written] = {"name": self.name}
        found |= {key: f"{values[key]:.{DIGITS}g} mm" for key in self.wishes.dimensions}
        found["pressures"] = [f"{pressure:.{DIGITS}g} kPa" for pressure in self.wishes.pressures_kPa(point)]
        forces = [wish for wish in self.wishes.wishes if wish.quantity == "force"]
        heights = [f"{height:g} mm" for height in dict.fromkeys(wish.height_mm for wish in forces)]
        if heights:
            found["end"] = {"y": heights[0]}
        pulled = [[f"{x:g} N", f"{y:g} N"] for x, y in self._pulls(found)]
        more = {name: given for name, given in (("end_y", heights[1:]), ("forces", pulled)) if given}
        if more:
            found["validation"] = more  # the law is measured up to these loads
        return self._with(found)

    def _with(self, values: Mapping[str, Written]) -> Document:
        return self.base.with_values(list(values.items()), lambda key: f"{self.source}: {key}")

    def _pulls(self, found: Mapping[str, Written]) -> dict[tuple[float, float], None]:
        """Forces (x, y) on the end, N, up to which wishes under a load need the law, with those that a stiffness beside
        them takes; found: what is written of the design."""
        if not any(wish.load for wish in self.wishes.wishes):
            return {}
        length, forces = read(Config, self._with(found)).design.length, list[tuple[float, float]]()
        for wish in self.wishes.wishes:
            x, y = wish.under.on(length, None, (0.0, 0.0), weight=False).force[:2]
            turned = abs(wish.under.moment) / length + ASKED[wish.quantity].deflects * length * wish.given
            forces.append((x, y + np.copysign(turned, y)))
        return dict.fromkeys(force for force in forces if any(force))

    def config(self, point: Array) -> Config:
        """The design of a point (n,). Raises InputError."""
        return read(Config, self.document(point))

    @cached_property
    def start(self) -> Config:
        """The design at the start. Raises InputError."""
        return self.config(self.wishes.start)

    @property
    def is_fine(self) -> bool:
        """Whether laws of the search have the accuracy of those that a run delivers."""
        return not self.draft and self.start.accuracy is not None

    def drawn(self, point: Array) -> Config:
        """The design of a point (n,) with the other values of the start, for what follows from its drawing alone.

        Raises `DesignError`.
        """
        values, known = self.wishes.values(point), self.start.design
        changes = {key.removeprefix(GEOMETRY): values[key] for key in self.wishes.dimensions}
        design: Any = replace(known, **changes)  # type: ignore[type-var]
        return replace(self.start, design=design.with_regions(known.regions))  # type: ignore[call-arg]


def rounded(point: Array) -> Array:
    """A point (n,) with the digits with which it is written."""
    return np.array([float(f"{value:.{DIGITS}g}") for value in point])
