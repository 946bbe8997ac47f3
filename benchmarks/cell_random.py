"""The arm's own law on designs drawn at random, against finite elements of the whole arm.

    python benchmarks/cell_random.py RESULTS [COUNT]

Draws designs of all families with cells and all laws, solves pieces at two pressures and the whole arm at these and one
between, and renews the table of docs/cell.md. Finished solutions of whole arms in RESULTS are kept. Half a minute to a
minute a design with two threads.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

import fem  # noqa: E402
from benchmarks.cell import (  # noqa: E402
    Arm,
    Case,
    Comparison,
    Pieces,
    Results,
    compare,
    percent,
    renew,
    report,
    table_of,
)
from fem.cell.piece import PieceFailed  # noqa: E402
from fem.materials.material import Material  # noqa: E402
from geometry import BisectedCircle, PneuNet, Semicircular, SemicircularSingle  # noqa: E402
from geometry.design import Design, DesignError  # noqa: E402
from rod import RodError  # noqa: E402

COUNT, SEED = 20, 15
#: what counts as right: shape over the length, error of the force over the force, or over that which moves the end of a
#: straight arm by a tenth of its length where this is larger
SHAPE, FORCE = 0.01, 0.03
#: MPa, of all laws at small strain
MODULUS = 1.2


def draw(rng: np.random.Generator, number: int) -> Arm:
    """A design, a law and a pressure; families and laws take turns."""

    def between(low: float, high: float) -> float:
        return round(float(rng.uniform(low, high)), 2)

    family = number % 4
    design: Design
    if family == 0:
        design = PneuNet(
            chambers=int(rng.integers(7, 13)),
            width=between(12, 18),
            chamber_length=between(6, 10),
            gap=between(1.5, 3),
            chamber_height=between(9, 14),
            wall=between(0.9, 1.5),
            roof=between(1.5, 2.5),
        )
        size, half_cells, pressure = 4.0, 1, between(15, 35)
    elif family == 1:
        design = Semicircular(
            chambers=int(rng.integers(7, 12)),
            radius=between(6, 9),
            chamber_length=between(6, 10),
            partition=between(1.5, 3),
            wall=between(0.9, 1.5),
        )
        size, half_cells, pressure = 4.5, 3, between(25, 50)
    else:
        kind = SemicircularSingle if family == 2 else BisectedCircle
        design = kind(length=between(90, 130), radius=between(6, 8), wall=between(0.9, 1.4))
        size, half_cells, pressure = 4.5, 5, between(25, 50)
    laws: list[Material] = [
        fem.StVenantKirchhoff(MODULUS, 0.495),
        fem.NeoHooke.from_uniaxial({"mu": MODULUS / 3}, 0.495),
        fem.Hencky(MODULUS, 0.49),
        fem.Yeoh.from_uniaxial({"c10": MODULUS / 6, "c20": 0.01, "c30": 0.0}, 0.495),
        fem.MooneyRivlin.from_uniaxial({"c10": MODULUS / 8, "c01": MODULUS / 24}, 0.495),
    ]
    dhat = 0.04 if family == 0 else None
    pressures = (round(pressure / 2, 2), pressure)
    return Arm(
        f"random {SEED} {number}",
        design,
        size,
        half_cells,
        pressures,
        round(0.75 * pressure, 2),
        dhat,
        laws[number % 5],
    )


def run(arm: Arm, results: Results) -> list[str]:
    """The row of a design."""
    design, words = (
        arm.design,
        [f"{type(arm.design).__name__}, {type(arm.material).__name__}, {arm.pressures[-1]:g} kPa"],
    )
    try:
        law = Pieces(arm, math.inf).law
        section = law.at(arm.pressures[0]).section
        rigidity = 1.0 / float(np.interp(0.0, section.moment, section.kappa_slope))
        force = float(f"{0.5 * rigidity / design.length**2:.2g}")
    except (PieceFailed, RodError, DesignError) as failure:
        report(f"{arm.name}: {failure}")
        return [*words, "no law", "", "", "", ""]
    cases = (
        Case("II", "II"),
        Case("III", "III"),
        Case("end", "III", round(0.1 * design.length, 1)),
        Case("dead", "dead", force=(0.0, force)),
    )
    rows: list[Comparison] = []
    for case in cases:
        for pressure, whole in results.whole(arm, case).items():
            row = compare(law, design.length, design.curve_y, case, pressure, whole)
            if row.force is not None:  # where the arm hardly bends, the force that holds its end is next to nothing
                scale = max(1.0, 0.3 * rigidity / design.length**2 / abs(float(whole.force[1])))
                row = replace(row, force=row.force / scale)
            rows.append(row)
            report(f"{arm.name}: {rows[-1]}")
    turn = math.degrees(law.at(arm.pressures[-1]).section.kappa_0 * design.length)
    sample = [row for row in rows if row.pressure in arm.pressures and row.case in ("II", "III")]
    between = [row for row in rows if row.pressure == arm.between and row.case in ("II", "III")]
    others = [[row for row in rows if row.case == name] for name in ("end", "dead")]
    is_right = all(_right(row) for row in rows)
    return [
        *words,
        f"{turn:.0f}",
        *(_largest(part) for part in (sample, between, *others)),
        "yes" if is_right else "no",
    ]


def _right(row: Comparison) -> bool:
    return not row.refusal and row.shape < SHAPE and abs(row.force or 0.0) < FORCE


def _largest(rows: Sequence[Comparison]) -> str:
    """Largest shape and force errors."""
    if not rows:
        return "-"
    if any(row.refusal for row in rows):
        return "refused"
    forces = [abs(row.force) for row in rows if row.force is not None]
    return percent(max(row.shape for row in rows)) + (f", {percent(max(forces))}" if forces else "")


COLUMNS = ("design", "turn, degrees", "II, III", "pressure between", "end 10 % of l elsewhere", "dead force", "right")


def main(folder: Path, count: int) -> None:
    """The table, renewed after every design."""
    results, rng, rows = Results(folder), np.random.default_rng(SEED), []
    for number in range(count):
        arm = draw(rng, number)
        rows.append(run(arm, results))
        right = sum(row[-1] == "yes" for row in rows)
        sentence = f"{right} of {len(rows)} designs (seed {SEED}) are right in all loads."
        renew("random", f"{sentence}\n\n{table_of(rows, COLUMNS)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else COUNT)
