"""The part of docs/unseen.md on designs that did not end and were run again with later sources (`again.py`)."""

from collections.abc import Sequence
from textwrap import fill

from benchmarks.peers.page import table
from benchmarks.unseen.details import five_at
from benchmarks.unseen.sorting import States, did_not_end, has_numbers, outcome, rod_errors, states_of
from benchmarks.unseen.summary import LAST_SEEDS
from benchmarks.unseen.wording import WIDTH, Record, name_of, percent, share
from benchmarks.unseen.work import LIMIT


def again(records: Sequence[Record], second: Sequence[Record]) -> str:
    """What became of them, and what the campaigns would be with their second records in the place of the first."""
    missing = [record for record in records if did_not_end(record)]
    if not second:
        return f"None of the {len(missing)} designs that did not end has been run again."
    in_time = sum(_seconds(record) <= LIMIT for record in second)
    head = ["seed and no.", "design", "outcome", "states", "five parameters", "own law", "shape error", "force error"]
    rows = [_row(record) for record in second]
    text = (
        f"{len(second)} of the {len(missing)} designs that were too slow or met an error of the program have been run "
        f"again with later sources, each stage with ten times the CPU time. "
        f"{sum(map(has_numbers, second))} of them have numbers, {in_time} after at most {LIMIT:g} s. "
        "Nothing else on this page counts them. "
    )
    return "\n\n".join(
        [fill(text + _with_second(records, second), WIDTH), table([*head, "CPU time of the run s", "sources"], rows)]
    )


def _seconds(record: Record) -> float:
    return float(record["seconds"].get("run", 0.0))


def _row(record: Record) -> list[str]:
    states, errors = states_of(record), rod_errors([record])
    return [
        name_of(record),
        record["words"],
        outcome(record),
        f"{states.solved} of {states.all}",
        five_at(record),
        "yes" if record.get("has_arm_law") else "no",
        *(percent(errors[name][0]) if errors[name] else "" for name in ("shape", "force")),
        f"{_seconds(record):.0f}",
        record["sources"],
    ]


def _with_second(records: Sequence[Record], second: Sequence[Record]) -> str:
    """The shares of states and numbers with the second records in the place of the first."""
    by_name = {name_of(record): record for record in second}
    order = list(dict.fromkeys(record["seed"] for record in records))
    parts = []
    for words, seeds in ((f"the last {LAST_SEEDS} seeds", order[-LAST_SEEDS:]), ("all seeds", order)):
        of_seeds = [by_name.get(name_of(r), r) for r in records if r["seed"] in seeds]
        good = sum((states_of(record) for record in of_seeds), States(0, 0, 0, 0)).good
        numbers = sum(map(has_numbers, of_seeds))
        parts.append(
            f"{share(good)} of the states of {words} would be solved or beyond a confirmed limit, and {numbers} of "
            f"{len(of_seeds)} designs would have numbers"
        )
    return f"With them in the place of the first records {'; '.join(parts)}."
