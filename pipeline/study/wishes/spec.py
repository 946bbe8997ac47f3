"""The file of a wish: a base configuration, what is free, what is wanted, limits, and what is made small."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from geometry import DesignError
from pipeline.config.config import Config
from pipeline.config.document import Document, read_document
from pipeline.config.kinds import Count, Length, Name, Text, in_unit, list_of
from pipeline.config.section import Field, Kind, Section, closest, not_known, read, section, section_of
from pipeline.config.units import LENGTH, PRESSURE, Dimension, convert, number_and_unit
from pipeline.study.wishes.wish import GEOMETRY, OBJECTIVES, QUANTITIES, Free, Limits, Wish, Wishes
from pipeline.study.wishes.wish import PRESSURE as PRESSURE_KEY
from pipeline.study.wishes.wish_file import WishFile
from pipeline.values.errors import InputError, quoted


@section(frozen=True)
class _Range(Section):
    low: Any = Field(alias="from", examples=["0.8 mm"])
    high: Any = Field(alias="to", examples=["1.6 mm"])
    start: Any = Field(default=None, examples=["1 mm"])


def _optional(dimension: Dimension) -> tuple[Any, Any]:
    kind = Kind("any", dimension.example, dimension.unit, in_unit(dimension))
    return Annotated[float | None, kind], Field(default=None)


_Wish = section_of(
    "_Wish",
    {
        "at": (Any, Field(examples=["20 kPa"])),
        "within": (Any, Field(examples=["2 %"])),
        **{name: _optional(dimension) for name, dimension in QUANTITIES.items()},
        "tip": (Annotated[list[Length] | None, list_of("x and y", "[30 mm, -40 mm]", count=2)], Field(default=None)),
        "at_height": _optional(LENGTH),
    },
    {},
)


@section(frozen=True)
class _File(Section):
    name: Name
    base: Text = Field(examples=["pneunet_coarse.yaml"])
    free: dict[str, _Range] = Field(examples=["{geometry.wall: {from: 0.8 mm, to: 1.6 mm}}"])
    wishes: list[_Wish] = Field(examples=["[{angle: 90 deg, at: 20 kPa, within: 2 deg}]"])  # type: ignore[valid-type]
    limits: Limits = Limits()
    minimize: Any = Field(default="", examples=["mass"])
    set: dict[str, Any] = Field(default_factory=dict)
    starts: Count = 3


def read_wishes(path: Path) -> WishFile:
    """The wish in a YAML file. Raises InputError with one sentence that names file, key and what is allowed."""
    document = read_document(path)
    content = read(_File, document)
    base = _base(document, path.parent / content.base, content.set)
    arm = read(Config, base)
    if reason := arm.effects.why_no_arm_law(arm.design) or ("" if arm.design.repeats else arm.design.why_no_cell):
        raise document.wrong(("base",), f"this arm has no law of its own, which a design needs: {reason}")
    for key in ("free", "wishes"):
        if not getattr(content, key):
            raise document.wrong((key,), f"is empty; for example {_File.key_fields()[key].examples[0]}")  # type: ignore[index]
    free = tuple(_free(document, key, written, arm) for key, written in content.free.items())
    wanted = tuple(_wish(document, number, written, free) for number, written in enumerate(content.wishes))
    _refuse_contradictions(document, wanted)
    if content.limits.mass_g is not None and arm.mass_tonne is None:
        raise document.wrong(("limits", "mass"), "the base has no density; give material.density there")
    minimize = _minimize(document, content.minimize, free, arm)
    found = WishFile(path, content.name, base, Wishes(free, wanted, content.limits, minimize, content.starts))
    try:
        found.start  # noqa: B018 - read here, or refused
    except (InputError, DesignError) as failure:
        raise document.wrong(("free",), f"the design at the start is none: {failure}") from None
    return found


def _base(document: Document, path: Path, settings: Mapping[str, Any]) -> Document:
    try:
        return read_document(path).with_values(list(settings.items()), lambda key: f"{document.path}: set.{key}")
    except InputError as failure:
        raise document.wrong(("base",), str(failure)) from None


def _free(document: Document, key: str, given: _Range, arm: Config) -> Free:
    place, is_pressure = ("free", key), key.startswith(PRESSURE_KEY)
    known = [f"{GEOMETRY}{name}" for name in arm.design.dimensions]
    if not is_pressure and key not in known:
        names = (*known, f"{PRESSURE_KEY}NAME")
        raise document.wrong(place, f"is no dimension of this arm that can change; {not_known(key, names)}")
    dimension = PRESSURE if is_pressure else LENGTH
    low, high = (
        _number(document, (*place, name), getattr(given, field), dimension)
        for name, field in (("from", "low"), ("to", "high"))
    )
    if not 0.0 < low < high:
        raise document.wrong(place, f"goes from {low:g} to {high:g} {dimension.unit}; allowed: 0 < from < to")
    where = "start" if is_pressure or given.start is not None else "the value of the base"
    if given.start is not None:
        start = _number(document, (*place, "start"), given.start, dimension)
    else:
        start = 0.5 * (low + high) if is_pressure else arm.design.dimensions[key.removeprefix(GEOMETRY)]
    if not low <= start <= high:
        bounds = f"{low:g} to {high:g} {dimension.unit}"
        raise document.wrong(place, f"{where}, {start:g} {dimension.unit}, is outside its bounds; allowed: {bounds}")
    return Free(key, low, high, start)


def _wish(document: Document, number: int, given: Any, free: tuple[Free, ...]) -> Wish:
    place = ("wishes", number)
    named = [name for name in QUANTITIES if getattr(given, name) is not None]
    if len(named) != 1:
        raise document.wrong(place, f"names {len(named)} quantities; give one of {', '.join(QUANTITIES)}")
    (quantity,) = named
    if (quantity == "force") != (given.at_height is not None):
        raise document.wrong((*place, "at_height"), "belongs to a force, and a force needs it; for example 0 mm")
    target = tuple(np.atleast_1d(getattr(given, quantity)).tolist())
    within = _within(document, (*place, "within"), given.within, target, QUANTITIES[quantity])
    return Wish(quantity, target, within, _pressure(document, (*place, "at"), given.at, free), given.at_height or 0.0)


def _within(
    document: Document, place: tuple[str | int, ...], written: Any, target: tuple[float, ...], dimension: Dimension
) -> float:
    parts = number_and_unit(written)
    if parts and parts[1] == "%":
        if len(target) > 1 or target[0] == 0.0:
            raise document.wrong(place, f"{written} of it is no tolerance here; give one such as {dimension.example}")
        within = abs(target[0]) * parts[0] / 100.0
    else:
        within = _number(document, place, written, dimension)
    if within <= 0.0:
        raise document.wrong(place, f"{written} is not above zero; for example 2 %")
    return within


def _pressure(document: Document, place: tuple[str | int, ...], written: Any, free: tuple[Free, ...]) -> float | str:
    names = [one.key.removeprefix(PRESSURE_KEY) for one in free if one.key.startswith(PRESSURE_KEY)]
    if written in names:
        return str(written)
    if isinstance(written, str) and number_and_unit(written) is None and not written[:1].isdigit():
        known = f"allowed: {', '.join(names)}, or a pressure" if names else "no pressure is free; write 20 kPa"
        near = closest(written, names)
        raise document.wrong(
            place, f"{quoted(written)} is no free pressure; {f'did you mean {near}? ' * bool(near)}{known}"
        )
    pressure = _number(document, place, written, PRESSURE)
    if pressure <= 0.0:
        raise document.wrong(place, f"{pressure:g} kPa is not above zero; for example 20 kPa")
    return pressure


def _refuse_contradictions(document: Document, wishes: tuple[Wish, ...]) -> None:
    """Two wishes for one number at one pressure that no arm meets."""
    for number, wish in enumerate(wishes):
        for earlier, other in enumerate(wishes[:number]):
            same = (wish.quantity, wish.at, wish.height_mm) == (other.quantity, other.at, other.height_mm)
            away = float(np.linalg.norm(np.subtract(wish.target, other.target))) if same else 0.0
            if away > wish.within + other.within:
                sentence = f"{wish.text(wish.target)} contradicts wishes[{earlier + 1}], {other.text(other.target)}"
                raise document.wrong(("wishes", number), f"{sentence}; leave one of them out")


def _minimize(document: Document, written: Any, free: tuple[Free, ...], arm: Config) -> str:
    if written in ("", None):
        return ""
    if written not in OBJECTIVES:
        raise document.wrong(("minimize",), not_known(written, OBJECTIVES))
    if written == "pressure" and not any(one.key.startswith(PRESSURE_KEY) for one in free):
        raise document.wrong(("minimize",), "no pressure is free; give one, {pressure.p: {from: 5 kPa, to: 30 kPa}}")
    if written == "mass" and arm.mass_tonne is None:
        raise document.wrong(("minimize",), "the base has no density; give material.density there")
    return str(written)


def _number(document: Document, place: tuple[str | int, ...], written: Any, dimension: Dimension) -> float:
    try:
        return convert(written, dimension)
    except ValueError as refused:
        raise document.wrong(place, str(refused)) from None
