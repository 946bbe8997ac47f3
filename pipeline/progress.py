"""Progress of a run: what is reported, and how it is shown.

A run calls the methods of `Progress`. In a worker process it calls them on a `ToQueue`, and `relayed` in the main
process passes the messages on to the listener, so that a single listener receives those of every experiment.
"""

import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple, Protocol, final

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from pipeline.remaining_time import RemainingTime, duration


class Progress(Protocol):
    """Receives the progress of a run. Pressures in kPa, residuals relative, seconds of wall time."""

    def stage(self, name: str) -> None:
        """The run waits for a stage: mesh, experiments, identification, rod, pictures, report. Experiments of others
        may be solved beside it."""

    def remark(self, sentence: str) -> None:
        """What a user should know before waiting for the result."""

    def experiment(self, name: str, pressures: Sequence[float]) -> None:
        """An experiment begins, which will be solved at `pressures`."""

    def iteration(self, experiment: str, pressure_kPa: float, newton_iteration: int, residual: float) -> None:
        """A Newton iteration on the way to `pressure_kPa` is finished."""

    def step_done(self, experiment: str, pressure_kPa: float, seconds: float) -> None:
        """A pressure is reached; `seconds` is 0 where its state was stored by an earlier run."""

    def stopped(self, experiment: str, pressures: Sequence[float], why: str) -> None:
        """An experiment has ended before the first of `pressures`, which it will not reach; `why` in a few words."""

    def done(self) -> None:
        """The run is finished."""


class Message(NamedTuple):
    """One call on its way between processes."""

    method: str
    arguments: tuple[Any, ...]


@final
class Silent:
    """Ignores everything."""

    def stage(self, name: str) -> None: ...

    def remark(self, sentence: str) -> None: ...

    def experiment(self, name: str, pressures: Sequence[float]) -> None: ...

    def iteration(self, experiment: str, pressure_kPa: float, newton_iteration: int, residual: float) -> None: ...

    def step_done(self, experiment: str, pressure_kPa: float, seconds: float) -> None: ...

    def stopped(self, experiment: str, pressures: Sequence[float], why: str) -> None: ...

    def done(self) -> None: ...


@final
class ToQueue:
    """Puts every call as a `Message` into a queue that another process reads."""

    def __init__(self, queue: Any) -> None:
        self._queue = queue

    def stage(self, name: str) -> None:
        self._queue.put(Message("stage", (name,)))

    def remark(self, sentence: str) -> None:
        self._queue.put(Message("remark", (sentence,)))

    def experiment(self, name: str, pressures: Sequence[float]) -> None:
        self._queue.put(Message("experiment", (name, tuple(pressures))))

    def iteration(self, experiment: str, pressure_kPa: float, newton_iteration: int, residual: float) -> None:
        self._queue.put(Message("iteration", (experiment, pressure_kPa, newton_iteration, float(residual))))

    def step_done(self, experiment: str, pressure_kPa: float, seconds: float) -> None:
        self._queue.put(Message("step_done", (experiment, pressure_kPa, seconds)))

    def stopped(self, experiment: str, pressures: Sequence[float], why: str) -> None:
        self._queue.put(Message("stopped", (experiment, tuple(pressures), why)))

    def done(self) -> None:
        """Sends nothing: the end of a worker is not the end of the run."""


@contextmanager
def relayed(queue: Any, listener: Progress) -> Iterator[None]:
    """While the block runs, and until the queue is empty, pass every `Message` in `queue` on to `listener`."""

    def relay() -> None:
        while (message := queue.get()) is not None:
            getattr(listener, message.method)(*message.arguments)

    thread = threading.Thread(target=relay, daemon=True)
    thread.start()
    try:
        yield
    finally:
        queue.put(None)
        thread.join(timeout=5.0)


@final
class Lines:
    """One plain line per stage and per pressure, for logs and pipes; `verbose` adds one per Newton iteration."""

    def __init__(self, console: Console, *, verbose: bool = False) -> None:
        self._console = console
        self._verbose = verbose
        self._clock = RemainingTime()
        self._iterations: dict[str, int] = {}
        self._has_explained = False

    def stage(self, name: str) -> None:
        if self._clock.is_over:
            self._clock = RemainingTime()
        self._print(f"stage: {name}")

    def remark(self, sentence: str) -> None:
        self._print(f"note: {sentence}")

    def experiment(self, name: str, pressures: Sequence[float]) -> None:
        self._clock.add(name, pressures)
        self._iterations.pop(name, None)  # of an experiment of this name that has failed
        self._print(f"experiment {name}: {', '.join(f'{pressure:g}' for pressure in pressures)} kPa")

    def iteration(self, experiment: str, pressure_kPa: float, newton_iteration: int, residual: float) -> None:
        self._iterations[experiment] = self._iterations.get(experiment, 0) + 1
        if self._verbose:
            at = f"{pressure_kPa:g} kPa, iteration {newton_iteration}"
            self._print(f"{experiment}: {at}, residual {residual:.0e}")

    def step_done(self, experiment: str, pressure_kPa: float, seconds: float) -> None:
        self._clock.reach(experiment, pressure_kPa, seconds)
        iterations = self._iterations.pop(experiment, 0)
        counted = f"{iterations} iterations, " if iterations else ""
        work = f"{counted}{duration(seconds)}" if seconds > 0.0 else "stored by an earlier run"
        left = self._clock.remaining()
        if left and not self._has_explained:
            self._print("time left: an estimate for the experiments that have begun; others may follow")
            self._has_explained = True
        after = f"; {left}" if left else ""
        self._print(f"{experiment}: {pressure_kPa:g} kPa ({work}){after}")

    def stopped(self, experiment: str, pressures: Sequence[float], why: str) -> None:
        self._clock.stop(experiment, pressures)
        self._print(_stopped(experiment, pressures, why))

    def done(self) -> None: ...

    def _print(self, text: str) -> None:
        self._console.print(text, highlight=False, markup=False, soft_wrap=True)


class _Row(NamedTuple):
    pressures: tuple[float, ...]
    reached: int
    iterations: int
    now: str
    has_stopped: bool = False


@final
class Terminal:
    """A live table: one row per experiment with its pressure, Newton iterations and a bar, until it ends or the next
    stage begins, whichever is later."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._clock = RemainingTime()
        self._stage = ""
        self._began = time.monotonic()
        self._rows: dict[str, _Row] = {}
        self._live = Live(get_renderable=self._picture, console=console, refresh_per_second=4)

    def stage(self, name: str) -> None:
        self._live.start()  # a second start changes nothing
        self._print_stage()
        if self._clock.is_over:
            self._clock = RemainingTime()
        self._rows = {
            name: row for name, row in self._rows.items() if row.reached < len(row.pressures) and not row.has_stopped
        }
        self._stage, self._began = name, time.monotonic()

    def remark(self, sentence: str) -> None:
        self._console.print(f"note: {sentence}", highlight=False, markup=False, soft_wrap=True)

    def experiment(self, name: str, pressures: Sequence[float]) -> None:
        self._clock.add(name, pressures)
        self._rows[name] = _Row(tuple(pressures), 0, 0, "starts")

    def iteration(self, experiment: str, pressure_kPa: float, newton_iteration: int, residual: float) -> None:
        row = self._rows.get(experiment, _Row((pressure_kPa,), 0, 0, ""))
        now = f"{pressure_kPa:g} kPa, iteration {newton_iteration}, residual {residual:.0e}"
        self._rows[experiment] = row._replace(iterations=row.iterations + 1, now=now)

    def step_done(self, experiment: str, pressure_kPa: float, seconds: float) -> None:
        self._clock.reach(experiment, pressure_kPa, seconds)
        row = self._rows.get(experiment, _Row((pressure_kPa,), 0, 0, ""))
        now = f"{pressure_kPa:g} kPa reached, {row.iterations} iterations in total"
        self._rows[experiment] = row._replace(reached=row.reached + 1, now=now)

    def stopped(self, experiment: str, pressures: Sequence[float], why: str) -> None:
        self._clock.stop(experiment, pressures)
        self._console.print(_stopped(experiment, pressures, why), highlight=False, markup=False, soft_wrap=True)
        row = self._rows.get(experiment, _Row(tuple(pressures), 0, 0, ""))
        self._rows[experiment] = row._replace(has_stopped=True, now="stopped")

    def done(self) -> None:
        self._print_stage()
        self._stage = ""
        self._live.stop()

    def _print_stage(self) -> None:
        if self._stage:
            self._console.print(f"{self._stage}: {duration(time.monotonic() - self._began)}", highlight=False)

    def _picture(self) -> Group:
        table = Table.grid("", "", "", padding=(0, 2))
        for name, row in self._rows.items():
            bar = ProgressBar(total=len(row.pressures), completed=row.reached, width=12)
            table.add_row(Text(name, overflow="ellipsis", no_wrap=True), bar, row.now)
        table.columns[0].max_width = 20
        if not self._stage:
            return Group(table)
        left = self._clock.remaining()
        head = f"{self._stage}: {duration(time.monotonic() - self._began)}"
        return Group(Text(f"{head}, {left} for experiments begun" if left else head), table)


def _stopped(experiment: str, pressures: Sequence[float], why: str) -> str:
    before = f" before {pressures[0]:g} kPa" if pressures else ""
    return f"{experiment} stopped{before}: {why}"


def progress_for(console: Console | None = None, *, verbose: bool = False) -> Progress:
    """A live table on a terminal, plain lines elsewhere; on standard output unless a console is given.

    `verbose`: plain lines everywhere, with every Newton iteration.
    """
    console = console or Console()
    return Terminal(console) if console.is_terminal and not verbose else Lines(console, verbose=verbose)
