"""Ogden's law: a sum of powers of the isochoric principal stretches.

R. W. Ogden, Proc. R. Soc. A 326 (1972) 565; in isochoric stretches J. C. Simo, R. L. Taylor, Comput. Methods Appl.
Mech. Eng. 85 (1991) 273. With the eigenvalues c_a and eigenvectors N_a of C the stress is sum_a S_a N_a N_a^T, and its
derivative has the divided differences (S_a - S_b) / (c_a - c_b), whose limit for equal stretches is the derivative.
"""

from dataclasses import dataclass
from typing import Annotated, final

import numpy as np

from fem.materials.material import BulkModulus, Exponents, MaterialError, Response, Stresses
from fem.materials.rubber_law import RubberLaw, check_positive
from fem.materials.tensors import CauchyGreen, from_principal_axes, kernels
from geometry.arrays import Array


@final
@dataclass(frozen=True)
class Ogden(RubberLaw):
    """W = sum_i mu_i / alpha_i (a^alpha_i + b^alpha_i + c^alpha_i - 3) + kappa/2 (J - 1)^2, a, b, c the isochoric
    principal stretches.

    mu in MPa and alpha without unit have one entry per term, alpha none that is 0. The sum of mu_i alpha_i, which is
    twice the shear modulus, and kappa (MPa) are positive. Raises `MaterialError`. With mu_i alpha_i > 0 in every term
    the law is stable at every strain. alpha = (2,) is the neo-Hookean law, alpha = (2, -2) with mu = (2 c10, -2 c01)
    that of Mooney and Rivlin. Programs that write 2 mu_i / alpha_i^2 (Abaqus) have other moduli: theirs times
    2 / alpha_i.
    """

    title = "Ogden"

    mu: Annotated[Stresses, "modulus μ_i of each term; the shear modulus is half the sum of μ_i α_i"]
    alpha: Annotated[Exponents, "exponent α_i of each term"]
    kappa: BulkModulus

    def __post_init__(self) -> None:
        if not self.mu or len(self.mu) != len(self.alpha):
            raise MaterialError(
                f"Ogden: mu has {len(self.mu)} and alpha {len(self.alpha)} entries; both need one for each term"
            )
        if not all(np.isfinite(self.alpha)) or 0 in self.alpha:
            raise MaterialError(f"Ogden: alpha = {list(self.alpha)} must be finite numbers other than 0")
        check_positive(Ogden, {"half the sum of mu times alpha": self.shear_modulus, "kappa": self.kappa})

    @property
    def terms(self) -> list[tuple[float, float]]:
        """mu (MPa) and alpha of each term."""
        return list(zip(self.mu, self.alpha, strict=True))

    @property
    def shear_modulus(self) -> float:
        return sum(mu * alpha for mu, alpha in self.terms) / 2

    def incompressible(self, stretch: Array, across: Array | None = None) -> Array:
        third = stretch**-0.5 if across is None else 1 / (stretch * across)
        return np.asarray(sum(mu * (stretch**a - third**a) for mu, a in self.terms) / stretch)

    def isochoric(self, c: CauchyGreen) -> Response:
        value, axes = c.principal_values()
        energy, diagonal = np.empty(value.shape[:-1]), np.empty((*value.shape, 3))
        stress, rotation = np.empty(value.shape), np.empty(value.shape)  # (..., a), (..., pair)
        of_point = energy.reshape(-1), stress.reshape(-1, 3), diagonal.reshape(-1, 3, 3), rotation.reshape(-1, 3)
        kernels().powers_of_stretches(value.reshape(-1, 3), np.array(self.mu), np.array(self.alpha), *of_point)
        return Response(energy, *from_principal_axes(axes, stress, diagonal, rotation))
