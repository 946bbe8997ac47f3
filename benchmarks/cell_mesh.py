"""Mesh convergence of the law of a cell: elements, gradings and sizes.

    OMP_NUM_THREADS=1 python benchmarks/cell_mesh.py RESULTS

Renews the tables of docs/cell.md under "Mesh convergence of the law"; finished meshes in RESULTS are kept until the
program changes. A quarter of an hour on an idle core.
"""

import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from math import ceil
from pathlib import Path
from time import process_time

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

import fem  # noqa: E402
from benchmarks.arguments import parser_of  # noqa: E402
from benchmarks.cell import ARMS, RUBBER, Arm, renew, report, table_of  # noqa: E402
from benchmarks.sources import key_of  # noqa: E402
from fem.cell.piece import BendingPiece, PieceFailed  # noqa: E402
from geometry import GRADINGS, PneuNet  # noqa: E402
from pipeline.cell.measure import cell_without_moment  # noqa: E402
from pipeline.identification.richardson import extrapolated  # noqa: E402
from pipeline.study import JsonFiles, Study  # noqa: E402


@dataclass(frozen=True)
class Series:
    """Meshes of one arm at one pressure with one kind of elements."""

    name: str  #: of the table
    arm: Arm
    pressure: float  #: kPa
    formulation: str
    grading: str
    sizes: tuple[float, ...]  #: mm, falling
    reference: str = ""  #: name of the series to whose finest mesh or limit errors refer; empty for its own
    extrapolate: bool = False  #: errors refer to the limit of the finest meshes


@dataclass(frozen=True)
class OnMesh:
    """The cell on one mesh."""

    unknowns: int
    kappa_0: float  #: 1/mm
    straight: float  #: N mm, moment that straightens the cell
    seconds: float  #: processor time of all states, mesh included

    @property
    def rigidity(self) -> float:
        """Secant between the two states, N mm2."""
        return -self.straight / self.kappa_0


#: orders of the error: 1.09 at edges with 270 degrees of material, where stresses grow as r^(0.545 - 1)
ORDERS = (1.0, 2.0)
#: finest meshes from which a limit is extrapolated
FINEST = 4
#: fine meshes bear no larger step of the pressure, kPa
STEP = 16.0
A, B = ARMS[0], ARMS[1]
ROUNDED = replace(A, design=PneuNet(fillet=0.5))
#: of the same E and nu as the St. Venant-Kirchhoff one
NEO_HOOKEAN = replace(A, material=fem.NeoHooke.from_uniaxial({"mu": RUBBER.shear_modulus}, RUBBER.nu))
SERIES = (
    Series("mesh pneunet", A, 31.0, "p2p0", "off", (3.5, 2.5, 1.8, 1.3, 1.0, 0.75, 0.5)),
    Series("mesh pneunet mixed", A, 31.0, "mixed", "walls", (3.5, 2.5, 1.8, 1.3, 1.0, 0.75)),
    Series("mesh pneunet fillet", ROUNDED, 24.0, "mixed", "walls", (3.5, 2.5, 1.8, 1.3, 1.0, 0.75), extrapolate=True),
    Series("mesh pneunet fillet p2p0", ROUNDED, 24.0, "p2p0", "off", (3.5, 2.5, 1.8, 1.3), "mesh pneunet fillet"),
    Series("mesh pneunet neo-Hookean", NEO_HOOKEAN, 31.0, "mixed", "walls", (3.5, 2.5, 1.8, 1.3), extrapolate=True),
    Series("mesh pneunet neo-Hookean p2p0", NEO_HOOKEAN, 31.0, "p2p0", "off", (3.5, 2.5), "mesh pneunet neo-Hookean"),
    Series("mesh semicircular", B, 37.0, "p2p0", "off", (4.0, 2.5, 1.8, 1.3, 1.0, 0.75, 0.5)),
    Series("mesh semicircular mixed", B, 37.0, "mixed", "walls", (4.0, 2.5, 1.8, 1.3, 1.0, 0.75, 0.5)),
)


def measured(series: Series, size: float, folder: Path) -> OnMesh | str:
    """One mesh, or why it has no such state; kept in the folder until series or program change."""
    files: JsonFiles[tuple[Series, float], OnMesh | str] = JsonFiles(
        lambda _: folder / f"{series.name.replace(' ', '_')}_{size:g}mm.json",
        lambda case: key_of(str(case), "benchmarks/cell_mesh.py", "benchmarks/cell.py"),
        lambda mesh: {"failure": mesh} if isinstance(mesh, str) else asdict(mesh),
        lambda content: str(content["failure"]) if "failure" in content else OnMesh(**content),
    )
    return next(Study([(series, size)], _solved, files).run())[1]


def _solved(case: tuple[Series, float]) -> OnMesh | str:
    series, size = case
    begin = process_time()
    body = series.arm.design.half_cell(size, GRADINGS[series.grading])
    piece = BendingPiece(body, series.arm.material, "mirror", series.formulation, dhat=series.arm.dhat)
    mesh: OnMesh | str
    try:
        middle, steps = cell_without_moment(piece, 0.0), ceil(series.pressure / STEP)
        for step in range(steps):
            pressure = series.pressure / 1000.0 * (step + 1) / steps
            middle = cell_without_moment(piece, pressure, middle.state)
        straight = piece.solve(middle.state.pressure, 0.0, middle.state)
        seconds = process_time() - begin
        mesh = OnMesh(piece.system.size, middle.state.angle / body.length, straight.moment, seconds)
    except PieceFailed as failure:
        mesh = str(failure)
    report(f"{series.name}, {size:g} mm: {mesh}")
    return mesh


def limit_of(series: Series, folder: Path) -> tuple[list[float], list[float]]:
    """kappa_0 (1/mm), moment (N mm) and rigidity (N mm2) that errors refer to, and their standard deviations."""
    meshes = {size: mesh for size in series.sizes if isinstance(mesh := measured(series, size, folder), OnMesh)}
    values = {size: (mesh.kappa_0, mesh.straight, mesh.rigidity) for size, mesh in meshes.items()}
    if not series.extrapolate:
        return list(values[min(values)]), [0.0] * 3
    finest = sorted(values)[:FINEST]
    limits = [extrapolated(finest, [values[size][k] for size in finest], ORDERS) for k in range(3)]
    return [limit.limit for limit in limits], [limit.limit_std for limit in limits]


def table(series: Series, folder: Path) -> str:
    """All meshes, with the errors against the finest that has a solution or the limit, of this series or another."""
    of = next((other for other in SERIES if other.name == series.reference), series)
    limit, deviations = limit_of(of, folder)
    digits, scale = (3, 3, 1), (1000.0, 1.0, 1.0)
    lines: list[Sequence[str]] = []
    for size in series.sizes:
        mesh = measured(series, size, folder)
        if isinstance(mesh, str):
            lines.append([f"{size:g} mm", *["-"] * 8])
            continue
        entries = []
        for value, last, d, unit in zip(
            (mesh.kappa_0, mesh.straight, mesh.rigidity), limit, digits, scale, strict=True
        ):
            entries += [f"{unit * value:.{d}f}", f"{100 * (value / last - 1):+.2f}"]
        lines.append([f"{size:g} mm", str(mesh.unknowns), *entries, f"{mesh.seconds:.1f}"])
    if series.extrapolate:
        entries = []
        for last, deviation, d, unit in zip(limit, deviations, digits, scale, strict=True):
            entries += [f"{unit * last:.{d}f}", f"± {100 * deviation / abs(last):.2f}"]
        lines.append(["limit", "", *entries, ""])
    quantities = ("κ₀, 1/m", "M straight, N mm", "M straight / κ₀, N mm²")
    return table_of(lines, ["mesh", "unknowns", *(c for q in quantities for c in (q, "%")), "seconds"])


def main() -> None:
    """All tables."""
    parser = parser_of(__doc__)
    parser.add_argument("results", type=Path)
    folder = parser.parse_args().results
    for series in SERIES:
        renew(series.name, table(series, folder))


if __name__ == "__main__":
    main()
