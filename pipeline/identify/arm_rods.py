"""The rods compared with the finite elements: with five parameters, and with the arm's own law."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from pipeline.values.formats import ARM_LAW, FIVE
from pipeline.values.parameters import RodParameters
from rod import ArmLaw, Rod, RodError

#: the rods of one pressure by their names; why there is none
Rods = Mapping[str, Rod | RodError]


@dataclass(frozen=True)
class ArmRods:
    """All rods of an arm over the pressure."""

    parameters: RodParameters = field(repr=False)  #: without pressures: no rods with five parameters
    law: ArmLaw | None  #: None: no rod with the law of the arm
    start: tuple[float, float] = (0.0, 0.0)  #: mm, the clamped end of the material curve

    @property
    def identified_kPa(self) -> tuple[float, ...]:
        """The pressures that have five parameters."""
        return self.parameters.pressures_kPa

    @cached_property
    def _sources(self) -> dict[str, Callable[[float], Rod]]:
        """By name: what gives the rod at a pressure."""
        sources: dict[str, Callable[[float], Rod]] = {}
        if self.identified_kPa:
            sources[FIVE] = replace(self.parameters.rods(), start=self.start).at
        if (law := self.law) is not None:
            sources[ARM_LAW] = lambda pressure: Rod(law.length, law=law.at(pressure), start=self.start)
        return sources

    def at(self, pressure: float) -> Rods:
        """The rods at a pressure in kPa, between identified ones by cubics; a reason for each that is none."""
        rods: dict[str, Rod | RodError] = {}
        for name, rod_at in self._sources.items():
            try:
                rods[name] = rod_at(pressure)
            except RodError as failure:
                rods[name] = failure
        return rods
