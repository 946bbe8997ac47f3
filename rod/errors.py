"""Why a request to the rod cannot be fulfilled."""

from geometry.errors import PneurodError


class RodError(PneurodError, ValueError):
    """A request to the rod cannot be fulfilled; the message is one sentence that says why."""


class LoadError(RodError):
    """Loads that contradict each other, or that need what is not known of the arm."""


class RodWarning(UserWarning):
    """A rod, or its shape under a load, is less certain than usual; the message is one sentence that says why."""
