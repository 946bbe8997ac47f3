"""The law of an arm with one pressure as the numbers of law.json, and back."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.keys import keys_of, record_of, value_of, values_of
from rod.arm_law.law import ArmLaw
from rod.arm_law.quantities import key_in_files
from rod.arm_law.rates import LawRate
from rod.checked import check_positive, check_table, positive
from rod.errors import RodError
from rod.load import pair
from rod.weight import Mass

#: what is interpolated over; curvatures and moments of a cell are compared by `CellCurve`
_RISING = ("s_mm", "moment_N_mm")


def plane_record(law: ArmLaw) -> dict[str, Any]:
    """The numbers of a law, with the keys of law.json."""
    return {
        **record_of(law),
        "pressures_kPa": list(law.pressures),
        "curves": [record_of(curve) for curve in law.cells],
        "clamp": {"curves": [record_of(curve) for curve in law.clamps]},
        "tip": {"curves": [record_of(curve) for curve in law.tips]},
        "mass": mass_record(law.mass),
        "weight_N_per_mm": list(law.weight),
        "derivatives": {name: _derivatives(law, name) for name in law.rates},
    }


def _derivatives(law: ArmLaw, name: str) -> dict[str, Any]:
    """By one parameter: of the curves, and at the pressures of the law what follows from them."""
    numbers = {key_in_files(number): row.tolist() for number, row in law.derivative(name).items()}
    return numbers | law.rate(name).record()


def plane_law(record: Mapping[str, Any]) -> ArmLaw:
    """The law of `plane_record`. Raises `RodError`, and KeyError for a part that is missing."""
    rates = record.get("derivatives", {}).items()
    return ArmLaw(
        **{name: positive(record[key], key) for name, key in keys_of(ArmLaw).items()},
        cells=_cells(record["curves"]),
        clamps=_ends(record, "clamp", ClampCurve),
        tips=_ends(record, "tip", TipCurve),
        mass=mass_of(record.get("mass")),
        weight=pair(record["weight_N_per_mm"], "weight_N_per_mm"),
        rates={name: LawRate.from_record(row, f"derivatives.{name}") for name, row in rates},
    )


def mass_record(mass: Mass | None) -> dict[str, Any] | None:
    """The mass as a file has it."""
    return None if mass is None else record_of(mass)


def mass_of(row: Any) -> Mass | None:
    """The mass in a file; None where it is not known. Raises `RodError`."""
    return None if row is None else value_of(Mass, row, "mass")


def _cells(rows: Any) -> tuple[CellCurve, ...]:
    cells = values_of(CellCurve, rows, "curves", _RISING)
    for k, row in enumerate(rows):
        check_positive(row, ("axial_rigidity_N", "shear_rigidity_N"), f"curves[{k}]")
        # a cell whose walls buckle has a negative rigidity beyond, but not near the state without moment
        at_rest = row["rigidity_N_mm2"][int(np.argmin(np.abs(row["moment_N_mm"])))]
        positive(at_rest, f"rigidity_N_mm2 of curves[{k}] at the smallest moment")
        if not np.all(row["rigidity_N_mm2"]):
            raise RodError(f"rigidity_N_mm2 of curves[{k}] must not be zero.")
    return cells


def _ends(record: Mapping[str, Any], part: str, kind: type[Any]) -> tuple[Any, ...]:
    check_table(record[part], {}, part)
    return values_of(kind, record[part]["curves"], f"{part}.curves", _RISING)
