"""Newton's method with the stress as an independent unknown (mixed integration points): algebra only.

Source: D. Magisano, L. Leonetti, G. Garcea, "How to improve efficiency and robustness of the Newton method in
geometrically non-linear structural problem discretized via displacement-based finite elements", Comput. Methods Appl.
Mech. Engrg. 313 (2017). There the law is linear. For others the strain e is carried beside the stress, and the law is
linearised around it,

    S(E(u)) ~ S(e) + C(e) : (E(u) - e),    K = sum w (B^T C(e) B + G(S)),    K du = -R(u),
    S <- S(e) + C(e) : (E(u) + B du - e),    e <- E(u) + B du,    u <- u + du,

because u alone strains the body far more on its way than it does in the end. In equilibrium e = E(u), which is checked
with the law itself, so the solution is that of the usual method. Measured with an older contact, three chambers of arm
(a), nu = 0.495, to 5, 17 and 37 kPa with contact: 5, 14 and 11 factorizations for Hencky's law (71, 41 and 191 with the
law at E(u)), 5, 13 and 11 for St. Venant-Kirchhoff's.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem.effects.effect import Terms, UnilateralTerm, advanced, smallest_gap, step_limit
from fem.equations.linear import SingularMatrix
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, Change, State
from fem.equations.system import System
from fem.path.control import Control

#: relative residual below which a state shows which walls meet. Factorizations of I, II and III on the coarse arm (a)
#: at 17 and 37 kPa: 51, and 54 where equilibrium without contact is found first
NEAR = 0.1

#: called after every iteration with its number and the relative residual
Watch = Callable[[int, float], None]


@dataclass(frozen=True)
class NewtonOptions:
    """When Newton stops."""

    tolerance: float = 1e-6  #: norm of the residual over the norm of the internal forces
    iterations: int = 30  #: factorizations per step at the most
    strain: float = 0.14  #: largest change of a strain component, to first order, where the tangent is indefinite
    limited: int = 10  #: iterations limited by that before the attempt is given up


@dataclass(frozen=True)
class Converged:
    """Equilibrium at one load factor, or a state near to it that wakes effects (see `solve`)."""

    state: State
    assembly: Assembly
    iterations: int  #: factorizations spent
    residual: float  #: relative
    linearised: Linearised | None  #: the tangent of the last iteration; None where no iteration was needed

    @property
    def negative_pivots(self) -> int:
        """Of the last iteration's tangent; 0 where no iteration was needed."""
        return 0 if self.linearised is None else self.linearised.negative_pivots


class StepFailed(ArithmeticError):
    """One attempt at a step ended without equilibrium; the sentence says where and why."""


def solve(
    system: System,
    terms: Terms,
    start: State,
    control: Control,
    options: NewtonOptions,
    watch: Watch,
    inactive: tuple[UnilateralTerm, ...] = (),
) -> Converged:
    """Equilibrium of the body with `terms` where `control` puts it, from `start`.

    Returns early, unconverged, once the relative residual is below NEAR and an inactive contact is penetrated; the
    caller then activates it.

    Raises `StepFailed`.
    """
    state = control.begin(start)
    linearised: Linearised | None = None
    relative, limited = np.inf, 0
    for iteration in range(options.iterations + 1):
        assembly = system.assemble(state, terms)
        jump = system.constraints.correction(state.displacement, control.prescribed)
        relative = _relative_residual(system, assembly)
        watch(iteration, relative)
        there = not np.any(jump) and abs(control.miss(system, state)) < options.tolerance
        if relative < options.tolerance and there:
            settled = system.state_at(state.displacement, state.factor)
            exact = system.assemble(settled, terms)
            relative = _relative_residual(system, exact)
            if relative < options.tolerance:
                return Converged(settled, exact, iteration, relative, linearised)
        if relative < NEAR and smallest_gap(inactive, system.space.points + state.displacement) < 0:
            return Converged(state, assembly, iteration, relative, linearised)
        if not np.isfinite(relative):
            raise StepFailed(f"the residual grew without bound after {iteration} iterations")
        if linearised is not None and limited > options.limited:
            raise StepFailed(f"the tangent stays indefinite ({linearised.negative_pivots} negative pivots)")
        if iteration < options.iterations:
            begin, x = state.displacement, system.space.points + state.displacement
            try:
                linearised = system.linearise(state, assembly, terms, jump, convex=relative > 0.1)
                change, unstable = control.change(system, state, assembly, linearised, jump, terms)
            except SingularMatrix as error:
                raise StepFailed(f"the tangent is singular ({error})") from None
            change = replace(change, displacement=change.displacement + jump)
            limit = options.strain if unstable else np.inf
            state, whole = _advance(system, terms, state, assembly, change, limit)
            limited += not whole
            terms = advanced(terms, x, state.displacement - begin)
    raise StepFailed(f"no equilibrium after {options.iterations} iterations (relative residual {relative:.1e})")


def _advance(
    system: System, terms: Terms, state: State, assembly: Assembly, change: Change, limit: float
) -> tuple[State, bool]:
    """The next state, and whether no strain component was kept from changing by more than `limit`."""
    strain = system.linearised_strain(state, change.displacement)
    largest = float(np.abs(strain).max())
    # an indefinite tangent (thin walls at rest under the whole pressure) points past a saddle: its direction counts
    whole = not largest > limit
    share = 1.0 if whole else limit / largest
    share *= step_limit(terms, system.space.points + state.displacement, share * change.displacement)
    return system.advanced(state, assembly, change.scaled(share), share * strain), whole


def _relative_residual(system: System, assembly: Assembly) -> float:
    residual = float(np.linalg.norm(system.constraints.reduce(assembly.gradient)))
    if residual <= assembly.roundoff:  # a turned body without stress: nothing balances, so nothing to compare with
        return 0.0
    return residual / assembly.scale if assembly.scale > 0 else (np.inf if residual > 0 else 0.0)
