"""Why something failed, or what is remarkable about it, as a value."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

#: numbers with their units in their names, words, and lists of them
Values: TypeAlias = Mapping[str, float | int | str | list[Any]]


@dataclass(frozen=True)
class Reason:
    """A code and the numbers that belong to it; `pipeline.notes.render` makes the sentence."""

    code: str
    values: Values = field(default_factory=dict, hash=False)
    where: tuple[float, float, float] | None = None  #: mm, in the reference configuration
