"""Bodies from files of other programs, run from file to report: the table of docs/how_to/own_bodies_tried.md.

    python benchmarks/foreign.py RESULTS [FILE ...]

The files are those of `write_tried` in tests/foreign_bodies.py. Each is run with the same pressures and material, and
everything else chosen by the program; finished runs in RESULTS are kept until the program changes. With names of files
only these are run, and the table is not written. About five minutes with one thread.
"""

import sys
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from time import process_time

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.arguments import parser_of  # noqa: E402
from benchmarks.sources import key_of, written_with  # noqa: E402
from pipeline.config.load import load_config  # noqa: E402
from pipeline.errors import InputError  # noqa: E402
from pipeline.progress import Silent  # noqa: E402
from pipeline.report.results import read_results  # noqa: E402
from pipeline.report.validation import rod_errors  # noqa: E402
from pipeline.run import run  # noqa: E402
from pipeline.run_report import RunReport  # noqa: E402
from pipeline.study import JsonFiles, Study  # noqa: E402
from tests.foreign_bodies import Tried, write_tried  # noqa: E402

DOCS = HERE / "docs" / "how_to" / "own_bodies_tried.md"
MARKS = "<!-- tried -->", "<!-- end of tried -->"
CONFIGURATION = """name: {stem}
geometry: {{family: own, file: {file}, {keys}}}
material: {{law: neo_hooke, mu: 0.1 MPa, nu: 0.49}}
pressures: [10 kPa, 20 kPa]
"""
TITLES = (
    *("file", "keys", "elements", "smallest radius ratio", "u_y of the tip, mm", "air, mm³"),
    *("error of the mesh in α₂, %", "error of the rod in the shape, %", "CPU s", "not reached"),
)


@dataclass(frozen=True)
class Ran:
    """How a body ended, and its numbers at the highest pressure reached; None where there is none."""

    reason: str  #: why it was refused or what was not reached, empty where all was
    elements: int | None = None
    radius_ratio: float | None = None  #: the smallest
    deflection: float | None = None  #: of the end of the curve along y in experiment II, mm
    air: float | None = None  #: in experiment II, mm3
    mesh_error: float | None = None  #: of alpha2, as the run estimates it
    rod_error: float | None = None  #: largest, of the best rod, over the length
    seconds: float = 0.0  #: of the processor

    @staticmethod
    def of(report: RunReport) -> "Ran":
        """The numbers of a finished run."""
        mesh = report.mesh.record
        ran = Ran(report.failure, int(str(mesh["elements"])), float(str(mesh["smallest_radius_ratio"])))
        records = report.outcomes["II"].records
        if not records:
            return ran
        last, errors = next(reversed(report.parameters), None), rod_errors(read_results(report.directory))
        return replace(
            ran,
            deflection=float(records[-1].centreline.y[-1]) - report.config.design.curve_y,
            air=records[-1].summary.cavity_volume_mm3,
            mesh_error=last.mesh_errors.get("alpha2") if last else None,
            rod_error=max((distance or 0.0 for distance in errors[0].distance), default=None) if errors else None,
        )

    def row(self, tried: Tried) -> str:
        """A line of the table."""
        numbers = (
            *(_number("d", self.elements), _number(".2g", self.radius_ratio), _number("+.3f", self.deflection)),
            *(_number(".0f", self.air), _number(".1f", self.mesh_error, 100.0), _number(".2f", self.rod_error, 100.0)),
            _number(".0f", self.seconds),
        )
        cells = (tried.words, f"`{tried.keys}`", *numbers, self.reason)
        return f"| {' | '.join(cells)} |"


def _number(form: str, value: float | None, factor: float = 1) -> str:
    return "" if value is None else format(factor * value, form)


def solve(results: Path, tried: Tried) -> Ran:
    """Run a body from its file, which is in `results`."""
    configuration = results / f"{_stem(tried)}.yaml"
    configuration.write_text(_configuration(tried), encoding="utf-8")
    begin = process_time()
    try:
        ran = Ran.of(run(load_config(configuration), results / _stem(tried), 1, True, Silent()))
    except InputError as refused:
        ran = Ran("; ".join(refused.sentences))
    return replace(ran, seconds=process_time() - begin)


def _stem(tried: Tried) -> str:
    return tried.file.replace(".", "_")


def _configuration(tried: Tried) -> str:
    return CONFIGURATION.format(stem=_stem(tried), file=tried.file, keys=tried.keys)


def _key(tried: Tried) -> str:
    return key_of(_configuration(tried), "benchmarks/foreign.py", "tests/foreign_bodies.py", "tests/step_bodies.py")


def main() -> None:
    """Run what is missing and write the table."""
    parser = parser_of(__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("names", nargs="*", metavar="FILE", help="run these bodies alone, and write no table")
    given = parser.parse_args()
    results, names = given.results, given.names
    results.mkdir(parents=True, exist_ok=True)
    tried_bodies = write_tried(results)
    if unknown := set(names) - {tried.file for tried in tried_bodies}:
        known = ", ".join(tried.file for tried in tried_bodies)
        parser.error(f"there is no body {', '.join(sorted(unknown))}; there are {known}")
    bodies = [tried for tried in tried_bodies if not names or tried.file in names]
    files: JsonFiles[Tried, Ran] = JsonFiles(
        lambda tried: results / f"{tried.file}.json", _key, asdict, lambda record: Ran(**record)
    )
    lines = [f"| {' | '.join(TITLES)} |", "|---|---|" + "---:|" * (len(TITLES) - 3) + "---|"]
    for tried, ran in Study(bodies, partial(solve, results), files).run():
        lines.append(ran.row(tried))
        sys.stdout.write(lines[-1] + "\n")
        sys.stdout.flush()
    if not names:
        before, rest = DOCS.read_text(encoding="utf-8").split(MARKS[0])
        table = "\n".join([MARKS[0], "", *lines, "", written_with(), "", MARKS[1]])
        DOCS.write_text(before + table + rest.split(MARKS[1])[1], encoding="utf-8")


if __name__ == "__main__":
    main()
