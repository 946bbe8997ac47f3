"""docs/unseen.md and unseen_designs.md from the records of the designs, which unseen.json beside them holds."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from math import degrees
from pathlib import Path
from statistics import median
from string import Template
from textwrap import fill
from typing import Any

from scipy.stats import beta

from benchmarks.peers.page import table
from benchmarks.unseen import designs
from benchmarks.unseen.checks import ALLOWED
from benchmarks.unseen.sorting import (
    EARLY,
    GOOD_MESHES,
    GOOD_STATES,
    MESH_ERROR,
    OUTCOMES,
    TOO_SLOW,
    TRACEBACK,
    WRONG,
    States,
    checks_in,
    has_numbers,
    outcome,
    rod_errors,
    states_of,
    within_mesh_error,
)

WIDTH = 118  #: characters of a line

Record = Mapping[str, Any]
#: why there is no law of the arm where a configuration asks for the five parameters alone
SWITCHED_OFF = "switched off in the config"
#: names of the three numbers in the records, and as they are written
NUMBERS = {"kappa_0": "κ₀(l/2)", "alpha2": "α₂", "force": "F"}


def joined(contents: Sequence[Record]) -> dict[str, Any]:
    """Several campaigns as one; raises ValueError where their designs were run with different laws of the rod, or two
    have the same seed."""
    campaigns = [campaign for content in contents for campaign in content["campaigns"]]
    if len({campaign["law"] for campaign in campaigns}) != 1:
        raise ValueError("campaigns on one page have the same law of the rod")
    if len({campaign["seed"] for campaign in campaigns}) != len(campaigns):
        raise ValueError("campaigns on one page have different seeds")
    return {"campaigns": campaigns, "records": [record for content in contents for record in content["records"]]}


def write_pages(folder: Path, content: Record) -> None:
    """Write unseen.json, unseen.md and unseen_designs.md into a folder."""
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    (folder / "unseen.json").write_text(text, encoding="utf-8")
    for name, page in pages(json.loads(text)).items():
        (folder / name).write_text(page, encoding="utf-8")


def pages(content: Record) -> dict[str, str]:
    """The two pages of {campaigns: [{seed, drawn, limit, law}], records} by their file names."""
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
        "targets": _targets(records),
        "certainty": fill(_certainty(records), WIDTH),
        "bend": fill(_bend(records), WIDTH),
        "outcomes": _outcomes(records),
        "sums": _sums(records),
        "table": _table(records),
        "rods": fill(_rods(records), WIDTH),
        "confirmed": fill(_confirmed(records), WIDTH),
        "limits": _limits(records),
        "other": _other(records),
        "checks": _checks(records),
        "unmade": _unmade(records),
        "mesh": _mesh(records),
    }
    templates = {"unseen.md": "page.md", "unseen_designs.md": "designs.md"}
    texts = {name: Path(__file__).with_name(template).read_text("utf-8") for name, template in templates.items()}
    return {name: Template(text).substitute(values) for name, text in texts.items()}


def _command(campaign: Record) -> str:
    return f"    make unseen SEED={campaign['seed']} N={campaign['drawn']} LAW={campaign['law']}"


def _name(record: Record) -> str:
    """Seed and number of a design."""
    return f"{record['seed']}-{record['number']}"


def _range(limits: tuple[float, float]) -> str:
    return f"{limits[0]:g} to {limits[1]:g}"


def _provenance(content: Record) -> str:
    sentences = []
    for campaign in content["campaigns"]:
        records = [record for record in content["records"] if record["seed"] == campaign["seed"]]
        run, drawn = len(records), campaign["drawn"]
        commits = sorted({record["sources"] for record in records})
        numbers = [record["number"] for record in records]
        if run == drawn:
            part = f"All {run} designs"
        elif numbers == list(range(run)):
            part = f"The first {run} of {drawn} designs"
        else:
            part = f"Of {drawn} designs those with the numbers {', '.join(map(str, numbers))}"
        others = "" if run == drawn else f" The other {drawn - run} have not been finished."
        sentences.append(
            f"{part} of seed {campaign['seed']}; sources of commit {', '.join(commits)}; at most "
            f"{campaign['limit']:g} s of CPU time for each stage.{others}"
        )
    seconds = [sum(record["seconds"].values()) for record in content["records"]]
    of_run = [record["seconds"].get("run", 0.0) for record in content["records"]]
    time = (
        f"CPU time of a run on one thread: median {median(of_run):.0f} s, largest {max(of_run):.0f} s; with the checks "
        f"all {len(seconds)} designs together {sum(seconds) / 3600:.1f} hours."
    )
    return "\n".join(_item(sentence) for sentence in sentences) + "\n\n" + fill(time, WIDTH)


def _law(law: str) -> str:
    if law == "both":
        return "Each design is run with the default law of the rod, that is with both laws."
    names = {"five": "the five parameters alone", "cell": "the arm's own law alone"}
    return (
        f"Each design is run with `law: {law}`: {names[law]}. The default is both laws; the arm's own law takes most "
        "of the time of a run and has a table of random designs of its own ([cell](cell.md))."
    )


def _targets(records: Sequence[Record]) -> str:
    counts = Counter(outcome(record) for record in records)
    bad = counts[WRONG] + counts[TRACEBACK] + counts[TOO_SLOW]
    states = sum((states_of(record) for record in records), States(0, 0, 0, 0))
    numbers = sum(has_numbers(record) for record in records)
    measured = [good for record in records if (good := within_mesh_error(record)) is not None]
    of_mesh = f"{sum(measured)} of {len(measured)}" if measured else "not measured"
    rows = [
        [
            "designs that end wrong, with an error of the program, or not in time",
            "none",
            f"{bad} of {len(records)}",
            bad == 0,
        ],
        [
            "states solved or beyond a limit that a second way confirms",
            _percent(GOOD_STATES),
            _percent(states.good),
            states.good >= GOOD_STATES,
        ],
        ["designs with numbers or an early refusal", "all", f"{numbers} of {len(records)}", numbers == len(records)],
        [
            f"designs of the sample with κ₀, α₂ and F within {100 * MESH_ERROR:g} % of the limit of the mesh",
            "nine of ten",
            of_mesh,
            bool(measured) and sum(measured) >= GOOD_MESHES * len(measured),
        ],
    ]
    return table(["", "goal", "result", "met"], [[*map(str, row[:3]), "yes" if row[3] else "**no**"] for row in rows])


def largest_share(bad: int, count: int) -> float:
    """The largest part of bad designs that is compatible with `bad` of `count` (95 % one-sided, Clopper-Pearson)."""
    return float(beta.ppf(0.95, bad + 1, count - bad)) if bad < count else 1.0


def _certainty(records: Sequence[Record]) -> str:
    bad = sum(outcome(record) in (WRONG, TRACEBACK, TOO_SLOW) for record in records)
    share = _percent(largest_share(bad, len(records)))
    return (
        f"{bad} of {len(records)} designs say that at most {share} of all designs that can be drawn end wrong, with an "
        "error of the program, or not in time (95 % confidence)."
    )


def _bend(records: Sequence[Record]) -> str:
    """How far the arms bend, because a small bend is a mild test."""
    turns = [abs(degrees(record["turn_rad"])) for record in records if record.get("turn_rad") is not None]
    if not turns:
        return ""
    return (
        f"At the lower pressure the arms bend by {min(turns):.1f} to {max(turns):.1f} degrees over their length, "
        f"median {median(turns):.1f}: the pressures are drawn by the strain of the walls and not by the bend, so that "
        "arms that curl are rare here; those are among the hard cases ([robustness](robustness.md))."
    )


def _outcomes(records: Sequence[Record]) -> str:
    counts = Counter(outcome(record) for record in records)
    return table(["outcome", "designs"], [[name, str(counts[name])] for name in OUTCOMES])


def _sums(records: Sequence[Record]) -> str:
    states = sum((states_of(record) for record in records), States(0, 0, 0, 0))
    numbers = sum(has_numbers(record) for record in records)
    early = sum(outcome(record) == EARLY for record in records)
    sentences = (
        f"States (experiments I, II and III at both pressures): {states.solved} of {states.all} are solved, "
        f"{states.beyond} are beyond a limit that a second way confirms, {states.not_confirmed} are not reached "
        f"without such a confirmation or belong to a wrong design, {states.not_tried} belong to designs that did not "
        f"end: {_percent(states.good)} are solved or beyond a confirmed limit.",
        f"Numbers (five parameters or the arm's own law) or an early refusal: {numbers} of {len(records)} designs, "
        f"{early} of them refused.",
    )
    return "\n\n".join(fill(sentence, WIDTH) for sentence in sentences)


def _table(records: Sequence[Record]) -> str:
    head = [
        "seed and no.",
        "design",
        "p V/(E V)",
        "elements",
        "unknowns",
        "outcome",
        "states",
        "κ₀l at the lower pressure, degrees",
    ]
    head += ["five parameters", "own law", "shape error", "force error", "CPU s"]
    return table(head, [_row(record) for record in records])


def _row(record: Record) -> list[str]:
    states = states_of(record)
    errors = rod_errors([record])
    turn = record.get("turn_rad")
    return [
        _name(record),
        record["words"],
        f"{record['load']:.4f}",
        record.get("elements", ""),
        str(record.get("unknowns", "")),
        outcome(record),
        f"{states.solved} of {states.all}" if states.all else "",
        "" if turn is None else f"{degrees(turn):.1f}",
        f"{len(record.get('five_at_kPa', ()))} of {len(record['pressures_kPa'])} pressures",
        "yes" if record.get("has_arm_law") else "no",
        *(_percent(errors[name][0]) if errors[name] else "" for name in ("shape", "force")),
        f"{sum(record['seconds'].values()):.0f}",
    ]


def _percent(value: float) -> str:
    return f"{100 * value:.2g} %" if abs(value) < 0.995 else f"{100 * value:.0f} %"


def _rods(records: Sequence[Record]) -> str:
    sentences = []
    for name, errors in rod_errors(records).items():
        if errors:
            small = {"shape": 0.03, "force": 0.10}[name]
            sentences.append(
                f"{name.capitalize()} error: median {_percent(median(errors))}, largest {_percent(max(errors))}, below "
                f"{_percent(small)} on {sum(error < small for error in errors)} of {len(errors)} designs."
            )
    chosen = Counter(record["rod"]["rod"] for record in records if record.get("rod"))
    if chosen:
        sentences.append(
            "Recommended rod: " + ", ".join(f"`{rod}` on {count}" for rod, count in chosen.most_common()) + "."
        )
    return " ".join(sentences)


def _confirmed(records: Sequence[Record]) -> str:
    """How many of the limits that were named a second way confirms."""
    limits = [limit for record in records for limit in record["limits"]]
    if not limits:
        return "No design met a limit."
    confirmed = sum(bool(limit["confirmed"]) for limit in limits)
    return f"{confirmed} of the {len(limits)} limits that runs named are confirmed."


def _limits(records: Sequence[Record]) -> str:
    rows = [
        [
            _name(record),
            limit["experiment"],
            f"{limit['limit_kPa']:.4g}",
            "yes" if limit["confirmed"] else "**no**",
            _cell(limit["sentence"]),
        ]
        for record in records
        for limit in record["limits"]
    ]
    if not rows:
        return "No design met a limit."
    return table(["seed and no.", "experiment", "limit kPa", "confirmed", "by"], rows)


def _other(records: Sequence[Record]) -> str:
    """The reasons of everything that did not go as it should, and of what was not reached besides."""
    lines = []
    for record in records:
        result = outcome(record)
        if record["reason"]:
            lines.append(f"Design {_name(record)}, {result}: {record['reason']}")
        for experiment, reason in record.get("reasons", {}).items():
            lines.append(f"Design {_name(record)}, experiment {experiment}: {reason}")
        lines += [f"Design {_name(record)}: {sentence}" for sentence in record.get("other_failures", ())]
        if record.get("why_no_arm_law") and record["why_no_arm_law"] != SWITCHED_OFF:
            lines.append(f"Design {_name(record)}, no law of the arm: {record['why_no_arm_law']}")
        lines += [f"Design {_name(record)}, {name}: {text}" for name, text in record.get("broken", {}).items()]
        lines += [f"Design {_name(record)}: {name} needed more time than allowed" for name in record["slow"]]
    if not lines:
        return "Nothing else was missing."
    return "What was not reached, in the program's own words:\n\n" + "\n".join(_item(line) for line in lines)


def _item(line: str) -> str:
    return fill(line.rstrip(".") + ".", WIDTH, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False)


def _cell(text: str) -> str:
    return text.replace("|", "/")


def _checks(records: Sequence[Record]) -> str:
    rows = []
    for name, allowed in ALLOWED.items():
        found = [check for record in records for check in checks_in(record) if check.name == name]
        made = [check.value for check in found if check.made]
        numbers = [f"{median(made):.1e}", f"{max(made):.1e}"] if made else ["", ""]
        failed = sum(check.failed for check in found)
        rows.append([name, str(len(made)), *numbers, f"{allowed:g}", str(failed)])
    return table(["check", "designs", "median difference", "largest", "allowed", "failed"], rows)


def _unmade(records: Sequence[Record]) -> str:
    lines = [
        f"Design {_name(record)}, {check.name} at {check.pressure_kPa:g} kPa: {check.note}"
        for record in records
        for check in checks_in(record)
        if not check.made
    ]
    without = [_name(record) for record in records if not record["checks"]]
    if without:
        lines.append(f"Without checks: designs {', '.join(without)}")
    if not lines:
        return "Every check was made on every design."
    return "Not made:\n\n" + "\n".join(_item(line) for line in lines)


def _mesh(records: Sequence[Record]) -> str:
    measured = [record for record in records if record.get("finer", {}).get("errors")]
    lacking = [record for record in records if record.get("finer") and not record["finer"].get("errors")]
    if not measured:
        return "Not measured in this campaign."
    good = sum(bool(within_mesh_error(record)) for record in measured)
    head = ["seed and no.", "design", "elements", "size mm"]
    for name in NUMBERS.values():
        head += [f"{name}, measured", f"{name}, estimated"]
    rows = []
    for record in measured:
        errors = record["finer"]["errors"]
        row = [_name(record), record["words"], record["elements"], f"{record['size_mm']:g}"]
        for name in NUMBERS:
            entry = errors[name]
            estimated = entry["estimated"]
            row += [
                f"{100 * entry['error']:+.1f} ± {100 * entry['std']:.1f} %",
                "" if estimated is None else f"{100 * estimated:.1f} %",
            ]
        rows.append(row)
    text = (
        f"On a sample of {len(measured)} designs, chosen by their numbers before anything was solved, II and III were "
        "solved again at the lower pressure on a mesh with elements smaller by a factor of 1.5. The table has the "
        "error of the default mesh against the limit that both extrapolate to (the standard deviation covers orders "
        "of convergence from 1 to 2), and the error that the run itself has estimated from a coarser mesh. "
        f"{good} of {len(measured)} designs are within {100 * MESH_ERROR:g} % in all three numbers."
    )
    parts = [fill(text, WIDTH), table(head, rows)]
    if lacking:
        reasons = "\n".join(_item(f"Design {_name(r)}: {r['finer'].get('failure', '')}") for r in lacking)
        parts.append("Of the sample these could not be compared:\n\n" + reasons)
    return "\n\n".join(parts)
