"""Uniaxial stress: the closed forms against the energy of each law, and the stretches at which no bar exists."""

from collections.abc import Callable

import numpy as np
import pytest

from fem import Hencky, Material, MooneyRivlin, NeoHooke, Ogden, StVenantKirchhoff, Yeoh
from fem.materials import LinearLaw
from geometry.arrays import Array
from tests.bodies import difference

LAWS: dict[str, Material] = {
    "svk": StVenantKirchhoff(E=1.2, nu=0.495),
    "hencky": Hencky(E=1.2, nu=0.3),
    "neo_hooke": NeoHooke(mu=0.4, kappa=3.0),
    "mooney_rivlin": MooneyRivlin(c10=0.15, c01=0.05, kappa=3.0),
    "yeoh": Yeoh(c10=0.11, c20=0.02, c30=0.001, kappa=3.0),
    "ogden": Ogden(mu=(0.3, 0.02, -0.01), alpha=(1.3, 5.0, -2.0), kappa=3.0),
}
STRETCHES = np.array([0.6, 0.8, 0.99, 1.0, 1.01, 1.2, 1.5, 1.7])


def energy(law: Material, along: Array, across: Array) -> Array:
    """W (n,) of the law of the finite elements at these stretches."""
    strain = np.zeros((len(along), 1, 6))
    strain[:, 0, 0] = (along**2 - 1) / 2
    strain[:, 0, 1] = strain[:, 0, 2] = (across**2 - 1) / 2
    return (law.shear(strain).energy + law.volumetric(strain).energy)[:, 0]


@pytest.mark.parametrize("name", LAWS)
def test_nominal_stress_and_free_sides_follow_from_the_energy(name: str) -> None:
    law = LAWS[name]
    bar = law.uniaxial(STRETCHES)
    unit = np.ones_like(STRETCHES)
    force = difference(lambda s: energy(law, s, bar.lateral), bar.stretch, unit, 1e-3)
    sides = difference(lambda t: energy(law, bar.stretch, t), bar.lateral, unit, 1e-3)
    np.testing.assert_allclose(bar.nominal, force, atol=1e-8)
    np.testing.assert_allclose(sides, 0.0, atol=1e-7)


def test_values_of_st_venant_kirchhoff() -> None:
    bar = LAWS["svk"].uniaxial(np.array([1.2, 0.8]))
    np.testing.assert_allclose(bar.nominal / 1.2, [0.2640, -0.1440], atol=1e-12)
    np.testing.assert_allclose(bar.lateral, [0.884421, 1.085449], atol=1e-6)


@pytest.mark.parametrize("name", [name for name, law in LAWS.items() if isinstance(law, LinearLaw)])
def test_the_terms_times_the_constants_are_the_nominal_stress_of_the_incompressible_bar(name: str) -> None:
    law = LAWS[name]
    constants = {constant: getattr(law, constant) for constant in law.uniaxial_terms(STRETCHES)}
    stiff = type(law)(**constants, **({"nu": law.nu} if hasattr(law, "nu") else {"kappa": 1e8}))
    terms = law.uniaxial_terms(STRETCHES)
    total = sum(constant * terms[key] for key, constant in constants.items())
    np.testing.assert_allclose(stiff.uniaxial(STRETCHES).nominal, total, rtol=1e-6, atol=1e-15)


def test_ogden_in_uniaxial_equibiaxial_and_plane_strain_tension() -> None:
    """Against Ogden's closed forms (1972) of the incompressible law: P = sum mu (s^(a-1) - t^a / s), t the stretch of
    the direction that is free of stress, s^(-1/2), s^-2 and 1/s."""
    law = Ogden(mu=(0.63, 0.0012, -0.01), alpha=(1.3, 5.0, -2.0), kappa=1e5)
    s = np.array([0.7, 1.2, 2.0, 4.0, 6.0])
    closed = {
        "uniaxial": sum(mu * (s ** (a - 1) - s ** (-a / 2 - 1)) for mu, a in law.terms),
        "equibiaxial": sum(mu * (s ** (a - 1) - s ** (-2 * a - 1)) for mu, a in law.terms),
        "plane strain": sum(mu * (s ** (a - 1) - s ** (-a - 1)) for mu, a in law.terms),
    }
    states = {"uniaxial": (s, s**-0.5, s**-0.5), "equibiaxial": (s, s, s**-2), "plane strain": (s, s**0, s**-1.0)}
    for name, stretches in states.items():
        strain = np.zeros((len(s), 1, 6))
        strain[:, 0, :3] = (np.stack(stretches, axis=1) ** 2 - 1) / 2
        kirchhoff = law.shear(strain).stress[:, 0, :3] * np.stack(stretches, axis=1) ** 2
        np.testing.assert_allclose((kirchhoff[:, 0] - kirchhoff[:, 2]) / s, closed[name], rtol=1e-12)
        np.testing.assert_allclose(law.incompressible(s, stretches[1]), closed[name], rtol=1e-12)
    np.testing.assert_allclose(law.uniaxial(s).nominal, closed["uniaxial"], rtol=1e-4)
    np.testing.assert_allclose(law.incompressible(s), closed["uniaxial"], rtol=1e-12)


@pytest.mark.parametrize("name", [name for name, law in LAWS.items() if isinstance(law, LinearLaw)])
@pytest.mark.parametrize("across", [lambda s: s, np.ones_like], ids=["equibiaxial", "planar"])
def test_the_terms_in_two_directions_are_differences_of_stresses(name: str, across: Callable[[Array], Array]) -> None:
    """Kirchhoff stress along the first axis less that along the free one, over the stretch, without volume change."""
    law, s = LAWS[name], np.array([0.8, 1.2, 1.6])
    stretches = np.stack([s, across(s), 1 / (s * across(s))], axis=1)
    strain = np.zeros((len(s), 1, 6))
    strain[:, 0, :3] = (stretches**2 - 1) / 2
    kirchhoff = law.shear(strain).stress[:, 0, :3] * stretches**2
    terms = law.uniaxial_terms(s, across(s))
    total = np.sum([getattr(law, key) * term for key, term in terms.items()], axis=0)
    exact = (kirchhoff[:, 0] - kirchhoff[:, 2]) / s
    ratio = law.shear_modulus / (law.E / 3) if hasattr(law, "E") else 1.0  # as if E were that of an incompressible body
    np.testing.assert_allclose(ratio * total, exact, rtol=1e-9)


def test_compressibility_softens_a_bar_of_rubber() -> None:
    """The error of the incompressible form is of the order of Kirchhoff stress over bulk modulus."""
    stiff, soft = (Yeoh(0.11, 0.02, 0.0, kappa).uniaxial(np.array([2.0])).nominal[0] for kappa in (220.0, 22.0))
    exact = float(sum(c * Yeoh.uniaxial_terms(np.array([2.0]))[k][0] for k, c in (("c10", 0.11), ("c20", 0.02))))
    assert soft < stiff < exact
    assert (exact - soft) / (exact - stiff) == pytest.approx(10.0, rel=0.2)


def test_stretches_at_which_no_bar_exists_give_nan() -> None:
    limit = np.sqrt(1 + 1 / 0.495)
    bar = LAWS["svk"].uniaxial(np.array([limit - 1e-6, limit + 1e-6]))
    assert np.isfinite(bar.nominal).tolist() == np.isfinite(bar.lateral).tolist() == [True, False]
    assert 0 < bar.stretch[0] * bar.lateral[0] ** 2 < 1e-4
    pressed = NeoHooke(0.4, 3.0).uniaxial(np.array([0.3, 0.05]))  # J (J - 1) has no value below -1/4
    assert np.isfinite(pressed.nominal).tolist() == [True, False]
    falling = Yeoh(0.11, -0.02, 0.0, 40.0).uniaxial(np.array([1.2, 4.0]))
    assert np.isfinite(falling.nominal).tolist() == [True, False]
