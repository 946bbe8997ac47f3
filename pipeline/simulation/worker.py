"""A worker process of an experiment: how it starts, when it ends, and where its progress goes."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pipeline.processes import SPAWN
from pipeline.progress import Progress, Silent, ToQueue, relayed
from pipeline.simulation.known_limit import KnownLimit


class _Worker:
    """The state of this process: who receives its progress, the limit of II. Set once, when the process starts."""

    progress: Progress = Silent()
    known_limit: KnownLimit | None = None


@contextmanager
def connected(progress: Progress) -> Iterator[Any]:
    """A queue for `start_worker`; while the block runs, `progress` receives what the workers report."""
    queue = SPAWN.Queue()
    queue.cancel_join_thread()  # a worker that was killed may hold the queue's lock for ever
    with relayed(queue, progress):
        yield queue


def start_worker(queue: Any, known: KnownLimit | None = None) -> None:
    """Runs first in a worker: interrupts are left to the main process, progress goes into the queue.

    A worker whose main process was killed ends as well, or it would write into a folder that another run uses, and
    then wait for work for ever.
    """
    for interrupt in (signal.SIGINT, signal.SIGHUP):
        signal.signal(interrupt, signal.SIG_IGN)
    threading.Thread(target=_end_with_main_process, daemon=True).start()
    _Worker.progress, _Worker.known_limit = ToQueue(queue), known


def worker_progress() -> Progress:
    """The listener of this worker."""
    return _Worker.progress


def known_limit() -> KnownLimit | None:
    """What experiment II tells the others; None where it is not solved."""
    return _Worker.known_limit


def _end_with_main_process() -> None:
    main_process = multiprocessing.parent_process()
    if main_process is not None:
        main_process.join()
        os._exit(1)
