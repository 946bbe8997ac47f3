"""From the content of result files to pandas frames: one row per thing, one number per cell, units in the columns.

Columns have the names of the keys in the files (docs/results.md). A position or a force becomes one column per
component (`reaction_N` -> `reaction_x_N`, `reaction_y_N`), a 95 % interval one per end (`d_mm_95_low`, `d_mm_95_high`).
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pipeline.store.formats import CURVE_COLUMNS, of_extensible
from pneurod.results import COLUMNS

Row = Mapping[str, Any]

#: per pressure in parameters.json, besides the five parameters; booleans last
_FIT = ("single_line_alpha_N_mm2", "single_line_alpha_N_mm2_std", "single_line_m0_N_mm")
_QUALITY = ("r2_two_lines", "r2_single_line", "observations", "evidence_for_two_lines", "evidence_of_choice")
_BOOLEANS = ("d_is_at_most", "d_is_at_least", "single_line_suffices", "two_lines_on_coarser_mesh")

#: columns that a frame has even without rows; further ones of the files come behind them
_FIRST: dict[str, tuple[str, ...]] = {
    "experiments": (
        *("experiment", "pressure_kPa", "end_x_mm", "end_y_mm", "reaction_x_N", "reaction_y_N", "cavity_volume_mm3"),
        *("stretch_of_curve", "curve_z_mm", "min_J", "max_stretch", "min_stretch", "min_gap_mm"),
        *("contact_error_mm", "contact_error_N", "seconds", "status", "reason"),
    ),
    "validation": (
        *("experiment", "pressure_kPa", "load", "rod", "sample", "distance_over_length", "distance_at_s_mm"),
        *("distance_over_length_without_stretch", "end_angle_error_rad", "force_error", "force_N", "rod_force_N"),
        *("curvature_error", "curvature_error_at_s_mm", "reason", "warning"),
    ),
    "effects": ("effect", "state", "reason", "share_of_time"),
    "curves": CURVE_COLUMNS,
    "validation_curves": ("load", *CURVE_COLUMNS),
    "kappa_0": ("pressure_kPa", "s_mm", "kappa_0_per_mm", "rest_stretch"),
    "kappa_0_cells": ("pressure_kPa", "s_mm", "kappa_0_per_mm"),
    "linearity": ("quantity", "pressure_kPa", "value", "off_the_line", "slope_per_kPa", "at_0_kPa"),
    "break_profile": ("pressure_kPa", "d_mm", "rms_per_mm"),
    "dimensionless": ("pressure_kPa", "s_over_length", "delta_kappa_times_length", "moment_over_m_g_length"),
}
#: columns that hold texts, empty where the file has none; all others hold numbers or true and false
_TEXTS = {
    *("experiment", "load", "rod", "sample", "law", "effect", "state", "status", "quantity"),
    *("reason", "warning"),
}


def rows_frame(name: str, rows: Sequence[Row]) -> pd.DataFrame:
    """The frame `name` of a list of rows as the JSON files have them."""
    return _frame(name, pd.DataFrame([_components(row) for row in rows]))


def curves_frame(name: str, path: Path) -> pd.DataFrame:
    """The frame `name` of a CSV file. Raises OSError and ValueError."""
    return _frame(name, pd.read_csv(path, dtype={"experiment": str, "load": str}))


def parameter_frames(content: Mapping[str, Any]) -> dict[str, pd.DataFrame]:
    """The frames of parameters.json by the name of their field in `Results`; without rows for an empty content.

    Raises KeyError, TypeError and ValueError for a content that is none.
    """
    pressures = content.get("pressures_kPa", [])
    profile = content["kappa_0"] if pressures else {}
    stretched = of_extensible(content) if pressures else {}
    estimators = [
        _by_pressure(pressures, columns).assign(estimator=name, reason=columns.get("reason", ""))
        for name, columns in content.get("estimators", {}).items()
        if pressures
    ]
    parameters = _by_pressure(pressures, content)
    parameters["kappa_0_middle_per_mm"] = _numbers(profile.get("middle_per_mm"), len(pressures))
    parameters["theta0_rad"] = _numbers(profile.get("theta0_rad"), len(pressures))
    if mesh_error := content.get("mesh_error"):
        for column in COLUMNS:
            parameters[f"{column}_mesh_std"] = _numbers(mesh_error[f"{column}_std"], len(pressures))
    extensible = _by_pressure(pressures if stretched else [], stretched)
    for column in ("eccentricity_mm", "eccentricity_mm_std"):
        extensible[column] = _numbers(stretched.get(column), len(extensible))
    return {
        "parameters": parameters,
        "extensible": extensible,
        "estimators": _estimators(estimators),
        "kappa_0": _profile(pressures, profile, stretched),
        "kappa_0_cells": _cells(pressures, profile),
        "linearity": _linearity(pressures, content.get("straightness", [])),
        "break_profile": _expanded("break_profile", content.get("profile_over_d", [])),
        "dimensionless": _expanded("dimensionless", content.get("dimensionless", [])),
    }


def _by_pressure(pressures: Sequence[float], content: Mapping[str, Any]) -> pd.DataFrame:
    """One row per pressure: the five parameters with their errors, and what else the content has of the fit."""
    count = len(pressures)
    if "d_is_at_most" in content:  # files of the first version do not say whether d is at its upper end
        content = {"d_is_at_least": [None] * count, **content}
    if "r2_two_lines" in content:  # nor do they say how clearly the data decide between a single line and two
        content = {
            "evidence_for_two_lines": None,
            "evidence_of_choice": None,
            "two_lines_on_coarser_mesh": [None] * count,
            **content,
        }
    columns: dict[str, Any] = {"pressure_kPa": _numbers(pressures, count)}
    for column in COLUMNS:
        columns[column] = _numbers(content.get(column), count)
        columns[f"{column}_std"] = _numbers(content.get(f"{column}_std"), count)
        columns |= _ends(f"{column}_95_{{}}", content.get(f"{column}_95"), count)
    columns |= {name: _numbers(content[name], count) for name in (*_FIT, *_QUALITY) if name in content}
    if "moment_range_N_mm" in content:
        columns |= _ends("moment_range_{}_N_mm", content["moment_range_N_mm"], count)
    columns |= {name: pd.array(content[name], dtype="boolean") for name in _BOOLEANS if name in content}
    return pd.DataFrame(columns)


def _ends(name: str, pairs: Sequence[Sequence[float] | None] | None, count: int) -> dict[str, Any]:
    pairs = pairs if pairs is not None else [None] * count
    low, high = ([None if pair is None else pair[end] for pair in pairs] for end in (0, 1))
    return {name.format("low"): _numbers(low, count), name.format("high"): _numbers(high, count)}


def _numbers(values: Any, count: int) -> Any:
    """(count,) floats, NaN for null and where there are none. Raises ValueError for another number of values."""
    numbers = np.full(count, np.nan) if values is None else np.array(values, dtype=float)
    if numbers.shape != (count,):
        raise ValueError(f"{count} numbers are needed, one per pressure, not {numbers.shape}")
    return numbers


def _profile(pressures: Sequence[float], profile: Row, stretched: Row) -> pd.DataFrame:
    s = profile.get("s_mm", [])
    unstretched = [[1.0] * len(s)] * len(pressures)
    rows = zip(pressures, profile.get("kappa_0_per_mm", []), stretched.get("rest_stretch", unstretched), strict=True)
    return _expanded(
        "kappa_0",
        [
            {"pressure_kPa": pressure, "s_mm": s, "kappa_0_per_mm": kappa_0, "rest_stretch": stretch}
            for pressure, kappa_0, stretch in rows
        ],
    )


def _cells(pressures: Sequence[float], profile: Row) -> pd.DataFrame:
    rows = zip(pressures, profile.get("cell_averaged_per_mm", []), strict=True)
    s = profile.get("cell_s_mm", [])
    return _expanded("kappa_0_cells", [{"pressure_kPa": p, "s_mm": s, "kappa_0_per_mm": kappa} for p, kappa in rows])


def _linearity(pressures: Sequence[float], lines: Sequence[Row]) -> pd.DataFrame:
    rows = [{**line, "pressure_kPa": pressures, "value": line["values"]} for line in lines]
    return _expanded("linearity", [{key: row[key] for key in _FIRST["linearity"]} for row in rows])


def _expanded(name: str, rows: Sequence[Row]) -> pd.DataFrame:
    """A frame of rows whose lists, equally long within a row, become one row per entry."""
    return _frame(name, pd.concat([pd.DataFrame(dict(row)) for row in rows] or [pd.DataFrame()], ignore_index=True))


def _components(row: Row) -> dict[str, Any]:
    """The row with every list of two or three numbers as one column per component, the unit at the end."""
    cells: dict[str, Any] = {}
    for key, value in row.items():
        if isinstance(value, list):
            stem, _, unit = key.rpartition("_")
            cells |= {f"{stem}_{axis}_{unit}": component for axis, component in zip("xyz", value, strict=False)}
        else:
            cells[key] = value
    return cells


def _frame(name: str, frame: pd.DataFrame) -> pd.DataFrame:
    """The columns that `name` always has, then the others as they are; ValueError for texts where numbers belong."""
    others = [column for column in frame.columns if column not in _FIRST[name]]
    frame = frame.reindex(columns=[*_FIRST[name], *others])
    for column in frame.columns:
        numeric = pd.api.types.is_numeric_dtype(frame[column])
        if column in _TEXTS:
            frame[column] = frame[column].astype(object).where(frame[column].notna(), "").astype(str)
        elif not numeric and (column in _FIRST[name] or frame[column].isna().all()):
            frame[column] = frame[column].astype(float)
    return frame


def _estimators(frames: Sequence[pd.DataFrame]) -> pd.DataFrame:
    frame = pd.concat(frames or [_by_pressure([], {}).assign(estimator="", reason="")], ignore_index=True)
    columns = ["estimator", *(column for column in frame.columns if column != "estimator")]
    return frame.reindex(columns=columns).astype({"estimator": str, "reason": str})
