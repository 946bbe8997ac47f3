"""Comparison of a state in contact with the equilibrium near it that has exact distances between walls.

A path is followed with pairs of nodes and triangles that face each other at rest: few factorizations lead along it, and
its states depend little on the targets. Where a cavity collapses, its walls slide along each other and turn,
and a node then rests on the plane of a triangle that it is no longer opposite to. Such a state is solved once more with
the distances between all triangles, and both are compared. The path goes on from the state with pairs.
"""

from dataclasses import replace

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.effect import at_constant_fraction
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.control import Control
from fem.path.newton import Converged, NewtonOptions, Start, StepFailed, Watch
from fem.post.extremes import extremes_of
from fem.reasons import Reasons
from fem.solution import ExactContact
from geometry import Reason

#: largest number of iterations; comparisons that succeeded took 3 to 14
MAX_ITERATIONS = 20
#: relative residual that is small enough for a comparison: with it the motions of nine ends were within 0.3 % of those
#: with 1e-6. Where walls fold Newton's method often stagnates below it
TOLERANCE = 1e-3


def with_exact_distances(
    control: Control, converged: Converged, active_set: ActiveSet, options: NewtonOptions, watch: Watch
) -> tuple[ExactContact | None, Reasons]:
    """The equilibrium with exact distances near the given one; or None and why it is not known.

    None and no reason where the distances of the given one need no comparison. options: those of the path.
    """
    system = control.system
    exact = active_set.with_exact_distances(system.space.points + converged.state.displacement)
    if exact is active_set:
        return None, ()
    terms = at_constant_fraction(exact.active, control.constant_fraction)
    start = Start(converged.state, terms, max_iterations=MAX_ITERATIONS)
    options = replace(options, tolerance=max(TOLERANCE, options.tolerance), far=MAX_ITERATIONS)
    added = system.storage.added
    try:
        solved = newton.solve(start, control, options, watch, exact.inactive)
        _check(system.space, solved, exact, options.tolerance)
    except StepFailed as failure:
        return None, failure.reasons
    except MemoryError as failure:
        return None, (Reason("out_of_memory", {"why": str(failure)}),)
    finally:
        system.storage.hold(added)  # the pattern of the matrix is again that of the path
    gradient = np.where(system.constraints.constrained, solved.assembly.gradient, 0.0)
    return ExactContact(solved.state.displacement, gradient), ()


def _check(space: Discretisation, solved: Converged, exact: ActiveSet, tolerance: float) -> None:
    """Raises `StepFailed` where the state is no equilibrium that the body can have."""
    x = space.points + solved.state.displacement
    if solved.assembly.jacobian.min() <= 0:
        worst = extremes_of(space, solved.assembly.strain, solved.assembly.jacobian)
        raise StepFailed(Reason("element_inverted", {"min_J": worst.min_J}, worst.min_J_at))
    if violations := exact.violations(x):
        raise StepFailed(violations[0])
    if solved.residual > tolerance or exact.activated(x) is not exact:
        raise StepFailed(Reason("further_walls_meet"))
