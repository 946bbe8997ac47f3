"""What is solved: one way of supporting and loading the body, over a schedule of pressures."""

from dataclasses import dataclass

from pipeline.config.config import Config, End
from pipeline.values.pressure import in_MPa
from rod.same_pressure import is_among


@dataclass(frozen=True)
class PressureSchedule:
    """The pressures of a load case in the order in which they are solved, and the load factors that stand for them.

    States are matched to their pressures by position in the schedule, never by their factors.
    """

    pressures_kPa: tuple[float, ...]
    reference_kPa: float  #: the pressure at load factor 1: the largest of the run

    @property
    def reference_MPa(self) -> float:
        """The pressure at load factor 1."""
        return in_MPa(self.reference_kPa)

    @property
    def factors(self) -> tuple[float, ...]:
        """The load factor of each pressure."""
        return tuple(map(self.factor_at, self.pressures_kPa))

    def factor_at(self, pressure_kPa: float) -> float:
        """The load factor of any pressure (kPa)."""
        return in_MPa(pressure_kPa) / self.reference_MPa

    def pressure_at(self, factor: float) -> float:
        """The pressure (kPa) at any load factor, for messages."""
        return factor * self.reference_kPa


@dataclass(frozen=True)
class LoadCase:
    """One experiment with its load. Its states are stored under its name."""

    name: str  #: I, II, III, III_end_10mm, dead_0_0.05N
    experiment: str  #: I, II, III or dead
    schedule: PressureSchedule
    end: End  #: displacements of the end and forces on it in III; the force alone in dead
    #: kPa, pressures at which the run has stored `near`, from which the way is short
    near_kPa: tuple[float, ...] = ()

    @property
    def near(self) -> str:
        """The experiment of the run that differs in the height of its end, or in the force on it, alone."""
        return "II" if self.experiment == "dead" else self.experiment

    def begin_kPa(self, pressure_kPa: float) -> float | None:
        """The pressure of `near` at which the way to a pressure begins: that pressure or the next lower one.

        None where it has no state at a pressure as high: it may have ended at a limit in between.
        """
        lower = [near for near in self.near_kPa if near <= pressure_kPa]
        return max(lower) if lower and max(self.near_kPa) >= pressure_kPa else None

    @property
    def held(self) -> tuple[bool, bool]:
        """Whether the displacement of the end along x and along y is prescribed."""
        return (self.end.x_mm is not None, self.end.y_mm is not None) if self.experiment == "III" else (False, False)

    @property
    def on_end(self) -> str:
        """The displacements of the end and the forces on it that are not zero, in words."""
        held = {"u_x": self.end.x_mm, "u_y": self.end.y_mm} if self.experiment == "III" else {}
        acting = [f"{name} = {value:g} mm" for name, value in held.items() if value]
        if self.experiment in ("III", "dead"):
            acting += [f"F_{axis} = {value:g} N" for axis, value in zip("xy", self.end.force_N, strict=True) if value]
        return ", ".join(acting)

    @property
    def load(self) -> str:
        """The load besides the pressure in words; empty for the three experiments."""
        if self.experiment == "dead":
            return f"dead force {self.end.force_N[0]:g}, {self.end.force_N[1]:g} N"
        if self.name == self.experiment:
            return ""
        return self.on_end if self.end.y_mm is None else f"end at {self.end.y_mm:+g} mm"


def schedule(config: Config, pressures_kPa: tuple[float, ...] | None = None) -> PressureSchedule:
    """The pressures of the run, or others that are scaled by the largest of the run."""
    return PressureSchedule(config.pressures_kPa if pressures_kPa is None else pressures_kPa, config.pressures_kPa[-1])


def identification_case(config: Config, experiment: str) -> LoadCase:
    """One of the three experiments I, II, III at the pressures of the run."""
    return LoadCase(experiment, experiment, schedule(config), config.end)


def _path_to(pressures_kPa: tuple[float, ...], stored_kPa: tuple[float, ...]) -> tuple[float, ...]:
    """The stored pressures from which the way to others is short, then these; both ascend.

    The next higher one comes first: with the next lower one it tells where the states between them are.
    """
    below = tuple(pressure for pressure in stored_kPa if pressure < pressures_kPa[0])
    above = tuple(pressure for pressure in stored_kPa if pressure > pressures_kPa[0])
    return (*((above[0], below[-1]) if above and below else below), *pressures_kPa)


def has_height_alone(end: End) -> bool:
    """Whether nothing but the height of the end is prescribed in III."""
    return end.y_mm is not None and end.x_mm is None and not any(end.force_N)


def validation_cases(config: Config, reached_kPa: tuple[float, ...] | None = None) -> tuple[LoadCase, ...]:
    """The loads that the parameters are not fitted to; the longest first.

    reached_kPa: pressures of the run at which II and III are stored, all of them by default. At pressures between those
    of the run II and III are loads of the validation as well, unless only the default load is solved.
    """
    validation, of_run = config.validation, config.pressures_kPa
    between = tuple(p for p in validation.pressures_kPa if validation.with_experiments and not is_among(of_run, p))
    of_II = (*reached_kPa, *between) if reached_kPa else ()
    of_III = reached_kPa if reached_kPa and has_height_alone(config.end) else ()
    pressures = schedule(config, validation.pressures_kPa)
    dead = ((f"dead_{x:g}_{y:g}N", End(None, None, (x, y))) for x, y in validation.forces_N)
    cases = [
        *(LoadCase(name, "dead", pressures, end, of_II) for name, end in dead),
        *(LoadCase(f"III_end_{y:g}mm", "III", pressures, End(y_mm=y), of_III) for y in validation.end_y_mm),
    ]
    if between:
        path = _path_to(between, of_run if reached_kPa is None else reached_kPa)
        cases += [LoadCase(name, name, schedule(config, path), config.end) for name in ("III", "II")]
    return tuple(cases)
