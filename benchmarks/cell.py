"""The arm's own law from a cell and two ends, held against finite elements of whole arms on the same kind of mesh.

    python benchmarks/cell.py RESULTS

Renews the tables of docs/cell.md between their marks; finished solutions of whole arms in RESULTS are kept until the
program changes. About ten minutes with two threads.
"""

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

import fem  # noqa: E402
from benchmarks.arguments import parser_of  # noqa: E402
from benchmarks.sources import key_of, written_with  # noqa: E402
from fem.cell.piece import BendingPiece  # noqa: E402
from fem.cell.response import slopes  # noqa: E402
from fem.materials.material import Material  # noqa: E402
from geometry import GRADINGS, BisectedCircle, PneuNet, Semicircular, SemicircularSingle  # noqa: E402
from geometry.arrays import Array  # noqa: E402
from geometry.design import Design  # noqa: E402
from pipeline.cell.measure import cell_without_moment, sweep_cell  # noqa: E402
from pipeline.cell.measure_clamp import clamp_curve  # noqa: E402
from pipeline.cell.measure_tip import tip_curve  # noqa: E402
from pipeline.cell.reach import Reach  # noqa: E402
from pipeline.study import JsonFiles, Study  # noqa: E402
from rod import RodError, RodSolution  # noqa: E402
from rod.arm_law.law import ArmLaw, LawRod  # noqa: E402

DOCS = HERE / "docs" / "cell.md"
RUBBER = fem.StVenantKirchhoff(E=1.2, nu=0.495)
#: N, for which the laws are made, on the end of the arm
FORCE = 0.06
#: mm, largest displacement of the end for which they are made
END_Y = 20.0
#: times EI / l^2: the force that moves the end of the straight arm by a tenth of its length
SMALL = 0.3


@dataclass(frozen=True)
class Arm:
    """An arm, its mesh, and the pressures of its law."""

    name: str
    design: Design
    size: float  #: mm, of the mesh
    half_cells: int  #: in each end piece
    pressures: tuple[float, ...]  #: kPa, at which pieces and whole arm are solved
    between: float | None  #: kPa, at which the whole arm alone is solved
    dhat: float | None = None  #: activation distance of contact, mm
    material: Material = RUBBER

    @property
    def all_pressures(self) -> list[float]:
        """Ascending, at which the whole arm is solved, kPa."""
        return sorted({*self.pressures, *([] if self.between is None else [self.between])})


@dataclass(frozen=True)
class Case:
    """A load of the whole arm besides its pressure."""

    name: str
    experiment: str
    end_y: float = 0.0  #: mm, in III
    force: tuple[float, float] = (0.0, 0.0)  #: N, of a dead force

    def solve(self, rod: LawRod) -> RodSolution:
        """The rod under this load; raises `RodError`."""
        return rod.solve(end_y=self.end_y) if self.experiment == "III" else rod.solve(self.force)


ARMS = (
    Arm("pneunet", PneuNet(), 3.5, 1, (5.0, 17.0, 31.0, 45.0), 24.0, 0.04),
    Arm("semicircular", Semicircular(), 4.0, 3, (20.0, 37.0), 28.0),
    Arm("semicircular_single", SemicircularSingle(), 4.0, 3, (20.0, 37.0), 28.0),
    Arm("bisected_circle", BisectedCircle(), 4.0, 5, (20.0, 37.0), 28.0),
)
CASES = (
    Case("II", "II"),
    Case("III", "III"),
    Case("end at +10 mm", "III", 10.0),
    Case("end at -10 mm", "III", -10.0),
    Case("end at +20 mm", "III", 20.0),
    Case("end at -20 mm", "III", -20.0),
    Case("dead force +0.05 N", "dead", force=(0.0, 0.05)),
    Case("dead force -0.05 N", "dead", force=(0.0, -0.05)),
)
#: of which the arms of other lengths are solved
LENGTH_CASES = (CASES[0], CASES[1], CASES[5], CASES[6])


@dataclass(frozen=True, eq=False)  # arrays inside
class WholeArm:
    """What finite elements of the whole arm gave at one pressure."""

    s: Array  #: (n,) rest positions along the material curve, mm
    points: Array  #: (n, 2) of the material curve, mm
    force: Array  #: (2,) on the end, N
    couple: float  #: of that force about the end of the curve, N mm
    planes: Array  #: (k, 2) planes between cells: rest position in mm, rotation in rad

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> "WholeArm":
        """From the numbers of a file."""
        s, points, force, planes = (np.array(record[name]) for name in ("s", "points", "force", "planes"))
        return cls(s, points, force, float(record["couple"]), planes)


@dataclass(frozen=True)
class Cost:
    """What a part of the work took."""

    seconds: float
    factorization: float  #: of them, in the numeric factorization
    factorizations: int


def effects_of(arm: Arm, pressure: float) -> list[fem.Effect]:
    """Of the whole arm."""
    contact = [] if arm.dhat is None else [fem.SelfContact("gap", arm.dhat, starts_inactive=False)]
    return [fem.Pressure("cavity", pressure / 1000.0), *contact]


def solve_whole(arm: Arm, case: Case, pressures: Sequence[float]) -> tuple[dict[float, WholeArm], Cost]:
    """The whole arm at rising pressures, as far as the path goes."""
    begin = perf_counter()
    body = arm.design.body(arm.size)
    experiment = fem.Experiment.of(case.experiment, body, case.end_y, case.force)
    model = experiment.model(arm.material, effects_of(arm, pressures[-1]), "p2p0")
    try:
        solution = fem.follow(model, [p / pressures[-1] for p in pressures])
    except fem.NotConverged as failure:
        solution = failure.partial
    results = {}
    for pressure, step in zip(pressures, solution.steps, strict=False):
        curve = experiment.centreline(step)
        results[pressure] = WholeArm(
            curve.s,
            np.stack([curve.x, curve.y], axis=1),
            experiment.end_force(step),
            experiment.end_couple(step),
            np.array(list(plane_rotations(arm, step))).reshape(-1, 2),
        )
    return results, Cost(perf_counter() - begin, solution.seconds.factorization, solution.factorizations)


def plane_rotations(arm: Arm, step: fem.Step) -> Iterator[tuple[float, float]]:
    """Rest position and mean rotation of the planes between the cells of a whole arm."""
    repetition = arm.design.repetition(arm.size, GRADINGS["off"])
    for k in range(1, repetition.half_cells, 2):
        s = repetition.middle + k * repetition.half_pitch
        rest = step.space.points
        nodes = np.flatnonzero(np.abs(rest[:, 0] - s) < 1e-6)
        height = rest[nodes, 1] - rest[nodes, 1].mean()
        x, y = (step.positions[nodes, k] for k in range(2))
        yield s, float(np.arctan2(-height @ x, height @ y))


@dataclass(frozen=True)
class Results:
    """Solutions of whole arms, kept in a folder until arm, load or program change."""

    folder: Path

    def whole(self, arm: Arm, case: Case) -> dict[float, WholeArm]:
        """At the pressures of the law, and between; without those beyond the end of the path."""
        files: JsonFiles[tuple[Arm, Case], dict[float, WholeArm]] = JsonFiles(
            lambda load: self.folder / f"{_name(*load)}.json",
            lambda load: key_of(str(load), "benchmarks/cell.py"),
            lambda states: {str(p): {key: _plain(value) for key, value in vars(s).items()} for p, s in states.items()},
            lambda rows: {float(p): WholeArm.of(row) for p, row in rows.items()},
        )
        return next(Study([(arm, case)], _solved, files).run())[1]


def _solved(load: tuple[Arm, Case]) -> dict[float, WholeArm]:
    arm, case = load
    states, cost = solve_whole(arm, case, arm.all_pressures)
    report(f"{arm.name}, {case.name}: {len(states)} pressures, {cost.seconds:.1f} s")
    return states


def _name(arm: Arm, case: Case) -> str:
    words = case.name.replace("+", "plus ").replace("-", "minus ")
    return re.sub(r"\W+", "_", f"{arm.name} {arm.design.length:g} {arm.size:g} {words} {arm.all_pressures}")


def report(sentence: str) -> None:
    """On the way."""
    sys.stdout.write(f"{sentence}\n")
    sys.stdout.flush()


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


class Pieces:
    """The pieces of an arm and the law they give."""

    def __init__(self, arm: Arm, force: float = FORCE) -> None:
        self.arm, self.force = arm, force
        design, size, self.dhat = arm.design, arm.size, arm.dhat
        self.cell = BendingPiece(design.half_cell(size), arm.material, "mirror", dhat=arm.dhat)
        self.end = design.end_piece(arm.half_cells, size)

    def end_piece(self, start: str) -> BendingPiece:
        return BendingPiece(self.end, self.arm.material, start, dhat=self.dhat)  # type: ignore[arg-type]

    def sweep(self) -> list[Any]:
        """The cell at all pressures, each from the state of the one before."""
        sweeps: list[Any] = []
        highest = cell_without_moment(self.cell, max(self.arm.pressures) / 1000.0)
        bend = highest.state.angle / self.cell.body.length
        reach = Reach(self.arm.design.length, self.force, END_Y, bend)
        for pressure in self.arm.pressures:
            start = None
            if sweeps:
                start = min(sweeps[-1].points, key=lambda point: abs(point.moment)).state
            sweeps.append(sweep_cell(self.cell, pressure, reach, start))
            for sentence in sweeps[-1].limits:
                report(f"{self.arm.name}: {sentence}")
        return sweeps

    @cached_property
    def law(self) -> ArmLaw:
        """Cell and both ends."""
        design = self.arm.design
        cells = [sweep.curve(self.cell.body.length) for sweep in self.sweep()]
        pieces = {start: self.end_piece(start) for start in ("clamp", "free")}
        clamps = [clamp_curve(pieces["clamp"], cell).curve for cell in cells]
        tips = [tip_curve(pieces["free"], cell).curve for cell in cells]
        first = design.repetition(self.arm.size, GRADINGS["off"]).middle
        return ArmLaw(design.pitch, first, design.length, tuple(cells), tuple(clamps), tuple(tips))


@dataclass(frozen=True)
class Comparison:
    """A rod with the law beside finite elements of the whole arm."""

    pressure: float  #: kPa
    case: str
    shape: float  #: largest distance of the material curves over the length
    force: float | None  #: relative error of the force that holds the end; None where it is given
    angle: float  #: error of the direction of the end, degrees
    share: float = 1.0  #: the force over the larger one of it and SMALL EI / l^2, EI of a cell at rest
    refusal: str = ""  #: why the rod gave nothing


def compare(law: ArmLaw, design: Design, case: Case, pressure: float, whole: WholeArm, rigidity: float) -> Comparison:
    """One load at one pressure; rigidity: EI of a cell at rest, N mm2."""
    length = design.length
    try:
        solution = case.solve(law.at(pressure, length))
    except RodError as refusal:
        return Comparison(pressure, case.name, np.nan, None, np.nan, refusal=str(refusal))
    points = solution.positions(whole.s) + np.array([0.0, design.curve_y])
    shape = float(np.linalg.norm(points - whole.points, axis=1).max()) / length
    force = float(solution.force[1] / whole.force[1]) - 1.0 if case.experiment == "III" else None
    angles = [np.degrees(np.arctan2(*(curve[-1] - curve[-5])[::-1])) for curve in (points, whole.points)]
    angle = float((angles[0] - angles[1] + 180.0) % 360.0 - 180.0)
    small = SMALL * rigidity / length**2
    return Comparison(pressure, case.name, shape, force, angle, min(1.0, abs(float(whole.force[1])) / small))


def rigidity_at_rest(cell: BendingPiece) -> float:
    """EI of a cell at rest, N mm2."""
    return float(slopes(cell, cell.rest()).moment_by_angle) * cell.body.length


def cell_errors(law: ArmLaw, arm: Arm, pressure: float, whole: WholeArm) -> Array:
    """Curvatures of the inner cells of the whole arm less those of the law at the same moments.

    In parts of the curvature without moment at the highest pressure of the law.

    Cells nearer to an end than twice the width, where its disturbance reaches, are left out.
    """
    rod = law.at(pressure)
    section, kappa_0 = rod.section, law.at(law.pressures[-1]).section.kappa_0
    s, rotation = whole.planes.T
    middle = (s[1:] + s[:-1]) / 2.0
    curvature = np.diff(np.unwrap(rotation)) / np.diff(s)
    at = np.stack([np.interp(middle, whole.s, whole.points[:, k]) for k in range(2)], axis=1)
    lever = whole.points[-1] - at
    moment = whole.couple + lever[:, 0] * whole.force[1] - lever[:, 1] * whole.force[0]
    theta = (rotation[1:] + rotation[:-1]) / 2.0
    axial = whole.force[0] * np.cos(theta) + whole.force[1] * np.sin(theta)
    effective = moment
    for _ in range(3):
        slopes = [
            np.interp(effective, section.moment, values) for values in (section.stretch_slope, section.kappa_slope)
        ]
        effective = moment + axial * slopes[0] / slopes[1]
    known = (effective >= section.moment[0]) & (effective <= section.moment[-1])
    reach = 2.0 * float(arm.design.extent[2])
    inside = known & (middle > reach) & (middle < rod.length - reach)
    return np.asarray((curvature - np.interp(effective, section.moment, section.kappa))[inside] / abs(kappa_0))


def table_of(rows: Sequence[Sequence[str]], columns: Sequence[str]) -> str:
    """Markdown."""
    lines = ["| " + " | ".join(columns) + " |", "|---|" + "---:|" * (len(columns) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def percent(value: float | None, digits: int = 2) -> str:
    """Of a fraction; empty for None."""
    return "" if value is None or np.isnan(value) else f"{100.0 * value:.{digits}f}"


def loads_table(comparisons: Sequence[Comparison]) -> str:
    """One row for each load, one column for each pressure: shape and force errors.

    Where a force is small its error over SMALL EI / l^2 stands beside it in brackets.
    """
    pressures = sorted({row.pressure for row in comparisons})
    by_load = {(row.case, row.pressure): row for row in comparisons}

    def entry(case: str, pressure: float) -> str:
        row = by_load.get((case, pressure))
        if row is None:
            return "-"
        if row.refusal:
            return "refused"
        force = "" if row.force is None else f", {100.0 * row.force:+.2f}"
        if row.force is not None and row.share < 1.0:
            force += f" ({100.0 * row.share * row.force:+.2f})"
        return f"{percent(row.shape)}{force}, {row.angle:+.1f}"

    names = [case.name for case in CASES if any(row.case == case.name for row in comparisons)]
    rows = [[name, *(entry(name, pressure) for pressure in pressures)] for name in names]
    return table_of(rows, ["load", *(f"{pressure:g} kPa" for pressure in pressures)])


def compare_arm(arm: Arm, pieces: Pieces, results: Results) -> tuple[str, list[list[str]]]:
    """The table of an arm, and the rows of its inner cells."""
    comparisons, cells = [], []
    law, rigidity = pieces.law, rigidity_at_rest(pieces.cell)
    for case in CASES:
        for pressure, whole in results.whole(arm, case).items():
            comparisons.append(compare(law, arm.design, case, pressure, whole, rigidity))
            row = comparisons[-1]
            report(f"{arm.name}: {row}")
            if pressure in arm.pressures:
                cells.append((pressure, case.name, cell_errors(law, arm, pressure, whole)))
    rows = []
    for pressure in arm.pressures:
        errors = [(float(np.abs(by_cell).max(initial=0.0)), name) for p, name, by_cell in cells if p == pressure]
        largest, name = max(errors)
        rows.append([arm.name, f"{pressure:g}", percent(largest), name])
    return loads_table(comparisons), rows


def compare_lengths(arm: Arm, pieces: Pieces, results: Results) -> str:
    """Arms of 7 and 20 chambers with the law of another one."""
    assert isinstance(arm.design, PneuNet)
    rows, law, rigidity = [], pieces.law, rigidity_at_rest(pieces.cell)
    for chambers in (7, 20):
        pressure = 31.0
        other = replace(arm, design=replace(arm.design, chambers=chambers), pressures=(pressure,), between=None)
        for case in LENGTH_CASES:
            end_y = case.end_y * other.design.length / arm.design.length
            force = tuple(component * (arm.design.length / other.design.length) ** 2 for component in case.force)
            scaled = replace(case, end_y=end_y, force=(force[0], force[1]))
            for p, whole in results.whole(other, scaled).items():
                row = compare(law, other.design, scaled, p, whole, rigidity)
                words = f"{chambers} chambers, {case.experiment}"
                words += f", end at {end_y:.0f} mm" if end_y else ""
                words += f", {force[1]:.3f} N" if any(force) else ""
                shown = "" if row.force is None else f"{100.0 * row.force:+.2f}"
                rows.append([words, row.refusal or percent(row.shape), shown, f"{row.angle:+.1f}"])
                report(f"{words}: {row}")
    return table_of(rows, ["arm and load at 31 kPa", "shape", "force", "end"])


def renew(name: str, text: str) -> None:
    """Put a table between its marks in the docs, with the version of the program below it."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    docs = DOCS.read_text(encoding="utf-8")
    before, rest = docs.split(begin)
    text = f"{text.rstrip()}\n\n{written_with()}\n"
    DOCS.write_text(f"{before}{begin}\n\n{text}\n{end}{rest.split(end)[1]}", encoding="utf-8")


def main() -> None:
    """All tables."""
    parser = parser_of(__doc__)
    parser.add_argument("results", type=Path)
    results, cells = Results(parser.parse_args().results), []
    for arm in ARMS:
        pieces = Pieces(arm)
        table, rows = compare_arm(arm, pieces, results)
        renew(arm.name, table)
        cells += rows
        if arm.dhat is not None:
            renew("lengths", compare_lengths(arm, pieces, results))
    renew("cells", table_of(cells, ["arm", "kPa", "largest error, % of κ₀ at the highest pressure", "under"]))


if __name__ == "__main__":
    main()
