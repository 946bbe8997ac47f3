"""The loads of a configuration at which the rod is compared with the finite elements, and the end of the arm."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any

from pipeline.config.effects import STATES, State, Switched
from pipeline.config.kinds import Length, Pressures, distinct, in_unit, list_of
from pipeline.config.section import Error, Field, Kind, ReadContext, Section, conflict, raise_all, section
from pipeline.config.units import FORCE, LENGTH, convert
from rod.same_pressure import as_known

#: how far the end of the load that is part of every run lies from that of experiment III, over the length
ELSEWHERE = 0.1
#: dead forces on the end that are part of every run, over EI / l^2 of the arm; the negative one is a payload
SMALL_FORCES = (-0.1, 0.02)


@dataclass(frozen=True)
class End:
    """The end of the arm in experiment III: along each axis a displacement or a force of constant direction."""

    x_mm: float | None = None  #: its displacement u_x; None where it is free
    y_mm: float | None = 0.0  #: its displacement u_y; None where it is free
    force_N: tuple[float, float] = (0.0, 0.0)  #: zero along an axis whose displacement is prescribed


#: along one axis: a displacement (mm), or None and a force (N)
Along = tuple[float | None, float]


def _along(value: Any) -> Along:
    try:
        return convert(value, LENGTH), 0.0
    except ValueError as refused:
        try:
            return None, convert(value, FORCE)
        except ValueError:
            raise ValueError(f"{refused}, or a force, for example '{FORCE.example}'") from None


_ON_END = Kind("a displacement, or a force", "5 mm", "mm or N", read=_along)


@section(frozen=True)
class GivenEnd(Section):
    """What is written of the end."""

    x: Annotated[Along, _ON_END] = Field(
        default=(None, 0.0),
        description="experiment III: [displacement of the end, or force on it](#the-end-in-experiment-iii)",
    )
    y: Annotated[Along, _ON_END] = Field(
        default=(0.0, 0.0),
        description="experiment III: the same across the arm, prescribed change of height relative to rest",
    )


def read_end(given: GivenEnd, *_: Any) -> End:
    """What the end has in III along both axes."""
    return End(given.x[0], given.y[0], (given.x[1], given.y[1]))


@dataclass(frozen=True)
class Validation:
    """Loads at which the rod is compared with the finite elements without being fitted to them."""

    pressures_kPa: tuple[float, ...] = ()  #: ascending; those of the run and others between them
    end_y_mm: tuple[float, ...] = ()  #: displacements u_y of the end in III
    forces_N: tuple[tuple[float, float], ...] = ()  #: dead forces on the end
    #: whether II and III are solved at the pressures between as well; not for the loads that the program chooses
    with_experiments: bool = True

    def among(self, reached_kPa: Sequence[float]) -> "Validation":
        """These loads, or those that the program chooses at a pressure among those (ascending) that were reached.

        Empty where that load has no such pressure.
        """
        if self.with_experiments or (reached_kPa and self.pressures_kPa[-1] <= reached_kPa[-1]):
            return self
        return replace(self, pressures_kPa=(middle_of_widest(reached_kPa),)) if reached_kPa else Validation()

    def beyond(self, held_mm: float, *, is_held_down: bool) -> "Validation":
        """Mirrors the end that the program chooses at the height u_y of III, if III pushes the end down."""
        if self.with_experiments or not is_held_down:
            return self
        return replace(self, end_y_mm=tuple(float(f"{2.0 * held_mm - y:.12g}") for y in self.end_y_mm))

    def with_small_forces(self, unit_N: float) -> "Validation":
        """Adds small dead forces on the end, up and down; of no unit there are none.

        unit_N: EI / l^2 of the arm.
        """
        if not self.pressures_kPa or not unit_N:
            return self
        small = ((0.0, float(f"{part * unit_N:.2g}")) for part in SMALL_FORCES)
        return replace(self, forces_N=(*self.forces_N, *small))

    def up_to(self, highest_kPa: float) -> "Validation":
        """These loads at the pressures up to this one; empty where there is none."""
        pressures = tuple(pressure for pressure in self.pressures_kPa if pressure <= highest_kPa)
        return replace(self, pressures_kPa=pressures) if pressures else Validation()


def middle_of_widest(pressures_kPa: Sequence[float]) -> float:
    """The middle of the widest interval between pressures (ascending), or the only one, kPa."""
    intervals = list(pairwise(pressures_kPa))
    low, high = max(intervals, key=lambda interval: interval[1] - interval[0], default=(pressures_kPa[0],) * 2)
    return float(f"{0.5 * (low + high):.12g}")


_Force = Annotated[float, Kind("any", FORCE.example, "N", in_unit(FORCE))]
_Forces = Annotated[tuple[_Force, _Force], list_of("", "[0 N, 0.05 N]", "N", count=2)]


@section(frozen=True)
class GivenValidation(Switched):
    """What is written of the loads for the validation."""

    state: Annotated[State, STATES] = Field(
        default="auto", description="whether validation loads are solved; `auto`: the program decides"
    )
    pressures_kPa: Pressures | None = Field(
        default=None, examples=["[24 kPa]"], description="within those of the run; II and III are solved at them too"
    )
    end_y_mm: Annotated[tuple[Length, ...], list_of("list", "[10 mm, -10 mm]", "mm", distinct)] = Field(
        default=(), description="other heights of the end than `end.y`"
    )
    forces_N: Annotated[tuple[_Forces, ...], list_of("list of pairs of x and y", "[[0 N, 0.05 N]]", "N", distinct)] = (
        Field(default=(), description="dead forces on the end")
    )


def read_validation(given: GivenValidation, beside: ReadContext) -> Validation:
    """The loads not used for the fit; where there are some and no pressures, all pressures of the run.

    Where none are given the program chooses: the middle of the widest interval of pressures, with the end above that
    of III, and later with small forces on the end, which need the rigidity of the arm.
    """
    design, of_run, end = beside.known("design", "pressures_kPa", "end")
    if given.state == "off":
        return Validation()
    if not (given.pressures_kPa or given.end_y_mm or given.forces_N):
        elsewhere = float(f"{(end.y_mm or 0.0) + ELSEWHERE * design.length:.12g}")
        return Validation((middle_of_widest(of_run),), (elsewhere,), (), with_experiments=False)
    pressures = tuple(as_known(of_run, pressure) for pressure in given.pressures_kPa or ())
    raise_all(_useless(given, pressures, of_run, end))
    other_loads = bool(given.end_y_mm or given.forces_N)
    return Validation(pressures or (of_run if other_loads else ()), given.end_y_mm, given.forces_N)


def _useless(
    given: GivenValidation, pressures: tuple[float, ...], of_run: tuple[float, ...], end: End
) -> Iterator[Error]:
    """Refuses loads at which the numbers are identified, and pressures outside those of the run."""
    fitted = "is what the numbers are identified with; give others"
    if end == End(y_mm=end.y_mm) and end.y_mm in given.end_y_mm:
        yield conflict(f"{end.y_mm:g} mm {fitted}", ("validation", "end_y"))
    for force in given.forces_N:
        if force == (0.0, 0.0) or end == End(None, None, force):
            yield conflict(f"[{force[0]:g} N, {force[1]:g} N] {fitted}", ("validation", "forces"))
    key, limits = ("validation", "pressures"), f"{of_run[0]:g} to {of_run[-1]:g} kPa"
    for pressure in pressures:
        if not of_run[0] <= pressure <= of_run[-1]:
            yield conflict(f"{pressure:g} kPa lies outside the pressures of the run; allowed: {limits}", key)
    if pressures and not given.end_y_mm and not given.forces_N and set(pressures) <= set(of_run):
        yield conflict("are all pressures of the run; give one between them, or end_y, or forces", key)
