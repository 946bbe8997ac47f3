"""The kernels against scikit-fem forms, finite differences and themselves with another number of threads."""

from collections.abc import Iterator

import numba
import numpy as np
import pytest
import skfem
from skfem.helpers import ddot, det, grad, identity, inv, mul, trace, transpose

from fem import Fixed, Model, StVenantKirchhoff
from fem.discretisation import MAX_CHUNKS, MIN_CHUNK_SIZE, Discretisation
from fem.effects.effect import Blocks
from fem.effects.loads import Pressure, enclosed_volume
from fem.elements import ELEMENTS
from fem.equations.linear import SuperLU
from fem.equations.system import System
from fem.kernels.element import ElementArrays, internal_force
from fem.kernels.tangent import LANES, LawArrays, Product, tangent_matrix
from geometry import Mesh, PneuNet
from geometry.arrays import Array
from tests.bodies import box, difference, hollow_box
from tests.laws import LAWS

LAW = StVenantKirchhoff(E=1.2, nu=0.4)
LAMBDA, MU = LAW.lame


def deformation(w: skfem.element.DiscreteField) -> Array:
    return grad(w) + identity(grad(w))


def green(w: skfem.element.DiscreteField) -> Array:
    f = deformation(w)
    return 0.5 * (mul(transpose(f), f) - identity(f))


def stress(strain: Array, lam: float, mu: float) -> Array:
    return lam * trace(strain) * identity(strain) + 2 * mu * strain


def internal_form(lam: float, mu: float) -> skfem.LinearForm:
    return skfem.LinearForm(lambda v, w: ddot(mul(deformation(w["u"]), stress(green(w["u"]), lam, mu)), grad(v)))


def tangent_form(lam: float, mu: float) -> skfem.BilinearForm:
    def form(du: skfem.element.DiscreteField, v: skfem.element.DiscreteField, w: dict) -> Array:
        f = deformation(w["u"])
        change = mul(transpose(f), grad(du))
        change = 0.5 * (change + transpose(change))
        return ddot(mul(grad(du), stress(green(w["u"]), lam, mu)) + mul(f, stress(change, lam, mu)), grad(v))

    return skfem.BilinearForm(form)


def bases(system: System, mesh: skfem.MeshTet) -> list[tuple[skfem.Basis, float, float]]:
    """The quadrature rules of a formulation with the Lame constants each of them carries."""
    if system.space.element.name == "p1":
        return [(skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP1()), intorder=1), LAMBDA, MU)]
    element = skfem.ElementVector(skfem.ElementTetP2())
    full = skfem.Basis(mesh, element, intorder=2)
    assert full.X.shape == (3, 4)
    if system.space.element.name == "p2":
        return [(full, LAMBDA, MU)]
    centre = skfem.Basis(mesh, element, quadrature=(np.full((3, 1), 0.25), np.array([1 / 6])))
    return [(full, 0.0, MU), (centre, LAMBDA, 0.0)]


def system_on(formulation: str, supports: list[Fixed]) -> tuple[System, skfem.MeshTet]:
    mesh = box((2, 2, 1), (1.0, 1.5, 0.7))
    system = Model(mesh, LAW, supports, [], formulation).system(SuperLU)
    return system, skfem.MeshTet(mesh.points.T.copy(), mesh.tets.T.copy())


def noise(system: System, size: float) -> Array:
    return np.random.default_rng(3).normal(scale=size, size=system.space.points.shape)


def dense(system: System, data: Array) -> Array:
    """The whole matrix (d, d) from the values of its upper triangle."""
    size = system.storage.pattern.size
    upper = np.zeros((size, size))
    rows = np.repeat(np.arange(size), np.diff(system.storage.pattern.indptr))
    assert (system.storage.pattern.indices >= rows).all()
    upper[rows, system.storage.pattern.indices] = data
    return upper + np.triu(upper, 1).T


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "p1"])
def test_internal_force_is_that_of_scikit_fem(formulation: str) -> None:
    system, mesh = system_on(formulation, [])
    u = noise(system, 0.05)
    expected = sum(
        internal_form(lam, mu).assemble(basis, u=basis.interpolate(u.ravel())) for basis, lam, mu in bases(system, mesh)
    )
    assembly = system.assemble(system.state_at(u, 1.0), ())
    np.testing.assert_allclose(assembly.gradient.ravel(), expected, atol=1e-13)
    assert np.abs(expected).max() > 0.01
    f = bases(system, mesh)[0][0].interpolate(u.ravel())
    np.testing.assert_allclose(np.sort(assembly.jacobian[:, :4].ravel()), np.sort(det(deformation(f)).ravel()))


@pytest.mark.parametrize("held", [[], [Fixed("left"), Fixed("back", "z"), Fixed("front", "xy")]])
@pytest.mark.parametrize("formulation", ["p2", "p2p0", "p1"])
def test_tangent_with_its_own_stress_is_that_of_scikit_fem(formulation: str, held: list[Fixed]) -> None:
    system, mesh = system_on(formulation, held)
    u = noise(system, 0.05)
    whole = sum(
        tangent_form(lam, mu).assemble(basis, u=basis.interpolate(u.ravel())).toarray()
        for basis, lam, mu in bases(system, mesh)
    )
    assembly = system.assemble(system.state_at(u, 1.0), ())
    jump = np.where(system.constraints.constrained, noise(system, 1.0), 0.0)
    state = system.state_at(u, 1.0)
    data, coupling = system.tangent(state, assembly, (), jump, convex=False)
    free = ~system.constraints.constrained.ravel()
    np.testing.assert_allclose(dense(system, data), whole[np.ix_(free, free)], atol=1e-12)
    np.testing.assert_allclose(coupling.displacement.ravel(), whole @ jump.ravel(), atol=1e-11)


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "p1"])
def test_force_is_the_derivative_of_the_energy(formulation: str) -> None:
    system, _ = system_on(formulation, [])
    u, du = noise(system, 0.05), noise(system, 1.0)[::-1]
    slope = difference(lambda v: np.float64(system.energy(v, 1.0, ())), u, du, 1e-3)
    assert np.vdot(system.assemble(system.state_at(u, 1.0), ()).gradient, du) == pytest.approx(slope, rel=1e-9)


def test_linearised_strain_is_the_derivative_of_the_strain() -> None:
    system, _ = system_on("p2p0", [])
    u, du = noise(system, 0.05), noise(system, 1.0)[::-1]
    state = system.state_at(u, 1.0)
    slope = difference(lambda v: system.space.strain_of(v)[0], u, du, 1e-3)
    np.testing.assert_allclose(system.linearised_strain(state, du), slope, atol=1e-9)


@pytest.mark.parametrize("turned", [False, True], ids=["as it is", "along y"])
def test_chunks_of_one_colour_share_no_node(turned: bool) -> None:
    body = PneuNet(chambers=6).body(4.0).mesh
    mesh = Mesh(body.points[:, [1, 0, 2]] * [1, 1, -1], body.tets, body.faces) if turned else body
    space = Discretisation.of(mesh, "p2p0")
    assert np.array_equal(np.unique(np.sort(space.nodes[:, :4])), np.arange(mesh.points.shape[0]))
    assert space.chunks[0] == space.colours[0] == 0
    assert space.chunks[-1] == space.nodes.shape[0] == mesh.tets.shape[0]
    assert space.colours[-1] == space.chunks.shape[0] - 1 == min(mesh.tets.shape[0] // MIN_CHUNK_SIZE, MAX_CHUNKS)
    assert space.colours.shape[0] - 1 < space.colours[-1] / 4  # several chunks at once
    for begin, end in zip(space.colours[:-1], space.colours[1:], strict=True):
        chunks = [np.unique(space.nodes[space.chunks[c] : space.chunks[c + 1]]) for c in range(begin, end)]
        together = np.concatenate(chunks)
        assert np.unique(together).size == together.size > 0


@pytest.fixture
def threads() -> Iterator[None]:
    before = numba.get_num_threads()
    yield
    numba.set_num_threads(before)


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="numba has one thread here")
@pytest.mark.usefixtures("threads")
def test_results_do_not_depend_on_the_number_of_threads() -> None:
    results = []
    for count in (1, 2):
        numba.set_num_threads(count)
        system = Model(hollow_box(half=True, parts=2), LAW, [Fixed("clamp")], [Pressure("cavity", 0.1)]).system(SuperLU)
        assert system.space.chunks.shape[0] - 1 > system.space.colours.shape[0] - 1 > 1
        u = noise(system, 0.03)
        assembly = system.assemble(system.state_at(u, 1.0), system.terms)
        state = system.state_at(u, 1.0)
        data, coupling = system.tangent(state, assembly, system.terms, noise(system, 1.0), convex=False)
        strain = system.linearised_strain(state, u)
        results.append((assembly.gradient, assembly.jacobian, data, coupling.displacement, strain))
    for first, second in zip(*results, strict=True):
        np.testing.assert_array_equal(first, second)


def test_results_do_not_depend_on_the_order_of_chunks_of_one_colour() -> None:
    """Bitwise: what one chunk adds to, no other of its colour does, whichever of the threads is first."""
    system = Model(PneuNet(chambers=3).body(6.0).mesh, LAW, [Fixed("clamp")], []).system(SuperLU)
    space, pattern = system.space, system.storage.pattern
    parts = [np.arange(space.chunks[c], space.chunks[c + 1]) for c in range(space.chunks.shape[0] - 1)]
    turned = [c for b, e in zip(space.colours[:-1], space.colours[1:], strict=True) for c in range(b, e)[::-1]]
    assert turned != sorted(turned)
    swapped = np.concatenate([parts[c] for c in turned])
    chunks = np.concatenate([[0], np.cumsum([parts[c].shape[0] for c in turned])])
    u = noise(system, 0.03)
    state = system.state_at(u, 1.0)
    tangent = system.assemble(state, ()).law_values.tangent
    results = []
    for bounds, order in ((space.chunks, np.arange(space.nodes.shape[0])), (chunks, swapped)):
        arrays = (space.nodes[order], space.inverse[order], space.reference, space.weight[order])
        elements, stress = ElementArrays(space.colours, bounds, *arrays), state.stress[order]
        force, data, coupling = np.zeros_like(u), np.zeros(pattern.indices.shape[0]), np.zeros_like(u)
        internal_force(elements, u, stress, force)
        law = LawArrays(stress, tangent)
        product = Product(noise(system, 1.0), coupling)
        tangent_matrix(elements, law, u, system.storage.element_starts[order], pattern.matrix(data), product)
        results.append((force, data, coupling))
    for first, second in zip(*results, strict=True):
        assert np.any(first)
        np.testing.assert_array_equal(first, second)


def pressure_form(v: skfem.element.DiscreteField, w: dict) -> Array:
    """int v . cof(F) N dA (Nanson): the area-weighted normal of the deformed face, out of the solid."""
    f = deformation(w["u"])
    normal = np.einsum("ji...,j...->i...", inv(f), w["n"])
    return np.einsum("i...,i...->...", v, det(f) * normal)


def dense_blocks(blocks: Blocks, points: int) -> Array:
    whole = np.zeros((points, 3, points, 3))
    for row, column, value in zip(blocks.rows, blocks.columns, blocks.values, strict=True):
        assert row <= column
        whole[row, :, column] += value
        if row < column:
            whole[column, :, row] += value.T
    return whole.reshape(3 * points, 3 * points)


@pytest.mark.parametrize(("formulation", "element"), [("p2p0", skfem.ElementTetP2()), ("p1", skfem.ElementTetP1())])
def test_pressure_force_is_that_of_scikit_fem_on_an_open_face(formulation: str, element: skfem.Element) -> None:
    mesh = box((2, 2, 1), (1.0, 1.5, 0.7))
    space = Discretisation.of(mesh, formulation)
    u = np.random.default_rng(3).normal(scale=0.05, size=space.points.shape)
    grid = skfem.MeshTet(mesh.points.T.copy(), mesh.tets.T.copy())
    facets = grid.facets_satisfying(lambda x: np.isclose(x[0], 1.0), boundaries_only=True)
    basis = skfem.FacetBasis(grid, skfem.ElementVector(element), facets=facets, intorder=6)
    expected = skfem.LinearForm(pressure_form).assemble(basis, u=basis.interpolate(u.ravel()))
    force = np.zeros_like(u)
    Pressure("right", 0.3).bind(space, LAW).gradient(space.points + u, 0.5, force)
    np.testing.assert_allclose(force.ravel(), 0.5 * 0.3 * expected, atol=1e-14)
    assert np.abs(force).max() > 1e-3


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
@pytest.mark.parametrize("half", [False, True])
def test_pressure_force_and_tangent_against_differences(half: bool, formulation: str) -> None:
    mesh = hollow_box(half)
    space = Discretisation.of(mesh, formulation)
    term = Pressure("cavity", 0.2).bind(space, LAW)
    generator = np.random.default_rng(5)
    moves = [generator.normal(scale=0.1, size=space.points.shape) for _ in range(2)]
    if half:
        for move in moves:
            move[space.surface("sym").unique_nodes, 2] = 0.0  # the plane that closes the cavity
    x, dx = space.points + moves[0], moves[1]

    def force(y: Array) -> Array:
        out = np.zeros_like(y)
        term.gradient(y, 0.7, out)
        return out

    faces = space.surface("cavity")
    swelling = difference(lambda y: np.float64(enclosed_volume(faces, y)), x, dx, 1e-3)
    assert np.vdot(force(x), dx) == pytest.approx(-0.7 * 0.2 * swelling, rel=1e-9)
    stiffness = dense_blocks(term.blocks(x, 0.7, convex=False), x.shape[0])
    change = difference(force, x, dx, 1e-3)
    if half:
        change[space.surface("sym").unique_nodes, 2] = 0.0  # the reaction of the plane is none of the potential's
        stiffness.reshape(*x.shape, *x.shape)[space.surface("sym").unique_nodes, 2] = 0.0
    np.testing.assert_allclose((stiffness @ dx.ravel()).reshape(x.shape), change, atol=1e-11)


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
def test_the_pressure_in_a_closed_cavity_has_no_resultant(formulation: str) -> None:
    space = Discretisation.of(hollow_box(half=False), formulation)
    x = space.points + np.random.default_rng(5).normal(scale=0.1, size=space.points.shape) + [10.0, -20.0, 5.0]
    force = np.zeros_like(x)
    Pressure("cavity", 1.0).bind(space, LAW).gradient(x, 1.0, force)
    scale = np.abs(force).sum()
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-14 * scale)
    np.testing.assert_allclose(np.cross(x, force).sum(axis=0), 0.0, atol=1e-13 * scale)


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
@pytest.mark.parametrize("half", [False, True])
def test_enclosed_volume_is_exact(half: bool, formulation: str) -> None:
    space = Discretisation.of(hollow_box(half), formulation)
    whole = 0.5 if half else 1.0
    faces = space.surface("cavity")
    assert enclosed_volume(faces, space.points) == pytest.approx(whole, rel=1e-13)
    shear = np.eye(3) + np.array([[0.2, 0.5, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.3]])
    assert enclosed_volume(faces, space.points @ shear.T) == pytest.approx(whole * np.linalg.det(shear), rel=1e-13)


@pytest.mark.parametrize("law", ["svk", "mooney_rivlin"])
@pytest.mark.parametrize("formulation", ELEMENTS)
def test_the_tangent_does_not_depend_on_how_elements_are_grouped(formulation: str, law: str) -> None:
    """Groups of eight, the last one smaller, against groups of one; with constant and with varying moduli."""
    mesh = box((3, 2, 1), (1.0, 1.5, 0.7))
    supports = [Fixed("left"), Fixed("back", "z"), Fixed("front", "xy")]
    system = Model(mesh, LAWS[law], supports, [], formulation).system(SuperLU)
    count = system.space.nodes.shape[0]
    assert count > LANES
    assert count % LANES
    u, du = noise(system, 0.05), noise(system, 1.0)
    state = system.state_at(u, 1.0)
    values = LawArrays(state.stress, system.assemble(state, ()).law_values.tangent)
    assert (values.tangent.shape[0] == 1) == (law == "svk")
    pattern, results = system.storage.pattern, []
    for bounds in (np.array([0, count]), np.arange(count + 1)):
        elements = system.space.arrays._replace(chunks=bounds, colours=np.arange(bounds.shape[0]))
        data, force = np.zeros(pattern.indices.shape[0]), np.zeros_like(u)
        starts, product = system.storage.element_starts, Product(du, force)
        tangent_matrix(elements, values, u, starts, pattern.matrix(data), product)
        results.append((data, force))
    for first, second in zip(*results, strict=True):
        np.testing.assert_allclose(first, second, atol=1e-13 * np.abs(first).max())
