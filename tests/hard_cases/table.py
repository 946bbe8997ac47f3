"""The table of studies/hard_cases.md."""

from collections.abc import Sequence

from benchmarks.markdown import write_made
from tests.hard_cases.solve import Line

COLUMNS = (
    *("case", "expected", "outcome", "checked against", "difference", "allowed", "load increments", "cutbacks"),
    *("factorizations", "min J", "stretches"),
)


def table(lines: Sequence[Line]) -> str:
    """Markdown."""
    rows = [COLUMNS, ["---"] * len(COLUMNS), *(_row(line) for line in lines)]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def summary(lines: Sequence[Line]) -> str:
    """What all of them did."""
    solved = [line for line in lines if not line.case.limit]
    wrong = [line.case.name for line in lines if not line.as_expected]
    return (
        f"{len(lines)} cases: {len(solved)} to be solved, {len(lines) - len(solved)} that meet a limit; "
        f"{len(wrong)} did not end as expected{': ' * bool(wrong)}{', '.join(wrong)}."
    )


def write_table(lines: Sequence[Line]) -> None:
    """Put the table and its summary between the marks of the page."""
    write_made("make hard", f"{summary(lines)}\n\n{table(lines)}")


def _row(line: Line) -> list[str]:
    case, check = line.case, line.case.check
    expected = "solved" if check else f"“{case.limit}”"
    compared = (
        ["", "", ""] if check is None else [f"{check.against} ({check.of})", f"{line.error:.1e}", f"{check.within:g}"]
    )
    begin, limit, rest = _sentence(line.reason).partition(case.limit or "\n")
    outcome = f"{begin}{limit}{' …' * bool(rest)}" if line.reason else "solved"
    if not line.as_expected:
        outcome = f"**not as expected**: {outcome}"
    is_body = bool(line.steps and not case.rod)
    stretches = f"{line.min_stretch:.3f} to {line.max_stretch:.3f}" if is_body else ""
    counts = [str(line.steps), *([str(line.cutbacks), str(line.factorizations)] if not case.rod else ["", ""])]
    return [case.name, expected, outcome, *compared, *counts, f"{line.min_J:.3f}" if is_body else "", stretches]


def _sentence(reason: str) -> str:
    """The reason without the folder of the configuration that it may begin with."""
    return reason.rpartition("configs/")[2].replace("|", "/")
