"""The file of a wish: a base configuration, what is free, what is wanted, limits, and what is made small."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from geometry import DesignError
from pipeline.config import kinds, units
from pipeline.config.config import Config
from pipeline.config.document import Key, read_document
from pipeline.config.load import UNUSED, checked, for_command
from pipeline.config.section import (
    Error,
    Field,
    Kind,
    Section,
    in_sentences,
    not_known,
    raise_all,
    read_each,
    read_keys,
    section,
    section_of,
    wrong,
)
from pipeline.study.wishes.wish import CHAMBERS, GEOMETRY, OBJECTIVES, QUANTITIES, Free, Limits, Wish, Wishes, WishFile
from pipeline.study.wishes.wish import PRESSURE as PRESSURE_KEY
from pipeline.values.errors import InputError
from pipeline.values.json_values import Written
from rod.arm_law.quantities import QUANTITIES as ASKED
from rod.errors import RodError
from rod.load import Loading


@section(frozen=True)
class _Range(Section):
    low: Any = Field(alias="from", examples=["0.8 mm"])
    high: Any = Field(alias="to", examples=["1.6 mm"])
    start: Any = Field(default=None, examples=["1 mm"])


def _optional(dimension: units.Dimension) -> tuple[Any, Any]:
    kind = Kind("any", dimension.example, dimension.unit, kinds.in_unit(dimension))
    return Annotated[float | None, kind], Field(default=None)


_Wish = section_of(
    "_Wish",
    {
        "at": (Any, Field(examples=["20 kPa"])),
        "within": (Any, Field(examples=["2 %"])),
        **{name: _optional(dimension) for name, dimension in QUANTITIES.items()},
        "tip": (
            Annotated[list[kinds.Length] | None, kinds.list_of("x and y", "[30 mm, -40 mm]", count=2)],
            Field(default=None),
        ),
        "at_height": _optional(units.LENGTH),
        "under": (Any, Field(default=None, examples=["{force: [0 N, -0.1 N]}"])),
    },
)
#: what may act on an arm of a wish, as `pneurod rod` takes it
LOADS = ("force", "moment", "orientation", "tip_mass")


@section(frozen=True)
class _File(Section):
    name: kinds.Name
    base: kinds.Base
    free: Annotated[dict[str, _Range], kinds.not_empty("{geometry.wall: {from: 0.8 mm, to: 1.6 mm}}")]
    wishes: Annotated[list[_Wish], kinds.not_empty("[{angle: 90 deg, at: 20 kPa, within: 2 deg}]")]  # type: ignore[valid-type]
    limits: Limits = Limits()
    minimize: Annotated[str, kinds.one_of(OBJECTIVES)] = ""
    set: dict[str, Written] = Field(default_factory=dict)
    starts: kinds.Count = 3


def read_wishes(path: Path) -> WishFile:
    """The wish in a YAML file. Raises InputError with a sentence that names file, key and what is allowed, for each
    mistake."""
    document = read_document(path)
    with in_sentences(document):
        content = read_keys(_File, document.content, document)
        base = content.base.with_values(list(content.set.items()), lambda key: f"{path}: set.{key}")
        arm, unused = for_command("design", base, checked)
        kept = base.without(UNUSED["design"] if unused else ["validation.pressures"])
        found = WishFile(path, content.name, kept, _wishes(content, arm), _counts(content.free, arm))
        try:
            found.start  # noqa: B018 - read here, or refused
        except (InputError, DesignError) as failure:
            raise_all([wrong(f"the design at the start is none: {failure}", ("free",))])
    return found


def _wishes(content: _File, arm: Config) -> Wishes:
    """What the file says, for the arm of the base."""
    if reason := arm.effects.why_no_arm_law(arm.design):
        raise_all([wrong(f"this arm has no law of its own, which a design needs: {reason}", ("base",))])
    others = {key: given for key, given in content.free.items() if key != CHAMBERS}
    free = read_each(others, lambda key, given: _free(key, given, arm), ("free",))
    names = [key.removeprefix(PRESSURE_KEY) for key in free if key.startswith(PRESSURE_KEY)]
    written = dict(enumerate(content.wishes))
    wishes = tuple(read_each(written, lambda _, given: _wish(given, names), ("wishes",)).values())
    raise_all((*_contradictions(wishes), *_needless(content, names, arm)))
    return Wishes(tuple(free.values()), wishes, content.limits, content.minimize, content.starts)


def _counts(free: Mapping[str, _Range], arm: Config) -> tuple[int, ...]:
    """The numbers of chambers that are tried: that of the base, or the start, and those nearest to it first."""
    if (given := free.get(CHAMBERS)) is None:
        return ()
    count: Any = getattr(arm.design, "chambers", None) if given.start is None else given.start
    if len(free) == 1 or not all(isinstance(n, int) for n in (count, given.low, given.high)) or not given.low > 0:
        sentence = "needs a family with chambers, another free key, and whole numbers such as {from: 4, to: 8}"
        raise_all([wrong(sentence, ("free", CHAMBERS))])
    return tuple(sorted(range(given.low, given.high + 1), key=lambda n: abs(n - count)))


def _needless(content: _File, names: list[str], arm: Config) -> Iterator[Error]:
    """Refuses what is asked of a number that the arm does not have; names: of the free pressures."""
    if content.minimize == "pressure" and not names:
        yield wrong("no pressure is free; give one, {pressure.p: {from: 5 kPa, to: 30 kPa}}", ("minimize",))
    asked: dict[Key, bool] = {
        ("limits", "mass"): content.limits.mass_g is not None,
        ("minimize",): content.minimize == "mass",
    }
    for key in (key for key, is_asked in asked.items() if is_asked and arm.mass_tonne is None):
        yield wrong("the base has no density; give material.density there", key)


def _free(key: str, given: _Range, arm: Config) -> Free:
    is_pressure, known = key.startswith(PRESSURE_KEY), [f"{GEOMETRY}{name}" for name in arm.design.dimensions]
    if not is_pressure and key not in known:
        names = (*known, f"{PRESSURE_KEY}NAME")
        raise ValueError(f"is no dimension of this arm that can change; {not_known(key, names)}")
    dimension = units.PRESSURE if is_pressure else units.LENGTH
    written = {"from": given.low, "to": given.high, "start": given.start}
    at_ends = {at: value for at, value in written.items() if value is not None}
    ends = read_each(at_ends, lambda _, value: units.convert(value, dimension))
    low, high, unit = ends["from"], ends["to"], dimension.unit
    if not 0.0 < low < high:
        raise ValueError(f"goes from {low:g} to {high:g} {unit}; allowed: 0 < from < to")
    usual = 0.5 * (low + high) if is_pressure else arm.design.dimensions[key.removeprefix(GEOMETRY)]
    if not low <= (start := ends.get("start", usual)) <= high:
        where = "start" if "start" in ends else "the value of the base"
        raise ValueError(f"{where}, {start:g} {unit}, is outside its bounds; allowed: {low:g} to {high:g} {unit}")
    return Free(key, low, high, start)


def _wish(given: Any, names: list[str]) -> Wish:
    """names: of the free pressures."""
    named = [name for name in QUANTITIES if getattr(given, name) is not None]
    if len(named) != 1:
        raise ValueError(f"names {len(named)} quantities; give one of {', '.join(QUANTITIES)}")
    (quantity,) = named
    if (quantity == "force") != (given.at_height is not None):
        raise_all([wrong("belongs to a force, and a force needs it; for example 0 mm", ("at_height",))])
    target = tuple(np.atleast_1d(getattr(given, quantity)).tolist())
    at = read_each({"at": given.at}, lambda _, written: _pressure(written, names))
    within = read_each({"within": given.within}, lambda _, written: _within(written, target, QUANTITIES[quantity]))
    under = read_each({"under": given.under}, lambda _, written: _loading(written, quantity))["under"]
    words = ", ".join(f"{name} {value}" for name, value in (given.under or {}).items()).replace("'", "")
    return Wish(quantity, target, within["within"], at["at"], given.at_height or 0.0, under, words)


def _loading(written: Any, quantity: str) -> Loading:
    """What acts besides the pressure."""
    if written is None:
        return Loading()
    if not ASKED[quantity].bears:
        raise ValueError(f"{quantity} is that of the arm without a load; an angle or a tip can be wished under one")
    if not isinstance(written, Mapping) or not written or not set(written) <= set(LOADS):
        raise ValueError(f"{written} is no load; allowed are {', '.join(LOADS)}, such as {{force: [0 N, -0.1 N]}}")
    direction, tip_mass = (written.get(name) for name in ("orientation", "tip_mass"))
    if tip_mass and direction is None:
        raise ValueError("a tip_mass needs orientation: hanging, lying, standing, '30 deg' or [0, -1]")
    try:
        return Loading(written.get("force"), written.get("moment", 0.0), None, (), direction, tip_mass or 0.0)
    except RodError as failure:
        raise ValueError(str(failure)) from None


def _within(written: Any, target: tuple[float, ...], dimension: units.Dimension) -> float:
    parts = units.number_and_unit(written)
    if parts and parts[1] == "%":
        if len(target) > 1 or target[0] == 0.0:
            raise ValueError(f"{written} of it is no tolerance here; give one such as {dimension.example}")
        within = abs(target[0]) * parts[0] / 100.0
    else:
        within = units.convert(written, dimension)
    if within <= 0.0:
        raise ValueError(f"{written} is not above zero; for example 2 %")
    return within


def _pressure(written: Any, names: list[str]) -> float | str:
    """kPa, or one of the names of free pressures."""
    if written in names:
        return str(written)
    if isinstance(written, str) and units.number_and_unit(written) is None and not written[:1].isdigit():
        raise ValueError(not_known(written, (*names, "a pressure such as 20 kPa")))
    pressure = units.convert(written, units.PRESSURE)
    if pressure <= 0.0:
        raise ValueError(f"{pressure:g} kPa is not above zero; for example 20 kPa")
    return pressure


def _contradictions(wishes: tuple[Wish, ...]) -> Iterator[Error]:
    """Two wishes for one number at one pressure that no arm meets."""
    for number, wish in enumerate(wishes):
        for earlier, other in enumerate(wishes[:number]):
            same = replace(wish, target=other.target, within=other.within, load=other.load) == other
            away = float(np.linalg.norm(np.subtract(wish.target, other.target))) if same else 0.0
            if away > wish.within + other.within:
                sentence = f"{wish.text(wish.target)} contradicts wishes[{earlier + 1}], {other.text(other.target)}"
                yield wrong(f"{sentence}; leave one of them out", ("wishes", number))
