"""The file of a wish: a base configuration, what is free, what is wanted, limits, and what is made small."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry import DesignError
from pipeline.config.config import Config
from pipeline.config.document import Document, read_document
from pipeline.config.kinds import Count, Name, Text
from pipeline.config.section import Field, Section, closest, not_known, read, section
from pipeline.config.units import LENGTH, MASS, PRESSURE, Dimension, convert, number_and_unit
from pipeline.errors import InputError, quoted
from pipeline.wishes.wish import OBJECTIVES, QUANTITIES, Free, Limits, Wish, Wishes
from pipeline.wishes.wish import PRESSURE as PRESSURE_KEY
from pipeline.wishes.wish_file import GEOMETRY, WALL, WishFile


@section(frozen=True)
class _Limits(Section):
    largest_stretch: Any = Field(default=None, examples=["1.4"])
    mass: Any = Field(default=None, examples=["30 g"])
    smallest_wall: Any = Field(default=None, examples=["0.8 mm"])
    bears: Any = Field(default=None, examples=["1.2"])


@section(frozen=True)
class _File(Section):
    name: Name
    base: Text = Field(examples=["pneunet_coarse.yaml"])
    free: dict[str, Any] = Field(examples=["{geometry.wall: {from: 0.8 mm, to: 1.6 mm}}"])
    wishes: list[Any] = Field(examples=["[{angle: 90 deg, at: 20 kPa, within: 2 deg}]"])
    limits: _Limits = _Limits()
    minimize: Any = Field(default="", examples=["mass"])
    set: dict[str, Any] = Field(default_factory=dict)
    starts: Count = 3


@section(frozen=True)
class _Range(Section):
    low: Any = Field(alias="from", examples=["0.8 mm"])
    high: Any = Field(alias="to", examples=["1.6 mm"])
    start: Any = Field(default=None, examples=["1 mm"])


@section(frozen=True)
class _Wish(Section):
    at: Any = Field(examples=["20 kPa"])
    within: Any = Field(examples=["2 %"])
    kappa_0: Any = None
    angle: Any = None
    tip: Any = None
    force: Any = None
    stiffness: Any = None
    at_height: Any = Field(default=None, examples=["0 mm"])


def read_wishes(path: Path) -> WishFile:
    """The wish in a YAML file. Raises InputError with one sentence that names file, key and what is allowed."""
    document = read_document(path)
    content = read(_File, document)
    base = _base(document, path.parent / content.base, content.set)
    arm = read(Config, base)
    if reason := arm.effects.why_no_arm_law(arm.design) or ("" if arm.design.repeats else arm.design.why_no_cell):
        raise document.wrong(("base",), f"this arm has no law of its own, which a design needs: {reason}")
    free = tuple(_free(document, key, written, arm) for key, written in content.free.items())
    if not free:
        raise document.wrong(
            ("free",), "names nothing; give a dimension with bounds, {geometry.wall: {from: 0.8 mm, .."
        )
    wanted = tuple(_wish(document, number, written, free) for number, written in enumerate(content.wishes))
    if not wanted:
        raise document.wrong(("wishes",), "is empty; for example [{angle: 90 deg, at: 20 kPa, within: 2 deg}]")
    _refuse_contradictions(document, wanted)
    limits = _limits(document, content.limits, arm)
    minimize = _minimize(document, content.minimize, free, arm)
    found = WishFile(path, content.name, base, Wishes(free, wanted, limits, minimize, content.starts))
    _check_start(document, found)
    return found


def _base(document: Document, path: Path, settings: Mapping[str, Any]) -> Document:
    try:
        return read_document(path).with_values(list(settings.items()), lambda key: f"{document.path}: set.{key}")
    except InputError as failure:
        raise document.wrong(("base",), str(failure)) from None


def _free(document: Document, key: str, written: Any, arm: Config) -> Free:
    place = ("free", key)
    known = [f"{GEOMETRY}{name}" for name in arm.design.dimensions]
    if not key.startswith(PRESSURE_KEY) and key not in known:
        names = (*known, f"{PRESSURE_KEY}NAME")
        raise document.wrong(place, f"is no dimension of this arm that can change; {not_known(key, names)}")
    if not isinstance(written, Mapping):
        raise document.wrong(place, f"{quoted(written)} has no bounds; for example {{from: 0.8 mm, to: 1.6 mm}}")
    given = _section(document, _Range, written, place)
    dimension = PRESSURE if key.startswith(PRESSURE_KEY) else LENGTH
    low, high = (
        _number(document, (*place, name), one, dimension) for name, one in (("from", given.low), ("to", given.high))
    )
    if not 0.0 < low < high:
        raise document.wrong(place, f"goes from {low:g} to {high:g} {dimension.unit}; allowed: 0 < from < to")
    if given.start is not None:
        start, where = _number(document, (*place, "start"), given.start, dimension), "start"
    elif dimension is PRESSURE:
        start, where = 0.5 * (low + high), "start"
    else:
        start, where = arm.design.dimensions[key.removeprefix(GEOMETRY)], "the value of the base"
    if not low <= start <= high:
        bounds = f"{low:g} to {high:g} {dimension.unit}"
        raise document.wrong(place, f"{where}, {start:g} {dimension.unit}, is outside its bounds; allowed: {bounds}")
    return Free(key, low, high, start)


def _wish(document: Document, number: int, written: Any, free: tuple[Free, ...]) -> Wish:
    place = ("wishes", number)
    given = _section(document, _Wish, written, place)
    named = [name for name in QUANTITIES if getattr(given, name) is not None]
    if len(named) != 1:
        raise document.wrong(place, f"names {len(named)} quantities; give one of {', '.join(QUANTITIES)}")
    (quantity,) = named
    dimension, value = QUANTITIES[quantity], getattr(given, quantity)
    if (quantity == "force") != (given.at_height is not None):
        raise document.wrong((*place, "at_height"), "belongs to a force, and a force needs it; for example 0 mm")
    values = value if quantity == "tip" else [value]
    if not isinstance(values, list) or len(values) != (2 if quantity == "tip" else 1):
        raise document.wrong((*place, quantity), f"{quoted(value)} is no place; for example [30 mm, -40 mm]")
    target = tuple(_number(document, (*place, quantity), one, dimension) for one in values)
    height = 0.0 if given.at_height is None else _number(document, (*place, "at_height"), given.at_height, LENGTH)
    within = _within(document, (*place, "within"), given.within, target, dimension)
    return Wish(quantity, target, within, _pressure(document, (*place, "at"), given.at, free), height)


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


def _limits(document: Document, given: _Limits, arm: Config) -> Limits:
    def limit(name: str, dimension: Dimension | None, least: float) -> float | None:
        written = getattr(given, name)
        if written is None:
            return None
        place = ("limits", name)
        if dimension is None:
            is_number = isinstance(written, int | float) and not isinstance(written, bool)
            value = float(written) if is_number else least
        else:
            value = _number(document, place, written, dimension)
        if not value > least:
            unit = "" if dimension is None else f" {dimension.unit}"
            raise document.wrong(place, f"{quoted(written)} is not allowed; allowed: a number above {least:g}{unit}")
        return value

    if given.mass is not None and arm.mass_tonne is None:
        raise document.wrong(("limits", "mass"), "the base has no density; give material.density there")
    return Limits(
        limit("largest_stretch", None, 1.0),
        limit("mass", MASS, 0.0),
        limit("smallest_wall", LENGTH, 0.0),
        limit("bears", None, 1.0),
    )


def _minimize(document: Document, written: Any, free: tuple[Free, ...], arm: Config) -> str:
    if written in ("", None):
        return ""
    if written not in OBJECTIVES:
        raise document.wrong(("minimize",), not_known(written, OBJECTIVES))
    if written == "pressure" and not any(one.key.startswith(PRESSURE_KEY) for one in free):
        raise document.wrong(("minimize",), "no pressure is free; give one, {pressure.p: {from: 5 kPa, to: 30 kPa}}")
    if written == "sensitivity" and WALL.removeprefix(GEOMETRY) not in arm.design.dimensions:
        raise document.wrong(("minimize",), "sensitivity is that to geometry.wall, which this arm does not have")
    if written == "mass" and arm.mass_tonne is None:
        raise document.wrong(("minimize",), "the base has no density; give material.density there")
    return str(written)


def _check_start(document: Document, found: WishFile) -> None:
    """Refuse a start that is no body, and limits that no corner of the bounds keeps."""
    try:
        found.start  # noqa: B018 - read here, or refused
    except (InputError, DesignError) as failure:
        raise document.wrong(("free",), f"the design at the start is none: {failure}") from None


def _section(document: Document, keys: Any, written: Any, place: tuple[str | int, ...]) -> Any:
    """A section below a place of the document. Raises InputError."""
    inner = Document(document.path, written if isinstance(written, Mapping) else {}, ())
    if not isinstance(written, Mapping):
        raise document.wrong(place, f"{quoted(written)} holds no keys; allowed: {', '.join(keys.key_fields())}")
    return read(keys, _Inside(inner.path, inner.content, (), place=place))


@dataclass(frozen=True)
class _Inside(Document):
    """A part of a document, whose keys are told from the beginning."""

    place: tuple[str | int, ...] = ()

    def sentence(self, key: tuple[str | int, ...], complaint: str) -> str:
        """With the place of the part."""
        return super().sentence((*self.place, *key), complaint)


def _number(document: Document, place: tuple[str | int, ...], written: Any, dimension: Dimension) -> float:
    try:
        return convert(written, dimension)
    except ValueError as refused:
        raise document.wrong(place, str(refused)) from None
