"""How a command ends when it cannot do its work: in sentences, and with the exit status that goes with them."""

import reprlib
from pathlib import Path
from typing import Any, final

from geometry import PneurodError

#: Characters of a user's value that a sentence repeats.
LONGEST = 60


class _Sentence(PneurodError):
    """One sentence on one line, whatever it quotes."""

    def __init__(self, sentence: str) -> None:
        super().__init__(_one_line(sentence))


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


@final
class ConflictError(InputError):
    """Values that the user gave do not go together, though each one is allowed."""


class RunFailed(_Sentence):
    """The work was started and could not be finished (exit status 1). Everything finished so far is on disk."""

    def __init__(self, sentence: str, directory: Path | None = None, brief: str = "") -> None:
        super().__init__(sentence)
        self.directory = directory  #: the folder with everything finished so far, where there is one
        self.brief = _one_line(brief) or str(self)  #: where the reasons are shown besides: the sentence without them


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
