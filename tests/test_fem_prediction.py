"""Where a path leads from its last places."""

import numpy as np
import pytest

from fem.prediction import FAR, Place, predicted
from fem.system import State


def state(value: float) -> State:
    return State(value, *(np.full(3, value) for _ in range(4)))


def place(at: float, function: np.polynomial.Polynomial, rate: bool) -> Place:
    return Place(at, 1.0, state(function(at)), rate=state(function.deriv()(at)) if rate else None)


CUBIC = np.polynomial.Polynomial([0.3, -1.2, 0.7, 0.4])


@pytest.mark.parametrize(
    ("degree", "rates"), [(1, (False, False)), (1, (True, False)), (2, (False, True)), (3, (True, True))]
)
def test_polynomials_are_foretold_exactly(degree: int, rates: tuple[bool, bool]) -> None:
    function = np.polynomial.Polynomial(CUBIC.coef[: degree + 1])
    found = predicted(place(1.0, function, rates[0]), place(3.0, function, rates[1]), 6.5)
    assert found is not None
    for values in (found.factor, found.displacement, found.pressure, found.strain, found.stress):
        np.testing.assert_allclose(values, function(6.5), rtol=1e-12)


def test_one_place_leads_along_its_rate() -> None:
    function = np.polynomial.Polynomial([2.0, 3.0])
    found = predicted(None, place(1.0, function, True), 1.5)
    assert found is not None
    np.testing.assert_allclose(found.displacement, function(1.5))
    assert predicted(None, place(1.0, function, False), 1.5) is None


def test_far_ahead_a_parabola_is_taken() -> None:
    value = 3.0 + 2.0 * (FAR + 0.5)
    cubic = predicted(place(1.0, CUBIC, True), place(3.0, CUBIC, True), value)
    parabola = predicted(place(1.0, CUBIC, False), place(3.0, CUBIC, True), value)
    assert cubic is not None
    assert parabola is not None
    np.testing.assert_array_equal(cubic.displacement, parabola.displacement)
