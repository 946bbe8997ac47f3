"""Half cells of arms (b) to (d) drawn at random: whether their rigidity falls with the pressure, and whether M over
kappa is one straight line. The paper prints no dimensions of these arms; this says how much hangs on our own.

    python -m benchmarks.paper.random_cells --seed 151 --count 200 --out results/paper

Designs are those of `benchmarks.unseen` of these families, on elements twice as large as the program would choose. Each
cell is followed at its pressure, or the largest part of it that it bears, and at half of that, from where it bears no
moment to beyond straight, as far as experiment III takes a cell. Rows are added to random_cells.csv in the folder;
those that are there are not solved again.
"""

import argparse
import csv
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from benchmarks.unseen.designs import Drawn, drawn, three_digits
from fem.cell.piece import BendingPiece, PieceFailed
from fem.cell.response import slopes
from fem.equations.linear import SingularMatrix
from geometry.arrays import Array
from pipeline.config.load import load_config
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.law.piece.reach import LEAST_TURN, MARGIN
from pipeline.values.errors import InputError
from pipeline.values.pressure import in_MPa

FILE = "random_cells.csv"
FAMILIES = ("semicircular", "semicircular_single", "bisected_circle")
#: sizes of elements over those that the program chooses, the lower pressure over the higher one, and parts of the way
#: that are solved
LARGER, LOWER, WAY = 2.0, 0.5, (0.0, 0.5, 1.0)
#: parts of the highest pressure of a design, of which the first one is taken that its cell bears
PARTS = (1.0, 0.75, 0.5, 0.35)


@dataclass(frozen=True)
class RandomCell:
    """A cell at a higher pressure and at half of it; nan where it bears none, or not all of the way."""

    seed: int
    number: int
    family: str
    law: str
    pressure_kPa: float  #: the higher one
    turn: float = float("nan")  #: kappa_0 l there, rad
    rigidity_low: float = float("nan")  #: N mm2, the slope of the line through M over kappa
    rigidity_high: float = float("nan")
    off_line: float = float("nan")  #: of M over kappa at the higher pressure, over the largest moment
    reason: str = ""  #: why it was not solved, at all or at the highest pressure of its design

    @property
    def is_solved(self) -> bool:
        """Whether it is at both pressures."""
        return bool(np.isfinite([self.rigidity_low, self.rigidity_high]).all())


def measure(design: Drawn, folder: Path) -> RandomCell:
    """A drawn design."""
    path = folder / "drawn.yaml"
    path.write_text(json.dumps(design.document), encoding="utf-8")
    high, why = design.pressures_kPa[-1], ""
    try:
        config = load_config(path)
        cell = ArmPieces(config.with_mesh_size(three_digits(LARGER * config.mesh.size_mm)), None).cell
    except (InputError, NoArmLaw) as failure:
        return RandomCell(design.seed, design.number, design.family, design.law, high, reason=_first_line(failure))
    for part in PARTS:
        try:
            laws = [law_of(cell, of * part * high, config.design.length) for of in (LOWER, 1.0)]
        except (PieceFailed, SingularMatrix) as failure:
            why = why or _first_line(failure)
            continue
        (low_slope, _), (slope, off) = (line_through(*law) for law in laws)
        turn = float(laws[1][0][0]) * config.design.length
        head = design.seed, design.number, design.family, design.law
        return RandomCell(*head, part * high, turn, low_slope, slope, off, why)
    return RandomCell(design.seed, design.number, design.family, design.law, high, reason=why)


def _first_line(failure: Exception) -> str:
    return str(failure).splitlines()[0]


def law_of(cell: BendingPiece, pressure_kPa: float, length: float) -> tuple[Array, Array]:
    """kappa (1/mm) and M (N mm) of a cell from the state without moment to beyond the straight one: (n,) each, by the
    cubics through the solved states. Raises `PieceFailed` and `SingularMatrix`."""
    h = cell.body.length
    state = cell_without_moment(cell, in_MPa(pressure_kPa)).state
    first = state.angle
    turn = -np.copysign(MARGIN * max(abs(first), LEAST_TURN * h / length), first)
    angles, moments, rates = [], [], []
    for part in WAY:
        state = cell.solve(state.pressure, first + part * turn, state)
        angles.append(state.angle)
        moments.append(state.moment)
        rates.append(slopes(cell, state).moment_by_angle)
    order = np.argsort(angles)
    law = CubicHermiteSpline(*(np.array(values)[order] for values in (angles, moments, rates)))
    at = first + turn * np.linspace(0.0, 1.0, 21)
    return at / h, np.asarray(law(at))


def line_through(kappa: Array, moment: Array) -> tuple[float, float]:
    """The slope of the least-squares line, N mm2, and how far the points are off it over the largest moment."""
    slope, at_zero = np.polyfit(kappa, moment, 1)
    return float(slope), float(np.abs(slope * kappa + at_zero - moment).max() / np.abs(moment).max())


def read(folder: Path) -> list[RandomCell]:
    """Those in a folder; none without the file."""
    if not (path := folder / FILE).is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return [
            RandomCell(**{f.name: _typed(f.type, row[f.name]) for f in fields(RandomCell)})
            for row in csv.DictReader(file)
        ]


def write(path: Path, cells: Sequence[RandomCell]) -> None:
    """Add rows to a file, which begins with the names of the columns."""
    is_new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if is_new:
            writer.writerow([field.name for field in fields(RandomCell)])
        writer.writerows(map(astuple, cells))


def _typed(kind: object, text: str) -> Any:
    read: Callable[[str], Any] = int if kind is int else float if kind is float else str
    return read(text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=151)
    parser.add_argument("--count", type=int, default=200, help="cells")
    parser.add_argument("--out", type=Path, default=Path("results/paper"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    known = {(cell.seed, cell.number) for cell in read(given.out)}
    designs = islice((d for d in drawn(given.seed, 2 * given.count) if d.family in FAMILIES), given.count)
    with TemporaryDirectory() as folder:
        for design in designs:
            if (design.seed, design.number) in known:
                continue
            begin = process_time()
            cell = measure(design, Path(folder))
            write(given.out / FILE, [cell])
            sys.stdout.write(f"{cell.number} {cell.family} {cell.law}, {process_time() - begin:.1f} s: {cell.reason}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
