"""Loads on the end of a rod from the command line, and the shapes under them."""

import math
from dataclasses import dataclass
from pathlib import Path

from pipeline.config.units import FORCE, LENGTH, MOMENT
from pipeline.errors import RunFailed
from pipeline.rods.at_pressure import RodAtPressure
from pipeline.rods.options import option_pair, option_value
from pipeline.store.atomic_file import write_atomic
from pipeline.store.result_folder import open_file
from rod.arm_law.law import LawRod
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod
from rod.solution import RodSolution


@dataclass(frozen=True)
class EndLoads:
    """Loads on the end of a rod; None for what is not prescribed.

    Positions are relative to the clamped end of the material curve.
    """

    force: tuple[float, float] | None  #: N
    moment: float  #: N mm
    end_y: float | None  #: mm
    end: tuple[float, float] | None  #: mm

    @staticmethod
    def read(force: str | None, moment: str, end_y: str | None, end: str | None) -> "EndLoads":
        """From the options of the command line, written with units. Raises InputError."""
        return EndLoads(
            None if force is None else option_pair("--force", force, FORCE),
            option_value("--moment", moment, MOMENT),
            None if end_y is None else option_value("--end-y", end_y, LENGTH),
            None if end is None else option_pair("--end", end, LENGTH),
        )

    def shape(self, rod: Rod) -> RodSolution:
        """The equilibrium of a rod under these loads. Raises RunFailed where there is none."""
        try:
            return rod.solve(force=self.force, moment=self.moment, end_y=self.end_y, end=self.end)
        except RodError as failure:
            raise RunFailed(f"{failure}{self._beyond_reach(rod)}") from None

    def _beyond_reach(self, rod: Rod) -> str:
        """A sentence where the end of a rod that stretches is to be farther from the clamped end than the arm is long;
        empty elsewhere: an inextensible rod says so itself."""
        away = abs(self.end_y or 0.0) if self.end is None else math.hypot(*self.end)
        inextensible = rod.extension is None and not isinstance(rod.law, LawRod)
        if away <= rod.length or inextensible:
            return ""
        return (
            f" The end is to be {away:g} mm away from the clamped end, but the arm is {rod.length:g} mm long at rest."
        )


def end_lines(selected: RodAtPressure, shape: RodSolution) -> list[str]:
    """Which rod it is, position, angle and force of its end, and the moment at the clamp, one line each."""
    x, y = shape.end
    lines = {
        "rod": selected.description,
        "end": f"x = {_rounded(x):.3f} mm, y = {_rounded(y):.3f} mm from the clamped end of the curve",
        "end angle": f"{shape.end_angle:.4f} rad",
        "end force": f"[{shape.force[0]:.5g}, {shape.force[1]:.5g}] N",
        "moment at the clamp": f"{shape.clamp_moment:.5g} N mm",
    }
    if any(selected.rod.weight):
        x, y = (selected.rod.length * component for component in selected.rod.weight)
        lines["weight"] = f"[{x:.5g}, {y:.5g}] N, which the rod carries besides"
    width = max(map(len, lines))
    return [f"{name:<{width}}  {value}" for name, value in lines.items()]


def _rounded(coordinate: float) -> float:
    """A coordinate to a thousandth of a millimetre (mm); one that is rounded to zero has no sign."""
    return round(coordinate, 3) + 0.0


def write_shape(shape: RodSolution, file: Path) -> None:
    """Write the shape as CSV: s_mm, x_mm, y_mm, theta_rad, kappa_per_mm, moment_N_mm.

    x and y are those of the material curve, theta and kappa those of the axis. Raises InputError when the file
    cannot be written.
    """
    columns = (shape.s, *shape.curve.T, shape.theta, shape.kappa, shape.moment)
    rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
    write_atomic(
        open_file(file), ("\n".join(["s_mm,x_mm,y_mm,theta_rad,kappa_per_mm,moment_N_mm", *rows]) + "\n").encode()
    )
