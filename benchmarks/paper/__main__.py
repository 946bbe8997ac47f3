"""The figures of the paper again from sweeps of finite elements, by the estimators that its reader would use.

    make paper-coarse        # or, after the sweeps of configs/paper: python -m benchmarks.paper results/paper_coarse

Reads the sweeps below the given folder and writes there estimates.csv, scan.csv and the figures as SVG. What was not
reached is listed, and a figure whose sweep is missing is left out.
"""

import csv
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.paper.estimates import COLUMNS, SCALES, Estimate, control, estimates_of, process, rows
from benchmarks.paper.figures import FIGURES
from benchmarks.paper.states import State, states_of, unreached
from rod import RodError

#: pressures of the scan of length scales, kPa
SCANNED = (17.0, 31.0)


def scan(states: Iterable[State]) -> list[Estimate]:
    """The process with every length scale, and the control, for the pneu-net of 11 chambers at two pressures."""
    found = []
    for state in states:
        if state.family == "pneunet" and state.config["geometry"]["chambers"] == 11 and state.pressure in SCANNED:
            for scale in SCALES:
                try:
                    found.append(process(state, scale))
                except RodError:
                    continue
            found.append(control(state, process(state).single_alpha))
    return found


def write(path: Path, estimates: Sequence[Estimate]) -> None:
    """A CSV table."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(rows(estimates))


def main(folder: Path) -> None:
    """Write the tables and the figures of the sweeps in a folder."""
    sweeps = {path.parent.name: path.parent for path in sorted(folder.glob("*/sweep.json"))}
    if not sweeps:
        sys.exit(f"{folder}: holds no sweeps; solve those of configs/paper first, as make paper-coarse does")
    for name, sweep in sweeps.items():
        for sentence in unreached(sweep):
            sys.stdout.write(f"not reached in {name}: {sentence}\n")
    estimates = {name: [e for s in states_of(sweep) for e in estimates_of(s)] for name, sweep in sweeps.items()}
    write(folder / "estimates.csv", [e for found in estimates.values() for e in found])
    if "pneunet" in sweeps:
        write(folder / "scan.csv", scan(s for s in states_of(sweeps["pneunet"]) if s.law == "svk"))
    for name, (needed, draw) in FIGURES.items():
        if set(needed) <= set(estimates):
            draw(*(estimates[sweep] for sweep in needed)).savefig(folder / f"{name}.svg")
            sys.stdout.write(f"written: {folder / name}.svg\n")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("give the folder of the sweeps: python -m benchmarks.paper results/paper_coarse")
    main(Path(sys.argv[1]))
