"""Functions of numbers and arrays that are compiled by numba once they have been called often enough to pay for it."""

import inspect
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, final

import numpy as np

P = ParamSpec("P")
R = TypeVar("R")


@final
class CompiledLater(Generic[P, R]):
    """A function that runs as plain Python at first, and compiled by numba from a later call on.

    To load numba takes longer than to solve one rod in plain Python, so programs that solve a single rod do without it;
    where something else has loaded numba every call is a compiled one.
    Both ways do the same operations in the same order. The function and all that it calls must be plain functions that
    numba can compile, and must tell numbers that are not finite without raising.
    """

    def __init__(
        self, function: Callable[P, R], calls: Sequence["Callable[..., Any] | CompiledLater[..., Any]"], after: int
    ) -> None:
        """calls: the functions that it calls, innermost first; of one that is compiled itself, the compiled one is
        called. after: largest number of calls in plain Python."""
        self.function = function
        self.calls = tuple(calls)
        self.remaining = after  #: calls in plain Python before the first compiled one
        self._compiled: Callable[P, R] | None = None

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        if self._compiled is not None:
            return self._compiled(*args, **kwargs)
        if self.remaining > 0 and "numba" not in sys.modules:
            self.remaining -= 1
            with np.errstate(all="ignore"):
                return self.function(*args, **kwargs)
        self._compiled = self.compiled()
        return self._compiled(*args, **kwargs)

    def compiled(self) -> Callable[P, R]:
        """The function compiled by numba, with a cache on disk that holds until one of the source files changes."""
        import numba.extending

        for call in self.calls:
            if isinstance(call, CompiledLater):
                numba.extending.overload(call.function)(_calling(call.compiled()))
            else:
                numba.extending.register_jitable(no_cfunc_wrapper=True)(call)
        compiled = numba.njit(cache=True, no_cfunc_wrapper=True)(self.function)
        # numba itself looks at the file of the function alone, and not at those of the functions that it calls
        compiled._cache._cache_file._source_stamp = source_stamp(self._all)
        result: Callable[P, R] = compiled
        return result

    @property
    def _all(self) -> tuple[Callable[..., Any], ...]:
        """The function, and all that are compiled with it."""
        calls = ((call._all if isinstance(call, CompiledLater) else (call,)) for call in self.calls)
        return self.function, *sum(calls, ())


def _calling(compiled: Callable[..., Any]) -> Callable[..., Any]:
    """What numba takes for calls of a plain function: those of the compiled one."""
    return lambda *args: lambda *args: compiled(*args)


def source_stamp(functions: Sequence[Callable[..., Any]]) -> tuple[tuple[str, int, int], ...]:
    """Name, time of the last change and size of the files in which functions stand."""
    files = sorted({Path(inspect.getfile(function)) for function in functions})
    return tuple((file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files)
