"""The body of a configuration: the keys of its family, or of the file that holds it."""

from collections.abc import Collection, Iterator, Mapping, Set
from dataclasses import MISSING, fields
from functools import cache
from pathlib import Path
from typing import Annotated, Any, get_type_hints

from geometry import (
    FAMILIES,
    MESH_SUFFIXES,
    SURFACE_SUFFIXES,
    Axes,
    CadFile,
    CellPlanes,
    Design,
    DesignError,
    Directions,
    MeshFile,
    Plug,
    SurfaceFile,
)
from pipeline.config.document import Document, Key
from pipeline.config.kinds import Count, Length, PositiveLength, Text, YesNo, above_zero, list_of, number
from pipeline.config.section import Error, Field, Kind, ReadContext, Section, chosen, conflict, raise_all, section_of
from pipeline.config.units import LENGTH, convert
from pipeline.values.errors import quoted

#: the family of a body that the user has drawn
OWN = "own"
#: all families
BODIES = (*FAMILIES, OWN)
#: the classes of designs by what the reference calls them
DESIGNS: dict[str, type[Design]] = {**FAMILIES, "own_cad": CadFile, "own_mesh": MeshFile, "own_surface": SurfaceFile}
#: what the file of `pneurod init` has at keys without a default
_EXAMPLES = {
    "file": "finger.step",
    "clamp": "0 mm",
    "tip": "80 mm",
    "curve": "1 mm",
    "parts": "{base: [20 mm, 1 mm, 0 mm]}",
    "cell": "8 mm",
    "chamber_lengths": f"[{', '.join(['8 mm'] * 11)}]",
    "chamber_heights": f"[{', '.join(['12 mm'] * 11)}]",
    "gaps": f"[{', '.join(['2 mm'] * 12)}]",
}
_OBLIQUE = "{along: [1, 0, 1], up: [0, 1, 0]}"


def _unit(value: Any) -> float:
    """The length of one unit: the name of a unit, or a length."""
    named = isinstance(value, str) and value.strip().isalpha()
    try:
        return convert(f"1 {value.strip()}" if named else value, LENGTH)
    except ValueError:
        raise ValueError(f"{quoted(value)} is no unit of length; allowed: mm, cm, m, inch, or a length") from None


def _direction(value: Any) -> tuple[float, float, float]:
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError(f"{quoted(value)} is no direction; allowed: three numbers: {_OBLIQUE}")
    x, y, z = map(number, value)
    return x, y, z


def _axes(value: Any) -> tuple[str, ...] | Directions:
    """Three directions of the file, or the directions along and up in it."""
    if isinstance(value, Mapping):
        if set(value) != {"along", "up"}:
            raise ValueError(f"{quoted(value)} are no directions; allowed: {_OBLIQUE}")
        return Directions(_direction(value["along"]), _direction(value["up"]))
    names = tuple(str(name).replace(" ", "").removeprefix("+") for name in value) if isinstance(value, list) else ()
    if len(names) != 3 or not all(name.removeprefix("-") in ("x", "y", "z") for name in names):
        allowed = "the directions of the file that are x (along the arm), y (up) and z of the arm, such as [x, z, -y], "
        allowed += f"or {_OBLIQUE}"
        raise ValueError(f"{quoted(value)} are no directions; allowed: {allowed}")
    return names


def _cell(value: Any) -> float | CellPlanes:
    """The length of a cell, or its two planes of mirror symmetry."""
    if not isinstance(value, Mapping):
        return convert(value, LENGTH)
    if set(value) != {"from", "to"}:
        listed = ", ".join(map(str, value))
        raise ValueError(f"has the keys {quoted(listed)}; write two planes, for example {{from: 40 mm, to: 44 mm}}")
    return CellPlanes(convert(value["from"], LENGTH), convert(value["to"], LENGTH))


def _plug(value: Any) -> bool | dict[str, tuple[float, ...]]:
    """Whether the inlet at the clamp is closed, or a point in the mouth of each inlet that is filled."""
    if isinstance(value, bool):
        return value
    points = list(value.values()) if isinstance(value, Mapping) else []
    if not points or not all(isinstance(point, list) and len(point) == 3 for point in points):
        allowed = "true (closes an inlet in the plane of the clamp), false, or a point in the mouth of each inlet"
        raise ValueError(f"{quoted(value)} is not allowed; allowed: {allowed}: {{inlet: [40 mm, 0 mm, 0 mm]}}")
    return {str(name): tuple(convert(x, LENGTH) for x in point) for name, point in value.items()}


Points = Annotated[
    dict[str, Annotated[tuple[Length, ...], list_of("", "[56 mm, 8 mm, 0 mm]", count=3)]],
    Kind("a name and a point for each", "{cavity: [40 mm, 7 mm, 0 mm]}", "mm"),
]
#: how a field of a design is written, by its type
_KINDS: dict[Any, Any] = {
    int: Count,
    float: Length,
    float | None: Length | None,
    tuple[float, ...]: Annotated[tuple[PositiveLength, ...], list_of("above 0, a list", "[8 mm, 6 mm]", "mm")],
    str: Text,
    bool: YesNo,
    bool | None: YesNo | None,
    Axes: Annotated[Any, Kind("three of `x`, `-x`, `y`, `-y`, `z`, `-z`, or `{along, up}`", "[x, z, -y]", read=_axes)],
    float | CellPlanes | None: Annotated[Any, Kind("a length, or two planes `{from, to}`", "8 mm", "mm", _cell)],
    Plug: Annotated[Any, Kind("`true`, `false`, or a name and a point for each", "true", "mm", _plug)],
}
_UNIT = Annotated[float, Kind("`mm`, `cm`, `m`, `inch` or a length", "mm", "mm", _unit, above_zero)]


def design_class(family: str, file: str) -> type[Design]:
    """The class of designs of a family; a user's own file is a drawing, a mesh or a surface by its suffix."""
    if family != OWN:
        return FAMILIES[family]
    suffix = Path(file).suffix.lower()
    if suffix in SURFACE_SUFFIXES:
        return SurfaceFile
    return MeshFile if suffix in MESH_SUFFIXES else CadFile


@cache
def geometry_section(design: Any) -> type[Section]:
    """The keys of a class of designs: its fields, whose meanings stand beside their types (`Annotated`)."""
    types, drawn = get_type_hints(design, include_extras=True), design in FAMILIES.values()
    keys: dict[str, tuple[Any, Any]] = {"family": (str, Field())}
    for field in fields(design):
        value, (meaning,) = types[field.name].__origin__, types[field.name].__metadata__
        kind = (_UNIT | None) if field.name == "unit" else _KINDS.get(value, Points)
        if drawn and kind is Length:
            kind = Annotated[Length, Kind("at least 0" if field.default == 0.0 else "above 0", LENGTH.example, "mm")]
        default = {key: v for key in ("default", "default_factory") if (v := getattr(field, key)) is not MISSING}
        examples = [_EXAMPLES[field.name]] if field.name in _EXAMPLES else None
        keys[field.name] = (kind, Field(**default, examples=examples, description=meaning))
    others = {name: [one.name for one in fields(own)] for name, own in DESIGNS.items()}  # type: ignore[arg-type]
    return section_of("Geometry", keys, others=others)


def read_design(value: Any, beside: ReadContext) -> Design:
    """The design that a section describes."""
    family, document = chosen(value, "family", BODIES), beside.document
    kind = design_class(family, str(value.get("file", "")))
    keys = beside.read(geometry_section(kind), value)
    dimensions = {field.name: getattr(keys, field.name) for field in fields(kind)}  # type: ignore[arg-type]
    if family == OWN:
        dimensions["file"] = str(document.path.parent / dimensions["file"])
    raise_all(_doubled(value.keys(), kind.lists, document))
    regions = document.content.get("materials", {})
    names = [name for name in regions if isinstance(name, str)] if isinstance(regions, Mapping) else []
    try:
        return kind(**dimensions).with_regions(names)
    except DesignError as refused:
        raise_all(design_conflicts(refused, dimensions))
        raise


def _doubled(given: Set[str], lists: Mapping[str, str], document: Document) -> Iterator[Error]:
    """Refuses a dimension beside the list that is given instead of it; an override with the list replaces it."""
    for several, usual in lists.items():
        keys = (("geometry", usual), ("geometry", several))
        if {several, usual} <= given and (keys[0] in document.overridden or keys[1] not in document.overridden):
            yield conflict(f"{usual} and {several} exclude each other; give one of them", *keys)


def design_conflicts(refused: DesignError, dimensions: Collection[str]) -> Iterator[Error]:
    """An error for each thing that is wrong about a design."""
    for error in (refused, *refused.others):
        yield conflict(error.sentence, *(design_key(key, dimensions) for key in error.keys))


def design_key(key: str, dimensions: Collection[str]) -> Key:
    """The key of a configuration that a `DesignError` names."""
    parts = tuple(key.split("."))
    return ("geometry", *parts) if parts[0] in dimensions else parts
