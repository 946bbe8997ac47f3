"""The figures and the claims of the paper, reproduced from sweeps of finite elements.

    make paper-coarse        # runs the sweeps of configs/paper/coarse, and then the next line
    python -m benchmarks.paper results/paper_coarse

Reads the sweeps below the given folder and writes there estimates.csv, scan.csv, the figures, and the claims as
paper.md and paper.json. What was not reached is listed, and a figure or a claim whose sweep is missing is left out or
says so.
"""

import argparse
import csv
import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.paper.claims import claims
from benchmarks.paper.data import ARMS, Data
from benchmarks.paper.drawing import NotThere
from benchmarks.paper.estimates import COLUMNS, SCALES, Estimate, control, process, rows
from benchmarks.paper.figures import FIGURES
from benchmarks.paper.page import write_page
from benchmarks.paper.states import State
from rod import RodError

#: pressures of the scan of length scales, kPa
SCANNED = (17.0, 31.0)


def scan(states: Iterable[State]) -> list[Estimate]:
    """The process with every length scale, and the control, at two pressures."""
    estimates = []
    for state in states:
        if state.pressure in SCANNED:
            for scale in SCALES:
                try:
                    estimates.append(process(state, scale))
                except RodError:
                    continue
            estimates.append(control(state, process(state).single_alpha))
    return estimates


def write(path: Path, estimates: Sequence[Estimate]) -> None:
    """A CSV table."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(rows(estimates))


def draw(data: Data, folder: Path) -> list[tuple[str, str]]:
    """Draw the figures whose sweeps and states are there; file and title of each."""
    drawn = []
    for name, figure in FIGURES.items():
        file = f"{name}.{figure.suffix}"
        try:
            if sweeps := sorted(set(figure.needs) - set(data.sweeps)):
                raise NotThere(f"the sweeps {', '.join(sweeps)}")
            figure.draw(data).savefig(folder / file)
        except NotThere as missing:
            sys.stdout.write(f"not drawn: {name}, without {missing}\n")
        else:
            sys.stdout.write(f"written: {folder / file}\n")
            drawn.append((file, figure.title))
    return drawn


def provenance(data: Data) -> str:
    """How the results were made: commits, mesh, and seconds."""
    records = {
        name: json.loads((path / "sweep.json").read_text(encoding="utf-8")) for name, path in data.sweeps.items()
    }
    commits = sorted({_short(record["commit"]) for record in records.values()})
    seconds = sum(point["seconds"] or 0.0 for record in records.values() for point in record["points"])
    sizes = sorted(
        {f"{s.config['mesh']['size_mm']:g} mm" for e in data.estimates.values() for s in [x.state for x in e]}
    )
    designs = sum(len(record["points"]) for record in records.values())
    return (
        f"The numbers are those of commit {', '.join(commits)}, on meshes of {', '.join(sizes)}, from {len(records)} "
        f"sweeps with {designs} designs. Each on one core, with others at work, they took "
        f"{seconds / 60.0:.0f} minutes together."
    )


def _short(commit: str | None) -> str:
    """A commit of a record: nine digits, and the "+" behind it where files differed from it."""
    return "unknown" if commit is None else commit[:9] + "+" * commit.endswith("+")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="of the sweeps, such as results/paper_coarse")
    parser.add_argument("--no-figures", action="store_true", help="tables and claims alone")
    options = parser.parse_args()
    data = Data(options.folder)
    if not data.sweeps:
        sys.exit(f"{options.folder}: holds no sweeps; solve those of configs/paper first, as make paper-coarse does")
    for name, sentences in data.unreached().items():
        for sentence in sentences:
            sys.stdout.write(f"not reached in {name}: {sentence}\n")
    write(options.folder / "estimates.csv", [e for estimates in data.estimates.values() for e in estimates])
    write(options.folder / "scan.csv", scan(data.states("pneunet", "svk", ARMS[0])))
    drawn = [] if options.no_figures else draw(data, options.folder)
    write_page(options.folder, provenance(data), claims(data), data.unreached(), drawn)
    sys.stdout.write(f"written: {options.folder / 'paper.md'}\n")


if __name__ == "__main__":
    main()
