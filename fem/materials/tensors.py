"""Right Cauchy-Green tensors and their products in Voigt notation, for laws that are not linear in the strain.

Components 11, 22, 33, 12, 23, 13. A fourth-order tensor with both minor symmetries becomes a 6 x 6 matrix of its own
components, which maps strains with engineering shear to stresses.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geometry.arrays import Array

ROW = np.array([0, 1, 2, 0, 1, 0])
COLUMN = np.array([0, 1, 2, 1, 2, 2])
IDENTITY = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
#: the identity on symmetric tensors
SYMMETRIC = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
#: lower bound of det C: Newton's iterates may pass through states that no body can have
MIN_DETERMINANT = 1e-12
#: pairs of principal axes
PAIRS = ((0, 1), (1, 2), (0, 2))


def voigt(tensor: Array) -> Array:
    """Components (..., 6) of symmetric tensors (..., 3, 3)."""
    return tensor[..., ROW, COLUMN]


def outer(first: Array, second: Array) -> Array:
    """first x second, (..., 6, 6)."""
    return first[..., :, None] * second[..., None, :]


def scaled(factor: Array, tensor: Array) -> Array:
    """factor (...) times the tensors (..., 6) or (..., 6, 6)."""
    return factor.reshape(factor.shape + (1,) * (tensor.ndim - factor.ndim)) * tensor


def principal_basis(axes: Array) -> tuple[Array, Array]:
    """N_a x N_a for each of the three axes and N_a x N_b + N_b x N_a for `PAIRS`, (..., 3, 6) both, of orthonormal
    axes in the columns of (..., 3, 3)."""
    vectors = np.swapaxes(axes, -1, -2)
    normal = vectors[..., ROW] * vectors[..., COLUMN]
    first, second = vectors[..., [a for a, _ in PAIRS], :], vectors[..., [b for _, b in PAIRS], :]
    return normal, first[..., ROW] * second[..., COLUMN] + second[..., ROW] * first[..., COLUMN]


@dataclass(frozen=True)
class CauchyGreen:
    """C = 2 E + I and what the laws need of it."""

    tensor: Array  #: (..., 3, 3)

    @classmethod
    def of(cls, strain: Array) -> "CauchyGreen":
        """From Green-Lagrange strains (..., 6) with engineering shear."""
        tensor = np.empty((*strain.shape[:-1], 3, 3))
        tensor[..., ROW, COLUMN] = tensor[..., COLUMN, ROW] = strain * np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        return cls(tensor + np.eye(3))

    @cached_property
    def determinant(self) -> Array:
        """(...,) det C = J^2."""
        c = self.tensor
        return np.maximum(np.einsum("...i,...i", c[..., 0, :], np.cross(c[..., 1, :], c[..., 2, :])), MIN_DETERMINANT)

    @cached_property
    def inverse_tensor(self) -> Array:
        """(..., 3, 3) C^-1."""
        c = self.tensor
        rows = [
            np.cross(c[..., 1, :], c[..., 2, :]),
            np.cross(c[..., 2, :], c[..., 0, :]),
            np.cross(c[..., 0, :], c[..., 1, :]),
        ]
        return np.stack(rows, axis=-1) / self.determinant[..., None, None]

    @cached_property
    def inverse(self) -> Array:
        """(..., 6) C^-1."""
        return voigt(self.inverse_tensor)

    @cached_property
    def inverse_derivative(self) -> Array:
        """(..., 6, 6) -d C^-1 / dC."""
        i, j, k, m = ROW[:, None], COLUMN[:, None], ROW[None, :], COLUMN[None, :]
        c = self.inverse_tensor
        return 0.5 * (c[..., i, k] * c[..., j, m] + c[..., i, m] * c[..., j, k])

    @cached_property
    def first(self) -> Array:
        """(...,) I1 = tr C."""
        return np.trace(self.tensor, axis1=-2, axis2=-1)

    @cached_property
    def second(self) -> Array:
        """(...,) I2 = (I1^2 - tr C^2) / 2."""
        return 0.5 * (self.first**2 - np.einsum("...ij,...ij", self.tensor, self.tensor))
