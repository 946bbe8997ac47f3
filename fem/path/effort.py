"""How long an equilibrium is sought with an increment before a smaller one is tried."""

from collections.abc import Sequence
from dataclasses import dataclass

from fem.path.control import Control
from fem.path.increments import Increments
from fem.path.predictor import PathPoint

#: largest number of iterations once an increment to the same target has failed: smaller ones converge in fewer; and
#: near a limit that the path announces
RETRY_ITERATIONS, ITERATIONS_NEAR_LIMIT = 12, 8
#: largest number of iterations with an indefinite tangent from a stable equilibrium to the next; those that led
#: anywhere on the hard cases had at most 5
MAX_UNSTABLE = 7
#: the same where a smaller increment follows one that failed, but for those from rest, and with walls in contact near a
#: limit that the path announces: 121 stable equilibria of short arms took at most 2, before all those with a
#: definite tangent
MAX_UNSTABLE_RETRY = 2
#: length of an increment over the last one from which on a smaller one costs less than other starts
FAR = 1.2


@dataclass(frozen=True)
class Effort:
    """What a solution may cost."""

    iterations: int | None = None  #: largest number of iterations besides that of the options; None: no other
    unstable: int | None = None  #: largest number of those with an indefinite tangent; None: any
    stays_stable: bool = False  #: whether none of those may follow one with a definite tangent
    is_near_limit: bool = False  #: whether one start is enough, because it is near or the load is too large


def effort_of(control: Control, increments: Increments, points: Sequence[PathPoint], is_stable: bool) -> Effort:
    """What the next increment may cost; points: the last two of the path, is_stable: whether the last one is.

    Near an announced limit, without contact, no longer than until the tangent is indefinite, because no unstable
    equilibrium would be accepted. Contact makes the tangent indefinite on the way to stable equilibria as well, and so
    do large rotations, of an arm that hangs under its weight for example.
    """
    before, last = points[0], points[-1]
    most = MAX_UNSTABLE_RETRY if last.touching else 0
    if increments.passes_limit or (increments.cutbacks and increments.nears_limit):
        return Effort(ITERATIONS_NEAR_LIMIT, most if is_stable else None, is_stable, True)
    iterations = RETRY_ITERATIONS if increments.cutbacks else None
    if not (control.gives_load and is_stable):
        return Effort(iterations)
    if increments.cutbacks and not increments.is_small:
        # from rest nothing is known of the path, and as a rule the load is too large
        return Effort(iterations, MAX_UNSTABLE_RETRY if len(points) > 1 else most, True)
    if len(points) > 1 and abs(control.value - last.value) > FAR * abs(last.value - before.value):
        return Effort(iterations, MAX_UNSTABLE_RETRY, True)
    return Effort(iterations, MAX_UNSTABLE)
