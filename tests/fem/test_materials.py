"""Every law: derivatives against finite differences, the linear limit, isotropy, stable range and refused constants."""

import numpy as np
import pytest

import fem
from fem.kernels.tensors import difference_of_powers, log_of_ratio
from fem.materials import Constant
from fem.materials.hencky import divided_difference
from fem.materials.rubber_law import stable_range
from fem.materials.tensors import CauchyGreen, Products
from geometry.arrays import Array
from tests.bodies import box, difference
from tests.laws import LAWS

#: axes of the components 11, 22, 33, 12, 23, 13
ROW, COLUMN = np.array([0, 1, 2, 0, 1, 0]), np.array([0, 1, 2, 1, 2, 2])

PARTS = [(name, part) for name in LAWS for part in ("shear", "volumetric")]


def voigt(tensor: Array) -> Array:
    """Components (..., 6) of symmetric tensors (..., 3, 3)."""
    return tensor[..., ROW, COLUMN]


def symmetric(strain: Array) -> Array:
    """(..., 3, 3) of strains (..., 6) with engineering shear."""
    full = np.empty((*strain.shape[:-1], 3, 3))
    full[..., ROW, COLUMN] = full[..., COLUMN, ROW] = strain * np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    return full


def strains(size: float, count: int = 7) -> Array:
    """Green-Lagrange strains (count, 2, 6) of random deformations."""
    f = np.eye(3) + np.random.default_rng(8).normal(scale=size, size=(count, 2, 3, 3))
    assert (np.linalg.det(f) > 0).all()
    e = 0.5 * (np.swapaxes(f, -1, -2) @ f - np.eye(3))
    return voigt(e) * np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


#: states with equal and nearly equal principal stretches, where spectral formulas divide by nothing
SPECIAL = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.2, 0.2, 0.2, 0.0, 0.0, 0.0],
        [0.3, 0.3, -0.1, 0.0, 0.0, 0.0],
        [0.3, 0.3 + 1e-9, -0.1, 1e-9, 0.0, 0.0],
        [0.1, 0.1, 0.1, 1e-4, 2e-4, 0.0],
        [0.1, 0.102, 0.1, 1e-3, 2e-3, 0.0],
    ]
)[:, None, :]


def test_every_law_of_the_configuration_is_tested_here() -> None:
    assert {name: type(law) for name, law in LAWS.items()} == fem.materials.LAWS


def test_the_kinds_of_constants_are_those_of_the_fields() -> None:
    assert fem.MooneyRivlin.constants() == {
        "c10": Constant.STRESS,
        "c01": Constant.STRESS,
        "kappa": Constant.POSITIVE_STRESS,
    }
    assert fem.Hencky.constants() == {"E": Constant.POSITIVE_STRESS, "nu": Constant.POISSON_RATIO}
    assert fem.Ogden.constants() == {
        "mu": Constant.STRESSES,
        "alpha": Constant.EXPONENTS,
        "kappa": Constant.POSITIVE_STRESS,
    }
    assert [constant.unit for constant in Constant] == [" MPa", " MPa", "", "", " MPa", ""]


@pytest.mark.parametrize("name", LAWS)
def test_a_law_from_a_tensile_test_has_the_given_poisson_ratio(name: str) -> None:
    law = LAWS[name]
    constants = {constant: getattr(law, constant) for constant in law.constants() if constant not in ("nu", "kappa")}
    other = type(law).from_uniaxial(constants, 0.4)
    assert other.poisson_ratio == pytest.approx(0.4)
    assert {constant: getattr(other, constant) for constant in constants} == constants
    rest = np.zeros((1, 1, 6))
    tangent = np.reshape(other.shear(rest).tangent + other.volumetric(rest).tangent, (6, 6))
    assert tangent[0, 1] / (tangent[0, 0] + tangent[0, 1]) == pytest.approx(0.4)  # lambda / (2 lambda + 2 mu)


@pytest.mark.parametrize("strain", [strains(0.01), strains(0.2), SPECIAL], ids=["small", "large", "special"])
@pytest.mark.parametrize(("name", "part"), PARTS)
def test_stress_and_tangent_are_derivatives(name: str, part: str, strain: Array) -> None:
    evaluate = getattr(LAWS[name], part)
    response = evaluate(strain)
    assert response.energy.shape == strain.shape[:-1]
    assert response.stress.shape == strain.shape
    tangent = np.broadcast_to(response.tangent, (*strain.shape, 6))
    np.testing.assert_allclose(tangent, np.swapaxes(tangent, -1, -2), atol=1e-12)
    for v in range(6):
        direction = np.broadcast_to(np.eye(6)[v], strain.shape)
        slope = difference(lambda e: evaluate(e).energy, strain, direction, 1e-3)
        np.testing.assert_allclose(response.stress[..., v], slope, atol=2e-8)
        change = difference(lambda e: evaluate(e).stress, strain, direction, 1e-3)
        np.testing.assert_allclose(tangent[..., v], change, atol=2e-7)


@pytest.mark.parametrize("digits", range(1, 40))
def test_at_rest_the_stress_is_exactly_zero(digits: int) -> None:
    """Not only to rounding: with nothing else in the balance Newton's method cannot tell rounding from a load."""
    share = digits / 40
    laws = (
        *(fem.StVenantKirchhoff(E=share, nu=0.45), fem.Hencky(E=share, nu=0.45), fem.NeoHooke(mu=share, kappa=3.0)),
        *(
            fem.MooneyRivlin(c10=0.15, c01=share, kappa=3.0),
            fem.Yeoh(c10=share, c20=share / 7, c30=share / 30, kappa=3.0),
        ),
        fem.Ogden(mu=(share, share / 7, -share / 30), alpha=(1.3, 5.0, -2.0), kappa=3.0),
    )
    rest = np.zeros((1, 1, 6))
    for law in laws:
        assert not law.shear(rest).stress.any(), law
        assert not law.volumetric(rest).stress.any(), law


@pytest.mark.parametrize("name", LAWS)
def test_at_rest_every_law_is_linear_elasticity(name: str) -> None:
    law = LAWS[name]
    rest = np.zeros((1, 1, 6))
    shear, volumetric = law.shear(rest), law.volumetric(rest)
    for part in (shear, volumetric):
        np.testing.assert_allclose(part.energy, 0.0, atol=1e-15)
        np.testing.assert_allclose(part.stress, 0.0, atol=1e-15)
    whole = np.reshape(shear.tangent + volumetric.tangent, (6, 6))
    mu, lam = law.shear_modulus, whole[0, 1]
    expected = np.diag([2 * mu, 2 * mu, 2 * mu, mu, mu, mu])
    expected[:3, :3] += lam
    np.testing.assert_allclose(whole, expected, atol=1e-12)
    if hasattr(law, "kappa"):
        assert lam + 2 * mu / 3 == pytest.approx(law.kappa)
    else:
        assert (lam, mu) == pytest.approx((3.724137931, 0.413793103))


@pytest.mark.parametrize(("name", "part"), PARTS)
def test_every_law_is_isotropic(name: str, part: str) -> None:
    strain = strains(0.2)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]

    def tensor(components: Array, factor: float) -> Array:
        full = np.zeros((*components.shape[:-1], 3, 3))
        full[..., ROW, COLUMN] = full[..., COLUMN, ROW] = components * np.array([1, 1, 1, factor, factor, factor])
        return full

    turned = voigt(turn @ tensor(strain, 0.5) @ turn.T) * np.array([1, 1, 1, 2, 2, 2])
    evaluate = getattr(LAWS[name], part)
    original, rotated = evaluate(strain), evaluate(turned)
    np.testing.assert_allclose(original.energy, rotated.energy, atol=1e-13)
    np.testing.assert_allclose(voigt(turn @ tensor(original.stress, 1.0) @ turn.T), rotated.stress, atol=1e-12)


@pytest.mark.parametrize(("name", "part"), PARTS)
def test_impossible_strains_give_finite_numbers(name: str, part: str) -> None:
    """Newton's iterates may pass through them."""
    flat = np.array([[[-0.5, 0.1, 0.2, 0.0, 0.0, 0.0], [-0.5] * 3 + [0.0] * 3, [40.0, -0.4, 3.0, 9.0, 1.0, 1.0]]])
    response = getattr(LAWS[name], part)(flat)
    for value in (response.energy, response.stress, response.tangent):
        assert np.isfinite(value).all()


def test_a_pure_volume_change_depends_on_the_bulk_modulus_alone() -> None:
    swollen = np.zeros((1, 1, 6))
    swollen[..., :3] = 0.5 * (1.3**2 - 1)
    for name in ("neo_hooke", "mooney_rivlin", "yeoh", "ogden"):
        parts = LAWS[name].shear(swollen), LAWS[name].volumetric(swollen)
        assert sum(part.energy[0, 0] for part in parts) == pytest.approx(1.5 * (1.3**3 - 1) ** 2)
        cauchy = sum(part.stress[0, 0] for part in parts) * 1.3**2 / 1.3**3
        np.testing.assert_allclose(cauchy, [3.0 * (1.3**3 - 1)] * 3 + [0.0] * 3, atol=1e-13)


def test_mooney_rivlin_and_yeoh_contain_neo_hooke() -> None:
    strain = strains(0.2)
    neo = fem.NeoHooke(mu=0.4, kappa=3.0).shear(strain)
    for other in (fem.MooneyRivlin(0.2, 0.0, 3.0), fem.Yeoh(0.2, 0.0, 0.0, 3.0)):
        response = other.shear(strain)
        np.testing.assert_allclose(response.stress, neo.stress, atol=1e-14)
        np.testing.assert_allclose(response.tangent, neo.tangent, atol=1e-13)


@pytest.mark.parametrize("strain", [strains(0.01), strains(0.2), SPECIAL], ids=["small", "large", "special"])
@pytest.mark.parametrize(
    ("ogden", "other"),
    [
        (fem.Ogden((0.4,), (2.0,), 3.0), fem.NeoHooke(0.4, 3.0)),
        (fem.Ogden((0.3, -0.1), (2.0, -2.0), 3.0), fem.MooneyRivlin(0.15, 0.05, 3.0)),
        (fem.Ogden((0.1, 0.2, -0.1), (2.0, 2.0, -2.0), 3.0), fem.MooneyRivlin(0.15, 0.05, 3.0)),
    ],
    ids=["neo-Hooke", "Mooney-Rivlin", "a term in two parts"],
)
def test_ogden_contains_neo_hooke_and_mooney_rivlin(ogden: fem.Ogden, other: fem.Material, strain: Array) -> None:
    for part in ("shear", "volumetric"):
        computed, expected = getattr(ogden, part)(strain), getattr(other, part)(strain)
        np.testing.assert_allclose(computed.energy, expected.energy, atol=1e-13)
        np.testing.assert_allclose(computed.stress, expected.stress, atol=1e-13)
        np.testing.assert_allclose(computed.tangent, expected.tangent, atol=1e-12)


def test_differences_of_powers_of_close_and_of_equal_numbers() -> None:
    """Against sums of products for whole exponents, which have no difference in them."""
    x = 1.3 * (1 + np.concatenate([[0.0], np.geomspace(1e-16, 50.0, 200), -np.geomspace(1e-16, 0.99, 200)]))
    y = np.full_like(x, 1.3)
    logs, divided = np.vectorize(log_of_ratio), np.vectorize(difference_of_powers)

    def differences(first: Array, second: Array, exponent: float) -> Array:
        return np.asarray(divided(first, second, logs(first, second), second**exponent, exponent))

    for n in (1, 2, 5):
        powers = sum(x ** (n - 1 - k) * y**k for k in range(n))
        np.testing.assert_allclose(differences(x, y, n), powers, rtol=1e-14 * 10)
        np.testing.assert_allclose(differences(x, y, -n), -powers / (x * y) ** n, rtol=1e-13)
    np.testing.assert_allclose(differences(y, y, -0.35), -0.35 * 1.3**-1.35, rtol=1e-15)


def log_hessian(law: fem.Ogden, stretches: Array) -> Array:
    """(2, 2) second derivative of psi by the logarithms of two principal stretches, the third following from J = 1."""
    weight = sum(mu * a * stretches**a for mu, a in law.terms)
    return np.array([[weight[0] + weight[2], weight[2]], [weight[2], weight[1] + weight[2]]])


def test_ogden_is_stable_at_every_strain_where_all_products_are_positive() -> None:
    """Drucker: more stress for more strain, so the second derivative is positive definite in all states."""
    stable, unstable = LAWS["ogden"], fem.Ogden((0.4, 0.02), (2.0, -4.0), 3.0)
    logs = np.random.default_rng(3).normal(scale=1.0, size=(500, 2))
    states = np.exp(np.column_stack([logs, -logs.sum(axis=1)]))
    lowest = {law: min(np.linalg.eigvalsh(log_hessian(law, s))[0] for s in states) for law in (stable, unstable)}
    assert lowest[stable] > 0 > lowest[unstable]
    assert stable.stretch_limits == (0.0, np.inf)


def test_the_divided_difference_is_continuous_where_its_series_takes_over() -> None:
    x = np.full(200, 1.3)
    y = x * (1 + np.geomspace(1e-9, 0.5, 200))
    exact = np.array([np.trapezoid((1 - np.log(t)) / t**2, t) for t in np.linspace(x, y, 20_001).T]) / (y - x)
    np.testing.assert_allclose(divided_difference(x, y), exact, rtol=1e-8)


def test_inverse_and_invariants() -> None:
    strain = strains(0.2)
    c, tensor = CauchyGreen.of(strain), np.eye(3) + 2.0 * symmetric(strain)
    np.testing.assert_allclose(c.components, tensor[..., ROW, COLUMN], rtol=1e-14)
    np.testing.assert_allclose(c.inverse, np.linalg.inv(tensor)[..., ROW, COLUMN], rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(c.determinant, np.linalg.det(tensor), rtol=1e-12)
    values = np.linalg.eigvalsh(tensor)
    np.testing.assert_allclose(c.first, values.sum(axis=-1))
    np.testing.assert_allclose(c.second, values[..., 0] * values[..., 1] + values[..., 2] * (values[..., :2].sum(-1)))


def test_products_of_tensors() -> None:
    """Against sums over all indices, one product after the other."""
    strain = strains(0.2)
    c, tensor, identity = CauchyGreen.of(strain), np.eye(3) + 2.0 * symmetric(strain), np.eye(3)
    inverse, every = np.linalg.inv(tensor), np.broadcast_to(identity, tensor.shape)

    def dyads(first: Array, second: Array) -> Array:
        return np.einsum("...ij,...km->...ijkm", first, second) + np.einsum("...ij,...km->...ijkm", second, first)

    def crossed(factor: Array) -> Array:
        both = np.einsum("...ik,...jm->...ijkm", factor, factor), np.einsum("...im,...jk->...ijkm", factor, factor)
        return 0.5 * (both[0] + both[1])

    expected = {
        "one_one": 0.5 * dyads(every, every),
        "one_inverse": dyads(every, inverse),
        "inverse_inverse": 0.5 * dyads(inverse, inverse),
        "derivative": crossed(inverse),
        "tensor_inverse": dyads(tensor, inverse),
        "symmetric": crossed(every),
    }
    assert set(expected) == set(Products._fields)
    factor = np.linspace(0.5, 2.0, c.first.size).reshape(c.first.shape)
    for name, full in expected.items():
        by_components = full[..., ROW[:, None], COLUMN[:, None], ROW, COLUMN]
        scaled = factor[..., None, None] * by_components
        np.testing.assert_allclose(c.products(Products(**{name: factor})), scaled, rtol=1e-10, atol=1e-13)
    total = c.products(Products(one_one=1.0))
    c.add_products(Products(symmetric=2.0), total)
    np.testing.assert_allclose(total, c.products(Products(one_one=1.0, symmetric=2.0)))


def test_stretch_limits() -> None:
    assert LAWS["svk"].stretch_limits == pytest.approx((1 / np.sqrt(3), np.sqrt(1 + 1 / 0.45)))
    assert LAWS["hencky"].stretch_limits == pytest.approx((0.0, np.e))
    assert LAWS["neo_hooke"].stretch_limits == (0.0, np.inf)
    assert LAWS["mooney_rivlin"].stretch_limits == (0.0, np.inf)
    assert fem.Yeoh(0.11, 0.02, 0.0, 5.0).stretch_limits == (0.0, np.inf)
    low, high = fem.Yeoh(0.11, -0.02, 0.0, 5.0).stretch_limits
    assert 0.1 < low < 1 < high < 3
    _, top = stable_range(lambda stretch: np.log(stretch) / stretch)
    assert top == pytest.approx(np.e, rel=2e-3)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("formulation", ["p2", "p2p0"])
def test_a_bent_beam_of_every_law_is_solved_in_one_increment(name: str, formulation: str) -> None:
    """Newton carries strain and stress of every law, so a beam bent by a third of its length takes one increment."""
    law = LAWS[name]
    weight = fem.Gravity(2.7e-7 * law.shear_modulus)
    model = fem.Model(box((6, 1, 1), (8.0, 1.0, 1.0)), law, [fem.Fixed("left")], [weight], formulation)
    step = fem.follow(model, [1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-10))).steps[0]
    tip = step.displacement[step.space.surface("right").unique_nodes].mean(axis=0)
    assert -7.0 < tip[1] < -2.0
    assert step.cutbacks == 0
    assert step.factorizations <= 12
    many = fem.follow(model, [0.3, 0.6, 1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-10))).steps[-1]
    np.testing.assert_allclose(step.displacement, many.displacement, atol=1e-7)
    np.testing.assert_allclose(step.stress, many.stress, atol=1e-7)
