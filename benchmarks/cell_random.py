"""The arm's own law on designs drawn at random, against finite elements of the whole arm.

    python benchmarks/cell_random.py RESULTS --seed SEED [--count 24] [--limit 600] [--publish]
    python benchmarks/cell_random.py RESULTS --seed SEED [--count 24] [--limit 600] [--first 0] [--whole]

Draws designs of all families and laws, measures the law of each as `pneurod cell` does, and solves the whole arm at the
two pressures of the configuration and at one between. With --publish the table of docs/cell.md is renewed after every
design: that is for a seed that was not used to improve the program. Each design has a folder in RESULTS with its
configuration, its whole arms and its row; what is finished is kept until the program changes, so that the same command
continues an interrupted one. With --whole only the whole arms are solved, with --first the designs from that number on;
the table is that of all designs, so --publish goes with neither. A design that takes longer than the limit (s) is a row
of its own. One to three minutes a design on one core.
"""

import json
import math
import multiprocessing
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.arguments import count, parser_of  # noqa: E402
from benchmarks.cell import (  # noqa: E402
    Arm,
    Case,
    Comparison,
    Results,
    WholeArm,
    compare,
    percent,
    renew,
    report,
    rigidity_at_rest,
    table_of,
)
from benchmarks.sources import key_of  # noqa: E402
from fem.materials import LAWS, Material  # noqa: E402
from pipeline.cell.build import build_law  # noqa: E402
from pipeline.cell.pieces import ArmPieces, NoArmLaw  # noqa: E402
from pipeline.config.config import Config  # noqa: E402
from pipeline.config.load import load_config  # noqa: E402
from pipeline.context import RunContext  # noqa: E402
from pipeline.errors import InputError, RunFailed  # noqa: E402
from pipeline.progress import Silent  # noqa: E402
from pipeline.simulation.scene import Scene  # noqa: E402
from pipeline.store.store import open_store  # noqa: E402
from pipeline.study import JsonFiles, Study  # noqa: E402

COUNT, LIMIT = 24, 600.0
#: what counts as right: shape over the length, error of the force over the force, or over that which moves the end of a
#: straight arm by a tenth of its length where this is larger
SHAPE, FORCE = 0.01, 0.03
#: why there is nothing to compare
NOT_SOLVED = "the path of the whole arm ends before this pressure"
#: MPa, of all laws at small strain
MODULUS = 1.2
#: over the highest pressure: the lower one of the configuration, and that between
LOWER, BETWEEN = 0.5, 0.65
#: laws by turns: constants in a tensile test in MPa, Poisson's ratio
MATERIALS: tuple[tuple[str, dict[str, float], float], ...] = (
    ("svk", {"E": MODULUS}, 0.495),
    ("neo_hooke", {"mu": MODULUS / 3}, 0.495),
    ("hencky", {"E": MODULUS}, 0.49),
    ("yeoh", {"c10": MODULUS / 6, "c20": 0.01, "c30": 0.0}, 0.495),
    ("mooney_rivlin", {"c10": MODULUS / 8, "c01": MODULUS / 24}, 0.495),
)
#: families by turns, with the largest edge of an element in mm
FAMILIES = (("pneunet", 7.0), ("semicircular", 6.0), ("semicircular_single", 6.0), ("bisected_circle", 6.0))


def drawn(seed: int, number: int) -> dict[str, Any]:
    """The configuration of one of the designs of a seed."""
    rng = np.random.default_rng(seed)
    for k in range(number + 1):
        geometry, pressure = _dimensions(rng, k % len(FAMILIES))
    family, size = FAMILIES[number % len(FAMILIES)]
    law, tensile, nu = MATERIALS[number % len(MATERIALS)]
    constants = asdict(LAWS[law].from_uniaxial(tensile, nu))
    return {
        "name": f"random_{seed}_{number}",
        "geometry": {"family": family, **geometry},
        "material": {
            "law": law,
            **{name: value if name == "nu" else f"{value!r} MPa" for name, value in constants.items()},
            "density": "1130 kg/m^3",
        },
        "pressures": [f"{round(LOWER * pressure, 2)} kPa", f"{pressure} kPa"],
        "mesh": {"size": f"{size} mm", "formulation": "p2p0", "grading": "off"},
    }


def _dimensions(rng: np.random.Generator, family: int) -> tuple[dict[str, Any], float]:
    """Dimensions of a design, and its highest pressure in kPa."""

    def between(low: float, high: float) -> float:
        return round(float(rng.uniform(low, high)), 2)

    counts: dict[str, int] = {}
    ranges: dict[str, tuple[float, float]]
    if family == 0:
        counts = {"chambers": int(rng.integers(7, 13))}
        ranges = {"width": (12, 18), "chamber_length": (6, 10), "gap": (1.5, 3), "chamber_height": (9, 14)}
        ranges |= {"wall": (0.9, 1.5), "roof": (1.5, 2.5)}
    elif family == 1:
        counts = {"chambers": int(rng.integers(7, 12))}
        ranges = {"radius": (6, 9), "chamber_length": (6, 10), "partition": (1.5, 3), "wall": (0.9, 1.5)}
    else:
        ranges = {"length": (90, 130), "radius": (6, 8), "wall": (0.9, 1.4)}
    lengths = {name: f"{between(*limits)} mm" for name, limits in ranges.items()}
    return counts | lengths, between(15, 35) if family == 0 else between(25, 50)


@dataclass(frozen=True)
class Row:
    """What came out of a design."""

    words: str
    seconds: dict[str, float]  #: by part of the work
    turn: float  #: degrees, of the unloaded arm at the highest pressure
    comparisons: tuple[Comparison, ...]  #: their forces in parts of the force itself
    refusal: str = ""  #: why there is no law, or no row

    @property
    def scaled(self) -> tuple[Comparison, ...]:
        """With errors of the force in parts of what is judged."""
        return tuple(
            row if row.force is None else replace(row, force=row.force * row.share) for row in self.comparisons
        )

    @property
    def is_right(self) -> bool:
        """In all loads, with small forces judged by the scale."""
        return self._are_right(self.scaled)

    @property
    def is_right_by_force(self) -> bool:
        """In all loads, with every force judged by itself, however small."""
        return self._are_right(self.comparisons)

    def _are_right(self, comparisons: Sequence[Comparison]) -> bool:
        """Whether something was compared, and all of it is right."""
        return not self.refusal and bool(comparisons) and all(map(_right, comparisons))

    @property
    def reasons(self) -> list[str]:
        """Why rod or law were refused, and what was not solved."""
        refused = {row.refusal: row for row in self.comparisons if row.refusal and row.refusal != NOT_SOLVED}
        rows = [*refused.values(), *(row for row in self.comparisons if row.refusal == NOT_SOLVED)]
        sentences = [f"{row.case} at {row.pressure:g} kPa: {row.refusal}" for row in rows]
        return [self.refusal, *sentences] if self.refusal else sentences

    @classmethod
    def of(cls, record: dict[str, Any]) -> "Row":
        """From the numbers of a file."""
        comparisons = tuple(Comparison(**row) for row in record["comparisons"])
        return cls(**{**record, "comparisons": comparisons})


def _right(row: Comparison) -> bool:
    return not row.refusal and row.shape < SHAPE and abs(row.force or 0.0) < FORCE


def solved(folder: Path, config: Config) -> Row:
    """The row of a design, solved unless the same sources have done so before."""
    files: JsonFiles[Config, Row] = JsonFiles(
        lambda _: folder / "row.json",
        lambda config: key_of(config.hash, "benchmarks/cell_random.py", "benchmarks/cell.py"),
        asdict,
        Row.of,
    )
    return next(Study([config], partial(_of_design, folder), files).run())[1]


def _of_design(folder: Path, config: Config) -> Row:
    with open_store(folder / "law", config) as store:
        return _compared(folder, config, RunContext.alone(store, Silent()))


def _compared(folder: Path, config: Config, context: RunContext) -> Row:
    """The law of a design beside its whole arm."""
    empty = Row(_words(config), {}, math.nan, ())
    begin = perf_counter()
    try:
        scene = Scene.meshed(config)
        measured = build_law(ArmPieces.of(scene), context)
    except (NoArmLaw, InputError, RunFailed) as failure:
        return replace(empty, refusal=str(failure), seconds={"law": perf_counter() - begin})
    if measured.failures:
        return replace(empty, refusal="; ".join(measured.failures), seconds={"law": perf_counter() - begin})
    seconds = {"law": perf_counter() - begin}
    law, design, rows = measured.law, config.design, []
    begin = perf_counter()
    rigidity = rigidity_at_rest(ArmPieces.of(scene).cell)
    for case, pressure, whole in whole_arm(folder, scene):
        if whole is None:
            rows.append(Comparison(pressure, case.name, math.nan, None, math.nan, refusal=NOT_SOLVED))
        else:
            rows.append(compare(law, design, case, pressure, whole, rigidity))
        report(f"{config.name}: {rows[-1]}")
    seconds["whole"] = perf_counter() - begin
    turn = math.degrees(law.at(config.pressures_kPa[-1]).section.kappa_0 * design.length)
    return replace(empty, seconds=seconds, turn=turn, comparisons=tuple(rows))


def whole_arm(folder: Path, scene: Scene) -> Iterator[tuple[Case, float, WholeArm | None]]:
    """All loads at all pressures, by finite elements, None where they have no equilibrium; kept in the folder."""
    config, design = scene.config, scene.config.design
    between = round(BETWEEN * config.pressures_kPa[-1], 2)
    size, dhat, material = config.mesh.element_size_mm, scene.activation_distance, scene.material
    assert isinstance(material, Material)
    arm = Arm(config.name, design, size, 0, config.pressures_kPa, between, dhat, material)
    cases = (
        Case("II", "II"),
        Case("III", "III"),
        Case("end", "III", round(0.1 * design.length, 1)),
        Case(
            "dead",
            "dead",
            force=(0.0, float(f"{0.5 * rigidity_at_rest(ArmPieces.of(scene).cell) / design.length**2:.2g}")),
        ),
    )
    results = Results(folder / "whole")
    for case in cases:
        states = results.whole(arm, case)
        for pressure in arm.all_pressures:
            yield case, pressure, states.get(pressure)


def _words(config: Config) -> str:
    return f"{config.family}, {config.material.law}, {config.pressures_kPa[-1]:g} kPa"


def config_of(folder: Path, seed: int, number: int) -> Config:
    """The configuration of a design, which is written into its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "design.yaml"
    path.write_text(json.dumps(drawn(seed, number), indent=1), encoding="utf-8")  # JSON is YAML
    return load_config(path)


def attempt(results: Path, seed: int, number: int, whole_alone: bool) -> Row:
    """A design, in the process that solves."""
    folder = _folder(results, seed, number)
    config = config_of(folder, seed, number)
    if not whole_alone:
        return solved(folder, config)
    begin = perf_counter()
    for _ in whole_arm(folder, Scene.meshed(config)):
        pass
    return Row(_words(config), {"whole": perf_counter() - begin}, math.nan, ())


def attempts(results: Path, seed: int, numbers: range, limit: float, whole_alone: bool) -> Iterator[Row]:
    """Design after design, in another process, which is ended where one takes longer than the limit (s)."""
    pool = multiprocessing.get_context("spawn").Pool(1)
    for number in numbers:
        words = _words(config_of(_folder(results, seed, number), seed, number))
        pending = pool.apply_async(attempt, (results, seed, number, whole_alone))
        empty = Row(words, {"": limit}, math.nan, ())
        try:
            yield pending.get(limit)
        except multiprocessing.TimeoutError:
            pool.terminate()
            pool = multiprocessing.get_context("spawn").Pool(1)
            yield replace(empty, refusal=f"not finished within {limit:g} s")
        except Exception as failure:  # one design must not end the others
            yield replace(empty, refusal=f"failed with {type(failure).__name__}: {failure}")
    pool.terminate()


def _folder(results: Path, seed: int, number: int) -> Path:
    return results / f"seed_{seed}" / f"design_{number:02d}"


def _largest(rows: Sequence[Comparison]) -> str:
    """Largest shape and force errors."""
    if not rows:
        return "-"
    if any(row.refusal for row in rows):
        return "not solved" if all(row.refusal in ("", NOT_SOLVED) for row in rows) else "refused"
    forces = [abs(row.force) for row in rows if row.force is not None]
    return percent(max(row.shape for row in rows)) + (f", {percent(max(forces))}" if forces else "")


def _entries(number: int, row: Row, between: float) -> list[str]:
    """The row of the table."""
    if row.refusal:
        return [str(number), row.words, "-", "-", "-", "-", "-", "no"]
    experiments = [comparison for comparison in row.scaled if comparison.case in ("II", "III")]
    sample = [comparison for comparison in experiments if comparison.pressure != between]
    others = [[comparison for comparison in row.scaled if comparison.case == name] for name in ("end", "dead")]
    parts = (sample, [comparison for comparison in experiments if comparison.pressure == between], *others)
    return [str(number), row.words, f"{row.turn:.0f}", *map(_largest, parts), "yes" if row.is_right else "no"]


COLUMNS = (
    *("no.", "design", "turn, degrees", "II, III", "pressure between", "end 10 % of l elsewhere", "dead force"),
    "right",
)


def page(seed: int, rows: Sequence[Row]) -> str:
    """The table with its counts and the reasons of refusals."""
    right, by_force = (sum(getattr(row, name) for row in rows) for name in ("is_right", "is_right_by_force"))
    sentence = (
        f"{right} of {len(rows)} designs (seed {seed}) are right in all loads; {by_force} of {len(rows)} are if every "
        "force is judged by its own size, however small."
    )
    highest = [float(row.words.split()[-2]) for row in rows]
    entries = [_entries(k, row, round(BETWEEN * highest[k], 2)) for k, row in enumerate(rows)]
    reasons = [f"- Design {k}: {reason.rstrip('.')}." for k, row in enumerate(rows) for reason in row.reasons]
    below = "\nRefused or not solved:\n\n" + "\n".join(reasons) + "\n" if reasons else ""
    return f"{sentence}\n\n{table_of(entries, COLUMNS)}{below}"


def main() -> None:
    """One design, or all with the table."""
    parser = parser_of(__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=count, default=COUNT)
    parser.add_argument("--limit", type=float, default=LIMIT, help="s per design")
    parser.add_argument("--first", type=int, default=0, help="number of the first design")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--whole", action="store_true", help="solve the whole arms alone")
    kind.add_argument("--publish", action="store_true", help="renew the table in the docs")
    given = parser.parse_args()
    if given.publish and given.first:
        parser.error("the table of --publish has all designs from number 0 on: leave --first out")
    rows: list[Row] = []
    numbers = range(given.first, given.count)
    for number, row in zip(
        numbers, attempts(given.results, given.seed, numbers, given.limit, given.whole), strict=True
    ):
        rows.append(row)
        state = "solved" if given.whole else "right" if row.is_right else "wrong"
        report(f"{number}: {row.words}: {state}, {sum(row.seconds.values()):.0f} s")
        for reason in row.reasons:
            report(f"  {reason}")
        if given.publish:
            renew("random", page(given.seed, rows))


if __name__ == "__main__":
    main()
