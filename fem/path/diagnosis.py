"""What the last equilibrium of a path tells of its end: a law out of its limits, a limit point near by, instability."""

from fem.effects.effect import Terms
from fem.equations.linear import SingularMatrix
from fem.equations.state import State
from fem.equations.system import System
from fem.path.modes import most_softened, softest_direction
from fem.path.newton import Converged
from fem.post import extremes
from fem.post.extremes import extremes_of, in_words, strain_at_stress_points

#: share left of the elastic stiffness, where least is left, below which a path that ends is at a limit point;
#: measured 0.2 % before the largest pressure of an arm of rubber, which prescribed volumes went through: 0.14
NEARLY_UNSTABLE = 0.2


def beyond_the_law(system: System, state: State) -> str:
    """A clause for a law that was driven out of its limits; empty otherwise."""
    worst = extremes_of(system.space, *strain_at_stress_points(system.space, state.displacement))
    clause = extremes.beyond_the_law(worst, system.material)
    return f"; there {clause}" if clause else ""


def near_limit_point(system: System, state: State, terms: Terms) -> str:
    """A clause where an equilibrium is about to lose its stability, or has lost it; empty otherwise."""
    try:
        last = most_softened(system, state, terms)
    except SingularMatrix:
        return ""
    if last.stiffness > NEARLY_UNSTABLE:
        return ""
    return (
        f"; the last equilibrium found has {max(last.stiffness, 0.0):.1%} of its elastic stiffness left against a "
        f"motion of {in_words(last.at)}: a limit point, beyond which only a prescribed volume or displacement leads"
    )


def instability(system: System, found: Converged, terms: Terms) -> str:
    """In how many directions an equilibrium is unstable, and where it moves; empty for a stable one."""
    if not found.negative_pivots:
        return ""
    count = f"{found.negative_pivots} direction{'s' if found.negative_pivots > 1 else ''}"
    try:
        softest = softest_direction(system, found.state, terms)
    except SingularMatrix:
        return f"unstable in {count}, at a limit point"
    return f"unstable in {count}; the motion nearest to a limit point is largest at {in_words(softest.at)}"
