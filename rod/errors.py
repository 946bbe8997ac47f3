"""Why a request to the rod cannot be fulfilled."""

from geometry.errors import PneurodError


class RodError(PneurodError, ValueError):
    """A request to the rod cannot be fulfilled; the message is one sentence that says why."""


class LoadError(RodError):
    """Loads that contradict each other, or that need what is not known of the arm."""


class RodWarning(UserWarning):
    """A rod, or its shape under a load, is less certain than usual; the message is one sentence that says why."""


def buckles_at(part: float, *, out_of_plane: bool = False) -> str:
    """The sentence on a path of loads that becomes unstable beyond a part of the load."""
    reached = f"{'out of its plane ' if out_of_plane else ''}at {100 * part:.3g} % of the load"
    return f"The rod buckles {reached}: beyond it the path from the unloaded rod is unstable or ends."
