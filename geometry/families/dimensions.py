"""Dimensions that no body can have: all of a design that can be told at once."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import Field, fields
from math import isfinite
from typing import Any

from geometry.errors import DesignError, raise_together

#: Smallest and largest dimension that Gmsh draws reliably, mm.
SHORTEST, LONGEST = 1e-3, 1e6
#: Smallest dimension over the smallest side of a body: a film of 10 um on a body of 20 mm has it.
THINNEST = 5e-4
#: Largest number of chambers: one chamber has at least 140 elements, so twice as many exceed MOST_TETS.
MOST_CHAMBERS = 10_000


def check_design(design: Any, relations: Callable[[], Iterable[DesignError]]) -> None:
    """Raise one `DesignError` with everything that is wrong about the fields of a dataclass.

    Every field must be as its default is: an integer from 1 to MOST_CHAMBERS, or a length in mm that can be drawn, or
    zero too where the default is zero. relations: what is wrong about several fields; beside a field that is wrong by
    itself it is asked where all are numbers, and what it says about that field is left out.
    """
    alone = list(_wrong_alone(design))
    wrong = {error.keys[0] for error in alone}
    together: list[DesignError] = []
    if not alone or all(_has_kind(field, getattr(design, field.name)) for field in fields(design)):
        together = [error for error in relations() if not wrong.intersection(error.keys)]
    raise_together([*alone, *together] or _too_small(design))


def _too_small(design: Any) -> Iterator[DesignError]:
    """A `DesignError` for each dimension that is too small beside the body, most likely in another unit."""
    side = min(design.extent)
    for name in (field.name for field in fields(design) if not isinstance(field.default, int)):
        value = getattr(design, name)
        smallest = min(value, default=side) if isinstance(value, tuple) else value
        if 0 < smallest < THINNEST * side:
            ratio = f"{smallest:g} mm is less than {THINNEST:g} of the smallest side of the arm, {side:.4g} mm"
            yield DesignError(name, f"{ratio}, and cannot be meshed; is its unit right?")


def not_less(design: Any, small: str, large: str, fraction: float = 1.0, because: str = "") -> Iterator[DesignError]:
    """A `DesignError` unless the field `small` is less than `fraction` (1 or 1/2) times the field `large`, or times the
    smallest entry of a list."""
    whole = getattr(design, large)
    value, bound = getattr(design, small), fraction * (min(whole) if isinstance(whole, tuple) else whole)
    if not value < bound:
        part = {1.0: "", 0.5: "half of "}[fraction] + ("the smallest of " if isinstance(whole, tuple) else "")
        reason = f": {because}" if because else ""
        yield DesignError((small, large), f"{small} {value:g} mm must be less than {part}{large}, {bound:g} mm{reason}")


def _wrong_alone(design: Any) -> Iterator[DesignError]:
    for field in fields(design):
        value = getattr(design, field.name)
        if isinstance(field.default, tuple):
            if not isinstance(value, tuple):
                yield DesignError(field.name, f"must be a tuple of positive lengths, not {value!r}")
                continue
            for number, entry in enumerate(value, start=1):
                yield from _wrong_length(field.name, entry, f"entry {number} ")
        elif isinstance(field.default, int):
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                yield DesignError(field.name, f"must be a whole number of at least 1, not {value!r}")
            elif value > MOST_CHAMBERS:
                yield DesignError(field.name, f"at most {MOST_CHAMBERS} fit into memory")
        elif field.default or isinstance(value, bool) or value != 0:
            yield from _wrong_length(field.name, value, "", "" if field.default else " or 0")


def _wrong_length(name: str, value: Any, which: str, also: str = "") -> Iterator[DesignError]:
    """A `DesignError` for a value that is no length that can be drawn; which: entry of a list."""
    if not _is_number(value) or not isfinite(value) or value <= 0:
        yield DesignError(name, f"{which}must be a positive length{also}, not {value!r}")
    elif not SHORTEST <= value <= LONGEST:
        yield DesignError(name, f"{which}must lie between {SHORTEST:g} mm and {LONGEST:g} mm, not be {value:g} mm")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _has_kind(field: Field[Any], value: Any) -> bool:
    """Whether a value is a number, or a list of numbers for a field that holds one."""
    if isinstance(field.default, tuple):
        return isinstance(value, tuple) and all(map(_is_number, value))
    return _is_number(value)
