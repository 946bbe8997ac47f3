"""The displacements that the supports of a model admit, as u = T q + g.

The equations of all supports are solved by elimination: each one expresses a displacement component with a large
coefficient by the others. What is never expressed are the unknowns q: displacement components, then the unknowns that
supports bring along (the distance of a shared plane). T holds the coefficients, g the prescribed values. Newton's
equations are T^T K T dq = -T^T r, with r the nodal forces; these are zero on T's range in equilibrium, and what is left
of them are the reactions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from fem.discretisation import Discretisation
from fem.supports import COMPONENTS, Equations, Support, SupportError
from geometry.arrays import Array, Mask

#: coefficients below this, where those of the equation were 1, are what rounding leaves of zero
NEGLIGIBLE = 1e-9
#: a component is expressed by the others where its coefficient is at least this part of the largest one
PIVOT = 0.5
#: parts of the largest displacement by which rounding may take a state off the constraints: a sum over nodes that move
#: together rounds with their number, of which there are taken to be so many at least
ROUNDOFF, FEWEST = np.finfo(float).eps, 64


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Constraints:
    """All supports of a model: u = T q + g, with g = factor ramped + fraction constant."""

    transformation: sp.csr_matrix  #: (3 n, m) T; its stored entries, zeros included, are the same for all values
    ramped: Array  #: (n, 3) part of g that grows with the load factor, mm at factor 1
    constant: Array  #: (n, 3) part of g that is there in full from the first target on, mm

    @classmethod
    def of(cls, supports: Sequence[Support], space: Discretisation) -> "Constraints":
        """The supports resolved to nodes.

        Raises `SupportError` where they contradict each other or name nothing, and ValueError for a face that does not
        exist.
        """
        elimination = _Elimination(supports, space)
        equations = [support.equations(space) for support in supports]
        for number, rows in enumerate(equations):
            elimination.take_single(number, rows)
        for number, rows in enumerate(equations):
            elimination.take_coupled(number, rows)
        return elimination.constraints()

    @property
    def size(self) -> int:
        """Number of unknowns m."""
        return int(self.transformation.shape[1])

    @cached_property
    def selects(self) -> bool:
        """Whether each unknown is one displacement component, in their order: T is columns of the identity."""
        counts = np.diff(self.transformation.indptr)
        data, indices = self.transformation.data, self.transformation.indices
        return bool(
            np.all(counts <= 1)
            and np.all(data == 1.0)
            and indices.shape[0] == self.size
            and np.array_equal(indices, np.arange(self.size))
        )

    @cached_property
    def constrained(self) -> Mask:
        """(n, 3) components on which a support acts: all others are unknowns by themselves."""
        matrix = self.transformation
        counts, uses = np.diff(matrix.indptr), np.bincount(matrix.indices, minlength=self.size)
        row = np.repeat(np.arange(matrix.shape[0]), counts)
        unknown = (counts[row] == 1) & (matrix.data == 1.0) & (uses[matrix.indices] == 1)
        constrained = np.ones(matrix.shape[0], dtype=bool)
        constrained[row[unknown]] = False
        return constrained.reshape(-1, 3)

    def prescribed(self, factor: float, fraction: float) -> Array:
        """g (n, 3) in mm at a load factor, the constant part scaled to `fraction`."""
        return factor * self.ramped + fraction * self.constant

    def reduce(self, forces: Array) -> Array:
        """T^T f (m,) of nodal forces (n, 3)."""
        return np.asarray(self._transposed @ forces.ravel())

    def expand(self, unknowns: Array) -> Array:
        """T q (n, 3), mm, of changes of the unknowns (m,)."""
        return np.asarray(self.transformation @ unknowns).reshape(-1, 3)

    def project(self, displacement: Array) -> Array:
        """The admissible variation T q (n, 3) that is nearest to nodal values (n, 3)."""
        right = self.reduce(displacement)
        return self.expand(right if self._normal is None else self._normal.solve(right))

    def correction(self, displacement: Array, prescribed: Array) -> Array:
        """The smallest change (n, 3) after which a displacement (n, 3) is T q + g for g = prescribed (n, 3), mm.

        Exactly zero where only rounding is left to correct.
        """
        change = self.project(displacement - prescribed) + prescribed - displacement
        if not self.selects:
            size = max(float(np.abs(displacement).max()), float(np.abs(prescribed).max()))
            change[np.abs(change) <= self._rounding * size] = 0.0
        return np.asarray(change)

    @cached_property
    def _rounding(self) -> float:
        """Part of the largest displacement by which rounding may take a state off the constraints."""
        return float(ROUNDOFF * max(FEWEST, np.bincount(self.transformation.indices).max()))

    @cached_property
    def _transposed(self) -> sp.csc_matrix:
        return self.transformation.T

    @cached_property
    def _normal(self) -> SuperLU | None:
        """T^T T, factorized; None where it is the identity."""
        if self.selects:
            return None
        return splu((self._transposed @ self.transformation).tocsc(), permc_spec="MMD_AT_PLUS_A")


@final
class _Elimination:
    """Gaussian elimination of the supports' equations, first those of one component each, then those that couple some.

    Components are numbered 3 n + i, and after them stands one unknown of each support that brings one along.
    """

    def __init__(self, supports: Sequence[Support], space: Discretisation) -> None:
        self.supports = supports
        self.space = space
        count = space.points.size
        self.owner = np.full(count, -1, dtype=np.int64)  #: the support that prescribes a component alone
        #: by component: ramped and constant part of what it is expressed by
        self.values = np.zeros((count + len(supports), 2))
        self.expressed: dict[int, dict[int, float]] = {}  #: by component: coefficients of those that express it
        self.users: dict[int, set[int]] = {}  #: by component: those that it helps to express
        self.common: set[int] = set()  #: unknowns of supports
        self.size = float(np.ptp(space.points, axis=0).max())

    def take_single(self, number: int, equations: Equations) -> None:
        """Equations that prescribe one component each."""
        if not _single(equations):
            return
        components = equations.components[:, 0]
        values = np.stack([equations.ramped, equations.constant], axis=1) / equations.coefficients
        earlier = self.owner[components] >= 0
        differs = earlier & (np.abs(values - self.values[components]).max(axis=1, initial=0.0) > NEGLIGIBLE * self.size)
        if differs.any():
            component = int(components[int(np.argmax(differs))])
            raise self._conflict(number, component, self.supports[int(self.owner[component])])
        self.owner[components] = number
        self.values[components] = values

    def take_coupled(self, number: int, equations: Equations) -> None:
        """Equations with several components, or with an unknown in common."""
        if _single(equations):
            return
        extra = self.owner.shape[0] + number
        if equations.common:
            self.common.add(extra)
        for row in np.flatnonzero(~self._take_apart(extra, equations)):
            terms = list(zip(equations.components[row].tolist(), equations.coefficients[row].tolist(), strict=True))
            if equations.common:
                terms.append((extra, -equations.common))
            right = np.array([equations.ramped[row], equations.constant[row]])
            self._eliminate(number, terms, right)

    def _take_apart(self, extra: int, equations: Equations) -> Mask:
        """Do all equations with a free component at once, by the rules of `_eliminate`; which of them these are.

        None where a component stands in two of them, or in earlier ones with several components.
        """
        components, coefficients = equations.components, equations.coefficients
        known, several = self.expressed.keys() | self.users.keys(), np.unique(components).size < components.size
        if several or not known.isdisjoint(components.ravel().tolist()):
            return np.zeros(components.shape[0], dtype=bool)
        size = np.abs(coefficients)
        scale = np.maximum(size.max(axis=1, keepdims=True), abs(equations.common))
        free = self.owner[components] < 0
        size = np.where(free & (size > NEGLIGIBLE * scale), size, 0.0)
        done = size.any(axis=1)
        rows, first = np.arange(components.shape[0]), np.argmax(size >= PIVOT * size.max(axis=1, keepdims=True), axis=1)
        known_part = np.sum(coefficients[..., None] * self.values[components], axis=1)
        right = np.stack([equations.ramped, equations.constant], axis=1) - known_part
        free[rows, first] = False
        for row in np.flatnonzero(done):
            pivot, leading = int(components[row, first[row]]), float(coefficients[row, first[row]])
            others, factors = components[row, free[row]].tolist(), -coefficients[row, free[row]] / leading
            expression = dict(zip(others, factors.tolist(), strict=True))
            if equations.common:
                expression[extra] = equations.common / leading
            self._express(pivot, expression, right[row] / leading)
        return np.asarray(done)

    def _eliminate(self, number: int, terms: Sequence[tuple[int, float]], right: Array) -> None:
        """Express one more component by the equation sum of coefficient times component = right (2,)."""
        row: dict[int, float] = {}
        for component, coefficient in self._expanded(terms):
            row[component] = row.get(component, 0.0) + coefficient
        right = right - sum(coefficient * self.values[component] for component, coefficient in terms)
        scale = max(abs(coefficient) for _, coefficient in terms)
        candidates = {component: value for component, value in row.items() if abs(value) > NEGLIGIBLE * scale}
        if not candidates:
            if np.abs(right).max() > NEGLIGIBLE * scale * self.size:
                raise self._conflict(number, terms[0][0], None)
            return
        displacements = [component for component in candidates if component not in self.common]
        largest = max(abs(candidates[component]) for component in displacements or candidates)
        # the first that is large enough: it stays the same for the next values, and with it the sparsity of T
        pivot = next(
            component for component in displacements or candidates if abs(candidates[component]) >= PIVOT * largest
        )
        leading = row.pop(pivot)
        expression = {component: -value / leading for component, value in row.items()}
        self._express(pivot, expression, right / leading)

    def _expanded(self, terms: Sequence[tuple[int, float]]) -> Iterator[tuple[int, float]]:
        """The terms in those components that are not yet prescribed or expressed by others."""
        for component, coefficient in terms:
            if component in self.expressed:
                for other, value in self.expressed[component].items():
                    yield other, coefficient * value
            elif component >= self.owner.shape[0] or self.owner[component] < 0:
                yield component, coefficient

    def _express(self, pivot: int, expression: dict[int, float], value: Array) -> None:
        """Replace the pivot in all expressions that contain it."""
        self.expressed[pivot] = expression
        self.values[pivot] = value
        for user in self.users.pop(pivot, set()):
            factor = self.expressed[user].pop(pivot)
            self.values[user] += factor * value
            for component, coefficient in expression.items():
                self.expressed[user][component] = self.expressed[user].get(component, 0.0) + factor * coefficient
                self.users.setdefault(component, set()).add(user)
        for component in expression:
            self.users.setdefault(component, set()).add(pivot)

    def constraints(self) -> Constraints:
        """u = T q + g for all components that are neither prescribed nor expressed by others."""
        count = self.owner.shape[0]
        free = self.owner < 0
        free[[component for component in self.expressed if component < count]] = False
        unknowns = [*np.flatnonzero(free).tolist(), *sorted(self.common - self.expressed.keys())]
        column = np.full(self.values.shape[0], -1)
        column[unknowns] = np.arange(len(unknowns))
        entries = [
            (component, other, value)
            for component, expression in self.expressed.items()
            if component < count
            for other, value in expression.items()
        ]
        rows, others, values = np.array(entries, dtype=float).reshape(-1, 3).T
        rows, columns = rows.astype(np.int64), column[others.astype(np.int64)]
        independent = np.flatnonzero(free)
        matrix = sp.csr_matrix(
            (
                np.concatenate([np.ones(independent.shape[0]), values]),
                (
                    np.concatenate([independent, rows]),
                    np.concatenate([np.arange(independent.shape[0]), columns]),
                ),
            ),
            shape=(count, len(unknowns)),
        )
        matrix.sort_indices()
        ramped, constant = self.values[:count].T.reshape(2, -1, 3)
        return Constraints(matrix, np.ascontiguousarray(ramped), np.ascontiguousarray(constant))

    def _conflict(self, number: int, component: int, other: Support | None) -> SupportError:
        node, axis = divmod(component, 3)
        at = ", ".join(f"{value:.6g}" for value in self.space.points[node])
        with_others = _words(other) if other is not None else "other supports"
        return SupportError(
            f"{_words(self.supports[number])} contradicts {with_others}: they prescribe different displacements "
            f"{COMPONENTS[axis]} of the node at ({at}) mm"
        )


def _single(equations: Equations) -> bool:
    """Whether each equation prescribes one component."""
    return equations.components.shape[1] == 1 and equations.common == 0.0


def _words(support: Support) -> str:
    """The support in a sentence."""
    where = support.where
    named = isinstance(where, str | tuple)
    return f"{type(support).__name__} at {where!r}" if named else f"{type(support).__name__} at given positions"
