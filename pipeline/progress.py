"""Progress of a run: what is reported, and how it is shown.

In a worker process it is told to a `ToQueue`, and `relayed` in the main process passes it on to the listener, so that a
single listener receives the progress of every experiment.
"""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple, final

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, TextColumn
from rich.progress import Progress as Bars
from rich.text import Text

from pipeline.remaining_time import RemainingTime, duration


class Message(NamedTuple):
    """What happened: the name of a method of `Progress`, and its arguments."""

    what: str
    arguments: tuple[Any, ...] = ()


class Progress(ABC):
    """Receives the progress of a run. Pressures in kPa, residuals relative, seconds of wall time."""

    @abstractmethod
    def tell(self, message: Message) -> None:
        """Show a message, or pass it on."""

    def stage(self, name: str) -> None:
        """The run waits for a stage: mesh, experiments, identification. Experiments of others may be solved beside
        it."""
        self.tell(Message("stage", (name,)))

    def remark(self, sentence: str) -> None:
        """What a user should know before waiting for the result."""
        self.tell(Message("remark", (sentence,)))

    def experiment(self, name: str, pressures: Sequence[float]) -> None:
        """An experiment begins, which will be solved at `pressures`."""
        self.tell(Message("experiment", (name, tuple(pressures))))

    def iteration(self, experiment: str, pressure_kPa: float, newton_iteration: int, residual: float) -> None:
        """A Newton iteration on the way to `pressure_kPa` is finished."""
        self.tell(Message("iteration", (experiment, pressure_kPa, newton_iteration, float(residual))))

    def step_done(self, experiment: str, pressure_kPa: float, seconds: float) -> None:
        """A pressure is reached; `seconds` is 0 where its state was stored by an earlier run."""
        self.tell(Message("step_done", (experiment, pressure_kPa, seconds)))

    def stopped(self, experiment: str, pressures: Sequence[float], why: str) -> None:
        """An experiment has ended before the first of `pressures`, which it will not reach; `why` in a few words."""
        self.tell(Message("stopped", (experiment, tuple(pressures), why)))

    def done(self) -> None:
        """The run is finished."""
        self.tell(Message("done"))


@final
class Silent(Progress):
    """Ignores everything."""

    def tell(self, message: Message) -> None:
        """Nothing."""


@final
class ToQueue(Progress):
    """Puts every message into a queue that another process reads."""

    def __init__(self, queue: Any) -> None:
        self._queue = queue

    def tell(self, message: Message) -> None:
        """Pass it on, but not the end of a worker, which is not the end of the run."""
        if message.what != "done":
            self._queue.put(message)


@contextmanager
def relayed(queue: Any, listener: Progress) -> Iterator[None]:
    """While the block runs, and until the queue is empty, pass every `Message` in `queue` on to `listener`."""

    def relay() -> None:
        while (message := queue.get()) is not None:
            listener.tell(message)

    thread = threading.Thread(target=relay, daemon=True)
    thread.start()
    try:
        yield
    finally:
        queue.put(None)
        thread.join(timeout=5.0)


@final
class Lines(Progress):
    """One plain line per stage and per pressure, for logs and pipes; `verbose` adds one per Newton iteration."""

    def __init__(self, console: Console, *, verbose: bool = False) -> None:
        self._console = console
        self._verbose = verbose
        self._clock = RemainingTime()
        self._iterations: dict[str, int] = {}
        self._has_explained = False

    def tell(self, message: Message) -> None:
        """Print a line."""
        self._clock.follow(*message)
        match message:
            case ("stage", (name,)):
                self._print(f"stage: {name}")
            case ("experiment", (name, pressures)):
                self._iterations.pop(name, None)  # of an experiment of this name that has failed
                self._print(f"experiment {name}: {', '.join(f'{pressure:g}' for pressure in pressures)} kPa")
            case ("iteration", (name, pressure, number, residual)):
                self._iterations[name] = self._iterations.get(name, 0) + 1
                if self._verbose:
                    self._print(f"{name}: {pressure:g} kPa, iteration {number}, residual {residual:.0e}")
            case ("step_done", (name, pressure, seconds)):
                self._reached(name, pressure, seconds)
            case _:
                _print_sentence(self._console, message)

    def _reached(self, name: str, pressure: float, seconds: float) -> None:
        iterations = self._iterations.pop(name, 0)
        counted = f"{iterations} iterations, " if iterations else ""
        work = f"{counted}{duration(seconds)}" if seconds > 0.0 else "stored by an earlier run"
        left = self._clock.remaining()
        if left and not self._has_explained:
            self._print("time left: an estimate for the experiments that have begun; others may follow")
            self._has_explained = True
        self._print(f"{name}: {pressure:g} kPa ({work}){f'; {left}' if left else ''}")

    def _print(self, text: str) -> None:
        self._console.print(text, highlight=False, markup=False, soft_wrap=True)


def _print_sentence(console: Console, message: Message) -> None:
    """Remarks, and experiments that have ended early; nothing of what else there is."""
    match message:
        case ("remark", (sentence,)):
            text = f"note: {sentence}"
        case ("stopped", (name, pressures, why)):
            text = f"{name} stopped{f' before {pressures[0]:g} kPa' if pressures else ''}: {why}"
        case _:
            return
    console.print(text, highlight=False, markup=False, soft_wrap=True)


@final
class Terminal(Progress):
    """A live table: a bar for each experiment with its pressure and Newton iterations, until it ends or the next stage
    begins, whichever is later."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._clock = RemainingTime()
        self._stage, self._began = "", time.monotonic()
        name = TextColumn("{task.fields[name]}", markup=False)
        self._bars = Bars(name, BarColumn(12), TextColumn("{task.fields[now]}", markup=False), console=console)
        self._live = Live(get_renderable=self._picture, console=console, refresh_per_second=4)

    def tell(self, message: Message) -> None:
        """Show it in the table, or above it."""
        self._clock.follow(*message)
        _print_sentence(self._console, message)
        match message:
            case ("stage", (name,)):
                self._live.start()  # a second start changes nothing
                self._begin_stage(name)
            case ("experiment", (name, pressures)):
                self._row(name, len(pressures), now="starts")
            case ("iteration", (name, pressure, number, residual)):
                self._row(name, iterations=1, now=f"{pressure:g} kPa, iteration {number}, residual {residual:.0e}")
            case ("step_done", (name, pressure, _)):
                self._row(name, reached=1, now=f"{pressure:g} kPa reached, {{}} iterations in total")
            case ("stopped", (name, _, _)):
                self._row(name, now="stopped", stopped=True)
            case ("done", ()):
                self._begin_stage("")
                self._live.stop()

    def _row(self, name: str, total: int = 0, *, reached: int = 0, iterations: int = 0, **fields: Any) -> None:
        """Change the row of an experiment, or begin one."""
        task = next((task for task in self._bars.tasks if task.description == name), None)
        if task is not None and total:
            self._bars.remove_task(task.id)  # of an experiment of this name that has failed
        if task is None or total:
            shown = name if len(name) <= 20 else f"{name[:19]}…"
            first: dict[str, Any] = {"name": shown, "now": "", "iterations": 0, "stopped": False}
            number = self._bars.add_task(name, total=total or 1, **first)
            task = next(task for task in self._bars.tasks if task.id == number)
        iterations += task.fields["iterations"]
        fields["now"] = fields["now"].format(iterations)
        self._bars.update(task.id, advance=reached, iterations=iterations, **fields)

    def _begin_stage(self, name: str) -> None:
        """Print how long the stage before has taken, and forget the experiments that have ended in it."""
        if self._stage:
            self._console.print(f"{self._stage}: {duration(time.monotonic() - self._began)}", highlight=False)
        self._stage, self._began = name, time.monotonic()
        for task in self._bars.tasks if name else ():
            if task.finished or task.fields["stopped"]:
                self._bars.remove_task(task.id)

    def _picture(self) -> Group:
        if not self._stage:
            return Group(self._bars)
        left = self._clock.remaining()
        head = f"{self._stage}: {duration(time.monotonic() - self._began)}"
        return Group(Text(f"{head}, {left} for experiments begun" if left else head), self._bars)


def progress_for(console: Console | None = None, *, verbose: bool = False) -> Progress:
    """A live table on a terminal, plain lines elsewhere; on standard output unless a console is given.

    `verbose`: plain lines everywhere, with every Newton iteration.
    """
    console = console or Console()
    return Terminal(console) if console.is_terminal and not verbose else Lines(console, verbose=verbose)
