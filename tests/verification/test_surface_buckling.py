"""The stretch at which the free surface of a compressed half space buckles, from the tangents of the laws.

M. A. Biot, Appl. Sci. Res. A 12 (1963) 168-182: an incompressible neo-Hookean half space in plane strain, at 0.544.
All wavelengths buckle at the same stretch, so that finer elements follow the shorter waves: below it an equilibrium of
a compressed surface depends on the mesh.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import fem
from fem.materials.material import Material
from geometry.arrays import Array

RUBBER = fem.StVenantKirchhoff(E=1.2, nu=0.495)
#: Voigt index of the components (3, 3) of a symmetric tensor
VOIGT = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])


def small_motions(material: Material, stretches: Array) -> tuple[Array, Array]:
    """First Piola-Kirchhoff stress (3, 3) and its derivative by the deformation gradient (3, 3, 3, 3)."""
    gradient = np.diag(stretches)
    strain = np.concatenate([(stretches**2 - 1) / 2, np.zeros(3)])
    parts = [part(strain[None]) for part in (material.shear, material.volumetric)]
    stress = np.asarray(sum(part.stress[0] for part in parts))[VOIGT]
    tangent = np.asarray(sum(part.tangent[0] for part in parts))[VOIGT[:, :, None, None], VOIGT[None, None]]
    slope = np.einsum("im,kn,mjnl->ijkl", gradient, gradient, tangent) + np.einsum("ik,jl->ijkl", np.eye(3), stress)
    return gradient @ stress, slope


def in_plane_strain(material: Material, along: float) -> Array:
    """Stretches along x, y (the surface's normal, without stress) and z (1)."""

    def normal_stress(across: float) -> float:
        return float(small_motions(material, np.array([along, across, 1.0]))[0][1, 1])

    return np.array([along, brentq(normal_stress, 0.9, 1 / along + 0.2), 1.0])


def stiffness_of_surface(material: Material, along: float) -> float:
    """Smallest eigenvalue of the stiffness of a half space y < 0 against waves exp(i x) of its surface, MPa.

    Motions v exp(i (x + p y)) in equilibrium obey (Q + p (R + R^T) + p^2 T) v = 0 (A. N. Stroh, Phil. Mag. 3 (1958)
    625-646); the two that decay downwards give the tractions of the surface.
    """
    slope = small_motions(material, in_plane_strain(material, along))[1]
    q, r, t = slope[:2, 0, :2, 0], slope[:2, 0, :2, 1], slope[:2, 1, :2, 1]
    inverse = np.linalg.inv(t)
    roots, vectors = np.linalg.eig(np.block([[-inverse @ r.T, inverse], [r @ inverse @ r.T - q, -r @ inverse]]))
    decaying = vectors[:, np.argsort(roots.imag)[:2]]
    stiffness = 1j * decaying[2:] @ np.linalg.inv(decaying[:2])
    return float(np.linalg.eigvalsh((stiffness + stiffness.conj().T) / 2)[0])


def buckling_stretch(material: Material) -> float:
    """The largest stretch below 1 without stiffness against waves."""
    stretches = np.arange(0.98, 0.5, -0.02)
    first = next(stretch for stretch in stretches if stiffness_of_surface(material, stretch) < 0)
    return float(brentq(lambda stretch: stiffness_of_surface(material, stretch), first, first + 0.02, xtol=1e-5))


def test_a_surface_at_rest_has_the_stiffness_of_a_half_space() -> None:
    """Traction over displacement is 2 mu / (3 - 4 nu) [[2 (1 - nu), i (1 - 2 nu)], [-i (1 - 2 nu), 2 (1 - nu)]]."""
    mu, nu = RUBBER.shear_modulus, RUBBER.nu
    expected = 2 * mu / (3 - 4 * nu) * (2 * (1 - nu) - (1 - 2 * nu))
    assert stiffness_of_surface(RUBBER, 1.0) == pytest.approx(expected, rel=1e-5)


def test_a_neo_hookean_surface_buckles_where_biot_found() -> None:
    soft = fem.NeoHooke.from_uniaxial({"mu": 0.4}, 0.4999)
    assert buckling_stretch(soft) == pytest.approx(0.5437, abs=2e-4)


@pytest.mark.parametrize(
    ("material", "stretch"),
    [(RUBBER, 0.657), (fem.Hencky(E=1.2, nu=0.495), 0.589), (fem.NeoHooke.from_uniaxial({"mu": 0.4}, 0.495), 0.545)],
)
def test_surfaces_of_the_other_laws_buckle_elsewhere(material: Material, stretch: float) -> None:
    """At the Poisson ratio of the arms; docs/theory.md gives these numbers."""
    assert buckling_stretch(material) == pytest.approx(stretch, abs=6e-4)
