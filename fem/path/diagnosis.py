"""What the last equilibrium of a path tells of its end: a law out of its limits, a limit point near by, instability."""

from fem.effects.effect import Terms, at_constant_fraction
from fem.equations.linear import SingularMatrix
from fem.equations.system import System
from fem.path.active_set import ActiveSet
from fem.path.modes import falling_mode, stiffness_ratio_mode
from fem.path.newton import Converged
from fem.path.predictor import PathPoint
from fem.reasons import Reasons
from fem.solution import Step
from geometry import Reason

#: fraction of the elastic stiffness that is left, where least is left, below which a path that ends is at a limit
#: point; 0.2 % before the largest pressure of an arm of rubber it is 0.14
NEARLY_UNSTABLE = 0.2
#: elements that reach limit points of the body early. With a law that ends, such as St. Venant-Kirchhoff's, mixed
#: elements end earlier
EARLY = ("p2p0",)
#: of a path under a given load that has lost its stability before
NOT_FOLLOWED_EARLIER = Reason("not_followed_earlier")


def near_limit_point(
    system: System,
    last: PathPoint,
    law_is_named: bool = False,
    limit_is_confirmed: bool = False,
    gives_load: bool = True,
) -> Reasons:
    """Whether the last equilibrium is about to lose its stability, or has lost it. Factorizes.

    limit_is_confirmed: whether the path ended at the limit that it announced. gives_load: whether the load is
    prescribed; a path under a prescribed volume goes through limit points of the load, which then explain nothing.
    Where it is not, nothing if the law was named as the reason, else what is excluded. A singular tangent at rest is no
    limit point: a part of the body is not held there.
    """
    unexplained = () if law_is_named else (Reason("unexplained_under_volume"),)
    try:
        mode = stiffness_ratio_mode(system, last.state, last.terms)
    except SingularMatrix:
        if last.constant_fraction == 0.0:
            return (Reason("body_not_held"),)
        return _limit_point(system, Reason("singular_limit_point"), law_is_named) if gives_load else unexplained
    if not gives_load:
        return unexplained
    values = {"stiffness": max(mode.stiffness, 0.0)}
    if limit_is_confirmed or mode.stiffness <= NEARLY_UNSTABLE:
        return _limit_point(system, Reason("limit_point", values, mode.position), law_is_named)
    return () if law_is_named else (Reason("unexplained", values, mode.position),)


def _limit_point(system: System, reason: Reason, law_is_named: bool) -> Reasons:
    """With what leads further."""
    if law_is_named:
        return reason, Reason("law_exceeded")
    early = (Reason("early_limit"),) if system.space.element.name in EARLY else ()
    return reason, Reason("volume_leads_on"), *early


def instability(system: System, converged: Converged, terms: Terms) -> Reasons:
    """Count of the directions in which an equilibrium is unstable, and where it falls; empty for a stable one.

    Factorizes where it is unstable.
    """
    if not converged.negative_pivots:
        return ()
    values = {"directions": converged.negative_pivots}
    try:
        mode = falling_mode(system, converged.state, terms)
        return (Reason("unstable", {**values, "axis": mode.axis}, mode.position),)
    except SingularMatrix:
        return (Reason("unstable_at_limit_point", values),)


def instability_of(system: System, step: Step) -> Reasons:
    """The `instability` of a finished step, under the constraints of a system, which need not be those of its path."""
    state = system.state_at(step.displacement, step.factor)
    terms = at_constant_fraction(ActiveSet.of_step(system.terms, step).active, 1.0)
    assembly = system.assemble(state, terms)
    try:
        linearised = system.linearise(state, assembly, terms)
    except SingularMatrix:
        return (Reason("unstable_at_limit_point", {"directions": 1}),)
    return instability(system, Converged(state, assembly, 1, 0.0, linearised), terms)
