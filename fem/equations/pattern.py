"""Sparsity pattern of the reduced upper triangle, kept by node pairs and made once per model."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fem.kernels.element import ReducedMatrix, scatter_blocks
from geometry.arrays import Array, Index, Mask


class MissingPairs(ValueError):
    """Node pairs that a pattern does not hold."""


@dataclass(frozen=True)
class Pattern:
    """Upper triangle (diagonal included) over the free components of all nodes, numbered node by node.

    Row r of node a holds first the components of a from r on, then all free components of the neighbours b > a in
    order; `offset_of(pairs)` therefore has one number per node pair.
    """

    node_dof: Index  #: (n, 3) reduced dof of each component, -1 where it is prescribed
    free: Index  #: (n,) free components per node
    keys: Index  #: (k,) node pairs a < b as a n + b, sorted
    offset: Index  #: (k,) where the columns of b begin after those of a itself
    indptr: Index  #: (d + 1,)
    indices: NDArray[np.int32]  #: (nnz,)

    @classmethod
    def of(cls, fixed: Mask, keys: Index) -> "Pattern":
        """Pattern for the prescribed components fixed (n, 3) and the sorted unique node-pair keys."""
        n = fixed.shape[0]
        node_dof = np.full((n, 3), -1, dtype=np.int64)
        node_dof[~fixed] = np.arange(np.count_nonzero(~fixed))
        free = np.count_nonzero(~fixed, axis=1).astype(np.int64)
        low, high = keys // n, keys % n
        before = np.concatenate([[0], np.cumsum(free[high])])
        first = np.searchsorted(low, np.arange(n + 1))
        offset = before[:-1] - before[first[low]]
        neighbours = before[first[1:]] - before[first[:-1]]
        owner = np.repeat(np.arange(n), free)
        rank = node_dof[~fixed] - node_dof[~fixed][np.cumsum(free)[owner] - free[owner]]
        counts = free[owner] - rank + neighbours[owner]
        indptr = np.concatenate([[0], np.cumsum(counts)])
        indices = _columns(free, first, high, indptr)
        return cls(node_dof, free, keys, offset, indptr, indices)

    @property
    def size(self) -> int:
        """Number of free dofs."""
        return self.indptr.shape[0] - 1

    def offset_of(self, rows: Index, columns: Index) -> Index:
        """Offset of each node pair rows <= columns, 0 for a pair of a node with itself.

        Raises `MissingPairs` where the pattern does not hold a pair.
        """
        off = rows != columns
        keys = rows * self.free.shape[0] + columns
        position = np.minimum(np.searchsorted(self.keys, keys), self.keys.shape[0] - 1)
        if np.any(off & (self.keys[position] != keys)):
            raise MissingPairs("the pattern does not hold a pair of nodes")
        return np.where(off, self.offset[position], 0)

    def starts_of(self, rows: Index, columns: Index) -> NDArray[np.int32]:
        """Where the columns of node pairs rows <= columns (...) begin among the values, in the row of each component.

        (..., 3), -1 where that component of the first node is prescribed, or all of the second node are. Of no meaning
        for pairs of a node with itself. Raises `MissingPairs` where the pattern does not hold a pair.
        """
        own = self._behind_own[rows]
        offset = self.offset_of(rows, columns).astype(np.int32)[..., None]
        return np.where((own < 0) | (self.free[columns] == 0)[..., None], np.int32(-1), own + offset)

    @cached_property
    def _behind_own(self) -> NDArray[np.int32]:
        """(n, 3) where the columns of other nodes begin in the row of each component, -1 where it is prescribed."""
        rank = np.cumsum(self.node_dof >= 0, axis=1) - 1  # among the free components of a node
        behind = self.indptr[self.node_dof] + self.free[:, None] - rank
        return np.where(self.node_dof < 0, -1, behind).astype(np.int32)

    def scatter(self, data: Array, rows: Index, columns: Index, values: Array, starts: NDArray[np.int32]) -> None:
        """Add node blocks values (m, 3, 3), rows <= columns, to data (nnz,); starts as `starts_of` gives them."""
        scatter_blocks(self.matrix(data), rows, columns, values, starts)

    def matrix(self, data: Array) -> ReducedMatrix:
        """The matrix with the values data (nnz,), as the kernels take it."""
        return ReducedMatrix(self.node_dof, self.indptr, self.free, data)


def element_keys(nodes: Index, points: int) -> Index:
    """Sorted unique keys of all node pairs that share an element; nodes (e, a)."""
    a, b = np.triu_indices(nodes.shape[1], 1)
    low = np.minimum(nodes[:, a], nodes[:, b])
    high = np.maximum(nodes[:, a], nodes[:, b])
    return sorted_unique((low * points + high).ravel())


def sorted_unique(values: Index) -> Index:
    """The different values (k,) of (m,) in ascending order; for millions of them faster than the hashing of numpy."""
    values = np.sort(values, kind="stable")
    return values[np.concatenate([[True], np.diff(values) > 0])[: values.shape[0]]]


def _columns(free: Index, first: Index, high: Index, indptr: Index) -> NDArray[np.int32]:
    """Column indices row by row: own components from the diagonal on, then the neighbours' free components."""
    start = np.concatenate([[0], np.cumsum(free)])
    indices = np.empty(indptr[-1], dtype=np.int32)
    lengths = free[high]
    begin = np.concatenate([[0], np.cumsum(lengths)])
    inner = np.arange(begin[-1]) - np.repeat(begin[:-1], lengths)
    spread = (np.repeat(start[high], lengths) + inner).astype(np.int32)
    rows = np.flatnonzero(free)
    for rank in range(3):
        here = rows[free[rows] > rank]
        own = free[here] - rank
        total = own + begin[first[here + 1]] - begin[first[here]]
        position = np.repeat(indptr[start[here] + rank], total)
        step = np.arange(total.sum()) - np.repeat(np.cumsum(total) - total, total)
        mine = step < np.repeat(own, total)
        value = np.empty(step.shape[0], dtype=np.int32)
        value[mine] = (np.repeat(start[here] + rank, total) + step)[mine]
        source = np.repeat(begin[first[here]], total) + step - np.repeat(own, total)
        value[~mine] = spread[source[~mine]]
        indices[position + step] = value
    return indices
