"""How a command ends when it cannot do its work: one sentence, and the exit status that goes with it."""

from typing import final

__all__ = ["InputError", "RunFailed"]


@final
class InputError(Exception):
    """What the user gave is wrong (exit status 2). The sentence names the file, the key and what is allowed."""


@final
class RunFailed(Exception):
    """The work was started and could not be finished (exit status 1). Everything finished so far is on disk."""
