"""Measured bodies: the error before a calibration, and after it on the rows that it has not seen.

    make experiments
    python -m benchmarks.experiments [--only NAME] [--cases FOLDER] [--out results/experiments] [--jobs 1]

A case is a folder with case.yaml and measured.csv; docs/experiments.md says how to add one.
"""

import argparse
import math
import sys
from pathlib import Path

from benchmarks.experiments.cases import cases_in
from benchmarks.experiments.judged import Line, lines_of
from benchmarks.markdown import table, write_made
from pipeline.values.errors import InputError, RunFailed

HEADS = ("case", "model", "calibrated on rows", "moduli times", "other rows", "error before", "after", "in 90 %")


def cells(line: Line) -> list[str]:
    """A line of the table."""
    rows = ", ".join(map(str, line.rows)) or "none"
    inside = "-" if math.isnan(line.inside) else f"{100.0 * line.inside:.0f} %"
    return [line.case, line.model, rows, f"{line.factor:.3g}", str(line.count), line.before, line.after, inside]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Measured bodies, before and after a calibration.")
    parser.add_argument("--only", help="name of a case")
    parser.add_argument("--cases", type=Path, default=Path(__file__).parent, help="folder with the folders of cases")
    parser.add_argument("--out", type=Path, default=Path("results/experiments"))
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    rows = []
    try:
        for case in cases_in(given.cases):
            if given.only in (None, case.name):
                rows += [cells(line) for line in lines_of(case, given.out / case.name, given.jobs)]
    except (InputError, RunFailed) as failure:
        sys.exit(str(failure))
    if given.only is None and given.cases == Path(__file__).parent:
        write_made("make experiments", table(HEADS, rows))
    sys.stdout.write(table(HEADS, rows) + "\n")


if __name__ == "__main__":
    main()
