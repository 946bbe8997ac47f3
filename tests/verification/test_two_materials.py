"""Bodies of two materials: layers in tension, composite beams, and two laws that are the same one in disguise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import fem
from fem.cell.piece import BendingPiece
from fem.cell.response import slopes
from fem.discretisation import Discretisation
from fem.elements import ELEMENTS
from geometry import Mesh
from tests.bodies import QUADRATIC, box, hollow_box
from tests.verification.test_pure_bending import HEIGHT, LENGTH, WIDTH, beam

OPTIONS = fem.PathOptions(fem.NewtonOptions(tolerance=1e-11))
SIDES = [fem.Fixed("left", "x"), fem.Fixed("bottom", "y"), fem.Fixed("back", "z")]


def with_base(mesh: Mesh, axis: int, top: float) -> Mesh:
    """The mesh with the elements below `top` (mm) along an axis as the region base."""
    below = np.flatnonzero(mesh.points[mesh.tets, axis].mean(axis=1) < top)
    return replace(mesh, regions={"base": below})


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("kind", [fem.StVenantKirchhoff, fem.Hencky])
def test_two_layers_in_tension_carry_the_sum_of_their_forces(formulation: str, kind: type) -> None:
    """With one Poisson ratio both contract alike, so that each is in uniaxial tension."""
    soft, stiff, stretch = kind(1.2, 0.4), kind(12.0, 0.4), 1.2
    mesh = with_base(box((2, 3, 1), (2.0, 3.0, 1.0)), 1, 1.0)
    pull = fem.Prescribed("right", "x", (stretch - 1) * 2.0)
    model = fem.Model(mesh, fem.ByRegion(soft, {"base": stiff}), [*SIDES, pull], [], formulation)
    step = fem.follow(model, [1.0], OPTIONS).steps[0]
    bars = [law.uniaxial(np.array([stretch])).nominal[0] for law in (soft, stiff)]
    assert step.reaction("right")[0] == pytest.approx(2.0 * bars[0] + 1.0 * bars[1], rel=1e-8)
    assert step.positions[:, 1].max() == pytest.approx(3.0 * soft.uniaxial(np.array([stretch])).lateral[0], rel=1e-8)


@pytest.mark.parametrize("formulation", ["p1", "p2", "p2p0"])
def test_two_bars_in_series_carry_one_force(formulation: str) -> None:
    """Without lateral contraction each is in uniaxial tension: s_1 + s_2 = 2.4 with equal nominal stress."""
    soft, stiff = fem.StVenantKirchhoff(1.2, 0.0), fem.StVenantKirchhoff(4.8, 0.0)

    def stress(law: fem.StVenantKirchhoff, stretch: float) -> float:
        return float(law.uniaxial(np.array([stretch])).nominal[0])

    shared = brentq(lambda s: stress(stiff, s) - stress(soft, 2.4 - s), 1.0, 1.4, xtol=1e-14)
    mesh = with_base(box((4, 1, 1), (2.0, 1.0, 1.0)), 0, 1.0)
    model = fem.Model(
        mesh, fem.ByRegion(soft, {"base": stiff}), [*SIDES, fem.Prescribed("right", "x", 0.4)], [], formulation
    )
    step = fem.follow(model, [1.0], OPTIONS).steps[0]
    assert step.reaction("right")[0] == pytest.approx(stress(stiff, shared), rel=1e-8)
    between = np.isclose(step.points[:, 0], 1.0)
    np.testing.assert_allclose(step.displacement[between, 0], shared - 1.0, atol=1e-9)


@pytest.mark.parametrize("formulation", ELEMENTS)
def test_one_law_in_two_disguises_is_one_material(formulation: str) -> None:
    """Ogden's law with alpha = 2 in the base of a neo-Hookean box that is inflated and bent by its weight."""
    mesh = hollow_box(half=True)
    supports, loads = [fem.Fixed("clamp"), fem.Fixed("sym", "z")], [fem.Pressure("cavity", 0.02), fem.Gravity(2e-6)]
    uniform = fem.Model(mesh, fem.NeoHooke(0.4, 20.0), supports, loads, formulation)
    disguised = fem.ByRegion(fem.NeoHooke(0.4, 20.0), {"base": fem.Ogden((0.4,), (2.0,), 20.0)})
    divided = fem.Model(with_base(mesh, 1, 1.0), disguised, supports, loads, formulation)
    expected, computed = (fem.follow(model, [1.0], OPTIONS).steps[0] for model in (uniform, divided))
    assert np.abs(expected.displacement).max() > 0.05
    if formulation != "mixed":  # whose pressure may jump between two laws
        np.testing.assert_allclose(computed.displacement, expected.displacement, atol=1e-10)
        np.testing.assert_allclose(computed.stress, expected.stress, atol=1e-9)
    else:
        assert divided.system().formulation.unknowns > uniform.system().formulation.unknowns
        off = np.linalg.norm(computed.displacement - expected.displacement) / np.linalg.norm(expected.displacement)
        assert off < 0.05
    equal = fem.ByRegion(fem.NeoHooke(0.4, 20.0), {"base": fem.NeoHooke(0.4, 20.0)})
    same = fem.follow(fem.Model(with_base(mesh, 1, 1.0), equal, supports, loads, formulation), [1.0], OPTIONS).steps[0]
    np.testing.assert_array_equal(same.displacement, expected.displacement)


@pytest.mark.parametrize("formulation", QUADRATIC)
@pytest.mark.parametrize(("stiffness", "nu"), [(10.0, 0.3), (0.1, 0.49), (100.0, 0.49)])
def test_a_composite_beam_has_the_rigidity_of_beam_theory(formulation: str, stiffness: float, nu: float) -> None:
    """A third of the height is stiffer: sum of E (I + A e^2) about the axis that the products E A balance (Gere and
    Timoshenko, "Mechanics of materials", transformed section). Exact for equal Poisson ratios."""
    counts, error = ((4, 12, 8), 5e-3) if formulation == "p2p0" else ((2, 6, 4), 1e-7)
    soft, stiff = fem.StVenantKirchhoff(1.2, nu), fem.StVenantKirchhoff(1.2 * stiffness, nu)
    body = beam(counts)
    body = replace(body, mesh=with_base(body.mesh, 1, HEIGHT / 3))
    piece = BendingPiece(body, fem.ByRegion(soft, {"base": stiff}), "mirror", formulation, pressures={})
    known = slopes(piece, piece.solve(0.0, 1e-8, piece.rest()))
    heights, middles = np.array([1, 2]) * HEIGHT / 3, np.array([0.5, 2.0]) * HEIGHT / 3
    axial = 2 * WIDTH * heights * np.array([stiff.E, soft.E])
    axis = axial @ middles / axial.sum()
    bending = axial @ (heights**2 / 12 + (middles - axis) ** 2)
    assert known.moment_by_angle * LENGTH == pytest.approx(bending, rel=error)
    assert LENGTH / known.distance_by_force == pytest.approx(axial.sum(), rel=max(error, 1e-3))


@pytest.mark.parametrize("formulation", ELEMENTS)
def test_the_tangent_of_two_materials_is_the_derivative_of_its_gradient(formulation: str) -> None:
    """Newton's method converges quadratically, with another law and another measure of the volume in the base."""
    mesh = with_base(hollow_box(half=True), 1, 1.0)
    solid = fem.ByRegion(fem.NeoHooke(0.4, 8.0), {"base": fem.Hencky(3.0, 0.45)})
    supports = [fem.Fixed("clamp"), fem.Fixed("sym", "z")]
    step = fem.follow(
        fem.Model(mesh, solid, supports, [fem.Pressure("cavity", 0.05)], formulation), [1.0], OPTIONS
    ).steps[0]
    assert step.factorizations <= 9
    many = fem.follow(
        fem.Model(mesh, solid, supports, [fem.Pressure("cavity", 0.05)], formulation), [0.3, 0.6, 1.0], OPTIONS
    )
    np.testing.assert_allclose(step.displacement, many.steps[-1].displacement, atol=1e-8)


def test_weight_and_stress_error_of_two_materials() -> None:
    mesh = with_base(box((2, 3, 1), (2.0, 3.0, 1.0)), 1, 1.0)
    space = Discretisation.of(mesh, "p2")
    force = fem.Gravity(1e-9, regions={"base": 5e-9}).bind(space, fem.StVenantKirchhoff(1.0, 0.3)).force
    assert force[:, 1].sum() == pytest.approx(-9810.0 * (4.0 * 1e-9 + 2.0 * 5e-9))
    soft, stiff = fem.StVenantKirchhoff(1.2, 0.4), fem.StVenantKirchhoff(12.0, 0.4)
    solid, pull = fem.ByRegion(soft, {"base": stiff}), fem.Prescribed("right", "x", 0.4)
    step = fem.follow(fem.Model(mesh, solid, [*SIDES, pull], [], "p2"), [1.0], OPTIONS).steps[0]
    assert fem.stress_error(step, solid).energy < 1e-12  # uniform in each layer
    assert fem.stress_error(step, soft).energy < 1e-12
    cauchy = fem.element_fields(step, solid)["cauchy_stress_MPa"][:, 0]
    assert cauchy[mesh.regions["base"]].min() > 9 * np.delete(cauchy, mesh.regions["base"]).max()


@pytest.mark.parametrize("formulation", ["p1", "p2", "p2p0"])
def test_the_fields_of_a_state_are_in_the_order_of_the_mesh(formulation: str) -> None:
    """One bar in two materials: the stretch of every tetrahedron is that of its own vertices."""
    mesh = with_base(box((4, 1, 1), (2.0, 1.0, 1.0)), 0, 1.0)
    mesh = replace(mesh, tets=mesh.tets[::-1], regions={"base": len(mesh.tets) - 1 - mesh.regions["base"]})
    solid = fem.ByRegion(fem.StVenantKirchhoff(1.2, 0.0), {"base": fem.StVenantKirchhoff(120.0, 0.0)})
    step = fem.follow(
        fem.Model(mesh, solid, [*SIDES, fem.Prescribed("right", "x", 0.4)], [], formulation), [1.0], OPTIONS
    ).steps[0]
    fields = fem.element_fields(step, solid)
    assert fields["stretch"][mesh.regions["base"]].max() < 1.01
    assert np.delete(fields["stretch"], mesh.regions["base"]).min() > 1.39
    np.testing.assert_array_equal(step.space.nodes_of_tets[:, :4], mesh.tets)
    moved = Mesh(step.positions[: len(mesh.points)], mesh.tets, {})
    np.testing.assert_allclose(fields["J"], moved.volumes / mesh.volumes, rtol=1e-9)


def test_a_stretch_beyond_the_law_of_a_region_is_named_with_it() -> None:
    mesh = with_base(box((2, 3, 1), (2.0, 3.0, 1.0)), 1, 1.0)
    solid = fem.ByRegion(fem.NeoHooke(0.4, 8.0), {"base": fem.StVenantKirchhoff(1.2, 0.4)})
    space = Discretisation.of(mesh, "p2")
    pressed = space.points * [0.5 - 1, 0.0, 0.0]
    (reason,) = fem.unstable_stretches(space, pressed, solid)
    assert reason.code == "stretch_too_small"
    assert reason.values["stretch"] == pytest.approx(0.5)
    assert reason.values["of_region"] == " of the region base"
    assert fem.unstable_stretches(space, pressed, fem.NeoHooke(0.4, 8.0)) == ()
