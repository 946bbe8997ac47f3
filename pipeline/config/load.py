"""A configuration read from a YAML file with units, checked.

A refusal is one sentence for each thing that is wrong: `FILE: key: what is wrong; what is allowed`.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from geometry import Reason
from pipeline.config.config import Config
from pipeline.config.document import Document, read_document
from pipeline.config.section import read
from pipeline.values.errors import InputError

Read = TypeVar("Read")
#: keys whose values a command does not use; a run uses all
UNUSED: dict[str, Sequence[str]] = {
    "mesh": [
        "pressures",
        "experiments",
        "end",
        "identification",
        "validation",
        "law",
        "newton",
        "accuracy",
    ],
    "cell": ["experiments", "identification", "validation.pressures", "law"],
    "design": ["pressures", "experiments", "identification", "validation", "law"],
}


def load_config(path: Path | str, overrides: Sequence[str] = ()) -> Config:
    """The configuration in the YAML file `path` with `overrides` ("mesh.size=4 mm") applied.

    Raises InputError with a sentence for each thing that is wrong, which names the file (or the override), the key and
    what is allowed.
    """
    return checked(read_document(Path(path), overrides))


def checked(document: Document) -> Config:
    """The configuration of a document. Raises InputError."""
    return read(Config, document)


def for_command(
    command: str, document: Document, read_one: Callable[[Document], Read]
) -> tuple[Read, tuple[Reason, ...]]:
    """What a document says, without wrong values of unused keys, and a note for each of them. Raises InputError."""
    try:
        return read_one(document), ()
    except InputError as refused:
        found = read_one(document.without(UNUSED.get(command, ())))
        reasons = (Reason("unused_key", {"complaint": one, "command": command}) for one in refused.sentences)
        return found, tuple(reasons)
