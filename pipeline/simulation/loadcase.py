"""What is solved: one way of holding and loading the body, over a list of pressures."""

from dataclasses import dataclass

from pipeline.config.config import Config


@dataclass(frozen=True)
class Case:
    """One experiment with its load. Its states are remembered under its name."""

    name: str  #: I, II, III, III_end_10mm, dead_0_0.05N
    experiment: str  #: I, II, III or dead
    pressures_kPa: tuple[float, ...]  #: ascending, none above the largest of the run
    end_y_mm: float = 0.0  #: displacement u_y of the end in III
    force_N: tuple[float, float] = (0.0, 0.0)  #: on the end in dead

    @staticmethod
    def of(config: Config, experiment: str) -> "Case":
        """One of the three experiments I, II, III at the pressures of the run."""
        return Case(experiment, experiment, config.pressures_kPa, config.end_y_mm)

    @property
    def load(self) -> str:
        """The load besides the pressure in words; empty for the three experiments."""
        if self.experiment == "dead":
            return f"dead force {self.force_N[0]:g}, {self.force_N[1]:g} N"
        return f"end at {self.end_y_mm:+g} mm" if self.name != self.experiment else ""


def up_to(config: Config, experiment: str, pressure: float) -> Case:
    """I, II or III at one more pressure (kPa) and those of the run below it, from which the path goes on."""
    below = tuple(known for known in config.pressures_kPa if known < pressure)
    return Case(experiment, experiment, (*below, pressure), config.end_y_mm)


def validation_cases(config: Config) -> tuple[Case, ...]:
    """The loads that the numbers are not fitted to; the longest first.

    At pressures between those of the run that is II and III as well.
    """
    asked, known = config.validation, config.pressures_kPa
    between = tuple(pressure for pressure in asked.pressures_kPa if pressure not in known)
    cases = [
        *(Case(f"III_end_{y:g}mm", "III", asked.pressures_kPa, end_y_mm=y) for y in asked.end_y_mm),
        *(Case(f"dead_{x:g}_{y:g}N", "dead", asked.pressures_kPa, force_N=(x, y)) for x, y in asked.forces_N),
    ]
    if between:
        every = tuple(sorted({*known, *between}))
        whole = tuple(pressure for pressure in every if pressure <= between[-1])
        cases += [Case(name, name, whole, config.end_y_mm) for name in ("III", "II")]
    return tuple(cases)
