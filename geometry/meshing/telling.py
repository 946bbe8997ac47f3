"""What a caller hears while a body is meshed, which may take minutes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_LISTENER: ContextVar[Callable[[str], None] | None] = ContextVar("listener of meshing", default=None)


@contextmanager
def heard_by(listener: Callable[[str], None]) -> Iterator[None]:
    """Give the listener a sentence, without full stop, at each step of meshing in this thread until the block ends."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def tell(sentence: str) -> None:
    """Say to the listener, if there is one, how far meshing is."""
    listener = _LISTENER.get()
    if listener is not None:
        listener(sentence)
