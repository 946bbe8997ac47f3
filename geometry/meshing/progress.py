"""Progress of meshing, which may take minutes, to whoever calls it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_RECEIVER: ContextVar[Callable[[str], None] | None] = ContextVar("receiver of the progress of meshing", default=None)


@contextmanager
def progress_to(receiver: Callable[[str], None]) -> Iterator[None]:
    """Call `receiver` with a sentence (no full stop) at each step of meshing in this thread, until the block ends."""
    token = _RECEIVER.set(receiver)
    try:
        yield
    finally:
        _RECEIVER.reset(token)


def report(sentence: str) -> None:
    """Give the receiver, if there is one, a sentence on how far meshing is."""
    receiver = _RECEIVER.get()
    if receiver is not None:
        receiver(sentence)
