"""The parts of docs/unseen_designs.md: every design with its limits, and what was not reached."""

from collections.abc import Sequence
from math import degrees

from benchmarks.peers.page import table
from benchmarks.unseen.sentences import names_the_pressure
from benchmarks.unseen.sorting import checks_in, limits_in, outcome, rod_errors, states_of
from benchmarks.unseen.wording import Record, item, name_of, percent

#: why there is no law of the arm where a configuration asks for the five parameters alone
SWITCHED_OFF = "switched off in the config"
#: what a table says of the rod of a design
ROD_HEAD = ("five parameters", "own law", "shape error", "force error")


def designs_table(records: Sequence[Record]) -> str:
    """A row for each design."""
    head = [
        "seed and no.",
        "design",
        "p V/(E V)",
        "elements",
        "unknowns",
        "outcome",
        "states",
        "κ₀(l/2) l at the lower pressure, degrees",
    ]
    head += [*ROD_HEAD, "CPU s"]
    return table(head, [_row(record) for record in records])


def _row(record: Record) -> list[str]:
    states = states_of(record)
    turn = record.get("turn_rad")
    return [
        name_of(record),
        record["words"],
        f"{record['load']:.4f}",
        record.get("elements", ""),
        str(record.get("unknowns", "")),
        outcome(record),
        f"{states.solved} of {states.all}" if states.all else "",
        "" if turn is None else f"{degrees(turn):.1f}",
        *rod_cells(record),
        f"{sum(record['seconds'].values()):.0f}",
    ]


def rod_cells(record: Record) -> list[str]:
    """What there is of the rod, and its errors: the cells of ROD_HEAD."""
    errors = rod_errors([record])
    return [
        _five(record),
        "yes" if record.get("has_arm_law") else "no",
        *(percent(errors[name][0]) if errors[name] else "" for name in ("shape", "force")),
    ]


def _five(record: Record) -> str:
    """At how many pressures there are five parameters; at others than those of the design where it bears none."""
    at, drawn = record.get("five_at_kPa", ()), record["pressures_kPa"]
    below = sum(pressure not in drawn for pressure in at)
    return f"{below} below the limit" if below else f"{len(at)} of {len(drawn)} pressures"


def limits(records: Sequence[Record]) -> str:
    """A row for each end that was checked: the limit that the run names, or the pressure at which its path ends."""
    rows = [
        [
            name_of(record),
            limit["experiment"],
            _end(record, limit),
            "yes" if limit["confirmed"] else "**no**",
            _cell(limit["sentence"]),
        ]
        for record in records
        for limit in limits_in(record)
    ]
    if not rows:
        return "No design met a limit."
    return table(["seed and no.", "experiment", "limit kPa", "confirmed", "by"], rows)


def _end(record: Record, limit: Record) -> str:
    if not limit["limit_kPa"]:
        return "passes through itself"
    pressure = f"{limit['limit_kPa']:.4g}"
    return pressure if names_the_pressure(record["reasons"][limit["experiment"]]) else f"path ends at {pressure}"


def other(records: Sequence[Record]) -> str:
    """The reasons of everything that did not go as it should, and of what was not reached besides."""
    lines = []
    for record in records:
        result = outcome(record)
        if record["reason"]:
            lines.append(f"Design {name_of(record)}, {result}: {record['reason']}")
        for experiment, reason in record.get("reasons", {}).items():
            lines.append(f"Design {name_of(record)}, experiment {experiment}: {reason}")
        lines += [f"Design {name_of(record)}: {sentence}" for sentence in record.get("other_failures", ())]
        if record.get("why_no_arm_law") and record["why_no_arm_law"] != SWITCHED_OFF:
            lines.append(f"Design {name_of(record)}, no law of the arm: {record['why_no_arm_law']}")
        lines += [f"Design {name_of(record)}, {name}: {text}" for name, text in record.get("broken", {}).items()]
        lines += [f"Design {name_of(record)}: {name} needed more time than allowed" for name in record["slow"]]
    if not lines:
        return "Nothing else was missing."
    return "What was not reached, in the program's own words:\n\n" + "\n".join(item(line) for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", "/")


def unmade(records: Sequence[Record]) -> str:
    """The checks that could not be made, with the reason."""
    lines = [
        f"Design {name_of(record)}, {check.name} at {check.pressure_kPa:g} kPa: {check.note}"
        for record in records
        for check in checks_in(record)
        if not check.made
    ]
    without = [name_of(record) for record in records if not record["checks"]]
    if without:
        lines.append(f"Without checks: designs {', '.join(without)}")
    if not lines:
        return "Every check was made on every design."
    return "Not made:\n\n" + "\n".join(item(line) for line in lines)
