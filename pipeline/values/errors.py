"""How a command ends when it cannot do its work: in sentences, and with the exit status that goes with them."""

import reprlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, TypeVar, final

from geometry.errors import PneurodError

Answer = TypeVar("Answer")

#: Characters of a user's value that a sentence repeats.
LONGEST = 60
#: options of the command line that are called otherwise than the arguments in Python
OPTIONS = {"start": "--from", "tolerances": "--tolerance"}
_ON_COMMAND_LINE: ContextVar[bool] = ContextVar("on_command_line", default=False)


class _Sentence(PneurodError):
    """One sentence on one line, whatever it quotes."""

    def __init__(self, sentence: str) -> None:
        super().__init__(_one_line(sentence))


@contextmanager
def on_command_line() -> Iterator[None]:
    """Within the block, sentences name arguments as options of the command line."""
    token = _ON_COMMAND_LINE.set(True)
    try:
        yield
    finally:
        _ON_COMMAND_LINE.reset(token)


def argument(name: str, value: object = None) -> str:
    """An argument as the caller writes it: out=results/arm, or --out results/arm on the command line.

    Without a value its name alone; with True a switch: fresh=True, or --fresh.
    """
    if not _ON_COMMAND_LINE.get():
        return name if value is None else f"{name}={value}"
    option = OPTIONS.get(name, f"--{name.replace('_', '-')}")
    return option if value is None or value is True else f"{option} {value}"


class InputError(PneurodError):
    """What the user gave is wrong (exit status 2). A sentence names the file, the key and what is allowed.

    Several things that are wrong are as many sentences, one on each line.
    """

    def __init__(self, *sentences: str) -> None:
        super().__init__(*(_one_line(sentence) for sentence in sentences))

    @property
    def sentences(self) -> tuple[str, ...]:
        """What is wrong, one sentence each."""
        return tuple(map(str, self.args))

    def __str__(self) -> str:
        return "\n".join(self.sentences)


def ask(where: str, function: Callable[..., Answer], *arguments: Any) -> Answer:
    """Call a function with values of a user. Raises InputError where it raises ValueError.

    where: the values were given, such as an argument; empty if the error says it.
    """
    try:
        return function(*arguments)
    except ValueError as refused:
        raise InputError(f"{where}: {refused}" if where else str(refused)) from None


@final
class ConflictError(InputError):
    """Values that the user gave do not go together, though each one is allowed."""


class RunFailed(_Sentence):
    """The work was started and could not be finished (exit status 1). Everything finished so far is on disk."""

    def __init__(self, sentence: str, directory: Path | None = None, brief: str = "") -> None:
        super().__init__(sentence)
        self.directory = directory  #: the folder with everything finished so far, where there is one
        self.brief = _one_line(brief) or str(self)  #: where the reasons are shown besides: the sentence without them
        self.reached: object = None  #: what the function would have returned, as far as it is known

    def with_reached(self, value: object) -> "RunFailed":
        """This failure with what was reached."""
        self.reached = value
        return self


@final
class WorkerLost(RunFailed):
    """A worker process was ended from outside."""


def _one_line(sentence: str) -> str:
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in sentence)


def quoted(value: Any) -> str:
    """A value as it stands in a sentence: on one line, never long, texts in quotes."""
    try:
        return _SHORT.repr(value)
    except ValueError:  # Python writes no number of more than 4300 digits
        return "a number with thousands of digits"


def shortened(text: str) -> str:
    """The beginning of a text that may be too long for a sentence."""
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


_SHORT = reprlib.Repr()
_SHORT.maxlevel = 2
_SHORT.maxlist = _SHORT.maxdict = _SHORT.maxtuple = _SHORT.maxset = 4
_SHORT.maxstring = _SHORT.maxlong = _SHORT.maxother = LONGEST
