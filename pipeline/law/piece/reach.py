"""Over which moments and curvatures a law is measured: those of the loads of its configuration, with a margin."""

from dataclasses import dataclass
from math import hypot, inf, sqrt

import numpy as np

from geometry.arrays import Array
from pipeline.config.config import Config

#: part of its curvature without moment by which an arm of constant rigidity is bent to the other side at the clamp
#: while its end is held at its height: the tip of a cantilever moves by kappa l^2 / 2 and back by F l^3 / (3 EI)
STRAIGHTENED = 0.5
#: curvatures that follow from the place of the end are taken this many times, because no arm has constant rigidity
MARGIN = 1.5
#: forces are taken this many times, because the arm stretches under pressure and its lever is longer than at rest
STRETCHED = 1.1
#: part of the curvature without moment by which a cell is bent further than that, whatever the loads
FURTHER = 0.5
#: a law is made for arms that bend by this angle at least, rad
LEAST_TURN = 0.1
#: no moment goes beyond the one that straightens the arm, or zero, by more than this many times EI/l
LARGEST = 3.0


@dataclass(frozen=True)
class Range:
    """How far a cell is followed to one side from its state without moment."""

    outward: int  #: 1 to larger moments, -1 to smaller ones
    turn: float  #: 1/mm, change of the curvature, positive, by loads that prescribe the place of the end
    straight: float  #: 1/mm, the part of it that straightens the cell
    force: float  #: N mm, moment of forces on the end, positive
    farthest: float  #: 1/mm, change of the curvature whose moment ends the range in any case, positive
    rigidity: float  #: N mm2, of the cell without moment

    @property
    def first_moment(self) -> float:
        """The end of the range if the cell kept its rigidity, N mm."""
        return self.outward * self.left(np.zeros(1), np.zeros(1))

    def left(self, moments: Array, turns: Array) -> float:
        """What the moment of the outermost state of a cell lacks, N mm; zero or less beyond the range.

        moments: (n,) N mm, from the state without moment outwards; turns: (n,) 1/mm, changes of the curvature.

        Changes of the curvature are turned into moments with the secant rigidity up to the outermost state, at most up
        to the straight cell, and not less than that without moment: where walls meet on the way, the arm needs a larger
        moment for the same change; where they meet beyond the straight cell, the arm bends elsewhere instead.
        """
        moments, turns = self.outward * moments, self.outward * turns
        rigidity, secant_to = self.rigidity, min(float(turns[-1]), self.straight)
        if secant_to > 0.0:
            rigidity = max(rigidity, float(np.interp(secant_to, turns, moments)) / secant_to)
        by_turn = min((self.turn - turns[-1]) * rigidity, self.turn * rigidity - moments[-1])
        return float(min(max(by_turn, self.force - moments[-1]), self.farthest * rigidity - moments[-1]))


@dataclass(frozen=True)
class Reach:
    """For what loads a law is made."""

    length: float  #: mm, of the arm
    force: float  #: N, the largest one on the end, with a margin
    end_y: float  #: mm, the largest displacement u_y of the end that is prescribed; infinite for any
    bend: float  #: 1/mm, curvature without moment at the highest pressure at which the curve is used
    weight: float = 0.0  #: N, of the arm in its plane, in any direction; zero without gravity

    @staticmethod
    def of(config: Config, bend: float) -> "Reach":
        """The reach of experiment III and of the validation loads of a configuration."""
        end, loads = config.end, config.validation
        forces = [hypot(*force) for force in (end.force_N, *loads.forces_N)]
        heights = [abs(height) for height in (end.y_mm or 0.0, *loads.end_y_mm)]
        largest = STRETCHED * max(forces)
        end_y, gravity = max(heights) if end.x_mm is None else inf, config.effects.gravity
        weight = (config.mass_tonne or 0.0) * hypot(*gravity.acceleration_mm_s2) if gravity.on else 0.0
        return Reach(config.design.length, largest, end_y, bend, weight)

    def range_from(self, kappa: float, rigidity: float, outward: int) -> Range:
        """From the cell without moment, its curvature in 1/mm and its rigidity in N mm2, to one side."""
        bend = max(abs(self.bend), LEAST_TURN / self.length)
        part = MARGIN * STRAIGHTENED if outward * self.bend < 0.0 else FURTHER
        straight = max(-outward * kappa, 0.0)
        turn = straight + part * bend + MARGIN * 3.0 * self.end_y / self.length**2
        # at the clamp at most: of a straight arm that lies, or of a soft one that turns over, whose bending energy per
        # length M^2 / (2 EI) is what its weight gains
        by_weight = STRETCHED * min(0.5 * self.weight * self.length, 2.0 * sqrt(rigidity * self.weight))
        farthest = max(straight + LARGEST / self.length, by_weight / rigidity)
        return Range(outward, turn, straight, max(self.force * self.length, by_weight), farthest, rigidity)
