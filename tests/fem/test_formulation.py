"""The mixed formulation: its derivatives, its inertia, its pressure, and its agreement with p2p0."""

from dataclasses import replace

import numpy as np
import pytest

from fem import (
    Fixed,
    Hencky,
    Material,
    Model,
    MooneyRivlin,
    NeoHooke,
    Prescribed,
    Pressure,
    StVenantKirchhoff,
    element_fields,
    follow,
)
from fem.equations.linear import SuperLU
from fem.equations.pardiso import Pardiso
from fem.equations.state import State
from fem.equations.system import System
from geometry.arrays import Array
from tests.bodies import box, difference, hollow_box
from tests.fem.test_kernels import dense, noise

LAWS = [StVenantKirchhoff(1.2, 0.495), Hencky(1.2, 0.495), NeoHooke(0.4, 40.0), MooneyRivlin(0.15, 0.05, 40.0)]
NAMES = [type(law).__name__ for law in LAWS]


def system_of(law: Material, supports: list[Fixed]) -> System:
    return Model(box((2, 2, 1), (1.0, 1.5, 0.7)), law, supports, [], "mixed").system(SuperLU)


def state_with_pressure(system: System, u: Array, pressure: Array) -> State:
    """A state whose pressure is not that of its displacement; the strain carried is that of the displacement."""
    state = system.state_at(u, 1.0)
    return replace(state, pressure=pressure, stress=system.formulation.evaluate(state.strain, pressure).stress)


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_force_is_the_derivative_of_the_energy(law: Material) -> None:
    """The pressure of a displacement makes the energy stationary, so its change does not contribute."""
    system = system_of(law, [])
    u, du = noise(system, 0.01), noise(system, 1.0)[::-1]
    slope = difference(lambda v: np.float64(system.energy(v, 1.0, ())), u, du, 1e-4)
    assembly = system.assemble(system.state_at(u, 1.0), ())
    assert np.vdot(assembly.gradient, du) == pytest.approx(slope, rel=1e-7)
    assert np.abs(assembly.pressure_residual).max() < 1e-12 * np.abs(assembly.stress).max()


@pytest.mark.parametrize("supports", [[], [Fixed("left"), Fixed("back", "z")]])
@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_tangent_is_the_derivative_of_force_and_pressure_residual(law: Material, supports: list[Fixed]) -> None:
    system = system_of(law, supports)
    generator = np.random.default_rng(5)
    u, pressure = noise(system, 0.01), generator.normal(scale=0.2, size=system.formulation.unknowns)
    du, dp = (
        np.where(system.constraints.constrained, 0.0, noise(system, 1.0)[::-1]),
        generator.normal(size=pressure.shape),
    )

    def residual(t: Array) -> Array:
        assembly = system.assemble(state_with_pressure(system, u + t * du, pressure + t * dp), ())
        return np.concatenate([system.constraints.reduce(assembly.gradient), assembly.pressure_residual])

    state = state_with_pressure(system, u, pressure)
    data, _ = system.tangent(state, system.assemble(state, ()), (), np.zeros_like(u), convex=False)
    product = dense(system, data) @ np.concatenate([system.constraints.reduce(du), dp])
    expected = difference(residual, np.float64(0.0), np.float64(1.0), 1e-4)
    np.testing.assert_allclose(product, expected, atol=1e-6 * np.abs(expected).max())


def test_tangent_times_an_increment_of_the_supports() -> None:
    free, clamped = system_of(LAWS[0], []), system_of(LAWS[0], [Fixed("left"), Fixed("back", "z")])
    u, pressure = noise(free, 0.03), np.full(free.formulation.unknowns, 0.3)
    increment = np.where(clamped.constraints.constrained, noise(free, 1.0), 0.0)
    state = state_with_pressure(free, u, pressure)
    data, _ = free.tangent(state, free.assemble(state, ()), (), np.zeros_like(u), convex=False)
    product = dense(free, data) @ np.concatenate([increment.ravel(), np.zeros(free.formulation.unknowns)])
    _, coupling = clamped.tangent(state, clamped.assemble(state, ()), (), increment, convex=False)
    np.testing.assert_allclose(coupling.displacement.ravel(), product[: increment.size], atol=1e-11)
    np.testing.assert_allclose(coupling.pressure, product[increment.size :], atol=1e-11)


@pytest.mark.parametrize("solver", [Pardiso, SuperLU])
def test_a_stable_body_has_one_negative_pivot_per_pressure_unknown(solver) -> None:
    model = Model(hollow_box(half=True), LAWS[0], [Fixed("clamp"), Fixed("sym", "z")], [], "mixed")
    system = model.system(solver)
    state = system.rest_state()
    linearised = system.linearise(state, system.assemble(state, ()), ())
    assert system.solver.negative_pivots == system.formulation.unknowns > 0
    assert linearised.negative_pivots == 0


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_mixed_and_p2p0_agree_on_an_inflated_cavity(law: Material) -> None:
    """Pressure of a twelfth of E: the growth of the cavity agrees, on the finer mesh more closely."""
    differences = []
    for parts in (1, 2):
        mesh = hollow_box(half=True, parts=parts)
        volumes = []
        for formulation in ("p2p0", "mixed"):
            supports = [Fixed("clamp"), Fixed("sym", "z")]
            step = follow(Model(mesh, law, supports, [Pressure("cavity", 0.1)], formulation), [1.0]).steps[0]
            volumes.append(step.cavity_volume("cavity") - 0.5)
            assert step.negative_pivots == 0
        differences.append(abs(volumes[1] / volumes[0] - 1))
    assert differences[1] < 0.6 * differences[0]
    assert differences[1] < 0.05


@pytest.mark.parametrize("nu", [0.495, 0.4999])
def test_bending_does_not_lock(nu: float) -> None:
    """A thin strip, its end lifted: the force hardly grows with nu (2 %), whereas p2 stiffens (16 and 21 %)."""
    mesh = box((6, 1, 1), (12.0, 1.0, 1.0))
    forces = {}
    for formulation in ("p2", "mixed"):
        for bulk in (0.45, nu):
            law = StVenantKirchhoff(1.2, bulk)
            model = Model(mesh, law, [Fixed("left"), Prescribed("right", "y", 0.5)], [], formulation)
            forces[formulation, bulk] = follow(model, [1.0]).steps[0].reaction("right")[1]
    growth = {formulation: forces[formulation, nu] / forces[formulation, 0.45] for formulation in ("p2", "mixed")}
    assert abs(growth["mixed"] - 1) < 0.03
    assert growth["p2"] > 1.15


def test_uniform_compression_has_a_uniform_pressure() -> None:
    law = StVenantKirchhoff(1.2, 0.4999)
    supports = [Fixed("left", "x"), Fixed("bottom", "y"), Fixed("back", "z"), Fixed("front", "z"), Fixed("top", "y")]
    model = Model(box((3, 2, 2), (3.0, 2.0, 2.0)), law, [*supports, Prescribed("right", "x", -0.03)], [], "mixed")
    step = follow(model, [1.0]).steps[0]
    strain = 0.5 * (0.99**2 - 1)
    stress = element_fields(step, law)["cauchy_stress_MPa"]
    np.testing.assert_allclose(stress[:, 1], law.lame[0] * strain / 0.99, rtol=1e-6)
    np.testing.assert_allclose(stress[:, 0], (law.lame[0] + 2 * law.lame[1]) * strain * 0.99, rtol=1e-6)
