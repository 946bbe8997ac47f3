"""The designs of docs/unseen.md that were too slow or met an error of the program, run again with the present sources.

    make unseen-again
    python -m benchmarks.unseen.again --page docs [--designs 131-28 131-38] [--jobs 2] [--limit 6000]

Each stage of a design may take ten times the CPU time of a campaign. The records stand beside those of the campaigns
in unseen.json and replace none of them; the page has them in a section of their own. A design whose second record is
from earlier sources is run again only where --designs names it.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.unseen.designs import drawn
from benchmarks.unseen.page import PAGES_DATA, write_pages
from benchmarks.unseen.sorting import did_not_end, outcome, run_seconds
from benchmarks.unseen.wording import name_of
from benchmarks.unseen.work import LIMIT, Record, Work, outcomes_of
from pipeline.processes import available_cores


def works_of(content: Mapping[str, Any], names: Sequence[str], results: Path, limit: float) -> list[Work]:
    """The designs to run: those named, or all that did not end and have no second record.

    Raises ValueError for a name that is none of those that did not end.
    """
    missing = [name_of(record) for record in content["records"] if did_not_end(record)]
    if bad := [name for name in names if name not in missing]:
        raise ValueError(f"{', '.join(bad)}: the designs that did not end are {', '.join(missing)}")
    known = {name_of(record) for record in content.get("again", [])}
    count_of = {campaign["seed"]: campaign["drawn"] for campaign in content["campaigns"]}
    works = []
    for name in names or [name for name in missing if name not in known]:
        seed, number = map(int, name.split("-"))
        works.append(Work(drawn(seed, count_of[seed])[number], results / name, limit, finer=False))
    return works


def with_second(content: Mapping[str, Any], record: Record) -> dict[str, Any]:
    """What the pages are written from with one more record of a design that was run again, in the place of an earlier
    one."""
    name = name_of(record)
    others = [known for known in content.get("again", []) if name_of(known) != name]
    order = [name_of(known) for known in content["records"]]
    return {**content, "again": sorted([*others, record], key=lambda known: order.index(name_of(known)))}


def main() -> None:
    """Run them and write the pages after each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--page", type=Path, required=True, help="folder of the pages and unseen.json")
    parser.add_argument("--designs", nargs="+", default=[], help="such as 131-28; by default all that have not been")
    parser.add_argument("--results", type=Path, default=Path("results/unseen/again"))
    parser.add_argument("--limit", type=float, default=10.0 * LIMIT, help="CPU seconds of a stage of a design")
    parser.add_argument("--jobs", type=int, default=available_cores(), help="designs worked on at the same time")
    given = parser.parse_args()
    path = given.page / PAGES_DATA
    try:
        works = works_of(json.loads(path.read_text(encoding="utf-8")), given.designs, given.results, given.limit)
    except (OSError, ValueError) as reason:
        parser.error(str(reason))
    for record in outcomes_of(works, given.jobs):
        words = f"{name_of(record)} {outcome(record)}, {run_seconds(record):.0f} s: {record['words']}"
        sys.stdout.write(f"{words} {record['reason']}\n")
        sys.stdout.flush()
        # read again: a campaign may have added its designs since
        write_pages(given.page, with_second(json.loads(path.read_text(encoding="utf-8")), record))


if __name__ == "__main__":
    main()
