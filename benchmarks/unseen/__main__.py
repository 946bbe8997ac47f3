"""A campaign over designs drawn at random: each is run as users run theirs, checked, and sorted by its outcome.

    make unseen SEED=1 N=4
    python -m benchmarks.unseen --seed 1 --count 4 [--first 2] [--jobs 2] [--finer 8] [--limit 600] [--law both] \\
        [--larger 1.5] [--page docs] [--with FOLDER ...]

Each design has a folder below results/unseen with its configuration, its results and outcome.json; what is finished
is kept, so that the same command continues an interrupted campaign. As many designs are worked on at the same time as
--jobs says, by default one for each core, each with one thread. A stage of a design that needs more CPU seconds than
the limit is recorded as too slow. After each design the pages are written into the folder of the campaign. At the end
its designs are added to those of the pages in the folder of --page, with their histogram. Results that are published
there are not replaced: designs of this campaign that they contain are not run again, and if they contain all of them,
they are run with the present sources, and their pages are in the folder of the campaign alone. Several campaigns may
run at the same time: the page is read again before it is written. --with adds the designs of other campaigns, given
by their folders, or those of this one that were run elsewhere; --stored solves nothing and writes the pages from what
is there. --larger multiplies the sizes of elements that the program chooses, for a quick check of the program whose
results are not published. Seeds 1 to 3, 10, 23, 31, 37, 47 and 73 are for finding and mending defects, so they are not
reported: --page is not for them.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.unseen.designs import Drawn, drawn, three_digits
from benchmarks.unseen.histogram import draw
from benchmarks.unseen.page import PAGES_DATA, joined, write_pages
from benchmarks.unseen.sorting import EARLY, ERROR, NO_LIMIT, TRACEBACK, WRONG, outcome, rod_errors
from benchmarks.unseen.work import LIMIT, Record, Work, kept, outcomes_of
from pipeline.config.config import LAW_CHOICES
from pipeline.config.load import load_config
from pipeline.errors import InputError
from pipeline.processes import available_cores

#: seeds with which the program was mended
MENDING = (1, 2, 3, 10, 23, 31, 37, 47, 73)


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
                size = three_digits(factor * load_config(path).mesh.element_size_mm)
            except InputError:
                changed.append(design)
                continue
            changed.append(replace(design, document={**design.document, "mesh": {"size": f"{size:g} mm"}}))
    return changed


def campaign(given: argparse.Namespace, records: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What the pages are written from."""
    settings = {"seed": given.seed, "drawn": given.count, "limit": given.limit, "law": given.law}
    return {"campaigns": [settings], "records": [{"seed": given.seed, **record} for record in records]}


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
    parser.add_argument("--page", type=Path, help="folder into which the pages and unseen.json are written as well")
    parser.add_argument("--with", dest="others", type=Path, nargs="+", default=[], help="folders of other campaigns")
    parser.add_argument("--stored", action="store_true", help="solve nothing; write the page from what is stored")
    given = parser.parse_args()
    if given.others and not given.page:
        parser.error("--with joins campaigns on a page: give --page too")
    larger = "" if given.larger == 1.0 else f"_{given.larger:g}_times_larger"
    folder = given.results / f"{given.seed}_of_{given.count}_{given.law}{larger}"
    try:
        published = _stored(given.page) if given.page and (given.page / PAGES_DATA).exists() else None
        if given.page and (why := _why_not_published(given, published)):
            if given.others:
                parser.error(f"{why}: leave --page and --with out")
            sys.stdout.write(f"{why}; its pages are written into {folder} alone\n")
            given.page, published = None, None
        others = [_stored(other) for other in given.others]
        known = [*([published] if published else []), *others]
        joined([*known, campaign(given, [])])
    except (OSError, ValueError) as reason:
        parser.error(f"--page and --with: {reason}")
    finer = sample(given.first or given.count, given.finer)
    elsewhere = {record["number"] for other in known for record in other["records"] if record["seed"] == given.seed}
    designs = with_larger_elements(with_law(drawn(given.seed, given.count)[: given.first], given.law), given.larger)
    all_works = [Work(design, folder / design.name, given.limit, design.number in finer) for design in designs]
    works = [work for work in all_works if work.design.number not in elsewhere]
    earlier = _stored_records([work for work in all_works if work.design.number in elsewhere])
    records: list[Record] = []
    for record in _stored_records(works) if given.stored else outcomes_of(works, given.jobs):
        records = sorted([*records, record], key=lambda record: record["number"])
        spent, number = sum(record["seconds"].values()), record["number"]
        sys.stdout.write(f"{number:3d} {outcome(record)}, {spent:.0f} s: {record['words']} {record['reason']}\n")
        sys.stdout.flush()
        _write(folder, campaign(given, sorted([*earlier, *records], key=lambda record: record["number"])))
    if given.page and (records or elsewhere):
        _publish(given.page, [*others, campaign(given, records)])
    results = {outcome(record) for record in records}
    bad = bool(results & {WRONG, TRACEBACK, NO_LIMIT}) or any(record["ended"] == ERROR for record in records)
    return int(bad or results == {EARLY})


def _why_not_published(given: argparse.Namespace, published: Mapping[str, Any] | None) -> str:
    """Why --page is not for this campaign; empty where it is. published: what its pages were written from, if any."""
    if given.seed in MENDING:
        return f"seed {given.seed} is for mending the program"
    if given.larger != 1.0:
        return "the elements are not those that the program chooses"
    if given.stored or published is None:
        return ""
    if any(entry["law"] != given.law for entry in published["campaigns"]):
        return f"the designs in {given.page} were run with another law of the rod than {given.law}"
    numbers = {record["number"] for record in published["records"] if record["seed"] == given.seed}
    if numbers >= set(range(given.first or given.count)):
        return f"{given.page} has results of these designs of seed {given.seed} already"
    return ""


def _stored_records(works: Sequence[Work]) -> list[Record]:
    """The complete records of designs in their folders, whatever sources they are from."""
    records = [kept(work.folder) for work in works]
    return [record for record in records if record is not None and record["finished"]]


def _stored(folder: Path) -> dict[str, Any]:
    """What the pages of a finished campaign were written from; raises OSError and ValueError."""
    content: dict[str, Any] = json.loads((folder / PAGES_DATA).read_text(encoding="utf-8"))
    if "campaigns" not in content:
        raise ValueError(f"{folder / PAGES_DATA} was written by an earlier version; run that campaign with --stored")
    if bad := {entry["seed"] for entry in content["campaigns"]} & set(MENDING):
        raise ValueError(f"seed {', '.join(map(str, bad))} is for mending the program and is not reported")
    return content


def _publish(page: Path, contents: Sequence[Mapping[str, Any]]) -> None:
    """Add campaigns to those of a page as it is now, to which others may have been added since this one began.

    Designs that the page has meanwhile stay as they are there.
    """
    published = [_stored(page)] if (page / PAGES_DATA).exists() else []
    there = {(record["seed"], record["number"]) for content in published for record in content["records"]}
    new = [
        {**content, "records": [r for r in content["records"] if (r["seed"], r["number"]) not in there]}
        for content in contents
    ]
    _write(page, joined([*published, *new]))


def _write(folder: Path, content: dict[str, Any]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pictures").mkdir(exist_ok=True)
    draw(rod_errors(content["records"]), folder / "pictures" / "unseen.png")
    write_pages(folder, content)


if __name__ == "__main__":
    sys.exit(main())
