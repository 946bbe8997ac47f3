"""Memory of the process: Python's garbage collector while libraries are loaded, and freed arrays of the C library.

The libraries of the solver make half a million objects that stay until the process ends. Collections on the way and one
at the end of the process look at every one of them and find nothing to free.
"""

import ctypes
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

#: objects that are made before Python looks for unused cycles among them; at its default of 700 this is a fifth of the
#: time in which libraries are loaded
CYCLES_AFTER = 10_000
#: parameters of glibc's mallopt (malloc.h): free memory at the end of the heap above which it is given back, and size
#: from which an array has pages of its own, which are given back when it is freed
TRIM_THRESHOLD, MMAP_THRESHOLD = -1, -3
#: bytes: the largest threshold that glibc allows, and what may stay at the end of the heap
LARGEST_ARRAY, LARGEST_END = 32 << 20, 256 << 20


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


@cache
def keep_freed_memory() -> bool:
    """Have the C library keep freed arrays of up to 32 MiB for the next ones, once in the life of the process.

    False where the C library is not glibc. By default it gives arrays of more than 128 KiB back, and learns to keep
    those of a size only after an array of that size was freed.
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        set_parameter = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):  # musl has none
        return False
    set_parameter.argtypes, set_parameter.restype = [ctypes.c_int, ctypes.c_int], ctypes.c_int
    return bool(set_parameter(MMAP_THRESHOLD, LARGEST_ARRAY) and set_parameter(TRIM_THRESHOLD, LARGEST_END))
