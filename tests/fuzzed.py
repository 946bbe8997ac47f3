"""Valid and invalid configurations for hypothesis: any family, key and value, and any text."""

import datetime
from copy import deepcopy
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

import yaml
from hypothesis import strategies as st

from fem.elements import ELEMENTS
from fem.materials import LAWS, Constant
from geometry import FAMILIES, GRADINGS
from pipeline.config.effects import EFFECTS

#: a drawing and a mesh that stand beside the configuration, and files that are not what their names say
SOUND_FILES = ("finger.step", "ready.msh")
SPOILT_FILES = ("empty.step", "cut.step", "text.brep", "empty.msh", "cut.msh", "text.msh", "folder.step", "folder.msh")

ODD_UNITS = (
    *(
        "",
        "furlongz",
        "mm^2",
        "mm mm",
        "degC",
        "dB",
        "mm**",
        "ml/cm^2",
        "m^-1",
        "rad",
        "%",
        "ｍｍ",
        "mm;",
        "(mm",
        "1/mm",
    ),
    *("mm^99999", "mm**1e9", "kPa kPa^-1 mm", "lightyear", "planck_length", "pi", "__class__", "mm # kPa"),
    *("delta_degC",),
    *("kPa", "MPa", "mm", "kg/m^3", "m/s^2", "N", "percent", "mm**mm", "mm^(1/0)", "a" * 300, "mm*" * 50 + "mm"),
    *("mm**9**9**9**9", "mm*9**9**9**9", "(" * 300 + "mm", "-" * 300 + "mm", "mm**(9**9**9**9)", "mm²²²²", "mm + mm"),
    *("mm" * 400,),
)
ODD_NUMBERS = st.one_of(
    st.integers(-320, 308).map(lambda power: f"1e{power}"),
    st.integers(-12, 12).map(lambda power: f"-3e{power}"),
    st.floats().map(str),
    st.sampled_from(
        ["0", "1e999", "1_000", "0x10", "1,5", "٣", "1e", ".", "+", "--1", "1.2.3", "inf", "nan", "9" * 400, "1e-400"]
    ),
)
ODD_VALUES = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.sampled_from([10**30, 10**400, -(10**30)]),
        st.floats(),
        st.text(max_size=12),
        st.binary(max_size=4),
        st.dates(datetime.date(1900, 1, 1)),
        st.sampled_from(["auto", "on", "p2", "svk", "own", "cavity", "~", "=", "<<", "1:30", "\x00", "../..", "NaN"]),
    ),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5) | st.integers(), inner, max_size=3),
    max_leaves=5,
)
#: 9**12 texts in a dozen short lists
LAUGHTER = "[&a0 [x]" + "".join(f", &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 13)) + "]"
JUNK = (
    LAUGHTER,
    *("\t", "\x00", "&a ", "*a", "<<: *a", "!!python/object:os.system ", "!!binary ", "%YAML 9", "---\n", "...\n"),
    *("? ", "- "),
    *(
        "{",
        "}",
        "[",
        "]",
        "]]",
        "'",
        '"',
        "|\n",
        ">",
        "#",
        ": ",
        ",",
        "@",
        "`",
        "\ufeff",
        "\u2028",
        "é",
        "🐙",
        "\ud7ff",
    ),
    *("0o9",),
    *("&a [*a]", "{? [a]: b}", "[" * 2000, "{a: " * 2000, "!!set {a}", "!!omap [a: 1]", "2020-13-45", "9" * 5000),
    *("1e5e5",),
    *("!!float x", "!!int x", "!!timestamp x", "!!null x", "!!bool 3", "!!map [a]", "!!seq {a: 1}", "!!str {a: b}"),
    *("<<: 3\n",),
    *("\nmesh: {size: 4 mm}\n", "\n? {a: b}\n: c\n", "\n[a]: b\n", "\n1: 2\n", "\n~: 2\n", "!x", "!<tag:> a", "\\"),
    *("\r", "\x85"),
)


@dataclass(frozen=True)
class Written:
    """A configuration as it comes in: what stands in the file, and what `--set` says."""

    content: bytes
    settings: tuple[str, ...]


def seldom(often: int) -> st.SearchStrategy[bool]:
    """True once in that many draws."""
    return st.integers(1, often).map(lambda number: number == often)


@st.composite
def quantity(draw: st.DrawFn, usual: float, unit: str) -> str:
    """Mostly near the usual value, sometimes far away, sometimes in another unit of the same kind."""
    far = st.sampled_from([1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.1, 10.0, 100.0, 1e3, 1e6, 1e12])
    factor = draw(far if draw(seldom(40)) else st.floats(0.5, 1.7))
    return f"{usual * factor:.4g} {unit}"


@st.composite
def geometry(draw: st.DrawFn) -> dict[str, Any]:
    """The dimensions of a family, some left out, or a file of one's own."""
    family = draw(st.sampled_from([*FAMILIES, *FAMILIES, "own"]))
    if family == "own":
        return draw(own_geometry())
    chosen: dict[str, Any] = {"family": family}
    for field in fields(FAMILIES[family]):  # type: ignore[arg-type]
        usual: Any = field.default
        if not draw(st.booleans()):
            continue
        if usual == ():
            if draw(seldom(15)):
                chosen[field.name] = draw(st.lists(quantity(5.0, "mm"), max_size=5) | quantity(5.0, "mm"))
            continue
        count = st.sampled_from([0, -1, 30, 10**3, 10**6, 10**12]) if draw(seldom(8)) else st.integers(1, 12)
        chosen[field.name] = draw(count if isinstance(usual, int) else quantity(usual, "mm"))
    return chosen


@st.composite
def own_geometry(draw: st.DrawFn) -> dict[str, Any]:
    """A file of one's own with the keys of the shipped finger, or with those of a ready mesh."""
    name = draw(st.sampled_from([*SOUND_FILES * 4, *SPOILT_FILES, "none.step", "", "a\x00b.step", "/", "..", "no.txt"]))
    chosen: dict[str, Any] = {"family": "own", "file": name, "curve": "1 mm"}
    if not name.endswith(".msh"):
        chosen |= {"clamp": "0 mm", "tip": "80 mm", "air": {"cavity": ["40 mm", "7 mm", "0 mm"]}}
    if draw(st.booleans()):
        chosen["cell"] = draw(quantity(8.0, "mm"))
    return chosen


def _constant(kind: Constant) -> st.SearchStrategy[Any]:
    """A constant of a law; lists have mostly one entry, seldom a number that need not agree."""
    stress, exponent = quantity(1.0, "MPa"), st.sampled_from([2.0, 1.3, 3, 5, 2, 4, 0, -2])
    if kind in (Constant.STRESSES, Constant.EXPONENTS):
        entry = stress if kind is Constant.STRESSES else exponent
        single, several = st.lists(entry, min_size=1, max_size=1) | entry, st.lists(entry, max_size=3)
        return seldom(8).flatmap(lambda more: several if more else single)
    return stress


def of_regions() -> st.SearchStrategy[dict[str, Any]]:
    """Materials of regions that some bodies have, and of one that none has."""
    material = {"law": st.just("svk"), "E": quantity(5.0, "MPa"), "nu": st.sampled_from([0.3, 0.49])}
    names = st.sampled_from(["base", "base", "base", "roof"])
    return st.dictionaries(names, st.fixed_dictionaries(material), max_size=1)


@st.composite
def document(draw: st.DrawFn) -> dict[str, Any]:
    """A configuration in which every key is known and of the right kind, though perhaps not of the right size."""
    law = draw(st.sampled_from([*LAWS]))
    usual = {"nu": st.sampled_from([0, 0.3, 0.495, 0.49999, *[0.45] * 5, -0.9, -1.0, 0.5]) | st.floats(0, 0.499)}
    shape = draw(geometry())
    whole: dict[str, Any] = {
        "name": draw(st.text(max_size=6) if draw(seldom(20)) else st.sampled_from(["arm", "arm-2.b", "x_7"])),
        "geometry": shape,
        "material": {
            "law": law,
            "density": draw(quantity(1130.0, "kg/m^3")),
            **{name: draw(usual.get(name, _constant(kind))) for name, kind in LAWS[law].constants().items()},
        },
        "mesh": {"size": "auto" if draw(seldom(20)) else draw(quantity(6.0, "mm")), **draw(of_the_mesh())},
    }
    if str(shape.get("file", "")).endswith(".msh"):
        del whole["mesh"]
    for name, value in draw(st.fixed_dictionaries({}, optional=extras())).items():
        whole[name] = value
    return whole


@cache
def extras() -> dict[str, st.SearchStrategy[Any]]:
    """The keys that may be left out."""
    states = st.sampled_from(["auto", "on", "off", True, False])
    more = {
        "self_contact": st.fixed_dictionaries({}, optional={"dhat": quantity(0.2, "mm"), "faces": st.just("gap")}),
        "gravity": st.fixed_dictionaries({"acceleration": st.lists(quantity(9.81, "m/s^2"), min_size=3, max_size=3)}),
        "strain_limiting_layer": st.fixed_dictionaries({}, optional={"thickness": quantity(0.1, "mm")}),
        "hoops": st.fixed_dictionaries(
            {},
            optional={
                "faces": st.sampled_from(["inner", "outer", "gap", "sym", "bottom"]),
                "threads": st.fixed_dictionaries({"EA": quantity(40.0, "N"), "pitch": quantity(2.0, "mm")}),
                "angle": quantity(20.0, "deg"),
                "E": quantity(100.0, "MPa"),
            },
        ),
        "pressure": st.fixed_dictionaries(
            {"cavities": st.dictionaries(st.sampled_from(["cavity", "cavity_lower", "x"]), quantity(10.0, "kPa"))}
        ),
    }
    pressures = st.lists(st.floats(0.5, 60.0), min_size=1, max_size=4, unique=True)
    return {
        "pressures": pressures.map(lambda values: [f"{value:.4g} kPa" for value in sorted(values)]),
        "materials": st.just({}) | seldom(3).flatmap(lambda given: of_regions() if given else st.just({})),
        "end": st.fixed_dictionaries({}, optional={"y": quantity(5.0, "mm")}),
        "validation": st.fixed_dictionaries({}, optional={"end_y": st.lists(quantity(5.0, "mm"), max_size=2)}),
        "effects": st.fixed_dictionaries(
            {}, optional={name: states | more.get(name, st.fixed_dictionaries({"state": states})) for name in EFFECTS}
        ),
        "newton": st.fixed_dictionaries({}, optional={"tolerance": st.floats(0.0, 0.02)}),
        "accuracy": st.sampled_from(["2 %", "off", "0.5 %", "100 %", "2", "0 %", f"{'9' * 400} %"]),
    }


@cache
def of_the_mesh() -> st.SearchStrategy[dict[str, Any]]:
    """The keys of `mesh` that may be left out."""
    return st.fixed_dictionaries(
        {},
        optional={
            "formulation": st.sampled_from([*ELEMENTS, "auto"]),
            "grading": st.sampled_from([*GRADINGS, False, "auto"]),
            "coarser": st.floats(0.9, 3.0) | st.sampled_from(["auto", False]),
        },
    )


def paths(inside: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of all keys and items."""
    items = inside.items() if isinstance(inside, dict) else enumerate(inside) if isinstance(inside, list) else ()
    return [inner for key, value in items for inner in [(*path, key), *paths(value, (*path, key))]]


@st.composite
def spoilt(draw: st.DrawFn, whole: dict[str, Any]) -> dict[str, Any]:
    """The same with one value replaced, one key gone, misspelt or added."""
    whole = deepcopy(whole)
    path = draw(st.sampled_from(paths(whole) or [("name",)]))
    inside: Any = whole
    for key in path[:-1]:
        inside = inside[key]
    odd = st.tuples(ODD_NUMBERS, st.sampled_from(ODD_UNITS)).map(" ".join)
    deed = draw(st.sampled_from(["odd quantity", "odd quantity", "odd value", "gone", "misspelt", "added"]))
    if deed == "odd quantity":
        inside[path[-1]] = draw(odd)
    elif deed == "odd value":
        inside[path[-1]] = draw(ODD_VALUES)
    elif isinstance(inside, list) or deed == "gone":
        inside.pop(path[-1], None) if isinstance(inside, dict) else inside.pop(path[-1])
    elif deed == "misspelt":
        inside[draw(st.sampled_from([f"{path[-1]}s", f"{path[-1]}"[::-1], "é", 3, None]))] = inside.pop(path[-1])
    else:
        inside[draw(st.text(max_size=4) | st.integers())] = draw(ODD_VALUES)
    return whole


@st.composite
def mangled(draw: st.DrawFn, text: str) -> str:
    """The text cut, or with junk in it, or with a part of it twice."""
    at = draw(st.integers(0, len(text)))
    return draw(
        st.sampled_from(JUNK).map(lambda junk: text[:at] + junk + text[at:])
        | st.just(text[:at])
        | st.just(text + text[at:])
        | st.characters(exclude_categories=["Cs"]).map(lambda other: text[:at] + other + text[at + 1 :])
        | st.text(max_size=30)
    )


@st.composite
def settings(draw: st.DrawFn, whole: dict[str, Any]) -> tuple[str, ...]:
    """Values of `--set`, mostly of keys that are there."""
    keys = st.sampled_from([".".join(map(str, path)) for path in paths(whole)] or ["name"]) | st.text(max_size=6)
    values = st.sampled_from(["3 mm", "4", "", "[17 kPa]", "off", "{a: b}", "[", "&a [*a]", "0.3", *JUNK]) | st.text(
        max_size=6
    )
    return tuple(
        f"{draw(keys)}{draw(st.sampled_from(['=', '=', '=', ' ']))}{draw(values)}"
        for _ in range(draw(st.integers(1, 2)))
    )


@st.composite
def configurations(draw: st.DrawFn) -> Written:
    """Two of six sound in form, three of six with a few wrong values, one of six with junk in the text."""
    whole = draw(document())
    kind = draw(st.sampled_from(["sound", "sound", "wrong", "wrong", "wrong", "junk"]))
    given: tuple[str, ...] = ()
    if kind == "wrong":
        for _ in range(draw(st.integers(1, 3))):
            whole = draw(spoilt(whole))
        if draw(st.integers(0, 3)) == 0:
            given = draw(settings(whole))
    text = yaml.safe_dump(whole, allow_unicode=True, sort_keys=False)
    if kind != "junk":
        return Written(text.encode(), given)
    text = draw(mangled(text))
    encoding = draw(st.sampled_from(["utf-8", "utf-8", "utf-8", "utf-8", "utf-8-sig", "utf-16", "cp1252"]))
    return Written(text.encode(encoding, errors="replace"), given)
