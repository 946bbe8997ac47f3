"""Newton's method with the stress as an independent unknown (mixed integration points): algebra only.

Source: D. Magisano, L. Leonetti, G. Garcea, "How to improve efficiency and robustness of the Newton method in
geometrically non-linear structural problem discretized via displacement-based finite elements", Comput. Methods Appl.
Mech. Engrg. 313 (2017). There the law is linear. For others the strain e is carried beside the stress, and the law is
linearised around it,

    S(E(u)) ~ S(e) + C(e) : (E(u) - e),    K = sum w (B^T C(e) B + G(S)),    K du = -R(u),
    S <- S(e) + C(e) : (E(u) + B du - e),    e <- E(u) + B du,    u <- u + du,

because u alone strains the body far more on its way than it does in the end. In equilibrium e = E(u), which is checked
with the law itself, so the solution is that of the usual method. Contact carries its gaps (`fem.effects.barrier`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem.effects.effect import Terms, UnilateralTerm, advanced, settled, smallest_gap, step_limit
from fem.equations.linear import SingularMatrix
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, State
from fem.equations.system import System
from fem.path.control import Control
from fem.reasons import FailedForReasons
from geometry import Reason
from geometry.arrays import Array

#: relative residual below which a state shows which walls meet, as well as an equilibrium does
NEAR = 0.1
#: relative residual above which terms give a positive semi-definite substitute of their second derivative
CONVEX_ABOVE = 0.1
#: relative residual above which a state is far from equilibrium
FAR = 0.5
#: part of the tolerance below which an equilibrium is taken that the factor of an earlier iteration led to, before the
#: last iteration; and that below which it is taken where rounding keeps its residual above a part of the one before
SHARPER, ROUNDED, KEPT = 0.001, 0.01, 0.5

#: called after every iteration with its number and the relative residual
Watch = Callable[[int, float], None]


@dataclass(frozen=True)
class NewtonOptions:
    """When Newton's method stops."""

    tolerance: float = 1e-6  #: norm of the reduced residual over the larger of the norms of internal forces and loads
    iterations: int = 30  #: largest number of iterations, one factorization each
    strain: float = 0.14  #: largest change of a strain component, to first order, where the tangent is indefinite
    #: largest number of iterations in which the change of strain is limited; those that led anywhere on the hard cases
    #: had at most 2
    limited: int = 5
    #: largest number of iterations far from equilibrium (`FAR`): where the method wanders longer, it finds nothing, or
    #: an equilibrium to which the path does not lead
    far: int = 8
    #: whether the strain is an unknown of its own; without, a body that stretches far more than it turns takes less
    carries: bool = True
    reuses: bool = False  #: whether the last iterations use the factor of the one before again, under a prescribed load
    rough: float = 0.0  #: relative residual at which a state is taken that only leads to others


@dataclass(frozen=True)
class Start:
    """Where Newton's method starts, and how much it may cost from there."""

    state: State
    terms: Terms  #: with the stress and the gaps that go with the state
    max_iterations: int | None = None  #: besides that of `NewtonOptions`; None: no other
    iterates: bool = False  #: whether an equilibrium there needs an iteration, whose tangent tells its stability
    trial: bool = False  #: whether it is given up as soon as the strain is limited, because another start follows
    max_unstable: int | None = None  #: iterations with an indefinite tangent, after which it is given up; None: any
    stays_stable: bool = False  #: whether it is given up where the tangent has been definite and is no longer

    @classmethod
    def at(cls, state: State, terms: Terms) -> "Start":
        """From an equilibrium of these or other terms; one beyond rest needs an iteration, to tell its stability."""
        return cls(state, terms, iterates=not state.is_at_rest)


@dataclass(frozen=True)
class Converged:
    """Equilibrium, or a state near to it in which walls cross whose contact is inactive (see `solve`)."""

    state: State
    assembly: Assembly
    iterations: int  #: those with a factorization of their own
    residual: float  #: relative
    linearised: Linearised | None  #: the tangent that was factorized last; None where no iteration was needed

    @property
    def negative_pivots(self) -> int:
        """Negative pivots of the last iteration's tangent; 0 where no iteration was needed, as at rest."""
        return 0 if self.linearised is None else self.linearised.negative_pivots


class StepFailed(FailedForReasons):
    """An attempt at an increment ended without equilibrium."""


class Unstable(StepFailed):
    """An attempt met no stable equilibrium: the tangent is indefinite."""


class NotAdmissible(StepFailed):
    """An attempt ended with an equilibrium that no body can have; its first reason is the cause."""


def solve(
    start: Start, control: Control, options: NewtonOptions, watch: Watch, inactive: tuple[UnilateralTerm, ...] = ()
) -> Converged:
    """Equilibrium of the body where `control` puts it, from `start`.

    Returns early, unconverged, once the relative residual is below NEAR and a term of `inactive` is penetrated; the
    caller then activates it. Raises `StepFailed`.
    """
    system, state, terms = control.system, control.start(start.state), start.terms
    most = min(options.iterations, start.max_iterations or options.iterations)
    patience = _Patience.of(start, options, most)
    linearised: Linearised | None = None
    again: Linearised | None = None
    relative, is_limited, reused = np.inf, False, 0
    for iteration in range(most + 1):
        assembly = system.assemble(state, terms)
        if iteration and not options.carries:
            state = replace(state, stress=assembly.stress)
        correction = system.constraints.correction(state.displacement, control.prescribed)
        last, relative = relative, _relative_residual(system, assembly)
        watch(iteration, relative)
        is_at_target = not np.any(correction) and abs(control.residual(state)) < options.tolerance
        sharper = ROUNDED if relative > KEPT * last else SHARPER
        is_near = relative < max(options.rough, options.tolerance * (sharper if again and iteration < most else 1.0))
        if is_near and is_at_target and (iteration or not start.iterates):
            consistent, exact = system.settled(state, settled(terms))
            relative = _relative_residual(system, exact)
            if relative < max(options.rough, options.tolerance):
                return Converged(consistent, exact, iteration - reused, relative, linearised)
        if relative < NEAR and smallest_gap(inactive, system.space.points + state.displacement) < 0:
            return Converged(state, assembly, iteration - reused, relative, linearised)
        patience.check(iteration, relative, linearised, is_limited)
        if iteration < most:
            # two more reductions like the last one lead to the tolerance: a factor is worth about five of them
            leads = is_at_target and not is_limited and relative**3 < options.tolerance * last**2
            again = linearised if options.reuses and leads and linearised and not linearised.negative_pivots else None
            reused += again is not None
            before = _Iterate(state, terms, assembly, correction, again)
            state, linearised, is_limited = _iterate(before, control, relative > CONVEX_ABOVE, options.strain)
            terms = advanced(terms, before.positions(system), state.displacement - before.state.displacement)
            state = state if options.carries else system.strained(state)
    raise StepFailed(Reason("not_converged", {"iterations": most, "residual": relative}))


@dataclass
class _Patience:
    """How long an attempt may go on without an equilibrium, and what of it is spent."""

    start: Start
    most_limited: int  #: iterations in which the change of strain is limited
    most_far: int  #: iterations far from equilibrium, the start among them
    limited: int = 0
    far: int = 0
    unstable: int = 0

    @classmethod
    def of(cls, start: Start, options: NewtonOptions, iterations: int) -> "_Patience":
        """At the start; iterations: the largest number of all."""
        far = iterations if any(term.is_infinite for term in start.terms) else options.far
        return cls(start, 0 if start.trial else options.limited, far + 1)

    def check(self, iteration: int, relative: float, linearised: Linearised | None, is_limited: bool) -> None:
        """Raises `StepFailed` where the tangent that led to this relative residual leads nowhere, `Unstable` where it
        is indefinite too long."""
        if not np.isfinite(relative):
            raise StepFailed(Reason("residual_unbounded", {"iterations": iteration}))
        self.far += relative > FAR
        if self.far > self.most_far:
            raise StepFailed(Reason("far_from_equilibrium", {"iterations": iteration, "residual": relative}))
        if linearised is None:
            return
        start, pivots = self.start, linearised.negative_pivots
        self.limited += is_limited
        self.unstable += pivots > 0
        code = ""
        if start.stays_stable and pivots and self.unstable < iteration:
            code = "tangent_turns_indefinite"
        elif start.max_unstable is not None and self.unstable > start.max_unstable:
            code = "tangent_indefinite"
        elif self.limited > self.most_limited:
            code = "tangent_stays_indefinite"
        if code:
            raise Unstable(Reason(code, {"negative_pivots": pivots}))


@dataclass(frozen=True)
class _Iterate:
    """What an iteration starts from."""

    state: State
    terms: Terms
    assembly: Assembly
    correction: Array  #: (n, 3) what the prescribed displacements still miss, mm
    again: Linearised | None  #: the tangent of an earlier iteration that is used once more; None: a new one

    def positions(self, system: System) -> Array:
        """(n, 3), mm."""
        return system.space.points + self.state.displacement


def _iterate(before: _Iterate, control: Control, convex: bool, max_strain: float) -> tuple[State, Linearised, bool]:
    """The next state, the tangent that led to it, and whether the strain was kept from changing by more than
    `max_strain` because the tangent is indefinite. Raises `StepFailed`."""
    system, state, assembly, terms = control.system, before.state, before.assembly, before.terms
    try:
        linearised = before.again or system.linearise(state, assembly, terms, before.correction, convex=convex)
        if before.again:  # nothing is left of the increment that it was coupled with
            nothing = linearised.coupling.scaled(0.0)
            linearised = replace(linearised, coupling=nothing)
        change, unstable = control.increment(state, assembly, linearised, before.correction, terms)
    except SingularMatrix as error:
        raise StepFailed(Reason("tangent_singular", {"why": str(error)})) from None
    change = replace(change, displacement=change.displacement + before.correction)
    strain = system.linearised_strain(state, change.displacement)
    largest = float(np.abs(strain).max())
    # an indefinite tangent (thin walls at rest under the full pressure) points past a saddle: its direction counts
    is_limited = unstable != 0 and largest > max_strain
    fraction = max_strain / largest if is_limited else 1.0
    fraction *= step_limit(terms, before.positions(system), fraction * change.displacement)
    return system.advanced(state, assembly, change.scaled(fraction), fraction * strain), linearised, is_limited


def _relative_residual(system: System, assembly: Assembly) -> float:
    """Infinite where a force is not finite."""
    residual = float(np.linalg.norm(system.constraints.reduce(assembly.gradient)))
    if not np.isfinite([residual, assembly.scale, assembly.roundoff]).all():
        return np.inf
    # a turned body without stress, or one without load: nothing balances, so nothing to compare with
    if residual <= assembly.roundoff:
        return 0.0
    return residual / assembly.scale if assembly.scale > 0 else (np.inf if residual > 0 else 0.0)
