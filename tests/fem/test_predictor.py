"""The predictor: extrapolation from the last points of a path, and the start at rest."""

import numpy as np
import pytest

from fem import Fixed, Model, Pressure, StVenantKirchhoff
from fem.equations.state import State
from fem.kernels.element import internal_force
from fem.path.control import LoadControl
from fem.path.predictor import MAX_PREDICTOR_STRAIN, PathPoint, Predictor, extrapolate
from tests.bodies import hollow_box


def state(value: float) -> State:
    return State(value, *(np.full(3, value) for _ in range(4)))


def point(at: float, function: np.polynomial.Polynomial, rate: bool) -> PathPoint:
    return PathPoint(at, 1.0, state(function(at)), rate=state(function.deriv()(at)) if rate else None)


CUBIC = np.polynomial.Polynomial([0.3, -1.2, 0.7, 0.4])


@pytest.mark.parametrize(
    ("degree", "rates"), [(1, (False, False)), (1, (True, False)), (2, (False, True)), (3, (True, True))]
)
def test_polynomials_are_extrapolated_exactly(degree: int, rates: tuple[bool, bool]) -> None:
    function = np.polynomial.Polynomial(CUBIC.coef[: degree + 1])
    extrapolated = extrapolate(point(1.0, function, rates[0]), point(3.0, function, rates[1]), 6.5)
    assert extrapolated is not None
    for values in (
        extrapolated.factor,
        extrapolated.displacement,
        extrapolated.pressure,
        extrapolated.strain,
        extrapolated.stress,
    ):
        np.testing.assert_allclose(values, function(6.5), rtol=1e-12)


def test_a_single_point_is_extrapolated_along_its_rate() -> None:
    function = np.polynomial.Polynomial([2.0, 3.0])
    extrapolated = extrapolate(None, point(1.0, function, True), 1.5)
    assert extrapolated is not None
    np.testing.assert_allclose(extrapolated.displacement, function(1.5))
    assert extrapolate(None, point(1.0, function, False), 1.5) is None


@pytest.mark.parametrize("formulation", ["p2p0", "mixed"])
def test_the_first_start_strains_little_under_a_stress_that_balances_the_whole_load(formulation: str) -> None:
    law, supports = StVenantKirchhoff(1.2, 0.49), [Fixed("clamp"), Fixed("sym", "z")]
    model = Model(hollow_box(half=True, parts=2), law, supports, [Pressure("cavity", 1.0)], formulation)
    system = model.system()
    rest = PathPoint(0.0, 0.0, system.rest_state(), terms=system.terms)
    control = LoadControl.of(system)
    balanced, last = Predictor(rest, control).starts([rest], control.target(1.0, 1.0), system.terms)
    assert balanced.trial
    assert not last.trial
    start = balanced.state
    np.testing.assert_array_equal(last.state.displacement, start.displacement)
    assert last.state.factor < start.factor == 1.0
    assert np.abs(start.strain).max() == pytest.approx(MAX_PREDICTOR_STRAIN)
    assert np.abs(start.stress).max() > 2 * np.abs(law.shear_modulus * start.strain).max()
    loads = system.loads(np.zeros_like(start.displacement), 1.0, system.terms)
    forces, space = np.zeros_like(loads), system.space
    internal_force(space.arrays, np.zeros_like(loads), start.stress, forces)
    assert np.linalg.norm(system.constraints.reduce(forces + loads)) < 1e-9 * np.linalg.norm(
        system.constraints.reduce(loads)
    )
