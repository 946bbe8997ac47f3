"""The outcome of a design in one word, and the sums over all designs, from their records alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.unseen.checks import Check
from benchmarks.unseen.confirm import names_a_limit
from benchmarks.unseen.work import ERROR, FAILED, REFUSED, SLOW

Record = Mapping[str, Any]

SOLVED, LIMIT, EARLY = "solved", "named limit", "refused early"
WRONG, NO_LIMIT, TOO_SLOW, TRACEBACK = "wrong", "stopped without a limit", "too slow", "error of the program"
#: all outcomes, the good ones first
OUTCOMES = (SOLVED, LIMIT, EARLY, NO_LIMIT, TOO_SLOW, TRACEBACK, WRONG)
#: largest error of the default mesh that is allowed, in parts of the number
MESH_ERROR = 0.03


def checks_in(record: Record) -> tuple[Check, ...]:
    """The checks of a design."""
    return tuple(Check(**row) for row in record["checks"])


def outcome(record: Record) -> str:
    """One of OUTCOMES. A check that fails counts more than anything else."""
    if any(check.failed for check in checks_in(record)):
        return WRONG
    if record.get("broken") or record["ended"] == ERROR:
        return TRACEBACK
    if record["ended"] == SLOW:
        return TOO_SLOW
    if record["ended"] in (REFUSED, FAILED):
        return EARLY if record["ended"] == REFUSED else NO_LIMIT
    if not record["reasons"]:
        return SOLVED
    return LIMIT if all(map(names_a_limit, record["reasons"].values())) else NO_LIMIT


@dataclass(frozen=True)
class States:
    """How many states the configurations have, and what became of them."""

    solved: int
    beyond: int  #: a limit that a second way confirms
    not_confirmed: int  #: beyond a named limit, or without one
    not_tried: int  #: of designs that were too slow or failed with an error

    @property
    def all(self) -> int:
        """All states."""
        return self.solved + self.beyond + self.not_confirmed + self.not_tried

    @property
    def good(self) -> float:
        """The part that is solved, or beyond a limit that is confirmed."""
        return (self.solved + self.beyond) / self.all if self.all else 1.0

    def __add__(self, other: "States") -> "States":
        return States(
            self.solved + other.solved,
            self.beyond + other.beyond,
            self.not_confirmed + other.not_confirmed,
            self.not_tried + other.not_tried,
        )


def states_of(record: Record) -> States:
    """The states I, II and III of a design. Those of one that is refused early do not count.

    A state counts as beyond a confirmed limit where its pressure is above the limit that was confirmed, or where its
    own experiment ended there. Limits of I and III are up to a fifth below that of II (studies/solver.md), so a state
    of theirs counts from 0.8 of it on.
    """
    result = outcome(record)
    if result == EARLY:
        return States(0, 0, 0, 0)
    rows = record["states"]
    if not rows:
        return States(0, 0, 0, 3 * len(record["pressures_kPa"]))
    if result == WRONG:
        return States(0, 0, len(rows), 0)
    reached = sum(row["reached"] for row in rows)
    missed = [row for row in rows if not row["reached"]]
    beyond = sum(any(_covers(limit, row) for limit in record["limits"]) for row in missed)
    return States(reached, beyond, len(missed) - beyond, 0)


def states_of_all(records: Sequence[Record]) -> States:
    """The sum of the states of designs."""
    return sum((states_of(record) for record in records), States(0, 0, 0, 0))


def _covers(limit: Mapping[str, Any], state: Mapping[str, Any]) -> bool:
    """Whether a confirmed limit explains that a state was not reached."""
    if not limit["confirmed"]:
        return False
    if limit["experiment"] == state["experiment"]:
        return True
    return bool(state["pressure_kPa"] >= 0.8 * limit["limit_kPa"] > 0.0)


def has_numbers(record: Record) -> bool:
    """Whether a design ended with five parameters or the arm's own law, or was refused early."""
    return bool(outcome(record) == EARLY or record.get("five_at_kPa") or record.get("has_arm_law"))


def within_mesh_error(record: Record) -> bool | None:
    """Whether kappa_0, alpha2 and F are within 3 % of the limit of the mesh; None where that was not measured."""
    errors = record.get("finer", {}).get("errors")
    return None if errors is None else all(abs(entry["error"]) <= MESH_ERROR for entry in errors.values())


def rod_errors(records: Sequence[Record]) -> dict[str, list[float]]:
    """The largest errors of the rod to take by design: of the shape over the length, and of the end force."""
    errors: dict[str, list[float]] = {"shape": [], "force": []}
    for record in records:
        rod = record.get("rod")
        for name, key in (("shape", "distance_over_length"), ("force", "force_error")):
            values = [rod[f"{key}_{sample}"] for sample in ("in_sample", "out_of_sample")] if rod else []
            known = [abs(value) for value in values if value is not None]
            if known:
                errors[name].append(max(known))
    return errors
