"""A segment under pressure: what is not known of it, and two calibrations on two of its pressures.

    make experiments
    python -m benchmarks.experiments.segment

The cell of the segment (`eth_segment`) is solved at rising pressures for several threads and walls. Between a plate and
its closed end the segment has the curvature of that cell; the law with its ends, which `make experiments` measures, has
its end within 4 % of there. Moduli times c bear c times the pressure, so that no curve is solved twice.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import cos, hypot, log, sin
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from benchmarks.experiments.eth_segment.draw import END, HERE, INNER_WALL, LENGTH, OUTER_WALL, PARTITION, PLATE, draw
from benchmarks.markdown import table, write_made
from fem.cell.piece import PieceFailed
from geometry.arrays import Array
from pipeline.config.load import load_config
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.values.pressure import in_MPa

#: kPa at which a cell is solved
PRESSURES = (*(2.0 * k for k in range(1, 13)), 27.0, 30.0, 33.5, 37.0, 40.0, 43.0, 46.0)
#: N/mm, EA over the pitch: that of the configuration, those that threads may have, and softer ones
GIVEN, POSSIBLE, SOFTER = 20.0, (10.0, 400.0), (0.3, 0.45, 0.7, 1.0, 1.5, 2.5, 5.0)
#: kPa of both calibrations, and those of the first table
CALIBRATED, SHOWN = (15.0, 35.0), (5.0, 10.0, 20.0, 30.0, 40.0)
#: the variant that was found after a look at the readings
THICK = f"- the same, outer wall {2.0 * OUTER_WALL} mm"
COMMAND = "python -m benchmarks.experiments.segment"


@dataclass(frozen=True)
class Curve:
    """The curvature of a cell over the pressure, as far as it bears one."""

    spline: CubicSpline  #: kPa -> 1/mm
    highest: float  #: kPa
    why: str  #: it ends there; empty at the last one that is asked

    def distance(self, pressure: float) -> float:
        """mm from the middle of the end at rest to where it is; NaN where the cell bears no such pressure."""
        if pressure > self.highest:
            return float("nan")
        kappa, long = float(self.spline(pressure)), LENGTH - END - PLATE
        turn = kappa * long
        x = PLATE + sin(turn) / kappa + END * cos(turn) - LENGTH
        return hypot(x, (1.0 - cos(turn)) / kappa + END * sin(turn))


def threads(stiffness: float, faces: str = "inner") -> str:
    """The setting for threads of so many N/mm."""
    return f"effects.hoops={{faces: {faces}, threads: {{EA: {stiffness} N, pitch: 1 mm}}}}"


def curve(*settings: str) -> Curve:
    """Of the cell of the segment with other settings."""
    cell = ArmPieces(load_config(HERE / "segment.yaml", list(settings)), None).cell
    pressures, kappas, why, state = [0.0], [0.0], "", cell.rest()
    for pressure in PRESSURES:
        try:
            state = cell_without_moment(cell, in_MPa(pressure), state).state
        except PieceFailed as failure:
            why = str(failure)
            break
        pressures.append(pressure)
        kappas.append(state.angle / cell.body.length)
    return Curve(CubicSpline(pressures, kappas), pressures[-1], why)


def variants() -> Iterator[tuple[str, Curve]]:
    """What is not known of the segment, with its curve; the first one is that of the configuration."""
    yield "loops about each chamber, 20 N/mm", curve(threads(GIVEN))
    for stiffness in POSSIBLE:
        yield f"- {stiffness:g} N/mm", curve(threads(stiffness))
    with TemporaryDirectory() as folder:
        thin, thick = (f"{folder}/{name}.brep" for name in ("thin", "thick"))
        draw(Path(thin), INNER_WALL)
        draw(Path(thick), PARTITION, 2.0 * OUTER_WALL)
        yield f"- walls between chambers {INNER_WALL} mm", curve(f"geometry.file={thin}")
        yield "- softer than threads, 2.5 N/mm", curve(threads(2.5))
        yield f"- outer wall {2.0 * OUTER_WALL} mm", curve(f"geometry.file={thick}")
        yield "loops about the arm, 20 N/mm", curve(threads(GIVEN, "outer"))
        yield THICK, curve(f"geometry.file={thick}", threads(GIVEN, "outer"))
    yield "no loops", curve("effects.hoops=off")


def fitted(of: Callable[[Array, float], float], measured: Mapping[float, float], start: tuple[float, ...]) -> Array:
    """The logarithms of the unknowns by which distances agree best with those measured at CALIBRATED.

    of: the unknowns and a pressure in kPa -> mm.
    """

    def off(unknowns: Array) -> list[float]:
        return [float(np.nan_to_num(log(of(unknowns, p) / measured[p]), nan=3.0)) for p in CALIBRATED]

    return np.asarray(least_squares(off, np.log(start), diff_step=1e-3).x)


@dataclass(frozen=True)
class BySoftness:
    """Curves by the stiffness of the threads, with moduli times c."""

    curves: Mapping[float, Curve]  #: by N/mm, rising

    def distance(self, unknowns: Array, pressure: float) -> float:
        """mm, of ln c and ln N/mm, at a pressure in kPa; NaN where a curve that is needed ends before."""
        c, at = np.exp(unknowns[0]), unknowns[1] - unknowns[0]
        known = [(log(s), d) for s, curve in self.curves.items() if np.isfinite(d := curve.distance(pressure / c))]
        if not known or at < known[0][0]:
            return float("nan")
        return float(CubicSpline(*zip(*known, strict=True))(min(at, known[-1][0]))) if len(known) > 1 else float("nan")


def read_measured() -> dict[float, float]:
    """mm, the distance of the middle of the end by pressure in kPa, from the comments of measured.csv."""
    lines = (HERE / "measured.csv").read_text(encoding="utf-8").splitlines()
    rows = (line[1:].split() for line in lines if line.startswith("#   "))
    return {float(row[0]): float(row[1]) for row in rows if row[0] != "kPa"}


def shown(distance: float) -> str:
    """A distance in mm; a dash where there is none."""
    return f"{distance:.1f}" if np.isfinite(distance) else "-"


def main() -> None:
    """Print both tables."""
    measured, known = read_measured(), dict(variants())
    drawn = next(iter(known.values()))
    rows = [[name, *(shown(c.distance(p)) for p in SHOWN), f"{c.highest:g}"] for name, c in known.items()]
    rows.append(["measured", *(shown(measured[p]) for p in SHOWN), "45"])
    heads = ["mm at", *(f"{p:g} kPa" for p in SHOWN), f"borne, of {PRESSURES[-1]:g} kPa"]
    possible = list(known.values())[:4]
    soft = BySoftness({s: curve(threads(s)) for s in (*SOFTER, GIVEN)})
    (stiffer,) = fitted(lambda u, p: drawn.distance(p / np.exp(u[0])), measured, (1.3,))
    (softer,) = fitted(lambda u, p: known[THICK].distance(p / np.exp(u[0])), measured, (0.95,))
    both = fitted(soft.distance, measured, (1.5, 0.8))
    lines = []
    for pressure, distance in measured.items():
        within = [curve.distance(pressure) for curve in possible]
        ones = [drawn.distance(pressure), drawn.distance(pressure / np.exp(stiffer)), soft.distance(both, pressure)]
        ones.append(known[THICK].distance(pressure / np.exp(softer)))
        cells = [f"{value:.1f} ({100.0 * (value / distance - 1.0):+.0f} %)" for value in ones]
        cells[0] += f", {min(within):.1f} to {max(within):.1f}"
        lines.append([f"{pressure:g}" + "*" * (pressure in CALIBRATED), f"{distance:.2f}", *cells])
    second = ["kPa", "measured, mm", "predicted, range", f"moduli times {np.exp(stiffer):.2f}"]
    second.append(f"moduli times {np.exp(both[0]):.2f}, threads {np.exp(both[1]):.2f} N/mm")
    second.append(f"outer wall and loops changed, moduli times {np.exp(softer):.2f}")
    text = f"{table(heads, rows)}\n\n{table(second, lines)}"
    write_made(COMMAND, text)
    sys.stdout.write(text + "\n")


if __name__ == "__main__":
    main()
