"""A worker process: tasks reach it through its standard input, results leave through its standard output.

It ends with the main process, killed or not; else it would write into a folder that another run uses. What libraries
print goes to the standard error. Nothing heavy is loaded here: libraries come with the first task that needs them.
"""

import gc
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from contextlib import suppress
from typing import IO, Any

import psutil

from fem.memory import CYCLES_AFTER

THREADS = ("MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS")
#: What the environment of a worker begins with so that glibc keeps freed memory for the next arrays. Given back to the
#: system at once, as it is by default, a quarter of the time of a worker would be page faults.
KEPT_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(1 << 30),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "MALLOC_ARENA_MAX": "1",
}
#: seconds between two looks of a worker at its memory and at its main process
PAUSE = 0.2
#: where replies go from this process if it is a worker
_replies: IO[bytes]
#: kinds of replies: the result of a task, what it has raised, and what it tells meanwhile
RESULT, FAILURE, TOLD = "result", "failure", "told"


def send(stream: IO[bytes], content: Any) -> None:
    """Write a value at once."""
    pickle.dump(content, stream)
    stream.flush()


def serve(main: int, memory: int) -> None:
    """Do what comes through the standard input until it is closed.

    main: number of the main process; memory: bytes beyond which this process ends.
    """
    for name in ("SIGINT", "SIGHUP"):  # Ctrl-C and a closed terminal, which reach all processes, are for the main one
        if hasattr(signal, name):  # Windows has no SIGHUP
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    gc.set_threshold(CYCLES_AFTER)
    global _replies
    _replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    threading.Thread(target=_watch, args=(main, memory), daemon=True).start()
    with suppress(EOFError):
        while True:
            task = pickle.load(sys.stdin.buffer)
            try:
                reply = RESULT, pickle.dumps(pickle.loads(task)())
            except BaseException as failure:
                failure.add_note(traceback.format_exc())
                reply = FAILURE, _pickled(failure)
            send(_replies, reply)


def tell(value: Any) -> None:
    """Called by a task: the listener in the main process receives a value."""
    send(_replies, (TOLD, pickle.dumps(value)))


def _pickled(failure: BaseException) -> bytes:
    try:
        return pickle.dumps(failure)
    except Exception:
        return pickle.dumps(RuntimeError(f"{type(failure).__name__}: {failure}"))


def _watch(main: int, memory: int) -> None:
    """End this process when its main process has ended, or when it uses too much memory."""
    this = psutil.Process()
    while this.ppid() == main and psutil.pid_exists(main) and this.memory_info().rss < memory:
        time.sleep(PAUSE)
    os._exit(1)
