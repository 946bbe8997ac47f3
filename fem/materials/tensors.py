"""Right Cauchy-Green tensors and their products in Voigt notation, for laws that are not linear in the strain.

Components 11, 22, 33, 12, 23, 13. A fourth-order tensor with both minor symmetries becomes a 6 x 6 matrix of its own
components, which maps strains with engineering shear to stresses. The loops over the points are compiled
(`fem.kernels.tensors`); they are loaded at the first call, because a configuration imports the laws, too.
"""

from dataclasses import dataclass
from types import ModuleType
from typing import NamedTuple, final

import numpy as np

from geometry.arrays import Array

IDENTITY = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
#: lower bound of det C: Newton's iterates may pass through states that no body can have
MIN_DETERMINANT = 1e-12
#: pairs of principal axes
PAIRS = ((0, 1), (1, 2), (0, 2))


def scaled(factor: Array, tensor: Array) -> Array:
    """factor (...) times the tensors (..., 6) or (..., 6, 6)."""
    return factor.reshape(factor.shape + (1,) * (tensor.ndim - factor.ndim)) * tensor


class Products(NamedTuple):
    """Factors (...), or one number for all points, of the fourth-order tensors that the tangents of isotropic laws are
    made of; a x b is the dyadic product."""

    one_one: Array | float = 0.0  #: of I x I
    one_inverse: Array | float = 0.0  #: of I x C^-1 + C^-1 x I
    inverse_inverse: Array | float = 0.0  #: of C^-1 x C^-1
    derivative: Array | float = 0.0  #: of -d C^-1 / dC
    tensor_inverse: Array | float = 0.0  #: of C x C^-1 + C^-1 x C
    symmetric: Array | float = 0.0  #: of the identity on symmetric tensors


@final
@dataclass(frozen=True)
class CauchyGreen:
    """C = 2 E + I and what the laws need of it."""

    components: Array  #: (..., 6) C
    inverse: Array  #: (..., 6) C^-1
    determinant: Array  #: (...,) det C = J^2, at least `MIN_DETERMINANT`
    first: Array  #: (...,) I1 = tr C
    second: Array  #: (...,) I2 = (I1^2 - tr C^2) / 2

    @classmethod
    def of(cls, strain: Array) -> "CauchyGreen":
        """From Green-Lagrange strains (..., 6) with engineering shear."""
        points = np.ascontiguousarray(strain, dtype=float).reshape(-1, 6)
        components, inverse, invariants = np.empty_like(points), np.empty_like(points), np.empty((points.shape[0], 3))
        kernels().cauchy_green(points, MIN_DETERMINANT, components, inverse, invariants)
        of_point = (invariants[:, number].reshape(strain.shape[:-1]) for number in range(3))
        return cls(components.reshape(strain.shape), inverse.reshape(strain.shape), *of_point)

    def products(self, factors: Products) -> Array:
        """(..., 6, 6) the sum of the products with these factors."""
        total = np.zeros((*self.components.shape, 6))
        self.add_products(factors, total)
        return total

    def add_products(self, factors: Products, total: Array) -> None:
        """Add the products with these factors to total (..., 6, 6), contiguous; raises ValueError for another one."""
        of_point = np.empty((*self.determinant.shape, 6))
        for number, factor in enumerate(factors):
            of_point[..., number] = factor
        points = (array.reshape(-1, 6) for array in (of_point, self.components, self.inverse))
        kernels().add_products(*points, total.reshape((-1, 6, 6), copy=False))

    def principal_values(self) -> tuple[Array, Array]:
        """Eigenvalues (..., 3) of C, at least `MIN_DETERMINANT`, and eigenvectors in the columns of (..., 3, 3)."""
        shape = self.determinant.shape
        values, axes = np.empty((*shape, 3)), np.empty((*shape, 3, 3))
        points = self.components.reshape(-1, 6), MIN_DETERMINANT, values.reshape(-1, 3), axes.reshape(-1, 3, 3)
        kernels().principal_axes(*points)
        return values, axes


def from_principal_axes(axes: Array, values: Array, diagonal: Array, rotation: Array) -> tuple[Array, Array]:
    """Stress (..., 6) and tangent (..., 6, 6) from what they are in the principal axes.

    With the axes N_a in the columns of axes (..., 3, 3), n_a = N_a N_a^T and r_k = N_a N_b^T + N_b N_a^T for `PAIRS`:
    stress sum_a values_a n_a, tangent sum_ab diagonal_ab n_a x n_b + sum_k rotation_k r_k x r_k; values (..., 3),
    diagonal (..., 3, 3) symmetric, rotation (..., 3).
    """
    shape = axes.shape[:-2]
    stress, tangent = np.empty((*shape, 6)), np.empty((*shape, 6, 6))
    given = (array.reshape(-1, *array.shape[len(shape) :]) for array in (axes, values, diagonal, rotation))
    kernels().principal(*given, stress.reshape(-1, 6), tangent.reshape(-1, 6, 6))
    return stress, tangent


def kernels() -> ModuleType:
    """The compiled loops."""
    import fem.kernels.tensors as compiled

    return compiled
