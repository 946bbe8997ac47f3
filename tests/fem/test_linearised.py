"""A factorized tangent is a value: it solves while its factor exists and refuses afterwards."""

from collections.abc import Callable

import numpy as np
import pytest

from fem import Fixed, Model, NewtonOptions, Pressure, StVenantKirchhoff
from fem.effects.effect import Terms
from fem.equations.linear import LinearSolver, SuperLU
from fem.equations.linearised import Linearised, StaleFactorization
from fem.equations.pardiso import Pardiso, available_solver
from fem.equations.state import State
from fem.equations.system import System
from fem.path import newton
from fem.path.control import LoadControl
from fem.path.diagnosis import near_limit_point
from fem.path.modes import falling_mode
from fem.path.newton import Converged, Start
from fem.path.predictor import PathPoint
from geometry.arrays import Array
from tests.bodies import box, hollow_box

LAW = StVenantKirchhoff(E=1.0, nu=0.3)
SOLVERS = [pytest.param(Pardiso, marks=pytest.mark.skipif(available_solver() is not Pardiso, reason="none")), SuperLU]


def bar(solver: Callable[[], LinearSolver]) -> System:
    return Model(box((2, 1, 1), (2.0, 1.0, 1.0)), LAW, [Fixed("left")], []).system(solver)


def at_rest(system: System) -> Linearised:
    rest = system.rest_state()
    return system.linearise(rest, system.assemble(rest, ()), ())


def force(system: System) -> Array:
    return np.random.default_rng(3).normal(size=system.space.points.shape)


@pytest.mark.parametrize("solver", SOLVERS)
def test_it_solves_as_often_as_needed(solver: Callable[[], LinearSolver]) -> None:
    system = bar(solver)
    linearised, load = at_rest(system), force(system)
    change = linearised.solve(load)
    np.testing.assert_array_equal(linearised.solve(load).displacement, change.displacement)
    np.testing.assert_array_equal(change.displacement[system.constraints.constrained], 0.0)
    rest = system.rest_state()
    _, product = system.tangent(rest, system.assemble(rest, ()), (), change.displacement, convex=False)
    np.testing.assert_allclose(
        system.constraints.reduce(product.displacement), -system.constraints.reduce(load), atol=1e-10
    )


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("event", ["linearised again", "sparsity pattern analysed again", "solver closed"])
def test_a_factorization_that_was_overwritten_refuses(solver: Callable[[], LinearSolver], event: str) -> None:
    system = bar(solver)
    first = at_rest(system)
    if event == "linearised again":
        at_rest(system).solve(force(system))
    elif event == "sparsity pattern analysed again":
        system.solver.analyse(system.storage.pattern.indptr, system.storage.pattern.indices)
    else:
        system.solver.close()
    with pytest.raises(StaleFactorization, match="factorized again"):
        first.solve(force(system))
    assert first.negative_pivots == 0


def equilibrium(control: LoadControl, start: State, options: NewtonOptions) -> Converged:
    return newton.solve(Start(start, control.system.terms), control, options, lambda *arguments: None)


def near_limit(system: System, state: State, terms: Terms) -> str:
    return near_limit_point(system, PathPoint(1.0, 1.0, state, terms=terms))


def test_the_analysis_of_instability_leaves_no_usable_factor_behind() -> None:
    """`falling_mode` and `near_limit_point` factorize; what Newton returned before must not solve with theirs."""
    model = Model(hollow_box(half=True), LAW, [Fixed("clamp"), Fixed("sym", "z")], [Pressure("cavity", 0.05)])
    for analysis in (falling_mode, near_limit):
        system = model.system()
        converged = equilibrium(LoadControl.of(system).target(1.0, 1.0), system.rest_state(), NewtonOptions())
        assert converged.linearised is not None
        converged.linearised.solve(force(system))
        analysis(system, converged.state, system.terms)
        with pytest.raises(StaleFactorization):
            converged.linearised.solve(force(system))


def test_the_rate_of_a_path_uses_the_last_tangent_of_newton() -> None:
    model = Model(hollow_box(half=True), LAW, [Fixed("clamp"), Fixed("sym", "z")], [Pressure("cavity", 0.05)])
    system = model.system()
    control = LoadControl.of(system).target(1.0, 1.0)
    options = NewtonOptions(tolerance=1e-9)
    converged = equilibrium(control, system.rest_state(), options)
    assert converged.linearised is not None
    assert converged.negative_pivots == converged.linearised.negative_pivots == 0
    before = system.solver.times.factorizations
    rate = control.rate(converged.state, converged.assembly, converged.linearised, system.terms)
    assert rate is not None
    assert system.solver.times.factorizations == before
    ahead = equilibrium(control.target(1.001, 1.0), converged.state, options)
    difference = (ahead.state.displacement - converged.state.displacement) / 0.001
    np.testing.assert_allclose(rate.displacement, difference, atol=0.01 * np.abs(difference).max())
