"""Progress of a run as it is shown: a live table on a terminal, plain lines elsewhere."""

from typing import final

from rich.console import Console
from rich.progress import BarColumn, Task, TaskID, TextColumn
from rich.progress import Progress as Bars

from pipeline.store.progress import Message, Progress
from pipeline.store.time_left import TimeLeft
from pipeline.values.formatting import duration

#: characters of the name of an experiment in the table
LONGEST_NAME = 20
#: part of the expected effort after which the time left of a run is told
TOLD_FROM = 0.05


@final
class Lines(Progress):
    """One plain line per stage and per pressure, for logs and pipes."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._iterations: dict[str, int] = {}
        self._left = TimeLeft({})

    def tell(self, message: Message) -> None:
        """Print a line."""
        match message:
            case ("expect", (steps,)):
                self._left = TimeLeft(steps, TOLD_FROM)
            case ("stage", (name,)):
                self._print(f"stage: {name}")
            case ("experiment", (name, pressures)):
                self._iterations.pop(name, None)  # of an experiment of this name that has failed
                self._left.announce(name, len(pressures))
                self._print(f"experiment {name}: {', '.join(f'{pressure:g}' for pressure in pressures)} kPa")
            case ("iteration", (name, *_)):
                self._iterations[name] = self._iterations.get(name, 0) + 1
            case ("step_done", (name, pressure, seconds)):
                iterations = self._iterations.pop(name, 0)
                counted = f"{iterations} iterations, " if iterations else ""
                work = f"{counted}{duration(seconds)}" if seconds > 0.0 else "already solved"
                self._print(f"{name}: {pressure:g} kPa ({work}){self._left.end(name, seconds)}")
            case _:
                _print_sentence(self._console, message)

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
    begins, whichever is later; and the stage with the time left of the run."""

    def __init__(self, console: Console) -> None:
        columns = (TextColumn(f"{{task.{shown}}}", markup=False) for shown in ("description", "fields[now]"))
        name, now = columns
        self._bars = Bars(name, BarColumn(12), now, console=console)
        self._stage: Task | None = None
        self._left = TimeLeft({})

    def tell(self, message: Message) -> None:
        """Show it in the table, or above it."""
        _print_sentence(self._bars.console, message)
        match message:
            case ("expect", (steps,)):
                self._left = TimeLeft(steps, TOLD_FROM)
            case ("stage", (name,)):
                self._bars.start()  # a second start changes nothing
                self._end_stage()
                for task in self._bars.tasks:
                    if task.finished or task.stop_time is not None:
                        self._bars.remove_task(task.id)
                self._stage = self._task(self._bars.add_task("", total=None, now=name, name=name))
            case ("experiment", (name, pressures)):
                self._left.announce(name, len(pressures))
                self._bars.reset(self._row(name), total=len(pressures), now="starts")
            case ("iteration", (name, pressure, number, residual)):
                self._bars.update(self._row(name), now=f"{pressure:g} kPa, iteration {number}, {residual:.0e}")
            case ("step_done", (name, pressure, seconds)):
                self._bars.update(self._row(name), advance=1, now=f"{pressure:g} kPa reached")
                left = self._left.end(name, seconds)
                if self._stage is not None:
                    self._bars.update(self._stage.id, now=f"{self._stage.fields['name']}{left}")
            case ("stopped", (name, _, _)):
                self._bars.stop_task(self._row(name))
            case ("done", _):
                self._end_stage()
                self._bars.stop()

    def _task(self, number: TaskID) -> Task:
        return next(task for task in self._bars.tasks if task.id == number)

    def _row(self, name: str) -> TaskID:
        """The row of an experiment, begun where there is none."""
        shown = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
        rows = (task.id for task in self._bars.tasks if task.description == shown)
        found = next(rows, None)
        return self._bars.add_task(shown, now="") if found is None else found

    def _end_stage(self) -> None:
        """Print how long a stage has taken, if one has begun."""
        if self._stage is not None:
            self._bars.console.print(
                f"{self._stage.fields['name']}: {duration(self._stage.elapsed or 0.0)}", highlight=False
            )
            self._bars.remove_task(self._stage.id)
            self._stage = None


def progress_for(console: Console | None = None) -> Progress:
    """A live table on a terminal, plain lines elsewhere; on standard output unless a console is given."""
    console = console or Console()
    return Terminal(console) if console.is_terminal else Lines(console)
