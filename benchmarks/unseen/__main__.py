"""A campaign over designs drawn at random: each is run as users run theirs, checked, and sorted by its outcome.

    make unseen SEED=1 N=4
    python -m benchmarks.unseen --seed 1 --count 4 [--first 2] [--jobs 2] [--finer 8] [--limit 600] [--law both] \\
        [--larger 1.5]

Each design has a folder below results/unseen with its configuration, its results and outcome.json; what is finished
is kept, so that the same command continues an interrupted campaign. The records of all are in unseen.json, and a table
is printed at the end. As many designs are worked on at the same time as --jobs says, by default one for each core, each
with one thread. A stage of a design that needs more CPU seconds than the limit is recorded as too slow. --larger
multiplies the sizes of elements that the program chooses, for a quick check. Seeds 1 to 3, 10, 23, 31, 37, 47 and 73
are for finding and mending defects; results that are published are those of others.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.unseen.designs import Drawn, drawn, three_digits
from benchmarks.unseen.sorting import EARLY, ERROR, NO_LIMIT, TRACEBACK, WRONG, outcome
from benchmarks.unseen.table import summary
from benchmarks.unseen.work import LIMIT, Record, Work, outcomes_of
from pipeline.config.config import LAW_CHOICES
from pipeline.config.load import load_config
from pipeline.store.cores import available_cores
from pipeline.values.errors import InputError


def sample(count: int, size: int) -> set[int]:
    """Numbers of the designs that are solved on a finer mesh too, evenly over all of them."""
    size = min(size, count)
    return {k * count // size for k in range(size)} if size else set()


def with_law(designs: Sequence[Drawn], law: str) -> list[Drawn]:
    """The designs with the law of the rod in their configurations, unless it is the default."""
    if law == "both":
        return list(designs)
    return [replace(design, document={**design.document, "law": law}) for design in designs]


def with_larger_elements(designs: Sequence[Drawn], factor: float) -> list[Drawn]:
    """The designs with elements larger by a factor than those that the program chooses; refused ones as they are."""
    if factor == 1.0:
        return list(designs)
    changed = []
    with TemporaryDirectory() as folder:
        for design in designs:
            path = Path(folder) / f"{design.name}.yaml"
            path.write_text(json.dumps(design.document), encoding="utf-8")
            try:
                size = three_digits(factor * load_config(path).mesh.size_mm)
            except InputError:
                changed.append(design)
                continue
            changed.append(replace(design, document={**design.document, "mesh": {"size": f"{size:g} mm"}}))
    return changed


def main() -> int:
    """0 where no design is wrong, none met an error of the program or an end without a limit, and one was run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True, help="designs to draw")
    parser.add_argument("--first", type=int, help="run only so many of them, in their order")
    parser.add_argument("--jobs", type=int, default=available_cores(), help="designs worked on at the same time")
    parser.add_argument("--results", type=Path, default=Path("results/unseen"))
    parser.add_argument("--limit", type=float, default=LIMIT, help="CPU seconds of a stage of a design")
    parser.add_argument("--finer", type=int, default=8, help="how many designs are solved on a finer mesh too")
    parser.add_argument("--law", choices=LAW_CHOICES, default="both", help="law of the rod, as in a configuration")
    parser.add_argument("--larger", type=float, default=1.0, help="sizes of elements over those of the program")
    given = parser.parse_args()
    larger = "" if given.larger == 1.0 else f"_{given.larger:g}_times_larger"
    folder = given.results / f"{given.seed}_of_{given.count}_{given.law}{larger}"
    finer = sample(given.first or given.count, given.finer)
    designs = with_larger_elements(with_law(drawn(given.seed, given.count)[: given.first], given.law), given.larger)
    works = [Work(design, folder / design.name, given.limit, design.number in finer) for design in designs]
    records: list[Record] = []
    for record in outcomes_of(works, given.jobs):
        records = sorted([*records, record], key=lambda record: record["number"])
        spent = sum(record["seconds"].values())
        say(f"{record['number']:3d} {outcome(record)}, {spent:.0f} s: {record['words']} {record['reason']}")
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "unseen.json").write_text(json.dumps(records, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    say(f"\n{summary(records)}")
    results = {outcome(record) for record in records}
    bad = bool(results & {WRONG, TRACEBACK, NO_LIMIT}) or any(record["ended"] == ERROR for record in records)
    return int(bad or results == {EARLY})


def say(text: str) -> None:
    """One line, at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
