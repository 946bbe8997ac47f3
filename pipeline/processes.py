"""Processes that compute side by side: how many threads each has, and that all end when one fails."""

import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from typing import Any

#: Workers begin afresh: the libraries they load read the number of threads then.
SPAWN = multiprocessing.get_context("spawn")
THREADS = ("MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS")


@contextmanager
def side_by_side(jobs: int, threads: int, **options: Any) -> Iterator[ProcessPoolExecutor]:
    """`jobs` workers of `threads` threads; `options` are those of ProcessPoolExecutor. An exception ends them all."""
    kept = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(kept, str(threads)))
    try:
        with ProcessPoolExecutor(jobs, SPAWN, **options) as pool:
            try:
                yield pool
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                for child in multiprocessing.active_children():
                    child.terminate()
                raise
    finally:
        for name, value in kept.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})
