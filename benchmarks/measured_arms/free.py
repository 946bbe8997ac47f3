"""The direction of an arm's tip over pressure by the curvature of its cell, and what readings of another arm say of it.

A factor of all moduli only stretches the axis of the pressure: an arm f times as stiff has at f p the shape of the
other one at p.
"""

import math
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.stats import t as student

from benchmarks.measured_arms.arms import Arm
from fem.cell.inflation import AirPath
from fem.cell.piece import BendingPiece, PieceFailed
from geometry.arrays import Array
from geometry.centreline import chord_angle
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene

#: mm, height of the bottom of the tip over the material curve
BOTTOM = -0.25
#: relative deviations of the pressure of two arms: of gauges (2 %), and of walls that are off by 0.2 mm
OF_GAUGE, OF_WALLS = 0.02, 0.015
#: part of all readings that an interval holds
HELD = 0.9
#: 1/mm, as far as cells are followed
MOST_BENT = 0.07
#: mm, of a mesh on which a cell can be followed farther
COARSE = 4.0
#: kPa by which the steepest pressure is looked for
FINE = 0.05


def curvatures(arm: Arm, model: str, most: float, folder: Path) -> Array:
    """(k, 2) kPa and 1/mm of the cell without moment, from rest along its air up to `most` kPa.

    Where that way ends before, it goes on as on a mesh of COARSE. What was found is kept.
    """
    config = arm.config([most], model)
    kept = folder / f"{arm.name}_{config.hash[:12]}.csv"
    if kept.exists():
        return np.loadtxt(kept, delimiter=",")
    way = _followed(ArmPieces.of(Scene.meshed(config)).cell, most)
    if way[-1, 0] < most and way[-1, 1] > -MOST_BENT and limit_at(way[:, 0]) == len(way) - 1:
        way = prolonged(way, _followed(ArmPieces.of(Scene.meshed(config.with_mesh_size(COARSE))).cell, most))
    folder.mkdir(parents=True, exist_ok=True)
    np.savetxt(kept, way, fmt="%.8g", delimiter=",")
    return way


def _followed(cell: BendingPiece, most: float) -> Array:
    """(k, 2) kPa and 1/mm without moment, from rest along the air of a cell, as far as it goes or to `most` kPa."""
    way = list[tuple[float, float]]()
    with suppress(PieceFailed):  # the way is kept as far as it goes
        for point in AirPath.of(cell).points():
            way.append((1e3 * point.pressure, (point.state.angle + point.lack) / cell.body.length))
            if way[-1][0] > most or way[-1][1] < -MOST_BENT:
                break
    return np.array(way)


def prolonged(way: Array, other: Array) -> Array:
    """(n, 2) kPa and 1/mm: a way (k, 2) and what another one has beyond, its pressures times a factor where they meet.

    Both bend further and further to the negative side.
    """
    farther = other[other[:, 1] < way[-1, 1]]
    factor = way[-1, 0] / np.interp(-way[-1, 1], -other[:, 1], other[:, 0])
    return np.vstack([way, farther * (factor, 1.0)])


def direction(turn: float, arm: Arm, height: float = BOTTOM) -> float:
    """Degrees from the clamp to the tip; turn: rad, of the end; height: mm, of a point of it over the material curve.

    The chambers with half a wall on both sides have the curvature of the cell. The ends, half a wall long, are
    straight.
    """
    end, bent = 0.5 * arm.wall, arm.chambers * arm.pitch
    along, down = (np.sinc(turn / math.pi), 0.5 * turn * np.sinc(0.5 * turn / math.pi) ** 2)
    x = end + bent * along + end * math.cos(turn) + height * math.sin(turn)
    y = bent * down + end * math.sin(turn) - height * math.cos(turn)
    return math.degrees(chord_angle(x, y, 0.5 * turn))


def limit_at(pressures: Array) -> int:
    """Number of the first state after which the pressure falls; the last one where it never does."""
    falls = np.flatnonzero(np.diff(pressures) < 0.0)
    return int(falls[0]) if len(falls) else len(pressures) - 1


@dataclass(frozen=True, eq=False)  # arrays inside
class FreeArm:
    """The direction of the tip of an arm over pressure, less that at rest."""

    pressures: Array  #: (n,) kPa, rising
    degrees: Array  #: (n,) rising

    @classmethod
    def of(cls, arm: Arm, bends: Array, height: float = BOTTOM) -> "FreeArm":
        """An arm of cells whose curvatures are known, up to the first limit; bends (k, 2): kPa and 1/mm.

        height: as of `direction`.
        """
        bends = bends[: limit_at(bends[:, 0]) + 1]
        turns = -bends[:, 1] * arm.chambers * arm.pitch
        degrees = np.array([direction(turn, arm, height) for turn in turns])
        return cls(bends[:, 0], degrees - degrees[0])

    def at(self, pressures: Array, factor: float | Array = 1.0) -> Array:
        """(n,) degrees at pressures in kPa, of an arm that is so many times as stiff; NaN beyond the last curvature."""
        curve = PchipInterpolator(self.pressures, self.degrees, extrapolate=False)
        return np.asarray(curve(np.asarray(pressures, float) / factor))

    def factors(self, pressures: Array, degrees: Array) -> Array:
        """(n,) times as stiff as this one is an arm with these readings, by each of them."""
        pressure = PchipInterpolator(self.degrees, self.pressures, extrapolate=False)
        return np.asarray(pressures / pressure(degrees))

    @property
    def steepest(self) -> float:
        """kPa at which the angle rises most."""
        fine = np.arange(self.pressures[0], self.pressures[-1], FINE)
        return float(fine[np.argmax(np.gradient(self.at(fine), fine))])


@dataclass(frozen=True)
class Factor:
    """How stiff an arm is over its law, as its readings say: a mean and the deviation of one reading, of logarithms."""

    mean: float
    std: float
    count: int  #: of readings

    @classmethod
    def of(cls, factors: Array) -> "Factor":
        """From the factors by each reading, (n,)."""
        logs = np.log(factors)
        return cls(float(logs.mean()), float(logs.std(ddof=1)), len(logs))

    @property
    def value(self) -> float:
        """1"""
        return math.exp(self.mean)

    def off(self, *, another: bool) -> float:
        """Half the interval of one reading, of its logarithm.

        another: whether of another arm, with a gauge and walls of its own.
        """
        own = math.hypot(OF_GAUGE, OF_WALLS) if another else 0.0
        spread = math.hypot(self.std * math.sqrt(1.0 + 1.0 / self.count), own)
        return float(student.ppf(0.5 + 0.5 * HELD, self.count - 1)) * spread

    def intervals(self, law: FreeArm, pressures: Array, *, another: bool) -> Array:
        """(3, n) degrees: what the law has with this factor, and the ends of intervals of one reading each.

        another: as of `off`.
        """
        off = self.off(another=another)
        return np.array([law.at(pressures, math.exp(self.mean + change)) for change in (0.0, off, -off)])
