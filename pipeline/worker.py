"""A worker process: tasks reach it through its standard input, results leave through its standard output.

It ends when its input is closed, as happens when the main process ends or is killed; else it would write into a folder
that another run uses. What libraries print goes to the standard error. Nothing heavy is loaded here: libraries come
with the first task that needs them.
"""

import os
import pickle
import queue
import signal
import sys
import threading
import time
import traceback
from typing import IO, Any

import psutil

THREADS = ("MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS")
#: What the environment of a worker begins with so that glibc keeps freed memory for the next arrays. Given back to the
#: system at once, as it is by default, a quarter of the time of a worker would be page faults.
KEPT_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(1 << 30),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "MALLOC_ARENA_MAX": "1",
}
#: seconds between two looks at the memory of a worker
PAUSE = 0.2
#: kinds of replies: the result of a task, what it has raised, and what it tells meanwhile
RESULT, FAILURE, TOLD = "result", "failure", "told"


def available_cores() -> int:
    """The processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def send(stream: IO[bytes], content: Any) -> None:
    """Write a value at once."""
    pickle.dump(content, stream)
    stream.flush()


class _Served:
    """The state of this process where it is a worker. Set once, when it starts."""

    replies: IO[bytes]


def serve(memory: int | None) -> None:
    """Do what comes through the standard input until it is closed; runs in a worker.

    memory: bytes beyond which it ends; None: no limit.
    """
    _ignore_interrupts()
    _Served.replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(tasks,), daemon=True).start()
    if memory is not None:
        threading.Thread(target=_end_beyond, args=(memory,), daemon=True).start()
    while True:
        try:
            reply = RESULT, pickle.dumps(pickle.loads(tasks.get())())
        except BaseException as failure:
            failure.add_note(traceback.format_exc())
            reply = FAILURE, _pickled(failure)
        send(_Served.replies, reply)


def tell(value: Any) -> None:
    """Called by a task: the listener in the main process receives a value."""
    send(_Served.replies, (TOLD, pickle.dumps(value)))


def _pickled(failure: BaseException) -> bytes:
    try:
        content = pickle.dumps(failure)
        pickle.loads(content)
    except Exception:
        return pickle.dumps(RuntimeError(f"{type(failure).__name__}: {failure}"))
    return content


def _receive(tasks: "queue.SimpleQueue[bytes]") -> None:
    try:
        while True:
            tasks.put(pickle.load(sys.stdin.buffer))
    finally:
        os._exit(1)


def _end_beyond(memory: int) -> None:
    this = psutil.Process()
    while this.memory_info().rss < memory:
        time.sleep(PAUSE)
    os._exit(1)


def _ignore_interrupts() -> None:
    """Leave Ctrl-C and a closed terminal, which reach all processes, to the main one."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):  # Windows has no SIGHUP
            signal.signal(getattr(signal, name), signal.SIG_IGN)
