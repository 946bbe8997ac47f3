"""Hard cases end as expected: solved in agreement with their checks, or with a reason that names the limit.

`make hard` solves them all and writes the table of studies/hard_cases.md.
"""

import pytest

from benchmarks.markdown import made
from tests.hard_cases.cases import read_cases
from tests.hard_cases.solve import line_of

CASES = {case.name: case for case in read_cases()}

#: of every kind one that takes a second
QUICK = ("one chamber", "nu = 0", "nu = 0.5", "pressure off", "contact lost on unloading")


def test_the_table_is_a_table() -> None:
    assert len(CASES) == len(read_cases()) >= 40
    assert sum(bool(case.limit) for case in CASES.values()) >= 5


def test_every_case_stands_in_the_page() -> None:
    [written] = [block.text for block in made() if block.command == "make hard"]
    assert [name for name in CASES if f"| {name} |" not in written] == []
    assert "not as expected**" not in written


@pytest.mark.parametrize("name", QUICK)
def test_quick_cases(name: str) -> None:
    line = line_of(CASES[name])
    assert line.as_expected, line


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CASES if name not in QUICK])
def test_all_others(name: str) -> None:
    line = line_of(CASES[name])
    assert line.as_expected, line
