"""The arm's own law as the numbers of law.json, and back."""

from collections.abc import Collection, Mapping
from dataclasses import MISSING, Field, fields
from typing import Any, get_args

import numpy as np

from rod.arm_law.curves import ACROSS, CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.rates import LawRate
from rod.checked import Shape, check_positive, check_table, positive
from rod.errors import RodError
from rod.load import pair
from rod.weight import Mass

Curve = CellCurve | ClampCurve | TipCurve | Mass
#: of the file; raised when a key changes its meaning
FORMAT = 2


def _shapes(kind: type[Curve], given: Collection[str] = ()) -> dict[str, Shape]:
    """By the key of a field in the file, of those that it must have or that are given."""
    keys = {get_args(field.type)[1]: field for field in fields(kind)}
    return {key: get_args(field.type)[2:] for key, field in keys.items() if key in given or not _may_be_missing(field)}


def _may_be_missing(field: "Field[Any]") -> bool:
    return field.default_factory is not MISSING


#: numbers of the derivatives by their keys in the file
DERIVATIVES = {
    "kappa_0_per_mm": "kappa_0",
    "rigidity_N_mm2": "rigidity",
    "moment_N_mm": "moment",
    "stretch": "stretch",
    "end_angle_rad": "end_angle",
    "lateral_rigidity_N_mm2": "lateral_rigidity",
    "torsional_rigidity_N_mm2": "torsional_rigidity",
    "contact_onset_per_mm": "contact_onset",
    "largest_stretch": "largest_stretch",
}
#: what is interpolated over; curvatures and moments of a cell are compared by `CellCurve`
_RISING = frozenset({"s_mm", "moment_N_mm"})


def law_record(law: ArmLaw) -> dict[str, Any]:
    """The contents of law.json but for the error of the mesh."""
    return {
        "format": FORMAT,
        "pitch_mm": law.pitch,
        "length_mm": law.length,
        "first_middle_mm": law.first_middle,
        "pressures_kPa": list(law.pressures),
        "curves": [record_of(curve) for curve in law.cells],
        "clamp": {"curves": [record_of(curve) for curve in law.clamps]},
        "tip": {"curves": [record_of(curve) for curve in law.tips]},
        "mass": None if law.mass is None else record_of(law.mass),
        "weight_N_per_mm": list(law.weight),
        "derivatives": {name: _derivatives(law, name) for name in law.rates},
    }


def _derivatives(law: ArmLaw, name: str) -> dict[str, Any]:
    """By one parameter: of the curves, and at the pressures of the law what follows from them."""
    numbers = law.derivative(name)
    known = {key: field for key, field in DERIVATIVES.items() if law.is_in_space or field not in ACROSS}
    columns = {key: getattr(numbers, field).tolist() for key, field in known.items()}
    return columns | law.rate(name).record()


def law_from_record(record: Mapping[str, Any]) -> ArmLaw:
    """The law that `law_record` wrote. Raises `RodError` with one sentence for anything else."""
    if record.get("format") != FORMAT:
        raise RodError(f"This is no law of an arm in format {FORMAT}; write it anew with `pneurod cell`.")
    try:
        return ArmLaw(
            pitch=positive(record["pitch_mm"], "pitch_mm"),
            first_middle=positive(record["first_middle_mm"], "first_middle_mm"),
            length=positive(record["length_mm"], "length_mm"),
            cells=tuple(curve_of(CellCurve, row) for row in _cell_rows(record["curves"])),
            clamps=tuple(curve_of(ClampCurve, row) for row in _end_rows(record, "clamp", ClampCurve)),
            tips=tuple(curve_of(TipCurve, row) for row in _end_rows(record, "tip", TipCurve)),
            mass=mass_of(record.get("mass")),
            weight=pair(record.get("weight_N_per_mm", (0.0, 0.0)), "weight_N_per_mm"),
            rates={
                name: LawRate.from_record(row, f"derivatives.{name}")
                for name, row in record.get("derivatives", {}).items()
            },
        )
    except KeyError as missing:
        raise RodError(f"The law of an arm lacks the key {missing}; write it anew with `pneurod cell`.") from None


def mass_of(row: Any) -> Mass | None:
    """The mass in a file; None where it is not known. Raises `RodError`."""
    if row is None:
        return None
    check_table(row, _shapes(Mass), "mass")
    return curve_of(Mass, row)


def _cell_rows(rows: Any) -> list[Mapping[str, Any]]:
    checked = _rows(rows, CellCurve, "curves")
    for k, row in enumerate(checked):
        check_positive(row, ("axial_rigidity_N", "shear_rigidity_N"), f"curves[{k}]")
        # a cell whose walls buckle has a negative rigidity beyond, but not near the state without moment
        at_rest = row["rigidity_N_mm2"][int(np.argmin(np.abs(row["moment_N_mm"])))]
        positive(at_rest, f"rigidity_N_mm2 of curves[{k}] at the smallest moment")
        if not np.all(row["rigidity_N_mm2"]):
            raise RodError(f"rigidity_N_mm2 of curves[{k}] must not be zero.")
    return checked


def _end_rows(record: Mapping[str, Any], part: str, kind: type[Curve]) -> list[Mapping[str, Any]]:
    check_table(record[part], {}, part)
    return _rows(record[part]["curves"], kind, f"{part}.curves")


def _rows(rows: Any, kind: type[Curve], name: str) -> list[Mapping[str, Any]]:
    """The rows of a part of the file. Raises `RodError` with the part and the key of what is wrong."""
    if not isinstance(rows, list):
        raise RodError(f"{name} must be a list of curves.")
    for k, row in enumerate(rows):
        check_table(row, _shapes(kind, row if isinstance(row, Mapping) else ()), f"{name}[{k}]")
        for key in _RISING.intersection(row):
            if np.any(np.diff(row[key]) <= 0.0):
                raise RodError(f"{key} of {name}[{k}] must rise.")
    return rows


def record_of(curve: Curve) -> dict[str, Any]:
    """One curve under the keys of the file."""
    known = [field for field in fields(curve) if not (_may_be_missing(field) and getattr(curve, field.name).size == 0)]
    values = {get_args(field.type)[1]: getattr(curve, field.name) for field in known}
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in values.items()}


def curve_of(kind: type[Any], record: Mapping[str, Any]) -> Any:
    """A curve of this kind from its record in the file. Raises KeyError."""
    keys = {field.name: get_args(field.type)[1] for field in fields(kind)}
    needed = {field.name for field in fields(kind) if not _may_be_missing(field)}
    return kind(**{name: record[key] for name, key in keys.items() if name in needed or key in record})
