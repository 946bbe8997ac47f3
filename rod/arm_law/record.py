"""The arm's own law as the numbers of law.json, and back."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.law import RodError

#: of the file; raised when a key changes its meaning
FORMAT = 2

#: key of the file and name of the value, curve by curve
CELL_KEYS = {
    "pressure_kPa": "pressure",
    "kappa_per_mm": "kappa",
    "moment_N_mm": "moment",
    "stretch": "stretch",
    "rigidity_N_mm2": "rigidity",
    "contact": "contact",
    "min_J": "min_J",
    "moment_by_pressure_N_mm_per_kPa": "moment_by_pressure",
    "stretch_by_kappa_mm": "stretch_by_kappa",
    "stretch_by_pressure_per_kPa": "stretch_by_pressure",
    "axial_rigidity_N": "axial_rigidity",
    "shear_rigidity_N": "shear_rigidity",
    "s_mm": "s",
    "ripple_mm": "ripple",
}
CLAMP_KEYS = {
    "pressure_kPa": "pressure",
    "moment_N_mm": "moment",
    "rotation_rad": "rotation",
    "rotation_by_moment_rad_per_N_mm": "rotation_by_moment",
    "rotation_by_pressure_rad_per_kPa": "rotation_by_pressure",
    "offset_mm": "offset",
    "offset_by_moment_per_N": "offset_by_moment",
    "s_mm": "s",
    "beside_mm": "beside",
}
TIP_KEYS = {
    "pressure_kPa": "pressure",
    "s_mm": "s",
    "beside_mm": "beside",
    "edge_mm": "edge",
    "couple_by_turn_N_mm": "couple",
    "acts_at_by_turn_mm": "acts_at",
    "beside_by_turn_mm": "beside_held",
    "beside_pinned_mm": "beside_pinned",
}


def law_record(law: ArmLaw) -> dict[str, Any]:
    """The contents of law.json but for the error of the mesh."""
    return {
        "format": FORMAT,
        "pitch_mm": law.pitch,
        "length_mm": law.length,
        "first_middle_mm": law.first_middle,
        "pressures_kPa": list(law.pressures),
        "curves": [curve_row(curve, CELL_KEYS) for curve in law.cells],
        "clamp": {"curves": [curve_row(curve, CLAMP_KEYS) for curve in law.clamps]},
        "tip": {"curves": [curve_row(curve, TIP_KEYS) for curve in law.tips]},
    }


def law_from_record(record: Mapping[str, Any]) -> ArmLaw:
    """The law that `law_record` wrote. Raises `RodError` with one sentence for anything else."""
    if record.get("format") != FORMAT:
        raise RodError(f"This is no law of an arm in format {FORMAT}; write it anew with `pneurod cell`.")
    try:
        return ArmLaw(
            pitch=float(record["pitch_mm"]),
            first_middle=float(record["first_middle_mm"]),
            length=float(record["length_mm"]),
            cells=tuple(CellCurve(**curve_values(row, CELL_KEYS)) for row in record["curves"]),
            clamps=tuple(ClampCurve(**curve_values(row, CLAMP_KEYS)) for row in record["clamp"]["curves"]),
            tips=tuple(TipCurve(**curve_values(row, TIP_KEYS)) for row in record["tip"]["curves"]),
        )
    except KeyError as missing:
        raise RodError(f"The law of an arm lacks the key {missing}; write it anew with `pneurod cell`.") from None


def curve_row(curve: object, keys: Mapping[str, str]) -> dict[str, Any]:
    """One curve under the keys of the file."""
    values = {key: getattr(curve, name) for key, name in keys.items()}
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in values.items()}


def curve_values(row: Mapping[str, Any], keys: Mapping[str, str]) -> dict[str, Any]:
    """The fields of a curve from its row in the file. Raises KeyError."""
    return {name: row[key] if np.isscalar(row[key]) else np.array(row[key]) for key, name in keys.items()}
