"""The bending energy of a flat layer against closed forms of plates, and a layer that wrinkles between soft blocks."""

from dataclasses import replace

import numpy as np
import pytest

import fem
from fem.discretisation import Discretisation
from fem.effects.layer_bending import BendingForm, bending_form
from fem.effects.membrane import StrainLimitingLayer
from fem.effects.mirror_layer import MirroredLayer
from geometry.arrays import Array, Index
from tests.bodies import box, bricks, named, on_plane
from tests.fem.test_membrane import HEIGHT, LENGTH, WIDTH, strip

D, NU = 0.7, 0.3


def patch(cells: int, quadratic: bool = True, shear: float = 0.0) -> tuple[Array, Index]:
    """Points and triangles of a square of 4 x 4 mm in the plane y = 0 without a plane of symmetry, or of a rhomb."""
    side = np.linspace(0.0, 4.0, cells + 1)
    x, z = (part.ravel() for part in np.meshgrid(side, side, indexing="ij"))
    points = np.column_stack([x + shear * z, 0 * x, z * np.sqrt(1 - shear**2)])
    number = np.arange(points.shape[0]).reshape(cells + 1, -1)
    a, b, c, d = number[:-1, :-1].ravel(), number[1:, :-1].ravel(), number[:-1, 1:].ravel(), number[1:, 1:].ravel()
    triangles = np.vstack([np.column_stack([a, b, c]), np.column_stack([d, c, b])])
    if not quadratic:
        return points, triangles
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [0, 2]]], axis=2).reshape(-1, 2)
    edges, edge = np.unique(ends, axis=0, return_inverse=True)
    middles = len(points) + edge.reshape(-1, 3)
    return np.vstack([points, points[edges].mean(axis=1)]), np.hstack([triangles, middles])


def form(points: Array, nodes: Index) -> BendingForm:
    return bending_form(points, nodes, D, NU, np.zeros(len(points), dtype=bool))


def deflected(points: Array, height: Array) -> Array:
    return points + np.outer(height, [0.0, 1.0, 0.0])


@pytest.mark.parametrize(("curvatures", "twist"), [((1.0, 0.0), 0.0), ((0.0, 1.0), 0.0), ((0.3, -0.8), 0.5)])
def test_constant_curvature_is_exact(curvatures: tuple[float, float], twist: float) -> None:
    points, nodes = patch(3)
    x, z = points[:, 0], points[:, 2]
    (k, m), size = curvatures, 1e-3
    energy = form(points, nodes).energy(deflected(points, size * (k * x**2 / 2 + m * z**2 / 2 + twist * x * z)))
    density = D / 2 * ((1 - NU) * (k**2 + m**2 + 2 * twist**2) + NU * (k + m) ** 2)
    assert energy == pytest.approx(16 * size**2 * density, rel=1e-9)


def test_a_wave_converges_with_the_square_of_the_size() -> None:
    errors = []
    for cells in (8, 16):
        points, nodes = patch(cells)
        wave = 2 * np.pi / 4
        energy = form(points, nodes).energy(deflected(points, 1e-2 * np.sin(wave * points[:, 0])))
        errors.append(energy / (D / 2 * 1e-4 * wave**4 * 8) - 1)
    assert errors[1] < 0.1
    assert np.log2(errors[0] / errors[1]) > 1.8


@pytest.mark.parametrize("direction", [0.0, 0.5, 1.5])
def test_hinges_of_equilateral_triangles_bend_as_the_plate(direction: float) -> None:
    points, nodes = patch(40, quadratic=False, shear=0.5)
    along = points @ [np.cos(direction), 0.0, np.sin(direction)]
    energy = form(points, nodes).energy(deflected(points, 1e-3 * along**2 / 2))
    assert energy == pytest.approx(16 * np.sqrt(0.75) * D / 2 * 1e-6, rel=0.06)  # but for the free edges


@pytest.mark.parametrize("quadratic", [True, False])
def test_rigid_motions_cost_nothing_and_all_others_something(quadratic: bool) -> None:
    points, nodes = patch(3, quadratic)
    middles = points.shape[0] - 1 if quadratic else 0
    points[middles] += [0.05, 0.0, 0.02] if quadratic else 0.0  # the middle of a round edge
    bending = form(points, nodes)
    turn, _ = np.linalg.qr(np.random.default_rng(6).normal(size=(3, 3)))
    assert bending.energy(points @ turn.T + 3.0) == pytest.approx(0.0, abs=1e-10)
    values = np.linalg.eigvalsh(bending.across.toarray())
    assert values[0] > -1e-10 * values[-1]
    assert np.count_nonzero(values < 1e-9 * values[-1]) == 3


def test_triangles_at_an_angle_bend_freely() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0.5, 1]])
    nodes = np.array([[0, 1, 2], [3, 2, 1]])
    assert abs(form(points, nodes).across).max() == 0.0
    points[3, 1] = 0.0
    assert abs(form(points, nodes).across).max() > 0.1


def test_half_a_layer_bends_as_the_whole() -> None:
    mesh = strip((6, 1, 2))
    energies = []
    for body in (mesh, mesh.mirrored()):
        space = Discretisation.of(body, "p2p0")
        term = StrainLimitingLayer(body.plane(1, 0.0), 0.5, 50.0, NU).bind(space, fem.NeoHooke(mu=1.0, kappa=10.0))
        height = 0.01 * np.abs(space.points[:, 2]) + 0.001 * space.points[:, 0] ** 2  # a crease at z = 0
        energies.append(term.bending.energy(deflected(space.points, height)))
    assert 2 * energies[0] == pytest.approx(energies[1], rel=1e-9)


@pytest.mark.parametrize("formulation", ["p2p0", "mixed"])
def test_a_strip_with_a_layer_that_resists_bending_itself(formulation: str) -> None:
    """A cantilever bent a little by its end, F = 3 B d / l^3: with the layer's own bending B is a third larger."""
    mesh, deflection, thickness, soft, stiff = strip((20, 2, 1)), 0.01, 0.4, 1.2, 12.0
    layer = StrainLimitingLayer(mesh.plane(1, 0.0), thickness, stiff, 0.0)
    supports = [fem.Fixed("clamp"), fem.Prescribed("tip", "y", deflection)]
    model = fem.Model(mesh, fem.StVenantKirchhoff(E=soft, nu=1e-3), supports, [layer], formulation)
    axis = soft * HEIGHT**2 / 2 / (soft * HEIGHT + stiff * thickness)
    composite = soft * (HEIGHT**3 / 12 + HEIGHT * (HEIGHT / 2 - axis) ** 2) + stiff * thickness * axis**2
    rigidity = WIDTH * (composite + stiff * thickness**3 / 12)
    force = fem.follow(model, [1.0]).steps[-1].reaction("tip")[1]
    assert force == pytest.approx(3 * rigidity * deflection / LENGTH**3, rel=2e-2)
    assert rigidity > 1.15 * WIDTH * composite


@pytest.mark.parametrize("cells", [6, 12])
def test_a_layer_between_soft_blocks_wrinkles_at_the_strain_of_a_plate(cells: int) -> None:
    """Plane strain, blocks that hardly change their volume: N = min over q of D q^2 + 4 G / q (M. A. Biot, "Folding
    instability of a layered viscoelastic medium under compression", Proc. R. Soc. Lond. A 242 (1957)).

    Without stiffness against bending the wave is as short as the elements: unstable directions appear between a
    fifth and two fifths of this strain with 4 elements along the wave, at half of that with 8, a quarter with 16.
    """
    youngs, thickness, shear, nu = 50.0, 0.2, 0.02, 0.3
    rigidity = youngs * thickness**3 / (12 * (1 - nu**2))
    wave = 2 * np.pi * (rigidity / (2 * shear)) ** (1 / 3)
    critical = 3 * (4 * shear**2 * rigidity) ** (1 / 3) * (1 - nu**2) / (youngs * thickness)
    mesh = box((cells, 2 * cells, 1), (wave, 2 * wave, 0.5))
    layer = StrainLimitingLayer(mesh.plane(1, wave), thickness, youngs, nu)
    fixed = (("left", "y"), ("right", "y"), ("back", "z"), ("front", "z"), (np.array([0.0, wave, 0.0]), "x"))
    supports = [fem.Fixed(where, axes) for where, axes in fixed]
    system = fem.Model(mesh, fem.NeoHooke(mu=shear, kappa=100 * shear), supports, [layer], "p2").system()

    def unstable(strain: float) -> int:
        shortened = system.space.points * [-strain, 1 / (1 - strain) - 1, 0.0]
        state = system.state_at(shortened, 1.0)
        return system.linearise(state, system.assemble(state, system.terms), system.terms).negative_pivots

    # the first wave appears at 0.8 of the strain of infinite blocks, the second at 0.97
    assert unstable(0.7 * critical) == 0
    assert unstable(1.1 * critical) in (1, 2)


@pytest.mark.parametrize("deflection", [0.1, 6.0])
def test_a_layer_bends_as_a_solid_of_its_thickness(deflection: float) -> None:
    """A soft strip with a stiff sheet in its middle, where only its own bending counts: 1.8 times that of the strip."""
    height, thickness, soft = 1.6, 0.2, fem.NeoHooke(mu=0.02, kappa=1.0)
    along, across = np.linspace(0.0, 20.0, 21), np.linspace(0.0, 3.0, 4)
    end = np.column_stack([np.full(4, 20.0), np.full(4, height / 2), across])
    forces = []
    for heights in ([0.0, 0.8, 1.6], [0.0, 0.7, 0.8, 0.9, 1.6], [0.0, 0.8, 1.6]):
        mesh = bricks(np.ones((20, len(heights) - 1, 3), dtype=bool), [along, np.array(heights), across])
        mesh = named(mesh, clamp=on_plane(mesh, 0, 0.0))
        middle = np.abs(mesh.points[mesh.tets].mean(axis=1)[:, 1] - height / 2) < thickness / 2
        law: fem.Solid = soft
        effects: list[fem.Effect] = []
        if len(heights) == 5:
            mesh = replace(mesh, regions={"sheet": np.flatnonzero(middle)})
            law = fem.ByRegion(soft, {"sheet": fem.StVenantKirchhoff(E=50.0, nu=0.3)})
        elif not forces:
            layer = StrainLimitingLayer(mesh.plane(1, height / 2), thickness, 50.0, 0.3)
            effects = [layer, MirroredLayer(layer, "clamp")]
        supports = [fem.Fixed("clamp"), fem.Prescribed(end, "y", deflection)]
        step = fem.follow(fem.Model(mesh, law, supports, effects, "p2p0"), [1.0]).steps[-1]
        forces.append(step.reaction(end)[1])
    sheet, solid, alone = forces
    assert sheet == pytest.approx(solid, rel=0.02)
    assert solid > 2 * alone
