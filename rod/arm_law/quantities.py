"""What can be asked of an arm by its own law, and how it changes with whatever the arm is made of.

A new question is a row of `QUANTITIES`. `jacobian` differentiates it by dimensions, moduli, pressure or load.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TypeVar

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import ACROSS
from rod.arm_law.law_rod import LawRod
from rod.errors import RodError
from rod.load import Load, Loading

#: displacement of the tip over the length, to both sides, over which its stiffness is meant
DEFLECTION = 0.01

#: the rod at a pressure in kPa
Rods = Callable[[float], LawRod]
State = TypeVar("State")


@dataclass(frozen=True)
class Quantity:
    """A number of an arm at one pressure, or two of a place."""

    name: str
    unit: str
    #: of a rod, beside the rod without changes, for what is given: the height of an end that is held, mm, for a force;
    #: about the stiffness, N/mm, for a stiffness; and under a load where it can bear one. Raises `RodError`
    of: Callable[[LawRod, LawRod, float, Load], float | Sequence[float]]
    size: int = 1
    title: str = ""  #: in the budget of tolerances; empty: it is not there
    in_law: bool = False  #: whether law.json and `results.sensitivities` have its derivatives
    wished: str = ""  #: how it follows dimensions of a design, "line" or "power"; empty: it cannot be wished
    bears: bool = False  #: whether it can be asked under a load
    deflects: float = 0.0  #: force on the tip that it takes by itself, over the length and what is given


def _rigidity(rod: LawRod, known: LawRod, *_: object) -> float:
    """Over the change of the curvature by 1/length of the known rod, towards the straight arm."""
    law, origin = known.section, known.section.kappa_0
    change = 1.0 / known.length if origin <= 0.0 else -1.0 / known.length
    room = float(law.kappa[-1] - origin if change > 0.0 else law.kappa[0] - origin)
    change = change if abs(room) > abs(change) else room
    return _moment_at(rod, rod.section.kappa_0 + change) / change


def _moment_at(rod: LawRod, kappa: float) -> float:
    law = rod.section
    return float(np.interp(kappa, law.kappa, law.moment)) if law.kappa[0] <= kappa <= law.kappa[-1] else math.nan


def _without_moment(rod: LawRod, name: str) -> float:
    """NaN for a law of the plane alone, of rigidities out of it."""
    law = rod.section
    values = law.in_space.get(name) if name in ACROSS else getattr(law, name)
    return math.nan if values is None else float(np.interp(0.0, law.moment, values))


def _force(rod: LawRod, _: LawRod, height: float, __: Load) -> float:
    return float(rod.under(Load(), end_y=height).force[1])


def _stiffness(rod: LawRod, _: LawRod, about: float, __: Load) -> float:
    """Of the tip without load, against a force across its end to both sides."""
    turn, force = float(rod.under(Load()).theta[-1]), DEFLECTION * rod.length * about
    across = np.array([-np.sin(turn), np.cos(turn)])
    back, ahead = (rod.under(Load((sign * force * across).tolist())).end for sign in (-1.0, 1.0))
    return 2.0 * force / float(np.subtract(ahead, back) @ across)


#: by name: of the material curve without load, of the cell without moment, and of an end that is held
QUANTITIES = {
    one.name: one
    for one in (
        Quantity("tip", "mm", lambda *of: of[0].under(of[3]).end, 2, title="tip / length", wished="line", bears=True),
        Quantity("kappa_0", "1/mm", lambda rod, *_: rod.section.kappa_0, title="κ₀", in_law=True, wished="power"),
        Quantity("rigidity", "N mm2", _rigidity, title="rigidity", in_law=True),
        Quantity("force", "N", _force, 1, title="force in III", wished="power"),
        Quantity("moment", "N mm", lambda rod, known, *_: _moment_at(rod, 0.5 * known.section.kappa_0), in_law=True),
        Quantity("stretch", "1", lambda rod, *_: _without_moment(rod, "stretch"), in_law=True),
        Quantity("end_angle", "rad", lambda rod, *_: float(rod.under(Load()).theta[-1]), in_law=True),
        Quantity(ACROSS[0], "N mm2", lambda rod, *_: _without_moment(rod, ACROSS[0]), title="B₂", in_law=True),
        Quantity(ACROSS[1], "N mm2", lambda rod, *_: _without_moment(rod, ACROSS[1]), title="GJ", in_law=True),
        Quantity("angle", "deg", lambda *of: of[0].under(of[3]).bending_deg, wished="line", bears=True),
        Quantity("stiffness", "N/mm", _stiffness, wished="power", deflects=DEFLECTION),
    )
}
#: units of those whose derivatives a law has, and of those that the rates of its cells tell
UNITS = {one.name: one.unit for one in QUANTITIES.values() if one.in_law}
OF_CELLS = {"contact_onset": "1/mm", "largest_stretch": "1"}


def key_in_files(name: str) -> str:
    """A name with its unit, such as kappa_0_per_mm."""
    unit = (UNITS | OF_CELLS)[name].replace("1/", "per_").replace(" ", "_")
    return name if unit == "1" else f"{name}_{unit}"


@dataclass(frozen=True, eq=False)
class QuantityAt:
    """A quantity at a pressure, of arms near a known one."""

    name: str  #: of `QUANTITIES`
    pressure: float  #: kPa
    known: LawRod  #: at that pressure
    given: float = math.nan  #: as `Quantity.of` takes it
    under: Loading = field(default_factory=Loading)

    def of(self, rods: Rods) -> Array:
        """(1,), or (2,) of a place. Raises `RodError` where the arm has no such number."""
        rod = rods(self.pressure)
        load = self.under.on(rod.length, rod.mass, rod.weight) if self.under != Loading() else Load()
        return np.atleast_1d(QUANTITIES[self.name].of(rod, self.known, self.given, load))

    def or_nan(self, rods: Rods) -> Array:
        """The quantity as of `of`; NaN where a rod has no such number. Raises `RodError` where there is no rod."""
        rods(self.pressure)
        try:
            return self.of(rods)
        except RodError:
            return np.full(QUANTITIES[self.name].size, math.nan)


def jacobian(
    at: Callable[[Array], State],
    quantities: Sequence[Callable[[State], Array]],
    steps: Sequence[float],
    refused: type[Exception] = RodError,
) -> Array:
    """(m, k) derivatives of all numbers of an arm by k parameters, by central differences.

    at: the arm after changes (k,) of the parameters, such as its rods. quantities: numbers of it, m in all. steps: of
    the parameters (k,). A quantity that one side does not have is differentiated on the other side. Raises what is
    refused, as `at` and the quantities do, where that is no way either.
    """
    columns = []
    for step, unit in zip(steps, np.eye(len(steps)), strict=True):
        there = cache(_along(at, step * unit))
        columns.append(np.concatenate([_change(there, of, refused) for of in quantities]) / step)
    return np.column_stack(columns)


def _along(at: Callable[[Array], State], move: Array) -> Callable[[float], State]:
    return lambda part: at(part * move)


def _change(there: Callable[[float], State], of: Callable[[State], Array], refused: type[Exception]) -> Array:
    """(n,) per step, from the parts -1 and 1 of it, or from one of them and 0."""
    found, failures = list[tuple[float, Array]](), list[Exception]()
    for part in (-1.0, 1.0, 0.0):
        try:
            found.append((part, of(there(part))))
        except refused as failure:
            failures.append(failure)
        if len(found) == 2:
            (first, less), (second, more) = found
            return np.asarray((more - less) / (second - first))
    raise failures[0]
