"""The strain-limiting layer: its derivatives against finite differences, and a two-layer strip against closed forms."""

import numpy as np
import pytest

import fem
from fem.discretisation import Discretisation
from fem.effects.effect import Term
from fem.effects.membrane import LayerTerm, StrainLimitingLayer
from fem.elements import ELEMENTS
from geometry import Mesh
from geometry.arrays import Array
from tests.bodies import QUADRATIC, difference

LENGTH, HEIGHT, WIDTH = 20.0, 1.0, 2.0
SOFT, STIFF, THICKNESS = 1.2, 600.0, 0.01


def strip(counts: tuple[int, int, int]) -> Mesh:
    """A box of LENGTH x HEIGHT x WIDTH cut into bricks of six tetrahedra each, its end faces named."""
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in counts), indexing="ij"), axis=-1)
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    steps = np.eye(3, dtype=int)
    tets = []
    for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        corners = np.concatenate([[np.zeros(3, int)], np.cumsum(steps[list(order)], axis=0)])
        tets.append([number[tuple(slice(c, c + n) for c, n in zip(at, counts, strict=True))].ravel() for at in corners])
    points = grid.reshape(-1, 3) * np.array([LENGTH, HEIGHT, WIDTH]) / counts
    mesh = Mesh(points, np.concatenate([np.array(t).T for t in tets]), {})
    ends = {"clamp": mesh.plane(0, 0.0), "tip": mesh.plane(0, LENGTH), "sym": mesh.plane(2, 0.0)}
    return Mesh(mesh.points, mesh.tets, ends)


def layer(mesh: Mesh, nu: float = 0.0) -> StrainLimitingLayer:
    return StrainLimitingLayer(mesh.plane(1, 0.0), THICKNESS, STIFF, nu)


@pytest.fixture(scope="module", params=["p2p0", "p1"])
def bound(request: pytest.FixtureRequest) -> tuple[LayerTerm, Array]:
    """A layer and positions in which it is bent and stretched."""
    mesh = strip((2, 1, 2))
    space = Discretisation.of(mesh, request.param)
    term = layer(mesh, nu=0.3).bind(space, fem.StVenantKirchhoff(E=SOFT, nu=0.3))
    assert isinstance(term, LayerTerm)
    noise = np.random.default_rng(1).normal(scale=0.1, size=space.points.shape)
    return term, space.points + noise


def test_force_is_the_derivative_of_the_energy(bound: tuple[LayerTerm, Array]) -> None:
    term, x = bound
    force = np.zeros_like(x)
    term.gradient(x, 1.0, force)
    for seed in range(3):
        direction = np.random.default_rng(seed).normal(size=x.shape)
        slope = difference(lambda y: np.float64(term.energy(y, 1.0)), x, direction, 1e-3)  # exact: quartic
        assert np.vdot(force, direction) == pytest.approx(slope, rel=1e-7)


def times(term: Term, x: Array, direction: Array) -> Array:
    blocks, product = term.blocks(x, 1.0, convex=False), np.zeros_like(x)
    assert (blocks.rows <= blocks.columns).all()
    for row, column, value in zip(blocks.rows, blocks.columns, blocks.values, strict=True):
        product[row] += value @ direction[column]
        if row != column:
            product[column] += value.T @ direction[row]
    return product


def check_derivatives(term: Term, x: Array) -> None:
    """Force and tangent against differences of energy and force."""
    force = np.zeros_like(x)
    term.gradient(x, 1.0, force)
    for seed in range(3):
        direction = np.random.default_rng(seed).normal(size=x.shape)
        slope = difference(lambda y: np.float64(term.energy(y, 1.0)), x, direction, 1e-4)
        assert np.vdot(force, direction) == pytest.approx(slope, rel=1e-6)
        ahead, behind = np.zeros_like(x), np.zeros_like(x)
        term.gradient(x + 1e-5 * direction, 1.0, ahead)
        term.gradient(x - 1e-5 * direction, 1.0, behind)
        product = (ahead - behind) / 2e-5
        np.testing.assert_allclose(times(term, x, direction), product, atol=1e-6 * np.abs(product).max())


def test_tangent_is_the_derivative_of_the_force(bound: tuple[LayerTerm, Array]) -> None:
    term, x = bound
    direction = np.random.default_rng(4).normal(size=x.shape)
    ahead, behind = np.zeros_like(x), np.zeros_like(x)
    term.gradient(x + 1e-5 * direction, 1.0, ahead)
    term.gradient(x - 1e-5 * direction, 1.0, behind)
    assert times(term, x, direction) == pytest.approx((ahead - behind) / 2e-5, rel=1e-6, abs=1e-6 * np.abs(ahead).max())


def test_the_carried_stress_is_linear_in_the_increment(bound: tuple[LayerTerm, Array]) -> None:
    term, x = bound
    direction = np.random.default_rng(5).normal(size=x.shape)
    carried = term.advanced(x, 1e-6 * direction)
    assert carried.carried == pytest.approx(term.stress(x + 1e-6 * direction), abs=1e-8 * STIFF)
    far = term.advanced(x, direction)
    assert far.carried is not None
    assert not np.allclose(far.carried, term.stress(x + direction), rtol=1e-3)
    assert far.energy(x, 1.0) == term.energy(x, 1.0)
    assert not np.allclose(times(far, x, direction), times(term, x, direction))


def test_a_rigid_motion_leaves_the_energy_of_the_layer_unchanged(bound: tuple[LayerTerm, Array]) -> None:
    """A motion in the plane of symmetry of the strip."""
    term, x = bound
    turn = np.eye(3)
    turn[:2, :2] = [[0.6, -0.8], [0.8, 0.6]]
    assert term.energy(x @ turn.T + 3.0, 1.0) == pytest.approx(term.energy(x, 1.0), rel=1e-12)


@pytest.mark.parametrize("formulation", ELEMENTS)
def test_a_two_layer_strip_in_tension(formulation: str) -> None:
    """Equal Poisson ratios keep the strip homogeneous: F = (E h + E_layer t) w (lambda^3 - lambda) / 2, exact."""
    mesh, nu, stretch = strip((4, 1, 2)), 0.3, 1.2
    supports = [
        fem.Fixed("clamp", "x"),
        fem.Fixed("sym", "z"),
        fem.Fixed(np.array([[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0]]), "y"),
        fem.Prescribed("tip", "x", (stretch - 1) * LENGTH),
    ]
    model = fem.Model(mesh, fem.StVenantKirchhoff(E=SOFT, nu=nu), supports, [layer(mesh, nu)], formulation)
    step = fem.follow(model, [1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-10))).steps[-1]
    expected = (SOFT * HEIGHT + STIFF * THICKNESS) * WIDTH * (stretch**3 - stretch) / 2
    assert step.reaction("tip")[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("formulation", QUADRATIC)
def test_a_two_layer_strip_in_bending(formulation: str) -> None:
    """A cantilever bent a little by its end: F = 3 B d / l^3 with the bending stiffness B about the common axis."""
    mesh, deflection = strip((20, 2, 1)), 0.01
    supports = [fem.Fixed("clamp"), fem.Prescribed("tip", "y", deflection)]

    def force(effects: list[fem.Effect]) -> float:
        model = fem.Model(mesh, fem.StVenantKirchhoff(E=SOFT, nu=1e-3), supports, effects, formulation)
        return float(fem.follow(model, [1.0]).steps[-1].reaction("tip")[1])

    soft, stiff = SOFT * HEIGHT, STIFF * THICKNESS
    axis = soft * HEIGHT / 2 / (soft + stiff)
    plain = WIDTH * soft * HEIGHT**2 / 12
    both = plain + WIDTH * (soft * (HEIGHT / 2 - axis) ** 2 + stiff * axis**2)
    assert both / plain > 3
    for bending, effects in ((plain, []), (both, [layer(mesh)])):
        assert force(effects) == pytest.approx(3 * bending * deflection / LENGTH**3, rel=1e-2)
