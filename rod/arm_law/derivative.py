"""What a parameter of the design does to an arm, from its own law: small central differences of laws and their rods."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Protocol, Self, final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.section import SectionLaw
from rod.errors import RodError
from rod.solution import RodSolution

#: change of the moments of the law in difference quotients, over the largest one, and that of the parameter at most
STEP, LARGEST_STEP = 1e-4, 1e-2


class Arm(Protocol):
    """An arm at one pressure, as `rod.arm_law.law_rod.LawRod` is."""

    @property
    def section(self) -> SectionLaw:
        """The law of its cells."""

    @property
    def length(self) -> float:
        """mm"""

    def solve(self) -> RodSolution:
        """The arm without load."""


class WithRates(Protocol):
    """A law with derivatives, as `rod.arm_law.law.ArmLaw` is."""

    def with_changes(self, changes: Mapping[str, float]) -> Self:
        """The law for small changes of parameters."""

    def step(self, name: str) -> float:
        """A change of a parameter for difference quotients."""

    def at(self, pressure: float) -> Arm:
        """The arm at a pressure in kPa."""


#: a number of the arm of a changed law, beside the arm of the law itself
Number = Callable[[Arm, Arm], float]


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Derivative:
    """By one parameter, per unit of it, at the pressures of the law; NaN where a number does not exist."""

    parameter: str  #: key of the configuration, such as geometry.wall
    value: float  #: of the parameter
    unit: str  #: of the parameter: mm, MPa, or 1
    pressures: Array  #: (n,) kPa
    kappa_0: Annotated[Array, "kappa_0_per_mm", "n"]  #: curvature without moment, 1/mm
    rigidity: Annotated[
        Array, "rigidity_N_mm2", "n"
    ]  #: mean bending rigidity from there on, over a change of the curvature by 1/length, N mm2
    moment: Annotated[Array, "moment_N_mm", "n"]  #: at half the curvature without moment, N mm
    stretch: Annotated[Array, "stretch", "n"]  #: of the axis without load
    end_angle: Annotated[Array, "end_angle_rad", "n"]  #: of the end of the arm without load, rad
    lateral_rigidity: Annotated[Array, "lateral_rigidity_N_mm2", "n"]  #: B_2 without moment, N mm2
    torsional_rigidity: Annotated[Array, "torsional_rigidity_N_mm2", "n"]  #: GJ without moment, N mm2
    contact_onset: Annotated[
        Array, "contact_onset_per_mm", "n"
    ]  #: curvature beyond which walls touch up to the end of a curve, 1/mm
    largest_stretch: Annotated[Array, "largest_stretch", "n"]  #: largest principal stretch of a cell without moment


#: numbers of an arm at one pressure, by the name of the field of `Derivative`
NUMBERS: dict[str, Number] = {}


def _number(function: Number) -> Number:
    NUMBERS[function.__name__] = function
    return function


@_number
def kappa_0(rod: Arm, known: Arm) -> float:
    """1/mm."""
    return rod.section.kappa_0


@_number
def rigidity(rod: Arm, known: Arm) -> float:
    """N mm2; over the same change of the curvature as of the known rod, towards the straight arm."""
    law, origin = known.section, known.section.kappa_0
    change = 1.0 / known.length if origin <= 0.0 else -1.0 / known.length
    room = float(law.kappa[-1] - origin if change > 0.0 else law.kappa[0] - origin)
    change = change if abs(room) > abs(change) else room
    return _moment_at(rod, rod.section.kappa_0 + change) / change


@_number
def moment(rod: Arm, known: Arm) -> float:
    """N mm; at half the curvature that the known rod has without moment."""
    return _moment_at(rod, 0.5 * known.section.kappa_0)


@_number
def stretch(rod: Arm, known: Arm) -> float:
    """Of the axis."""
    return float(np.interp(0.0, rod.section.moment, rod.section.stretch))


@_number
def end_angle(rod: Arm, known: Arm) -> float:
    """rad."""
    return float(rod.solve().theta[-1])


@_number
def lateral_rigidity(rod: Arm, known: Arm) -> float:
    """N mm2, without moment; NaN for a law of the plane alone."""
    return _across(rod, "lateral_rigidity")


@_number
def torsional_rigidity(rod: Arm, known: Arm) -> float:
    """N mm2, without moment; NaN for a law of the plane alone."""
    return _across(rod, "torsional_rigidity")


def _across(rod: Arm, name: str) -> float:
    law = rod.section
    return float(np.interp(0.0, law.moment, law.in_space[name])) if name in law.in_space else np.nan


def _moment_at(rod: Arm, kappa: float) -> float:
    law = rod.section
    return float(np.interp(kappa, law.kappa, law.moment)) if law.kappa[0] <= kappa <= law.kappa[-1] else np.nan


def rates_of(
    law: WithRates,
    name: str,
    pressures: Sequence[float],
    numbers: Mapping[str, Number],
) -> dict[str, Array]:
    """Derivatives (n,) of numbers of the arm at pressures (n,) in kPa by one parameter, per unit of it.

    numbers: each of the rod of a changed law, beside the rod of the law itself; NaN where a rod has no such number.
    Raises `RodError` for a parameter without derivatives.
    """
    step = law.step(name)
    try:
        less, more = (law.with_changes({name: sign * step}) for sign in (-1.0, 1.0))
    except RodError:
        return {number: np.full(len(pressures), np.nan) for number in numbers}
    rows = [_differences(law, less, more, pressure, numbers) for pressure in pressures]
    return dict(zip(numbers, np.array(rows, float).T / (2.0 * step), strict=True))


def _differences(
    law: WithRates, less: WithRates, more: WithRates, pressure: float, numbers: Mapping[str, Number]
) -> list[float]:
    try:
        known, low, high = (one.at(pressure) for one in (law, less, more))
    except RodError:
        return [np.nan] * len(numbers)
    return [_difference(number, known, low, high) for number in numbers.values()]


def _difference(number: Number, known: Arm, low: Arm, high: Arm) -> float:
    try:
        return number(high, known) - number(low, known)
    except RodError:
        return float("nan")
