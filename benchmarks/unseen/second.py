"""The part of docs/unseen.md on designs that did not end and were run again with later sources (`again.py`)."""

from collections.abc import Sequence
from textwrap import fill

from benchmarks.peers.page import table
from benchmarks.unseen.details import ROD_HEAD, rod_cells
from benchmarks.unseen.sorting import did_not_end, has_numbers, outcome, run_seconds, states_of, states_of_all
from benchmarks.unseen.summary import LAST_SEEDS, of_last_seeds
from benchmarks.unseen.wording import WIDTH, Record, name_of, share
from benchmarks.unseen.work import LIMIT


def again(records: Sequence[Record], second: Sequence[Record]) -> str:
    """What became of them, and what the campaigns would be with their second records in the place of the first."""
    missing = [record for record in records if did_not_end(record)]
    if not second:
        return f"None of the {len(missing)} designs that did not end has been run again."
    in_time = sum(run_seconds(record) <= LIMIT for record in second)
    head = ["seed and no.", "design", "outcome", "states", *ROD_HEAD, "CPU time of the run s", "sources"]
    rows = [_row(record) for record in second]
    text = (
        f"{len(second)} of the {len(missing)} designs that were too slow or met an error of the program have been run "
        f"again with later sources, each stage with ten times the CPU time. "
        f"{sum(map(has_numbers, second))} of them have numbers, {in_time} after at most {LIMIT:g} s. "
        "Nothing else on this page counts them. "
    )
    return "\n\n".join([fill(text + _with_second(records, second), WIDTH), table(head, rows)])


def _row(record: Record) -> list[str]:
    states = states_of(record)
    return [
        name_of(record),
        record["words"],
        outcome(record),
        f"{states.solved} of {states.all}",
        *rod_cells(record),
        f"{run_seconds(record):.0f}",
        record["sources"],
    ]


def _with_second(records: Sequence[Record], second: Sequence[Record]) -> str:
    """The shares of states and numbers with the second records in the place of the first."""
    by_name = {name_of(record): record for record in second}
    latest = [by_name.get(name_of(record), record) for record in records]
    parts = [
        f"{share(states_of_all(some).good)} of the states of {words} would be solved or beyond a confirmed limit, and "
        f"{sum(map(has_numbers, some))} of {len(some)} designs would have numbers"
        for words, some in ((f"the last {LAST_SEEDS} seeds", of_last_seeds(latest)), ("all seeds", latest))
    ]
    return f"With them in the place of the first records {'; '.join(parts)}."
