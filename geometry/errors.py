"""What is wrong with a mesh or a design, and where; reasons as values."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

#: numbers with their units in their names, words, and lists of them
Values: TypeAlias = Mapping[str, float | int | str | list[Any]]


class Word(str):
    """A word that stands where a sentence may expect a number: no format changes it."""

    def __format__(self, spec: str) -> str:
        return str(self)


def with_words(value: Any) -> Any:
    """A value whose numbers are all finite: the words "unknown" and "infinite" stand for those that are not."""
    if isinstance(value, Mapping):
        return {name: with_words(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [with_words(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return Word("unknown" if math.isnan(value) else "infinite")
    return Word(value) if isinstance(value, str) else value


@dataclass(frozen=True)
class Reason:
    """A code and the numbers that belong to it, all finite; `pipeline.values.reasons.render` makes the sentence."""

    code: str
    values: Values = field(default_factory=dict, hash=False)
    where: tuple[float, float, float] | None = None  #: mm, in the reference configuration

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", with_words(self.values))


class PneurodError(Exception):
    """Base class of the errors that a caller of pneurod may want to catch; the message is a sentence."""


class MeshError(PneurodError, ValueError):
    """A mesh that cannot be used, with the reason in one sentence."""


def position_text(point: Iterable[float], digits: str = ".1f") -> str:
    """A point (3,) in mm with its unit, for sentences; digits: as in a format, by default a tenth of a millimetre."""
    return "(" + ", ".join(f"{x:{digits}}" for x in point) + ") mm"


class DesignError(PneurodError, ValueError):
    """Dimensions that no body can have.

    `keys` are the names of the dimensions as in a config (`("wall", "chamber_length")`), `sentence` tells what is
    allowed. `others` are what else is wrong about the same design.
    """

    def __init__(self, keys: str | Sequence[str], sentence: str, others: Sequence["DesignError"] = ()) -> None:
        self.keys: tuple[str, ...] = (keys,) if isinstance(keys, str) else tuple(keys)
        self.sentence = sentence
        self.others = tuple(others)
        super().__init__("; ".join([f"{', '.join(self.keys)}: {sentence}", *map(str, self.others)]))

    def __reduce__(self) -> tuple[type["DesignError"], tuple[object, ...]]:
        """For other processes."""
        return type(self), (self.keys, self.sentence, self.others)


def raise_together(design_errors: Iterable[DesignError]) -> None:
    """Raise one `DesignError` that holds all those found, if there are any."""
    errors = list(design_errors)
    if errors:
        raise DesignError(errors[0].keys, errors[0].sentence, errors[1:])
