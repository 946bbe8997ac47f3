"""The product T^T K T of a sparse matrix K, given by its upper triangle, on a pattern that is made once.

Each entry of the product is a fixed linear combination of the entries of K, so that a sparse matrix times the values of
K gives the values of the product. Entries that happen to be zero stay in the pattern.
"""

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from geometry.arrays import Array, Index


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Reduction:
    """T^T K T for matrices K of one pattern and one T."""

    indptr: Index  #: (m + 1,) upper triangle of the product, diagonal included, in compressed rows
    indices: NDArray[np.int32]  #: (r,)
    weights: sp.csr_matrix  #: (r, nnz) what each entry of K contributes to each of the product

    @classmethod
    def of(cls, indptr: Index, indices: NDArray[np.int32], transformation: sp.csr_matrix) -> "Reduction":
        """For the upper triangle indptr (d + 1,), indices (nnz,) of K and T (d, m).

        All stored entries of T make entries of the product, zeros too: two matrices T with the same stored entries give
        the same pattern.
        """
        size = transformation.shape[1]
        begin, count = transformation.indptr[:-1].astype(np.int64), np.diff(transformation.indptr).astype(np.int64)
        row, column = np.repeat(np.arange(indptr.shape[0] - 1), np.diff(indptr)), indices.astype(np.int64)
        pairs = count[row] * count[column]
        entry = np.repeat(np.arange(indices.shape[0]), pairs)
        within = np.arange(entry.shape[0]) - np.repeat(np.cumsum(pairs) - pairs, pairs)
        left, right = np.divmod(within, count[column[entry]])
        left += begin[row[entry]]
        right += begin[column[entry]]
        first, second = (transformation.indices[part].astype(np.int64) for part in (left, right))
        weight = transformation.data[left] * transformation.data[right]
        diagonal = (row == column)[entry]
        weight[~diagonal & (first == second)] *= 2.0  # K_ij and K_ji fall on one diagonal entry
        kept = ~diagonal | (first <= second)
        keys = np.minimum(first, second)[kept] * size + np.maximum(first, second)[kept]
        keys, position = np.unique(np.concatenate([keys, np.arange(size) * (size + 1)]), return_inverse=True)
        weights = sp.csr_matrix(
            (weight[kept], (position[: int(kept.sum())], entry[kept])), shape=(keys.shape[0], indices.shape[0])
        )
        starts = np.searchsorted(keys, np.arange(size + 1) * size)
        return cls(starts, (keys % size).astype(np.int32), weights)

    def values(self, data: Array) -> Array:
        """Values (r,) of the product for the values (nnz,) of K."""
        return np.asarray(self.weights @ data)
