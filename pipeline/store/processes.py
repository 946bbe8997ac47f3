"""Worker processes of this machine as an executor: a task whose process ends is lost alone, all end with the block.

A worker is this Python with a program of one line, so that it neither imports nor repeats the program that started it.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from typing import Any, ParamSpec, TypeVar, final

from pipeline.store.worker import FAILURE, KEPT_MEMORY, THREADS, TOLD, send, serve
from pipeline.values.errors import WorkerLost

P = ParamSpec("P")
Value = TypeVar("Value")

#: what is told where a worker has ended, as one that is killed does
LOST = (
    "a process of the run was ended from outside, as happens when memory runs out; finished results "
    "are kept, and the same command continues from there, with --jobs 1 in less memory"
)


@final
class Processes(ThreadPoolExecutor):
    """Workers that begin tasks in the order in which they were submitted.

    A task is a function of a module, which a worker can import. It raises `WorkerLost` where its process ends; the next
    task has a new process then. An exception leaves a `with` block when all workers have ended.
    """

    def __init__(
        self,
        jobs: int,
        *,
        threads: int = 1,
        memory: int = sys.maxsize,
        attempts: int = 1,
        is_fresh: bool = False,
        listen: Callable[[Any], None] | None = None,
    ) -> None:
        """jobs: tasks that are done at the same time; threads: of the libraries in a worker; memory: bytes beyond which
        a worker ends itself; attempts: how often a task is begun whose process ends; is_fresh: whether every task has a
        process of its own; listen: receives what tasks `tell`, one value at a time."""
        super().__init__(jobs, initializer=_block_interrupts)
        self._new = partial(_Process, threads, memory)
        self._attempts, self._is_fresh, self._listen = attempts, is_fresh, listen
        self._lock, self._listening = threading.Lock(), threading.Lock()
        self._processes: dict[int, _Process] = {}  # by thread
        self._is_over = False

    def submit(self, fn: Callable[P, Value], /, *args: P.args, **kwargs: P.kwargs) -> "Future[Value]":
        """A task, which begins when a worker is free. Raises RuntimeError when the workers have ended."""
        return super().submit(self._done, partial(fn, *args, **kwargs), self._attempts)

    def end(self) -> None:
        """Kill all workers: what they do is lost, and nothing else is begun."""
        with self._lock:
            self._is_over = True
            for process in self._processes.values():
                process.kill()
        super().shutdown(wait=False, cancel_futures=True)

    def __exit__(self, kind: object, *failure: object) -> None:
        if kind is not None:
            self.end()
        self.shutdown()
        for process in self._processes.values():
            process.close()

    def _done(self, task: Callable[[], Value], attempts: int) -> Value:
        try:
            return self._process().do(task, self._tell)
        except WorkerLost:
            if attempts == 1 or self._is_over:
                raise
        return self._done(task, attempts - 1)

    def _process(self) -> "_Process":
        """The worker of this thread, a new one where it has ended."""
        with self._lock:
            if self._is_over:
                raise WorkerLost(LOST)
            own = self._processes.get(threading.get_ident())
            if own is None or self._is_fresh or own.poll() is not None:
                if own is not None:
                    own.close()
                own = self._processes[threading.get_ident()] = self._new()
            return own

    def _tell(self, value: Any) -> None:
        with self._listening:
            if self._listen is not None:
                self._listen(value)


def _block_interrupts() -> None:
    """Called in a thread: Ctrl-C and a closed terminal, which reach all processes, do not end those that it starts."""
    if hasattr(signal, "pthread_sigmask"):  # Windows has none
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})


class _Process(subprocess.Popen[bytes]):
    """A worker process, as its main process sees it."""

    def __init__(self, threads: int, memory: int) -> None:
        call = f"serve({os.getpid()}, {memory})"
        program = f"import sys; sys.path = {sys.path!r}; from {serve.__module__} import serve; {call}"
        environment = {**os.environ, **KEPT_MEMORY, **dict.fromkeys(THREADS, str(threads))}
        pipe = subprocess.PIPE
        super().__init__([sys.executable, "-c", program], stdin=pipe, stdout=pipe, env=environment)

    def do(self, task: Callable[[], Value], listen: Callable[[Any], None]) -> Value:
        """The result of a task. Raises what it raises, or the listener, and `WorkerLost`."""
        assert self.stdin is not None
        content = pickle.dumps(task)
        with suppress(OSError):  # it has ended, which its reply tells
            send(self.stdin, content)
        while (reply := self._reply())[0] == TOLD:
            try:
                listen(pickle.loads(reply[1]))
            except BaseException:
                self.kill()  # it would go on with the task
                self.wait()
                raise
        value: Value = pickle.loads(reply[1])
        if reply[0] == FAILURE and isinstance(value, BaseException):
            raise value
        return value

    def _reply(self) -> tuple[str, bytes]:
        assert self.stdout is not None
        try:
            kind, content = pickle.load(self.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            self.kill()
            raise WorkerLost(f"{LOST} (it ended with status {self.wait()})") from None
        return kind, content

    def close(self) -> None:
        """End it, and what belongs to it here."""
        self.kill()
        with suppress(BrokenPipeError):  # of a task that it did not read
            self.__exit__(None, None, None)
