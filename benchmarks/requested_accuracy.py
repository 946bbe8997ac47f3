"""Requested accuracy on designs from which its error model was not derived: estimated errors and true ones.

    python benchmarks/requested_accuracy.py RESULTS

Each design is run with `--accuracy`, and again on two finer meshes (FINER times the planned size), from which the limit
is extrapolated over the degrees of freedom as in `pneurod accuracy`. Renews the table of docs/accuracy.md between its
marks; finished runs and meshes in RESULTS are kept until the program changes. Three quarters of an hour with one
thread.
"""

import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.arguments import parser_of  # noqa: E402
from benchmarks.sources import key_of, written_with  # noqa: E402
from pipeline.accuracy.ladder import Rung, mesh_series  # noqa: E402
from pipeline.accuracy.measure import measure, numbers_of  # noqa: E402
from pipeline.accuracy.result import HEADLINE, Headline, RungResult  # noqa: E402
from pipeline.config.config import Config, Newton  # noqa: E402
from pipeline.config.load import load_config  # noqa: E402
from pipeline.identification.richardson import extrapolated  # noqa: E402
from pipeline.progress import Silent  # noqa: E402
from pipeline.run import run  # noqa: E402
from pipeline.study import JsonFiles, Study  # noqa: E402

DOCS = HERE / "docs" / "accuracy.md"
MARKS = "<!-- requested-accuracy -->", "<!-- end of requested-accuracy -->"
#: sizes of the meshes of the reference over the planned one
FINER = (0.8, 0.6)
ROUND, GAPPED = "20 kPa", "5 kPa"  #: the walls of the gapped arm do not touch at 5 kPa


@dataclass(frozen=True)
class Request:
    """A design and the accuracy requested for it."""

    name: str
    words: str
    base: str  #: the file in configs it differs from
    settings: tuple[str, ...]
    percent: float

    @property
    def config(self) -> Config:
        """As `pneurod run --set mesh.size=auto --accuracy` has it."""
        settings = [*self.settings, "mesh.size=auto", f"accuracy={self.percent:g} %", "law=five", "validation=off"]
        return load_config(HERE / "configs" / f"{self.base}.yaml", settings)


def design(name: str, words: str, base: str, percent: float, pressures: str, /, **dimensions: str) -> Request:
    """A design by the dimensions in which it differs from its base."""
    settings = [f"geometry.{key}={value}" for key, value in dimensions.items()]
    return Request(name, f"{words}, {pressures}", base, (f"pressures=[{pressures}]", *settings), percent)


BISECTED, SEMI, SINGLE, PNEU = (
    f"{name}_coarse" for name in ("bisected_circle", "semicircular", "semicircular_single", "pneunet")
)
DESIGNS = (
    design(
        *("bisected_92", "bisected circle, l = 92, wall 1.5, divider 2 mm", BISECTED, 2.0, ROUND),
        length="92 mm",
        wall="1.5 mm",
        divider="2 mm",
    ),
    design(
        *("bisected_90", "bisected circle, l = 90, radius 9, wall 1.2 mm", BISECTED, 3.0, ROUND),
        length="90 mm",
        radius="9 mm",
        wall="1.2 mm",
    ),
    design(
        *("semicircular_9", "semicircular, 9 chambers, radius 8, wall 1.3 mm", SEMI, 5.0, ROUND),
        chambers="9",
        radius="8 mm",
        wall="1.3 mm",
    ),
    design("semicircular_7", "semicircular, 7 chambers", SEMI, 5.0, "20 kPa, 30 kPa", chambers="7"),
    design("single_9", "semicircular, one cavity, radius 9 mm", SINGLE, 3.0, ROUND, radius="9 mm"),
    design(
        *("semicircular_8", "semicircular, 8 chambers, radius 7, base 3 mm", SEMI, 5.0, ROUND),
        chambers="8",
        radius="7 mm",
        base="3 mm",
    ),
    design(
        *("single_6", "semicircular, one cavity, radius 6.5, wall 1.3 mm", SINGLE, 5.0, "37 kPa"),  # straight at 20
        radius="6.5 mm",
        wall="1.3 mm",
    ),
    design("gapped_8", "gapped, 8 chambers", PNEU, 6.0, GAPPED, chambers="8"),
    design("gapped_7", "gapped, 7 chambers, wall 1.4 mm", PNEU, 5.0, GAPPED, chambers="7", wall="1.4 mm"),
)


@dataclass(frozen=True)
class Solved:
    """A run with a requested accuracy."""

    accuracy: dict[str, Any]  #: the part of run.json about it
    degrees_of_freedom: int
    numbers: tuple[Headline, ...]  #: by pressure
    cpu_seconds: float

    @staticmethod
    def read(record: dict[str, Any]) -> "Solved":
        """From the file of a design."""
        return Solved(**{**record, "numbers": tuple(Headline(**numbers) for numbers in record["numbers"])})


def solve(request: Request) -> Solved:
    """Run a design with its requested accuracy."""
    begin = process_time()
    with tempfile.TemporaryDirectory() as out:
        report = run(request.config, Path(out), 1, True, Silent())
        report.raise_if_failed()
    if report.accuracy is None:
        raise RuntimeError(f"{request.name}: no accuracy was planned")
    accuracy = dict(report.accuracy.plan.record(report.accuracy.review))
    numbers = tuple(numbers_of(at_pressure).headline for at_pressure in report.parameters)
    return Solved(accuracy, report.outcomes.degrees_of_freedom, numbers, process_time() - begin)


def finer_rung(request: Request, accuracy: dict[str, Any], factor: float) -> Rung:
    """The design on a mesh of `factor` times the planned size."""
    size = factor * accuracy["size_mm"]
    config = request.config
    mesh = replace(config.mesh, size_mm=size, formulation=accuracy["formulation"], grading=accuracy["grading"])
    config = replace(config, mesh=mesh, newton=Newton(accuracy["newton_tolerance"]))
    config = config.with_contact_distance(accuracy["contact_dhat_mm"])
    return Rung(mesh_series(config), size, config)


def measure_all(rung: Rung) -> RungResult:
    """The numbers at every pressure. Raises RuntimeError where one is missing."""
    result = measure(rung)
    if result.failure:
        raise RuntimeError(f"{rung.config.name}, mesh of {rung.value:.3g} mm: {result.failure}")
    return result


@dataclass(frozen=True)
class TrueError:
    """Relative error of a number at the pressure where it is largest."""

    to_limit: float
    std: float  #: of the limit
    to_finest: float

    def __str__(self) -> str:
        return f"{100 * self.to_limit:+.1f} ± {100 * self.std:.1f} ({100 * self.to_finest:+.1f})"


def true_errors(run_result: Solved, references: Sequence[RungResult]) -> list[TrueError]:
    """Of kappa_0(l/2), alpha2 and F."""
    freedom = [run_result.degrees_of_freedom, *(mesh.cost.degrees_of_freedom for mesh in references if mesh.cost)]
    sizes = [n ** (-1 / 3) for n in freedom]
    numbers = [run_result.numbers, *([at_pressure.headline for at_pressure in mesh.numbers] for mesh in references)]
    errors = []
    for name in HEADLINE:
        at_pressures = []
        for of_meshes in zip(*numbers, strict=True):
            values = [headline.by_name()[name] for headline in of_meshes]
            end = extrapolated(sizes, values)
            to_limit, std = values[0] / end.limit - 1.0, abs(end.limit_std / end.limit)
            at_pressures.append(TrueError(to_limit, std, values[0] / values[-1] - 1.0))
        errors.append(max(at_pressures, key=lambda error: abs(error.to_limit)))
    return errors


def row(request: Request, result: Solved, errors: Sequence[TrueError]) -> str:
    """A line of the table."""
    accuracy = result.accuracy
    after = accuracy["after"]
    before, later = (
        " / ".join(f"{100 * stage['estimated'][name]:.1f}" for name in HEADLINE) for stage in (accuracy, after)
    )
    true = " / ".join(map(str, errors))
    cells = (
        *(
            request.words,
            f"{request.percent:g}",
            f"{accuracy['size_mm']:g}",
            f"{result.degrees_of_freedom:,}".replace(",", " "),
        ),
        *(f"{accuracy['order']:.1f}", before, later, true, f"{100 * after['identification']:.2g}"),
        f"{result.cpu_seconds:.0f}",
    )
    return f"| {' | '.join(cells)} |"


TITLES = (
    *("design", "requested %", "size mm", "degrees of freedom", "order", "estimated before %", "estimated after %"),
    *("true %", "α₂ identified to ± %", "CPU s"),
)


def _file_of_rung(folder: Path, rung: Rung) -> Path:
    return folder / f"{rung.value:.4g}mm.json"


def _key(config: Config) -> str:
    return key_of(config.hash, "benchmarks/requested_accuracy.py")


def main() -> None:
    """Run what is missing and write the table."""
    parser = parser_of(__doc__)
    parser.add_argument("results", type=Path)
    results = parser.parse_args().results
    lines = [f"| {' | '.join(TITLES)} |", "|---|---:|---:|---:|---:|---|---|---|---:|---:|"]
    runs: JsonFiles[Request, Solved] = JsonFiles(
        lambda request: results / request.name / "run.json", lambda request: _key(request.config), asdict, Solved.read
    )
    for request, result in Study(DESIGNS, solve, runs).run():
        rungs = [finer_rung(request, result.accuracy, factor) for factor in FINER]
        files: JsonFiles[Rung, RungResult] = JsonFiles(
            partial(_file_of_rung, results / request.name),
            lambda rung: _key(rung.config),
            RungResult.record,
            RungResult.read,
        )
        references = [reference for _, reference in Study(rungs, measure_all, files).run()]
        lines.append(row(request, result, true_errors(result, references)))
        sys.stdout.write(lines[-1] + "\n")
        sys.stdout.flush()
    begin, end = MARKS
    table = "\n".join([begin, "", *lines, "", written_with(), "", end])
    text = DOCS.read_text(encoding="utf-8")
    DOCS.write_text(re.sub(f"{begin}.*?{end}", lambda _: table, text, flags=re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    main()
