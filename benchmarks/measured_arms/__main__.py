"""Measured pneumatic arms beside their law: one is calibrated, and a longer one of the same cells predicted.

    make measured-arms
    python -m benchmarks.measured_arms [--only given] [--out results/measured_arms]

Laws are kept in the folder, so that the command repeats in minutes. It writes the tables of docs/measured_arms.md and
its pictures.
"""

import argparse
import sys
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from benchmarks.markdown import table, write_made
from benchmarks.measured_arms.arms import (
    GIVEN,
    LONGER,
    config_of,
    directions,
    law_of,
    second_test,
)
from benchmarks.measured_arms.foretold import Calibrated
from benchmarks.measured_arms.pictures import draw_foretold
from geometry.arrays import Array
from pipeline.answers.measured.predicted import Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.values.errors import InputError, RunFailed
from rod.arm_law.law import ArmLaw

#: kPa: rows of the calibration, and those of the tables
CALIBRATED = tuple(range(12, 37, 3))
ROWS = (15.0, 20.0, 25.0, 30.0, 33.0, 34.0, 35.0, 36.0, 37.0)
COMMAND = "python -m benchmarks.measured_arms --only {}"


def beside(rows: Measurements, intervals: Array, more: Mapping[float, float]) -> tuple[str, str]:
    """A table of some readings beside what was foretold of them, and how many of all are in their intervals."""
    measured, pressures = -Numbers.of(rows).values, Numbers.of(rows).pressures
    middle, *ends = -intervals
    low, high = np.minimum(*ends), np.maximum(*ends)
    inside = (measured >= low) & (measured <= high)
    lines = [
        [f"{p:g}", f"{m:.1f}", *([f"{more[p]:.1f}" if p in more else "-"] if more else []),
         f"{v:.1f}", f"{a:.1f} to {b:.1f}", "yes" if is_in else "no"]
        for p, m, v, a, b, is_in in zip(pressures, measured, middle, low, high, inside, strict=True) if p in ROWS
    ]  # fmt: skip
    heads = ["kPa", "measured", *(["second test"] if more else []), "predicted", "90 %", "inside"]
    return table(heads, lines), f"{int(inside.sum())} of {len(inside)} rows are within their intervals."


def near(rows: Measurements, intervals: Array) -> str:
    """How many rows of the angle above 15 kPa are within 15 % of it, or 1.5 kPa beside the curve that was foretold."""
    pressures, measured, foretold = Numbers.of(rows).pressures, -Numbers.of(rows).values, -intervals[0]
    at = [np.interp(pressures + shift, pressures, foretold) for shift in (-1.5, 1.5)]
    is_near = (np.abs(foretold / measured - 1.0) <= 0.15) | ((at[0] <= measured) & (measured <= at[1]))
    asked, off = pressures > 15.0, float(np.sqrt(np.mean((foretold - measured) ** 2)))
    count = f"{int(is_near[asked].sum())} of {int(asked.sum())} rows above 15 kPa"
    return f"{count} are within 15 % of the angle, or 1.5 kPa of the curve; root mean square {off:.1f}°."


class Page:
    """The parts of the page; what several of them need is computed once."""

    def __init__(self, out: Path) -> None:
        self.out = out

    @cached_property
    def own(self) -> ArmLaw:
        """The law of the given arm."""
        return law_of(GIVEN, self.out)

    @cached_property
    def calibrated(self) -> Calibrated:
        """It, calibrated to its own rows."""
        rows = directions(GIVEN, self.out, CALIBRATED)
        return Calibrated.to(self.own, config_of(GIVEN).record(), rows)

    def given(self) -> str:
        """The arm after its calibration: what was found, and its rows."""
        found, rows = self.calibrated, directions(GIVEN, self.out)
        estimates = table(["unknown", "before", "after"], found.told())
        intervals = found.same.intervals(rows)
        draw_foretold("measured_arms_given", rows, intervals, {})
        return "\n\n".join([estimates, *beside(rows, intervals, {}), near(rows, intervals)])

    def longer(self) -> str:
        """The arm with seven chambers, of whose rows nothing was fitted."""
        law, rows = replace(self.own, length=LONGER.length), directions(LONGER, self.out)
        foretold, second = self.calibrated.for_arm(law), second_test()
        intervals = foretold.intervals(rows)
        draw_foretold("measured_arms_longer", rows, intervals, second)
        return "\n\n".join([*beside(rows, intervals, second), near(rows, intervals)])


PARTS = ("given", "longer")


def main() -> None:
    """Write the parts of the page and their pictures, and print them."""
    parser = argparse.ArgumentParser(description="Measured pneumatic arms, after a calibration.")
    parser.add_argument("--only", choices=PARTS)
    parser.add_argument("--out", type=Path, default=Path("results/measured_arms"))
    given = parser.parse_args()
    page = Page(given.out)
    try:
        for part in [given.only] if given.only else PARTS:
            text = getattr(page, part)()
            write_made(COMMAND.format(part), text)
            sys.stdout.write(text + "\n\n")
    except (InputError, RunFailed) as failure:
        sys.exit(str(failure))


if __name__ == "__main__":
    main()
