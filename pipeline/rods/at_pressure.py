"""An identified rod, or one with the arm's own law, at one pressure."""

from dataclasses import dataclass

from pipeline.store.formats import ARM_LAW, EXTENSIBLE, FIVE
from rod.arm_law.law import LawRod
from rod.export.tables import unloaded_distance
from rod.identification.moment_range import MomentRange
from rod.mechanics.equilibrium import Rod
from rod.pressurised_rod import IDENTIFIED, PressurisedRod
from rod.solution import RodSolution


@dataclass(frozen=True)
class RodAtPressure:
    """The rod of a file at one pressure."""

    rod: Rod
    moment_range: MomentRange | None  #: of the identification, None where the file has none
    origin: str = IDENTIFIED  #: where the five parameters at this pressure come from

    @staticmethod
    def of(rods: PressurisedRod, pressure: float, extrapolate: bool) -> "RodAtPressure":
        """That of a file at a pressure in kPa. Raises RodError."""
        rod = rods.at(pressure, extrapolate=extrapolate)
        return RodAtPressure(rod, rods.moment_range_at(pressure, extrapolate=extrapolate), rods.origin_at(pressure))

    @property
    def description(self) -> str:
        """Which rod it is: its name in validation.json, and where its numbers come from."""
        if isinstance(self.rod.law, LawRod):
            return f"{ARM_LAW}: the arm's own law"
        if self.rod.extension is None:
            which = f"{FIVE}: five parameters, inextensible"
        else:
            which = f"{EXTENSIBLE}: five parameters of the key eccentricity, with the stretch of the curve"
        return which if self.origin == IDENTIFIED else f"{which}; {self.origin}"

    def warning(self, shape: RodSolution) -> str:
        """What to know where the moments of a shape leave the range of the identification; empty elsewhere."""
        outside = "" if self.moment_range is None else self.moment_range.warning(shape)
        if not outside:
            return ""
        jump = unloaded_distance(self.rod)
        return (
            f"{outside} Under any load, however small, the offsets m0 bend this rod as well: its end is then "
            f"{jump:.3g} mm from its place without load."
        )
