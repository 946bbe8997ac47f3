"""The rods compared with the finite elements: with five parameters, the same with stretch, with the arm's law."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.identification.parameters import Parameters
from pipeline.store.formats import ARM_LAW, EXTENSIBLE, FIVE
from rod import ArmLaw, MomentRange, PressurisedRod, Rod, RodError


@dataclass(frozen=True)
class NoSolution:
    """A rod that has no equilibrium under a load, or cannot be compared."""

    reason: str  #: a sentence


@dataclass(frozen=True)
class FittedRod:
    """A rod with parameters of experiment III, and the moments they were identified from."""

    rod: Rod
    moment_range: MomentRange


@dataclass(frozen=True)
class PredictedRod:
    """A rod with the law of the arm, which nothing was fitted to."""

    rod: Rod


#: the rods of one pressure by their names
Rods = Mapping[str, FittedRod | PredictedRod | NoSolution]


@dataclass(frozen=True)
class ArmRods:
    """All rods of an arm over the pressure."""

    parameters: tuple[Parameters, ...]  #: by ascending pressure; empty: no rods with five parameters
    law: ArmLaw | None  #: None: no rod with the law of the arm
    start: tuple[float, float] = (0.0, 0.0)  #: mm, the clamped end of the material curve
    straight_without_pressure: bool = True  #: see `PressurisedRod`

    def at(self, pressure: float) -> Rods:
        """The rods at a pressure in kPa, between identified ones by cubics; a reason for each that is none."""
        rods: dict[str, FittedRod | PredictedRod | NoSolution] = {}
        if self.parameters:
            for name, over_pressure in ((FIVE, self._inextensible), (EXTENSIBLE, self._extensible)):
                try:
                    rods[name] = fitted_rod(over_pressure(), pressure)
                except RodError as failure:
                    rods[name] = NoSolution(str(failure))
        if self.law is not None:
            try:
                rods[ARM_LAW] = PredictedRod(Rod(self.law.length, law=self.law.at(pressure), start=self.start))
            except RodError as failure:
                rods[ARM_LAW] = NoSolution(str(failure))
        return rods

    def _inextensible(self) -> PressurisedRod:
        return self._over_pressure([p.rod for p in self.parameters], [p.moment_range for p in self.parameters])

    def _extensible(self) -> PressurisedRod:
        ranges = [p.extensible_moment_range for p in self.parameters]
        return self._over_pressure([p.extensible_rod for p in self.parameters], ranges)

    def _over_pressure(self, rods: Sequence[Rod], ranges: Sequence[MomentRange]) -> PressurisedRod:
        """Rods at the pressures of the parameters."""
        return PressurisedRod(
            rods[0].length,
            np.array([p.pressure_kPa for p in self.parameters]),
            tuple(rod.five for rod in rods),
            np.asarray(rods[0].kappa_0)[:, 0],
            np.array([np.asarray(rod.kappa_0)[:, 1] for rod in rods]),
            np.array([rod.theta0 for rod in rods]),
            rods[0].start,
            tuple(rod.extension for rod in rods if rod.extension is not None),
            tuple(ranges),
            self.straight_without_pressure,
            rods[0].weight,
            rods[0].weight_height,
        )


def fitted_rod(rods: PressurisedRod, pressure: float) -> FittedRod:
    """The rod at a pressure (kPa) with its range of moments. Raises RodError."""
    moment_range = rods.moment_range_at(pressure)
    if moment_range is None:
        raise RodError("The range of moments of the identification is missing.")
    return FittedRod(rods.at(pressure), moment_range)
