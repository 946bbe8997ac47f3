"""Kinds of values in a configuration: what may be written for each, with its unit, and how it is refused."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from fem.elements import ELEMENTS
from geometry import GRADINGS, CellPlanes
from pipeline.config.config import LAW_CHOICES, AlongAxis
from pipeline.config.effects import CavityPressure
from pipeline.config.units import ACCELERATION, DENSITY, FORCE, LENGTH, PRESSURE, STRESS, Dimension, convert, with_point
from pipeline.errors import quoted
from rod.same_pressure import SAME, is_same

#: sizes of the second mesh over that of the first
LEAST_COARSER, MOST_COARSER = 1.1, 5.0


@dataclass(frozen=True)
class Written:
    """How a kind of value is written, for the reference: its unit and what is allowed."""

    unit: str
    allowed: str


def _in(dimension: Dimension) -> BeforeValidator:
    return BeforeValidator(lambda value: convert(value, dimension))


def _number(value: Any) -> float:
    if isinstance(value, str) and (meant := with_point(value)):
        raise ValueError(f"{quoted(value)} has a decimal comma; did you mean {meant}? Write decimals with a point")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{quoted(value)} is not a plain number; write it without a unit, for example 0.495")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{quoted(value)} is too large") from None


def _around_one(values: tuple[float, ...]) -> tuple[float, ...]:
    if len(values) != 2 or not 0.0 < values[0] <= 1.0 <= values[1] or values[0] == values[1]:
        raise ValueError(
            f"[{', '.join(f'{value:g}' for value in values)}] is not allowed; allowed: two stretches, the first above "
            "0 and up to 1, the second 1 or more; for example [0.7, 1.9]"
        )
    return values


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{quoted(value)} is not a whole number; write it without a unit, for example 11")
    return value


def _yes_or_no(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{quoted(value)} is neither true nor false")
    return value


def _above_zero(value: float) -> float:
    if not value > 0.0:
        raise ValueError(f"{value:g} is not allowed; allowed: above zero")
    return value


def _coarser(value: Any) -> Any:
    """auto, off (YAML 1.1 reads a bare off as false) or a number above 1."""
    if value is False or value in ("auto", "off"):
        return value or "off"
    factor = _number(value)
    if not LEAST_COARSER <= factor <= MOST_COARSER:
        raise ValueError(
            f"{factor:g} is not allowed; allowed: {LEAST_COARSER:g} to {MOST_COARSER:g}, for example 1.5: meshes that "
            "differ less or more do not show how the results converge"
        )
    return factor


def _poisson_ratio(value: float) -> float:
    if not -1.0 < value < 0.5:
        raise ValueError(f"{value:g} is not a Poisson ratio a body can have here; allowed: above -1 and below 0.5")
    return value


def _ascending(values: tuple[float, ...]) -> tuple[float, ...]:
    if not values:
        raise ValueError("is empty; give at least one pressure, for example [17 kPa, 37 kPa]")
    if min(values) <= 0.0:
        vacuum = (
            "; for a vacuum give a cavity a negative fraction of them, for example "
            "effects.pressure: {cavities: {cavity: -1}}"
        )
        raise ValueError(
            f"{min(values):g} kPa is not above zero; give pressures above 0 kPa in ascending order"
            f"{vacuum if min(values) < 0.0 else ''}"
        )
    if any(later <= earlier for earlier, later in pairwise(values)):
        listed = ", ".join(f"{value:g} kPa" for value in values)
        raise ValueError(f"[{listed}] is not in ascending order; list every pressure once, the lowest first")
    for earlier, later in pairwise(values):
        if is_same(earlier, later):
            raise ValueError(
                f"has {earlier:.12g} kPa and {later:.12g} kPa, which differ by less than {SAME:g} of themselves and "
                "count as one pressure; list every pressure once"
            )
    return values


def _unit(value: Any) -> float:
    """The length of one unit: the name of a unit, or a length."""
    named = isinstance(value, str) and value.strip().isalpha()
    try:
        return _above_zero(convert(f"1 {value.strip()}" if named else value, LENGTH))
    except ValueError:
        raise ValueError(
            f"{quoted(value)} is no unit of length; allowed: mm, cm, m, inch, or a length above 0 such as 25.4 mm"
        ) from None


def _axes(value: Any) -> tuple[str, ...]:
    names = tuple(str(name).replace(" ", "").removeprefix("+") for name in value) if isinstance(value, list) else ()
    if len(names) != 3 or not all(name.removeprefix("-") in ("x", "y", "z") for name in names):
        raise ValueError(
            f"{quoted(value)} are no directions; allowed: those of the file that are x (along the arm), y (up) and z "
            "of the arm, such as [x, z, -y] for a file with z up"
        )
    return names


def _three(example: str) -> Callable[[tuple[float, ...]], tuple[float, ...]]:
    def check(values: tuple[float, ...]) -> tuple[float, ...]:
        if len(values) != 3:
            raise ValueError(f"has {len(values)} numbers instead of x, y and z; for example {example}")
        return values

    return check


def _experiments(value: Any) -> tuple[str, ...]:
    names = tuple(value) if isinstance(value, list) else (value,)
    if sorted(map(str, names)) not in (["I", "II", "III"], ["II", "III"]):
        raise ValueError(
            f"{quoted(value)} is not allowed; allowed: [I, II, III] or [II, III], for the parameters need II and III; "
            "other choices are for `pneurod sweep`"
        )
    return tuple(sorted(names))


def _pair(values: tuple[float, ...]) -> tuple[float, ...]:
    if len(values) != 2:
        raise ValueError(f"has {len(values)} numbers instead of the force along x and y; for example [0 N, 0.05 N]")
    return values


def _distinct(values: tuple[Any, ...]) -> tuple[Any, ...]:
    if len(set(values)) < len(values):
        raise ValueError("has an entry twice; list every load once")
    return values


def _not_below_zero(value: int) -> int:
    if value < 0:
        raise ValueError(f"{quoted(value)} is not allowed; allowed: 0 or more")
    return value


STATES = ("auto", "on", "off")


def _state(value: Any) -> Any:
    """auto, on or off; YAML 1.1 reads a bare on as true."""
    state = {True: "on", False: "off"}[value] if isinstance(value, bool) else value
    if state not in STATES:
        raise ValueError(f"{quoted(value)} is not allowed; allowed: auto, on or off")
    return state


def _listed(value: Any) -> Any:
    """One entry, or several."""
    return value if isinstance(value, list) and value else [value]


def _list(value: Any) -> Any:
    if not isinstance(value, list):
        raise ValueError(f"{quoted(value)} is no list; write one length for each, for example [8 mm, 6 mm]")
    return value


def _effect(value: Any) -> Any:
    """A bare state is an effect with the usual parameters; parameters without a state switch the effect on."""
    return {"state": "on", **value} if isinstance(value, Mapping) else {"state": _state(value)}


def _fraction_or_pressure(value: Any) -> CavityPressure:
    """A plain number is a fraction of the pressure of the run, one with a unit is a constant pressure."""
    if isinstance(value, int | float) and not isinstance(value, bool) and isfinite(number := _number(value)):
        return CavityPressure(number, 0.0)
    try:
        return CavityPressure(0.0, convert(value, PRESSURE))
    except ValueError:
        raise ValueError(
            f"{quoted(value)} is neither a fraction of the pressure, for example 0.5, nor a pressure, for example "
            "'10 kPa'"
        ) from None


def _grading(value: Any) -> Any:
    """A name of a grading, None for auto; YAML 1.1 reads a bare off as false."""
    return "off" if value is False else _or_auto(value)


def _on_end(value: Any) -> AlongAxis:
    """A displacement or a force, by its unit."""
    try:
        return AlongAxis(convert(value, LENGTH))
    except ValueError as refused:
        try:
            return AlongAxis(None, convert(value, FORCE))
        except ValueError:
            raise ValueError(f"{refused}, or a force, for example '{FORCE.example}'") from None


def _or_auto(value: Any) -> Any:
    """None for auto, which leaves the choice to the program."""
    return None if value == "auto" else value


def _small(value: float) -> float:
    if not 0.0 < value <= 1e-2:
        raise ValueError(f"{value:g} is not allowed; allowed: above 0 and at most 0.01")
    return value


#: the largest relative error that can be requested
MOST_ACCURACY = 0.2


def _percentage(value: Any) -> Any:
    """2 % as 0.02."""
    matched = re.fullmatch(r"\s*(\d+\.?\d*)\s*%\s*", value) if isinstance(value, str) else None
    most = 100.0 * MOST_ACCURACY
    if matched is None or not 0.0 < float(matched[1]) <= most:
        raise ValueError(
            f"{quoted(value)} is no accuracy; write a percentage above 0 and at most {most:g}, for example 2 %"
        )
    return float(matched[1]) / 100.0


def _one_of(names: Sequence[str]) -> Written:
    return Written("", ", ".join(f"`{name}`" for name in names))


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
        raise ValueError(
            f"{quoted(value)} is not allowed; allowed: true (closes an inlet in the plane of the clamp), false, or a "
            "name for each inlet and a point in its mouth, for example {inlet: [40 mm, 0 mm, 0 mm]}"
        )
    return {str(name): tuple(convert(x, LENGTH) for x in point) for name, point in value.items()}


def _plug_at_clamp(value: Any) -> bool:
    if isinstance(value, Mapping):
        raise ValueError(
            "points in the mouths of inlets are for CAD files and surfaces; allowed: true (closes an inlet in the "
            "plane of the clamp) or false"
        )
    return _yes_or_no(value)


def _size(value: Any) -> Any:
    return None if value == "auto" else _above_zero(convert(value, LENGTH))


Length = Annotated[float, _in(LENGTH), Field(examples=[LENGTH.example]), Written("mm", "any")]
PositiveLength = Annotated[Length, AfterValidator(_above_zero), Written("mm", "above 0")]
ActivationDistance = Annotated[PositiveLength, Field(examples=["0.04 mm"])]
Lengths = Annotated[
    tuple[PositiveLength, ...],
    BeforeValidator(_list),
    Field(strict=False, examples=["[8 mm, 8 mm]"]),
    Written("mm", "above 0, a list"),
]
OptionalLength = Annotated[float | None, _in(LENGTH), Field(examples=[LENGTH.example]), Written("mm", "any")]
Unit = Annotated[
    float, BeforeValidator(_unit), Field(examples=["inch"]), Written("mm", "`mm`, `cm`, `m`, `inch` or a length")
]
Directions = Annotated[
    tuple[str, ...],
    BeforeValidator(_axes),
    Field(strict=False, examples=["[x, z, -y]"]),
    Written("", "three of `x`, `-x`, `y`, `-y`, `z`, `-z`"),
]
Stress = Annotated[float, _in(STRESS), Field(examples=[STRESS.example]), Written("MPa", "any")]
PositiveStress = Annotated[Stress, AfterValidator(_above_zero), Written("MPa", "above 0")]
Stresses = Annotated[
    tuple[Annotated[float, _in(STRESS)], ...],
    BeforeValidator(_listed),
    Field(strict=False, examples=["[0.4 MPa]"]),
    Written("MPa", "a list, one for each term"),
]
Exponents = Annotated[
    tuple[Annotated[float, BeforeValidator(_number)], ...],
    BeforeValidator(_listed),
    Field(strict=False, examples=["[2]"]),
    Written("1", "a list, one for each term; not 0"),
]
#: a range of stretches that contains 1
Stretches = Annotated[
    tuple[Annotated[float, BeforeValidator(_number)], ...],
    AfterValidator(_around_one),
    Field(strict=False, examples=["[0.7, 1.9]"]),
    Written("1", "two stretches, 1 between them"),
]
PositiveDensity = Annotated[
    float,
    _in(DENSITY),
    AfterValidator(_above_zero),
    Field(examples=[DENSITY.example]),
    Written("kg/m³", "above 0"),
]
Pressure = Annotated[float, _in(PRESSURE)]
Pressures = Annotated[
    tuple[Pressure, ...],
    AfterValidator(_ascending),
    Field(strict=False, examples=["[17 kPa, 37 kPa]"]),
    Written("kPa", "above 0, ascending"),
]
Acceleration = Annotated[
    tuple[Annotated[float, _in(ACCELERATION)], ...],
    AfterValidator(_three("[0 m/s^2, -9.81 m/s^2, 0 m/s^2]")),
    Field(strict=False, examples=["[0 m/s^2, -9.81 m/s^2, 0 m/s^2]"]),
    Written("m/s²", "x, y and z"),
]
Point = Annotated[
    tuple[Length, ...], AfterValidator(_three("[56 mm, 8 mm, 0 mm]")), Field(strict=False, examples=["[56 mm, ...]"])
]
OnEnd = Annotated[
    Any, BeforeValidator(_on_end), Field(examples=["5 mm"]), Written("mm or N", "a displacement, or a force")
]
PositiveForce = Annotated[
    float, _in(FORCE), AfterValidator(_above_zero), Field(examples=["0.4 N"]), Written("N", "above 0")
]
Force = Annotated[tuple[Annotated[float, _in(FORCE)], ...], AfterValidator(_pair), Field(strict=False)]
#: of the validation loads
PressuresBetween = Annotated[Pressures, Field(strict=False, examples=["[24 kPa]"])]
Ends = Annotated[
    tuple[Length, ...],
    AfterValidator(_distinct),
    Field(strict=False, examples=["[10 mm, -10 mm]"]),
    Written("mm", "list"),
]
Forces = Annotated[
    tuple[Force, ...],
    AfterValidator(_distinct),
    Field(strict=False, examples=["[[0 N, 0.05 N]]"]),
    Written("N", "list of pairs of x and y"),
]
Cell = Annotated[
    Any, BeforeValidator(_cell), Field(examples=["8 mm"]), Written("mm", "a length, or two planes `{from, to}`")
]
Points = Annotated[
    dict[str, Point], Field(examples=["{cavity: [40 mm, 7 mm, 0 mm]}"]), Written("mm", "a name and a point for each")
]
Plugs = Annotated[
    Any,
    BeforeValidator(_plug),
    Field(examples=["true"]),
    Written("mm", "`true`, `false`, or a name and a point for each"),
]
PlugAtClamp = Annotated[
    bool, BeforeValidator(_plug_at_clamp), Field(examples=["true"]), Written("", "`true` or `false`")
]
Coarser = Annotated[
    float | Literal["auto", "off"],
    BeforeValidator(_coarser),
    Field(examples=["1.5"]),
    Written("1", "1.1 to 5, `auto` or `off`"),
]
PoissonRatio = Annotated[
    float,
    BeforeValidator(_number),
    AfterValidator(_poisson_ratio),
    Field(examples=["0.495"]),
    Written("1", "above -1, below 0.5"),
]
Count = Annotated[int, BeforeValidator(_count), Field(examples=["11"]), Written("", "1 to 10000")]
YesNo = Annotated[bool, BeforeValidator(_yes_or_no), Field(examples=["true"]), Written("", "`true` or `false`")]
OptionalYesNo = Annotated[
    bool | None, BeforeValidator(_yes_or_no), Field(examples=["true"]), Written("", "`true` or `false`")
]
Name = Annotated[
    str,
    Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", examples=["pneunet"]),
    Written("", "letters, digits, `_`, `-` and `.`"),
]
Text = Annotated[str, Field(min_length=1), Written("", "a text")]
WeightOf = Annotated[Text, Field(examples=["pneunet"])]
FaceNames = Annotated[
    tuple[Text, ...],
    BeforeValidator(_listed),
    Field(strict=False, examples=["[gap, cavity]"]),
    Written("", "names of faces"),
]
State = Annotated[Literal[STATES], BeforeValidator(_state), Written("", "`auto`, `on` or `off`")]  # type: ignore[valid-type]
OneCavity = Annotated[Any, BeforeValidator(_fraction_or_pressure)]
Cavities = Annotated[
    dict[str, OneCavity], Field(examples=["{cavity: 1}"]), Written("1 or kPa", "a number or a pressure for each")
]

#: a mesh size, None for auto
MeshSize = Annotated[
    float | None, BeforeValidator(_size), Field(examples=[LENGTH.example]), Written("mm", "above 0, or `auto`")
]
_GRADINGS, _FORMULATIONS = tuple(GRADINGS), tuple(ELEMENTS)
Grading = Annotated[
    Literal[_GRADINGS] | None,  # type: ignore[valid-type]
    BeforeValidator(_grading),
    Field(examples=["walls"]),
    _one_of((*_GRADINGS, "auto")),
]
Formulation = Annotated[
    Literal[_FORMULATIONS] | None,  # type: ignore[valid-type]
    BeforeValidator(_or_auto),
    Field(examples=["mixed"]),
    _one_of((*_FORMULATIONS, "auto")),
]
CountFromZero = Annotated[Count, AfterValidator(_not_below_zero), Written("", "0 or more")]
Tolerance = Annotated[
    float,
    BeforeValidator(_number),
    AfterValidator(_small),
    Field(examples=["0.000001"]),
    Written("1", "above 0, at most 0.01"),
]
#: an accuracy in per cent as a number
Percentage = Annotated[
    float | None, BeforeValidator(_percentage), Field(examples=["2 %"]), Written("%", "above 0, at most 20")
]
#: the experiments of a run
Experiments = Annotated[
    tuple[str, ...],
    BeforeValidator(_experiments),
    Field(examples=["[II, III]"]),
    Written("", "`[I, II, III]` or `[II, III]`"),
]
#: which laws a rod is made with
LawChoice = Annotated[Literal[LAW_CHOICES], Field(examples=["five"]), _one_of(LAW_CHOICES)]  # type: ignore[valid-type]
#: for the section of an effect, which may be written as its state alone
FROM_STATE = BeforeValidator(_effect)
