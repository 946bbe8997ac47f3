"""How a rod in equilibrium answers to small changes: of its kappa_0, of its law, at its clamp and of a held end.

One integration of the linearised equations (`linearised`) gives the derivatives of the shape and of the end force with
respect to any number of them. The boundary conditions choose the changes of M(0), F_x and F_y with which the moment at
the tip and the prescribed positions stay what they are.
"""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod.errors import RodError
from rod.mechanics.equilibrium import Equilibrium
from rod.mechanics.linearised import integrate
from rod.mechanics.own_weight import rest_moment_changes


@dataclass(frozen=True)
class Changes:
    """m small changes of a rod, at the n steps of its integration.

    Delta changes by compliance M_b - offset, with M_b the moment that bends the rod (M without that of the weight at
    rest).
    """

    kappa_0: Array  #: (n, 6, m) 1/mm, at `ABSCISSAE` of every step
    compliance: Array  #: (n, m) 1/(N mm2)
    offset: Array  #: (n, m) 1/mm
    theta0: Array  #: (m,) rad, at the clamp


@dataclass(frozen=True)
class Response:
    """Derivatives of an equilibrium: of the shape and the end force by every change, and by the end's position."""

    s: Array  #: (n + 1,) mm, ends of the steps
    shape: Array  #: (n + 1, 2, m) mm, of x and y
    force: Array  #: (2, m) N
    shape_by_end: Array  #: (n + 1, 2, 2), of x and y by the end's x and y against the clamp; zero where it is free
    force_by_end: Array  #: (2, 2) N/mm, likewise

    def shape_at(self, s: Array) -> Array:
        """(k, 2, m) of `shape` at the ends of steps nearest to s (k,) mm."""
        return self.shape[self._nearest(s)]

    def end_at(self, s: Array) -> Array:
        """(k, 2, 2) of `shape_by_end`, likewise."""
        return self.shape_by_end[self._nearest(s)]

    def _nearest(self, s: Array) -> Array:
        behind = np.clip(np.searchsorted(self.s, s), 1, len(self.s) - 1)
        return np.where(s - self.s[behind - 1] < self.s[behind] - s, behind - 1, behind)


def response(equilibrium: Equilibrium, changes: Changes) -> Response:
    """The derivatives at an equilibrium.

    Raises `RodError` for a rod that stretches, whose intercepts fade, or on which no load acts: it has no intercepts
    (`rod.law`), and the smallest load gives it those.
    """
    rod, problem, point = equilibrium.rod, equilibrium.problem, equilibrium.point
    if not equilibrium.load_steps:
        raise RodError("A rod without load has no derivatives: the smallest load adds the intercepts of its law.")
    if rod.extension is not None or rod.fade > 0.0:
        raise RodError("Derivatives are those of an inextensible rod whose intercepts do not fade.")
    length, base = rod.length, equilibrium.rigidity
    bent = changes.kappa_0 * length
    constant = bent - changes.offset[:, None] * length
    if problem.own_weight.any():
        at_rest = rest_moment_changes(problem.steps, problem.own_weight, problem.theta0, bent, changes.theta0)
        constant = constant - at_rest / problem.alpha[:, None, None]
    states = np.empty((len(problem.steps.s), 4))
    columns = np.empty((*states.shape, 3 + len(changes.theta0)))
    weight = problem.weight_at(1.0)
    by_moment = changes.compliance * base
    integrate(problem.arrays(1.0), point.unknowns, weight, constant, by_moment, changes.theta0, states, columns)
    at_end = columns[-1, 1:]  # of M, x and y
    matrix = np.where(np.outer(problem.free, problem.free), at_end[:, :3], np.eye(3))
    unknowns = np.linalg.solve(matrix, np.where(problem.free[:, None], -at_end[:, 3:], 0.0))
    by_end = np.linalg.solve(matrix, np.eye(3)[:, 1:] * problem.free[1:])
    shape, unit = columns[:, 2:], base / length**2
    return Response(
        problem.steps.s * length,
        length * (shape[:, :, 3:] + shape[:, :, :3] @ unknowns),
        unit * unknowns[1:],
        shape[:, :, :3] @ by_end,
        np.asarray(unit / length * by_end[1:]),
    )
