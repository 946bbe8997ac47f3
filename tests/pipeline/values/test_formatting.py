"""Numbers are written alike wherever they stand."""

import pytest

from pipeline.show.tables import decimals_beside, decimals_of, fixed, interval, with_spread
from pipeline.values.formatting import duration, listed, number, percent


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (0.0, "0"), (1.23456789, "1.235"), (123456.0, "1.235e+05"), (3, "3"), (0.02, "0.02"), ("II", "II")],
)
def test_numbers_are_readable(value: object, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize(
    ("values", "spreads", "decimals"),
    [
        ([287.09, 448.17], [0.483, 0.775], 1),  # one digit of 0.5
        ([183.0], [23.6], 0),  # two digits of 24
        ([302.69], [0.0121], 1),  # no value has more than four digits
        ([0.0067, -0.0022], [0.52, 1.24], 1),
        ([0.0067], [0.0012], 4),
        ([7.0], [None], 3),
        ([7.0], [float("nan")], 3),
        ([], [], 2),
        ([0.0], [0.0], 2),
    ],
)
def test_the_deviation_decides_how_many_decimals(
    values: list[float], spreads: list[float | None], decimals: int
) -> None:
    assert decimals_of(values, spreads) == decimals


@pytest.mark.parametrize(
    ("value", "spread", "decimals", "text"),
    [
        (-0.0022, 1.37, 1, "0.0 ± 1.4"),  # a number that is rounded to zero has no sign
        (302.69, 0.0121, 1, "302.7 ± 0.1"),  # a deviation is never zero
        (302.69, None, 0, "303"),
        (302.69, 0.0, 0, "303"),
        (None, 1.0, 1, "-"),
        (float("nan"), 1.0, 1, "-"),
    ],
)
def test_a_number_with_its_deviation(value: float | None, spread: float | None, decimals: int, text: str) -> None:
    assert with_spread(value, spread, decimals) == text


def test_other_forms() -> None:
    assert fixed(-0.04, 1) == "0.0"
    assert fixed(-0.06, 1) == "-0.1"
    assert interval([-0.01, 2.345], 1) == "0.0 … 2.3"
    assert interval(None, 1) == ""
    assert [decimals_beside(spread, 1) for spread in (1234.0, 12.3, 0.01, None)] == [-1, 1, 1, 1]
    assert [percent(value) for value in (None, 0.000861, 0.0249, 1.236)] == ["-", "0.086 %", "2.5 %", "120 %"]
    assert [duration(value) for value in (0.26, 41.65)] == ["0.3 s", "42 s"]
    assert [listed(words) for words in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == ["", "a", "a and b", "a, b and c"]
