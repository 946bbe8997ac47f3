"""docs/unseen.md and unseen_designs.md from the records of the designs, which unseen.json beside them holds."""

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from string import Template
from textwrap import fill
from typing import Any

from benchmarks.unseen import designs, details, second, summary
from benchmarks.unseen.sorting import run_seconds
from benchmarks.unseen.wording import WIDTH, Record, item

#: what the pages are written from, beside them
PAGES_DATA = "unseen.json"


def joined(contents: Sequence[Record]) -> dict[str, Any]:
    """Several campaigns, or parts of them with different designs, as one.

    Raises ValueError where their designs were run with different laws of the rod, parts of one seed drew different
    designs or had different limits, or two hold the same design.
    """
    campaigns: list[Record] = []
    for campaign in (campaign for content in contents for campaign in content["campaigns"]):
        if any(campaign["law"] != known["law"] for known in campaigns):
            raise ValueError("campaigns on one page must have the same law of the rod")
        if any(campaign["seed"] == known["seed"] and campaign != known for known in campaigns):
            raise ValueError(
                f"parts of seed {campaign['seed']} must have the same number of designs and the same limit"
            )
        campaigns += [] if campaign in campaigns else [campaign]
    order = [campaign["seed"] for campaign in campaigns]
    records = [record for content in contents for record in content["records"]]
    names = [(order.index(record["seed"]), record["number"]) for record in records]
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        seed, number = order[twice[0][0]], twice[0][1]
        raise ValueError(f"design {seed}-{number} is in two of the folders and pages")
    by_name = dict(zip(names, records, strict=True))
    whole = {"campaigns": campaigns, "records": [by_name[name] for name in sorted(names)]}
    again = [record for content in contents for record in content.get("again", [])]
    return {**whole, "again": again} if again else whole


def write_pages(folder: Path, content: Record) -> None:
    """Write unseen.json, unseen.md and unseen_designs.md into a folder."""
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    (folder / PAGES_DATA).write_text(text, encoding="utf-8")
    for name, page in pages(json.loads(text)).items():
        (folder / name).write_text(page, encoding="utf-8")


def pages(content: Record) -> dict[str, str]:
    """The two pages of {campaigns: [{seed, drawn, limit, law}], records, again} by their file names.

    again: records of designs that did not end and were run again (`again.py`); may be missing.
    """
    records, campaigns = content["records"], content["campaigns"]
    values = {
        "commands": "\n".join(_command(campaign) for campaign in campaigns),
        "provenance": _provenance(content),
        "law": fill(_law(campaigns[0]["law"]), WIDTH),
        "modulus": _range(designs.MODULUS),
        "poisson": f"{designs.POISSON[0][0]:g} to {designs.POISSON[1][1]:g}",
        "size": _range(designs.SIZE),
        "cells": f"{min(designs.CELLS)} to {max(designs.CELLS)}",
        "load": _range(designs.LOAD),
        "targets": summary.targets(records),
        "seeds": summary.seeds(records),
        "certainty": fill(summary.certainty(records), WIDTH),
        "bend": fill(summary.bend(records), WIDTH),
        "outcomes": summary.outcomes(records),
        "sums": summary.sums(records),
        "again": second.again(records, content.get("again", [])),
        "table": details.designs_table(records),
        "rods": fill(summary.rods(records), WIDTH),
        "confirmed": fill(summary.confirmed(records), WIDTH),
        "limits": details.limits(records),
        "other": details.other(records),
        "checks": summary.checks(records),
        "unmade": details.unmade(records),
        "mesh": summary.mesh(records),
    }
    templates = {"unseen.md": "page.md", "unseen_designs.md": "designs.md"}
    texts = {name: Path(__file__).with_name(template).read_text("utf-8") for name, template in templates.items()}
    return {name: Template(text).substitute(values) for name, text in texts.items()}


def _command(campaign: Record) -> str:
    return f"    make unseen SEED={campaign['seed']} N={campaign['drawn']} LAW={campaign['law']}"


def _range(limits: tuple[float, float]) -> str:
    return f"{limits[0]:g} to {limits[1]:g}"


def _numbers(numbers: Sequence[int]) -> str:
    """Rising whole numbers in words, those that follow each other as ranges."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][-1] + 1:
            ranges[-1] = [ranges[-1][0], number]
        else:
            ranges.append([number])
    *first, last = [" to ".join(map(str, each)) for each in ranges]
    return f"{', '.join(first)} and {last}" if first else last


def _provenance(content: Record) -> str:
    sentences = []
    for campaign in content["campaigns"]:
        records = [record for record in content["records"] if record["seed"] == campaign["seed"]]
        run, drawn = len(records), campaign["drawn"]
        numbers = [record["number"] for record in records]
        commits = {
            commit: _numbers([record["number"] for record in records if record["sources"] == commit])
            for commit in dict.fromkeys(record["sources"] for record in records)
        }
        sources = next(iter(commits)) if len(commits) == 1 else "; ".join(f"{c} for {n}" for c, n in commits.items())
        if run == drawn:
            part = f"All {run} designs"
        elif numbers == list(range(run)):
            part = f"The first {run} of {drawn} designs"
        else:
            part = f"Of {drawn} designs those with the numbers {_numbers(numbers)}"
        others = "" if run == drawn else f" The other {drawn - run} have not been finished."
        sentences.append(
            f"{part} of seed {campaign['seed']}; sources of commit {sources}; at most "
            f"{campaign['limit']:g} s of CPU time for each stage.{others}"
        )
    seconds = [sum(record["seconds"].values()) for record in content["records"]]
    of_run = [run_seconds(record) for record in content["records"]]
    time = (
        f"CPU time of a run on one thread: median {median(of_run):.0f} s, largest {max(of_run):.0f} s; with the checks "
        f"all {len(seconds)} designs together {sum(seconds) / 3600:.1f} hours."
    )
    return "\n".join(item(sentence) for sentence in sentences) + "\n\n" + fill(time, WIDTH)


def _law(law: str) -> str:
    if law == "both":
        return "Each design is run with the default law of the rod, that is with both laws."
    names = {"five": "the five parameters alone", "cell": "the arm's own law alone"}
    return (
        f"Each design is run with `law: {law}`: {names[law]}. The default is both laws; the arm's own law takes most "
        "of the time of a run and has a table of random designs of its own ([cell](cell.md))."
    )
