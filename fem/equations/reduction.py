"""The product T^T K T of a sparse matrix K, given by its upper triangle, on a pattern that is made once.

Each entry of the product is a fixed linear combination of the entries of K, so that a sparse matrix times the values of
K gives the values of the product. Entries that happen to be zero stay in the pattern.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.equations.pattern import sorted_unique
from geometry.arrays import Array, Index, Mask


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Reduction:
    """T^T K T for matrices K of one pattern and one T.

    Each of its p products T_ia K_ij T_jb is added to one entry of the result; products are sorted by that entry.
    """

    indptr: Index  #: (m + 1,) upper triangle of the result, diagonal included, in compressed rows
    indices: NDArray[np.int32]  #: (r,)
    transformation: sp.csr_matrix  #: (d, m) T
    starts: Index  #: (r + 1,) where the products of each entry of the result begin
    entry: Index  #: (p,) number of K_ij among the values of K
    left: Index  #: (p,) number of T_ia among the values of T
    right: Index  #: (p,) number of T_jb
    doubled: Mask  #: (p,) products that stand for K_ij and K_ji, which are added to the same entry on the diagonal
    count: int  #: number of values of K

    @classmethod
    def of(cls, indptr: Index, indices: NDArray[np.int32], transformation: sp.csr_matrix) -> "Reduction":
        """For the upper triangle indptr (d + 1,), indices (nnz,) of K and T (d, m).

        All stored entries of T make entries of the result, zeros too: two matrices T with the same stored entries give
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
        diagonal = (row == column)[entry]
        kept = np.flatnonzero(~diagonal | (first <= second))
        keys = np.minimum(first, second)[kept] * size + np.maximum(first, second)[kept]
        order = np.argsort(keys, kind="stable")
        kept, keys = kept[order], keys[order]
        entries = sorted_unique(np.concatenate([keys, np.arange(size) * (size + 1)]))
        return cls(
            indptr=np.searchsorted(entries, np.arange(size + 1) * size),
            indices=(entries % size).astype(np.int32),
            transformation=transformation,
            starts=np.concatenate([np.searchsorted(keys, entries), [keys.shape[0]]]),
            entry=entry[kept],
            left=left[kept],
            right=right[kept],
            doubled=(~diagonal & (first == second))[kept],
            count=indices.shape[0],
        )

    def applies_to(self, transformation: sp.csr_matrix) -> bool:
        """Whether another T has the same stored entries."""
        return (
            transformation.shape == self.transformation.shape
            and np.array_equal(transformation.indptr, self.transformation.indptr)
            and np.array_equal(transformation.indices, self.transformation.indices)
        )

    def with_values(self, transformation: sp.csr_matrix) -> "Reduction":
        """The same products for another T with the same stored entries."""
        return replace(self, transformation=transformation)

    def values(self, data: Array) -> Array:
        """Values (r,) of the result for the values (nnz,) of K."""
        return np.asarray(self._weights @ data)

    @cached_property
    def _weights(self) -> sp.csr_matrix:
        """(r, nnz) what each value of K contributes to each value of the result."""
        coefficient = self.transformation.data[self.left] * self.transformation.data[self.right]
        coefficient[self.doubled] *= 2.0
        return sp.csr_matrix((coefficient, self.entry, self.starts), shape=(self.indices.shape[0], self.count))
