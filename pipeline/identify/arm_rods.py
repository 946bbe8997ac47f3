"""The rods compared with the finite elements: with five parameters, with their stretch, with the arm's own law."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from pipeline.results.saved_rod import pressurised_rod
from pipeline.values.formats import ARM_LAW, EXTENSIBLE, FIVE
from rod import ArmLaw, PressurisedRod, Rod, RodError


@dataclass(frozen=True)
class NoSolution:
    """A rod that has no equilibrium under a load, or cannot be compared."""

    reason: str  #: a sentence


#: the rods of one pressure by their names
Rods = Mapping[str, Rod | NoSolution]


@dataclass(frozen=True)
class ArmRods:
    """All rods of an arm over the pressure."""

    parameters: Mapping[str, Any] = field(repr=False)  #: parameters.json; empty: no rods with five parameters
    law: ArmLaw | None  #: None: no rod with the law of the arm
    start: tuple[float, float] = (0.0, 0.0)  #: mm, the clamped end of the material curve

    @property
    def identified_kPa(self) -> tuple[float, ...]:
        """The pressures that have five parameters."""
        return tuple(self.parameters.get("pressures_kPa", ()))

    @cached_property
    def _fitted(self) -> dict[str, PressurisedRod]:
        if not self.identified_kPa:
            return {}
        kinds = {FIVE: False, EXTENSIBLE: True}
        return {
            name: replace(pressurised_rod(self.parameters, extensible), start=self.start)
            for name, extensible in kinds.items()
        }

    def at(self, pressure: float) -> Rods:
        """The rods at a pressure in kPa, between identified ones by cubics; a reason for each that is none."""
        rods: dict[str, Rod | NoSolution] = {}
        for name, over_pressure in self._fitted.items():
            try:
                rods[name] = over_pressure.at(pressure)
            except RodError as failure:
                rods[name] = NoSolution(str(failure))
        if self.law is not None:
            try:
                rods[ARM_LAW] = Rod(self.law.length, law=self.law.at(pressure), start=self.start)
            except RodError as failure:
                rods[ARM_LAW] = NoSolution(str(failure))
        return rods
