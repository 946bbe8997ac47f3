"""Progress of a run as it is reported; `pipeline.show.progress` shows it.

In a worker process it is told to a `PassedOn`, so that a single listener in the main process receives the progress of
every experiment.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, final


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

    def expect(self, steps: Mapping[str, Sequence[float]]) -> None:
        """The steps that follow, by the beginning of the names under which they are told, with their efforts in s."""
        self.tell(Message("expect", (dict(steps),)))

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
class PassedOn(Progress):
    """Passes every message on to a function, as a worker process does to its main process."""

    def __init__(self, pass_on: Callable[[Message], None]) -> None:
        self._pass_on = pass_on

    def tell(self, message: Message) -> None:
        """Pass it on, but not the end of a worker, which is not the end of the run."""
        if message.what != "done":
            self._pass_on(message)
