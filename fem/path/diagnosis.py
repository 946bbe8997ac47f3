"""What the last equilibrium of a path tells of its end: a law out of its limits, a limit point near by, instability."""

from fem.effects.effect import Terms
from fem.equations.linear import SingularMatrix
from fem.equations.state import State
from fem.equations.system import System
from fem.path.modes import critical_mode, stiffness_ratio_mode
from fem.path.newton import Converged
from fem.path.predictor import PathPoint
from fem.post.extremes import unstable_stretch
from geometry import position_text

#: fraction of the elastic stiffness that is left, where least is left, below which a path that ends is at a limit
#: point; 0.2 % before the largest pressure of an arm of rubber it is 0.14
NEARLY_UNSTABLE = 0.2

PASSABLE = "a limit point, beyond which only a prescribed volume (in Python, fem.follow_volume) or displacement leads"
#: where the law was driven out of its limits: beyond such limits of half discs and bars of St. Venant-Kirchhoff a
#: prescribed volume did not lead, and neo-Hooke's law led 1.1 to 1.4 times as far, on three designs drawn at random
OF_LAW = "a limit point; the law is beyond its limits there, and another law may lead further"
#: what is added to limit points of the body, not of the law, for an element that reaches them early: 12 to 16 % on arms
#: of rubber, 78.8 instead of 93.7 kPa. With a law that ends, such as St. Venant-Kirchhoff's, mixed elements end earlier
EARLY_LIMITS = {"p2p0": " (p2p0 elements are too soft and reach limit points up to 16 % early; mixed ones do not)"}

#: begin of a clause about a path under a given load that has lost its stability, and what follows where it did
NOT_FOLLOWED = "the path was not followed: it lost its stability"
OTHER_BRANCH = "; smaller steps there end at a limit point or follow another branch"
NOT_FOLLOWED_EARLIER = f"{NOT_FOLLOWED} on the way to an earlier state{OTHER_BRANCH}"


def not_followed(stable: float, unstable: float) -> str:
    """A clause about a path that lost its stability between these two fractions of the way to a target."""
    where = f"between {100 * stable:.1f} and {100 * unstable:.1f} % of the way to this state"
    return f"{NOT_FOLLOWED} {where}{OTHER_BRANCH}"


def law_limit_clause(system: System, state: State) -> str:
    """A clause for a law that was driven out of its limits; empty otherwise."""
    clause = unstable_stretch(system.space, state.displacement, system.material)
    return f"; there {clause}" if clause else ""


def near_limit_point(
    system: System,
    last: PathPoint,
    law_is_named: bool = False,
    limit_is_confirmed: bool = False,
    gives_load: bool = True,
) -> str:
    """A clause where the last equilibrium is about to lose its stability or has lost it. Factorizes.

    That is so where the path ended at the limit that it announced, whatever stiffness is left. Otherwise empty where
    the law was named as the reason, and a clause that says what was excluded where it was not. A singular tangent at
    rest is no limit point: a part of the body is not held there. gives_load: whether the load is prescribed; a path
    under a prescribed volume goes through limit points of the load, which then explain nothing and are not named.
    """
    limit_point = OF_LAW if law_is_named else PASSABLE + EARLY_LIMITS.get(system.space.element.name, "")
    try:
        mode = stiffness_ratio_mode(system, last.state, last.terms)
    except SingularMatrix:
        if last.constant_fraction == 0.0:
            return "; at rest the tangent is singular: a part of the body is not held"
        if not gives_load:
            return _unexplained_under_volume(law_is_named)
        return f"; the tangent at the last equilibrium is singular: {limit_point}"
    if not gives_load:
        return _unexplained_under_volume(law_is_named)
    is_near = limit_is_confirmed or mode.stiffness <= NEARLY_UNSTABLE
    if not is_near and law_is_named:
        return ""
    if not is_near:
        return (
            f"; neither the law nor a limit point explains it: the last equilibrium has {mode.stiffness:.0%} of its "
            f"elastic stiffness left, least in a motion that is largest at {position_text(mode.position)}; a smaller "
            "mesh there, another formulation of the elements or pressures in between may lead further"
        )
    return (
        f"; the last equilibrium has {max(mode.stiffness, 0.0):.1%} of its elastic stiffness left in a motion "
        f"that is largest at {position_text(mode.position)}: {limit_point}"
    )


def _unexplained_under_volume(law_is_named: bool) -> str:
    """A clause about the end of a path under a prescribed volume; empty where the law was named as the reason."""
    if law_is_named:
        return ""
    return (
        "; the law does not explain it: a smaller mesh, another formulation of the elements or volumes in between may "
        "lead further"
    )


def instability(system: System, converged: Converged, terms: Terms) -> str:
    """In how many directions an equilibrium is unstable, and where it moves; empty for a stable one.

    Factorizes where it is unstable.
    """
    if not converged.negative_pivots:
        return ""
    count = f"{converged.negative_pivots} direction{'s' if converged.negative_pivots > 1 else ''}"
    try:
        mode = critical_mode(system, converged.state, terms)
    except SingularMatrix:
        return f"unstable in {count}, at a limit point"
    return f"unstable in {count}; the motion nearest to a limit point is largest at {position_text(mode.position)}"
