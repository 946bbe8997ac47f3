"""The factorized tangent of a system at one state, as a value."""

from dataclasses import dataclass, field
from typing import final

import numpy as np

from fem.equations.constraints import Constraints
from fem.equations.linear import LinearSolver
from fem.equations.state import Change
from geometry.arrays import Array


class StaleFactorization(RuntimeError):
    """A factorization was used after the solver that held it made another one."""


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Linearised:
    """The tangent at one state, factorized.

    The solver holds one factor at a time. `solve` works until the system is linearised again, its sparsity pattern
    grows or its solver is closed, and raises `StaleFactorization` from then on; the other members stay.
    """

    coupling: Change  #: the tangent times the increment by which the displacement is about to meet the constraints
    negative_pivots: int  #: beyond the one that every pressure unknown has; 0 in a stable equilibrium
    _solver: LinearSolver = field(repr=False)
    _generation: int = field(repr=False)
    _constraints: Constraints = field(repr=False)

    @classmethod
    def of(cls, solver: LinearSolver, constraints: Constraints, coupling: Change) -> "Linearised":
        """The matrix that `solver` has just factorized."""
        pivots = solver.negative_pivots - coupling.pressure.shape[0]
        return cls(coupling, pivots, solver, solver.generation, constraints)

    def solve(self, gradient: Array, pressure_residual: Array | None = None) -> Change:
        """The change of the unknowns that cancels a gradient (n, 3), N, and a pressure residual (v,), zero by default.

        It keeps to the constraints: prescribed components do not change. Raises `StaleFactorization`, and
        `SingularMatrix` where the solution is not finite.
        """
        if self._solver.generation != self._generation:
            raise StaleFactorization("the tangent was factorized again since; this factorization is gone")
        if pressure_residual is None:
            pressure_residual = np.zeros_like(self.coupling.pressure)
        solution = self._solver.solve(-np.concatenate([self._constraints.reduce(gradient), pressure_residual]))
        count = self._constraints.size
        return Change(0.0, self._constraints.expand(solution[:count]), solution[count:])
