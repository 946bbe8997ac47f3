"""The assembled tangent of every law, formulation and effect against finite differences, and Newton's convergence."""

from itertools import pairwise

import numpy as np
import pytest

import fem
from fem.elements import ELEMENTS
from fem.equations.linear import SuperLU
from fem.equations.system import System
from geometry import Mesh
from geometry.arrays import Array
from tests.bodies import difference, fork, hollow_box
from tests.laws import LAWS


def layer(mesh: Mesh) -> fem.StrainLimitingLayer:
    return fem.StrainLimitingLayer(mesh.plane(1, 1.0), thickness=0.05, E=20.0, nu=0.3)


def loaded_box(law: str, formulation: str) -> System:
    """A closed cavity under pressure in a heavy box with a layer; nothing holds it."""
    mesh = hollow_box(half=False)
    effects = [fem.Pressure("cavity", 0.2), fem.Gravity(1.13e-5), layer(mesh)]
    return fem.Model(mesh, LAWS[law], [], effects, formulation).system(SuperLU)


def force(system: System, u: Array) -> Array:
    return system.assemble(system.state_at(u, 1.0), system.terms).gradient


def upper_triangle_times(system: System, data: Array, du: Array) -> Array:
    """K du (n, 3) of a system without supports from the values of the upper triangle of its matrix."""
    pattern = system.storage.pattern
    rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
    product = np.zeros(pattern.size)
    np.add.at(product, rows, data * du.ravel()[pattern.indices])
    off = rows != pattern.indices
    np.add.at(product, pattern.indices[off], data[off] * du.ravel()[rows[off]])
    return product.reshape(du.shape)


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "p1"])
@pytest.mark.parametrize("law", LAWS)
def test_force_and_tangent_are_derivatives(law: str, formulation: str) -> None:
    system = loaded_box(law, formulation)
    generator = np.random.default_rng(7)
    u, du = (generator.normal(scale=size, size=system.space.points.shape) for size in (0.02, 1.0))
    slope = difference(lambda v: np.float64(system.energy(v, 1.0, system.terms)), u, du, 1e-4)
    assert np.vdot(force(system, u), du) == pytest.approx(slope, rel=1e-7)
    state = system.state_at(u, 1.0)
    assembly = system.assemble(state, system.terms)
    data, coupling = system.tangent(state, assembly, system.terms, du, convex=False)
    change = difference(lambda v: force(system, v), u, du, 1e-4)
    tolerance = 1e-7 * np.abs(change).max()
    np.testing.assert_allclose(coupling.displacement, change, atol=tolerance)
    np.testing.assert_allclose(upper_triangle_times(system, data, du), change, atol=tolerance)


def orders(model: fem.Model) -> list[float]:
    """How many times as many digits each of the last iterations has: 2 where Newton is quadratic, 1 where it creeps."""
    seen: list[float] = []

    def watch(factor: float, iteration: int, residual: float) -> None:
        if iteration == 0:
            seen.clear()
        seen.append(residual)

    fem.follow(model, [1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-11)), fem.PathObserver(watch))
    near = [residual for residual in seen if 1e-12 < residual < 0.02]
    return [float(np.log(after) / np.log(before)) for before, after in pairwise(near)]


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_newton_ends_quadratically(law: str, formulation: str) -> None:
    """With a tangent that is wrong anywhere the order would be 1. Measured: 1.97 to 2.6."""
    mesh = hollow_box(half=False)
    effects = [fem.Pressure("cavity", 0.1), fem.Gravity(1e-6), layer(mesh)]
    rates = orders(fem.Model(mesh, LAWS[law], [fem.Fixed("clamp")], effects, formulation))
    assert rates
    assert min(rates) > 1.8


@pytest.mark.parametrize("formulation", ELEMENTS)
def test_newton_ends_quadratically_in_contact(formulation: str) -> None:
    """The barrier bends so fast that the order grows slowly. Measured at the end: 1.56 to 2.0."""
    corners = np.array([[6.0, 0.0, 0.0], [6.0, 0.0, 1.0]])
    press = [fem.Prescribed(corners, "y", 0.25), fem.Prescribed(corners + np.array([0.0, 2.4, 0.0]), "y", -0.25)]
    model = fem.Model(
        fork(0.4), LAWS["svk"], [fem.Fixed("clamp"), *press], [fem.SelfContact("prongs", dhat=0.1)], formulation
    )
    rates = orders(model)
    assert rates[-1] > 1.5
