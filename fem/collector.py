"""Python's garbage collector while libraries and kernels are loaded: it would look through all of them several times.

The libraries of the solver make half a million objects that stay until the process ends. Collections on the way and one
at the end of the process look at every one of them and find nothing to free.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused() -> Iterator[None]:
    """No collection inside the block."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def pass_over_what_is_loaded() -> None:
    """From now on collections pass over the objects that exist, the last one at the end of the process too."""
    gc.freeze()
