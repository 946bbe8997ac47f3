"""Mesh convergence of the law of a cell: elements, gradings and sizes.

    OMP_NUM_THREADS=1 python benchmarks/cell_mesh.py RESULTS

Renews the tables of docs/cell.md under "Mesh convergence of the law"; finished meshes in RESULTS are kept. Ten minutes
on an idle core.
"""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.cell import ARMS, Arm, renew, report, table_of  # noqa: E402
from fem.cell.piece import BendingPiece, PieceFailed  # noqa: E402
from geometry import GRADINGS  # noqa: E402
from pipeline.cell.measure import cell_without_moment  # noqa: E402


@dataclass(frozen=True)
class Series:
    """Meshes of one arm at one pressure with one kind of elements."""

    name: str  #: of the table
    arm: Arm
    pressure: float  #: kPa
    formulation: str
    grading: str
    sizes: tuple[float, ...]  #: mm, falling


@dataclass(frozen=True)
class OnMesh:
    """The cell on one mesh."""

    unknowns: int
    kappa_0: float  #: 1/mm
    straight: float  #: N mm, moment that straightens the cell
    seconds: float  #: wall time of both states, mesh included

    @property
    def rigidity(self) -> float:
        """Secant between the two states, N mm2."""
        return -self.straight / self.kappa_0


A, B = ARMS[0], ARMS[1]
SERIES = (
    Series("mesh pneunet", A, 31.0, "p2p0", "off", (3.5, 2.5, 1.8, 1.3, 1.0, 0.75, 0.5)),
    Series("mesh pneunet mixed", A, 31.0, "mixed", "walls", (3.5, 2.5, 1.8, 1.3, 1.0, 0.75)),
    Series("mesh semicircular", B, 37.0, "p2p0", "off", (4.0, 2.5, 1.8, 1.3, 1.0, 0.75, 0.5)),
    Series("mesh semicircular mixed", B, 37.0, "mixed", "walls", (4.0, 2.5, 1.8, 1.3, 1.0, 0.75, 0.5)),
)


def measured(series: Series, size: float, folder: Path) -> OnMesh | str:
    """One mesh, or why it has no such state; kept in the folder."""
    file = folder / f"{series.name.replace(' ', '_')}_{size:g}mm.json"
    if not file.is_file():
        begin = perf_counter()
        body = series.arm.design.half_cell(size, GRADINGS[series.grading])
        piece = BendingPiece(body, series.arm.material, "mirror", series.formulation, dhat=series.arm.dhat)
        try:
            half = cell_without_moment(
                piece, series.pressure / 2000.0
            )  # fine meshes bear no larger step of the pressure
            middle = cell_without_moment(piece, series.pressure / 1000.0, half.state)
            straight = piece.solve(middle.state.pressure, 0.0, middle.state)
            seconds = perf_counter() - begin
            found = OnMesh(piece.system.size, middle.state.angle / body.length, straight.moment, seconds)
            content = asdict(found)
        except PieceFailed as failure:
            content = {"failure": str(failure)}
        report(f"{series.name}, {size:g} mm: {content}")
        file.write_text(json.dumps(content), encoding="utf-8")
    content = json.loads(file.read_text(encoding="utf-8"))
    return str(content["failure"]) if "failure" in content else OnMesh(**content)


def table(series: Series, folder: Path) -> str:
    """All meshes, with the errors against the finest that has a solution."""
    rows = [(size, measured(series, size, folder)) for size in series.sizes]
    solved = [found for _, found in rows if isinstance(found, OnMesh)]
    lines: list[Sequence[str]] = []
    for size, found in rows:
        if isinstance(found, str):
            lines.append([f"{size:g} mm", *["-"] * 8])
            continue
        pairs = [
            (1000.0 * found.kappa_0, 1000.0 * solved[-1].kappa_0, 3),
            (found.straight, solved[-1].straight, 3),
            (found.rigidity, solved[-1].rigidity, 1),
        ]
        entries = [
            entry for value, last, d in pairs for entry in (f"{value:.{d}f}", f"{100 * (value / last - 1):+.2f}")
        ]
        lines.append([f"{size:g} mm", str(found.unknowns), *entries, f"{found.seconds:.1f}"])
    quantities = ("kappa_0, 1/m", "M straight, N mm", "M straight / kappa_0, N mm2")
    return table_of(lines, ["mesh", "unknowns", *(c for q in quantities for c in (q, "%")), "seconds"])


def main(folder: Path) -> None:
    """All tables."""
    folder.mkdir(parents=True, exist_ok=True)
    for series in SERIES:
        renew(series.name, table(series, folder))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
