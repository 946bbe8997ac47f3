"""Where the values of a tangent stand: in the upper triangle over the free components, reduced by the constraints."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.discretisation import Discretisation, pairs_within
from fem.effects.effect import Blocks
from fem.equations.constraints import Constraints
from fem.equations.formulation import Formulation, PressureOffsets
from fem.equations.linear import LinearSolver
from fem.equations.pattern import MissingPairs, Pattern, element_keys, sorted_unique
from geometry.arrays import Array, Index, Mask


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Reduction:
    """T^T K T for matrices K of one pattern, given by their upper triangles, and one T, on a pattern that is made once.

    Each entry of the product is a fixed linear combination of the entries of K, so that a sparse matrix times the
    values of K gives those of the product. Entries that happen to be zero stay. Each of the p products T_ia K_ij T_jb
    is added to one entry of the result; products are sorted by that entry.
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
        """These products for another T with the same stored entries."""
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


#: row starts (d + 1,) and columns (nnz,) of an upper triangle in compressed rows
UpperTriangle = tuple[Index, NDArray[np.int32]]
#: what is analysed before anything is
_NOTHING: UpperTriangle = np.empty(0, np.int64), np.empty(0, np.int32)
#: rows and columns (m,), rows <= columns
NodePairs = tuple[Index, Index]


@final
class TangentStorage:
    """Sparsity pattern of a model's tangent, with the positions of elements, pressures and effects in it.

    Where the constraints select components the tangent is assembled over these alone. For others it is assembled over
    all components and reduced, T^T K T. The pattern is enlarged by new contact pairs and does not shrink along a path,
    so that re-analysis is rare. It is made when it is first used: a path of which every state is stored needs none.
    """

    added: Index  #: (k,) the node pairs of the pattern that no element has, as `Pattern.keys` are, sorted
    _pattern: Pattern
    _element_starts: NDArray[np.int32]
    _pressure_offsets: PressureOffsets

    def __init__(
        self, space: Discretisation, formulation: Formulation, constraints: Constraints, solver: LinearSolver
    ) -> None:
        self._space = space
        self._formulation = formulation
        self._constraints = constraints
        self._reduction: Reduction | None = None  #: None where the constraints select components
        self._solver = solver
        #: pattern of the factorized matrix, as it was last analysed
        self._analysed = _NOTHING
        #: blocks of the last tangent: their rows and starts, by the identity of the array of rows
        self._last: dict[int, tuple[Index, NDArray[np.int32]]] = {}
        self._nodes = space.points.shape[0] + formulation.unknowns
        self._of_elements = element_keys(formulation.element_unknowns, self._nodes)
        self.added = np.empty(0, dtype=np.int64)
        self._is_current = False  #: whether the pattern is that of `added`

    @property
    def pattern(self) -> Pattern:
        """Sparsity pattern of the assembled tangent."""
        self._bring_up_to_date()
        return self._pattern

    @property
    def element_starts(self) -> NDArray[np.int32]:
        """(e, pairs, 3) of the node pairs a <= b of each element, see `Pattern.starts_of`."""
        self._bring_up_to_date()
        return self._element_starts

    @property
    def pressure_offsets(self) -> PressureOffsets:
        """Where the pressures stand."""
        self._bring_up_to_date()
        return self._pressure_offsets

    def hold(self, added: Index) -> None:
        """Take the pattern of the elements and of these further node pairs, as `added` gives them."""
        if not np.array_equal(added, self.added):
            self.added, self._is_current = added, False

    def _bring_up_to_date(self) -> None:
        if not self._is_current:
            self._use(sorted_unique(np.concatenate([self._of_elements, self.added])))

    def constrain(self, constraints: Constraints) -> None:
        """Take other constraints."""
        self._constraints = constraints
        transformation = with_identity(constraints.transformation, self._formulation.unknowns)
        if self._is_current and self._reduction is not None and self._reduction.applies_to(transformation):
            self._reduction = self._reduction.with_values(transformation)
        else:
            self._is_current = False

    def reduced(self, data: Array) -> Array:
        """Values of the factorized matrix from those of the assembled tangent (nnz,)."""
        return data if self._reduction is None else self._reduction.values(data)

    def enlarge(self, rows: Index, columns: Index) -> None:
        """Hold the node pairs rows <= columns (m,) as well."""
        off = rows != columns
        keys = np.union1d(self.added, rows[off] * self._nodes + columns[off])
        self.hold(np.setdiff1d(keys, self._of_elements, assume_unique=True))

    def starts(self, blocks: Sequence[Blocks], near: Callable[[], NodePairs]) -> list[NDArray[np.int32]]:
        """Where the blocks of effects stand in the pattern.

        Where it does not hold them it is enlarged, by them and by the node pairs that `near` gives.
        """
        self._bring_up_to_date()
        try:
            starts = [self._starts(block) for block in blocks]
        except MissingPairs:
            rows, columns = near()
            rows = np.concatenate([rows, *(block.rows for block in blocks)])
            columns = np.concatenate([columns, *(block.columns for block in blocks)])
            self.enlarge(rows, columns)
            self._bring_up_to_date()
            starts = [self._starts(block) for block in blocks]
        self._last = {id(block.rows): (block.rows, start) for block, start in zip(blocks, starts, strict=True)}
        return starts

    def _starts(self, blocks: Blocks) -> NDArray[np.int32]:
        """From the last call where an effect gives the same array of rows again; raises `MissingPairs`."""
        if id(blocks.rows) in self._last:
            return self._last[id(blocks.rows)][1]
        return self._pattern.starts_of(blocks.rows, blocks.columns)

    def _use(self, keys: Index) -> None:
        """Take the pattern of node pairs with these keys."""
        space, selects, count = self._space, self._constraints.selects, self._space.points.shape[0]
        prescribed = np.ones((count + self._formulation.unknowns, 3), dtype=bool)
        prescribed[:count] = self._constraints.constrained if selects else False
        prescribed[count:, 0] = False  # a pressure stands in the pattern as a node with one component
        self._pattern = pattern = Pattern.of(prescribed, keys)
        of_elements = pattern.starts_of(*pairs_within(space.nodes)[:2])
        self._element_starts = of_elements.reshape(len(space.nodes), -1, 3)
        self._pressure_offsets = self._formulation.offsets(pattern)
        self._last = {}
        self._reduction = None
        if not selects:
            transformation = with_identity(self._constraints.transformation, self._formulation.unknowns)
            self._reduction = Reduction.of(pattern.indptr, pattern.indices, transformation)
        self._is_current = True

    def analyse(self) -> None:
        """Have the solver choose the order of elimination for the factorized matrix, if it has another pattern now."""
        pattern, (starts, columns) = self.pattern, self._analysed
        made = self._reduction or pattern
        if not (np.array_equal(made.indptr, starts) and np.array_equal(made.indices, columns)):
            self._analysed = _NOTHING
            self._solver.analyse(made.indptr, made.indices)
            self._analysed = made.indptr, made.indices


def with_identity(transformation: sp.csr_matrix, unknowns: int) -> sp.csr_matrix:
    """T with an identity for further unknowns below it and to its right; stored zeros stay."""
    rows, columns = transformation.shape
    return sp.csr_matrix(
        (
            np.concatenate([transformation.data, np.ones(unknowns)]),
            np.concatenate([transformation.indices, columns + np.arange(unknowns)]),
            np.concatenate([transformation.indptr, transformation.indptr[-1] + 1 + np.arange(unknowns)]),
        ),
        shape=(rows + unknowns, columns + unknowns),
    )
