"""The factorized tangent of a system at one state, as a value."""

from collections.abc import Sequence
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

    The solver holds one factor at a time. `solve` works until the system is linearised again or its solver is closed,
    and raises `StaleFactorization` from then on; the other members stay.
    """

    coupling: Change  #: the tangent times the increment by which the displacement is about to meet the constraints
    negative_pivots: int  #: beyond the one that every pressure unknown has; 0 in a stable equilibrium
    _solver: LinearSolver = field(repr=False)
    _generation: int = field(repr=False)
    _constraints: Constraints = field(repr=False)

    def solve(self, gradient: Array, pressure_residual: Array | None = None) -> Change:
        """The change of the unknowns that cancels a gradient (n, 3), N, and a pressure residual (v,), zero by default.

        It keeps to the constraints: prescribed components do not change. Raises `StaleFactorization`, and
        `SingularMatrix` where the solution is not finite.
        """
        return self.solve_each([(gradient, pressure_residual)])[0]

    def solve_each(self, residuals: Sequence[tuple[Array, Array | None]]) -> list[Change]:
        """What `solve` gives for each gradient (n, 3) and pressure residual (v,), in less time.

        None stands for a pressure residual of zero. Raises as `solve`.
        """
        if self._solver.generation != self._generation:
            raise StaleFactorization("the tangent was factorized again since; this factorization is gone")
        count, none = self._constraints.size, np.zeros_like(self.coupling.pressure)
        columns = [
            np.concatenate([self._constraints.reduce(gradient), none if pressures is None else pressures])
            for gradient, pressures in residuals
        ]
        right = -columns[0] if len(columns) == 1 else -np.column_stack(columns)
        solutions = self._solver.solve(right).reshape(right.shape[0], -1).T
        return [Change(0.0, self._constraints.expand(each[:count]), each[count:].copy()) for each in solutions]
