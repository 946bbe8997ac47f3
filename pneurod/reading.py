"""The results of a finished, failed or interrupted run, from the files in its folder."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pandas as pd

from pipeline.cell.saved import SavedLaw
from pipeline.errors import InputError
from pipeline.report.results import read_results as read_report_results
from pipeline.report.verdict import Verdict, verdict_of
from pipeline.rods.checks import check_parameters
from pipeline.rods.saved import pressurised_rod
from pipeline.store.formats import validation_rows, with_present_keys
from pneurod.arguments import given_path
from pneurod.results import PressureSlopes, Results, RunRecord
from pneurod.tables import curves_frame, parameter_frames, rows_frame

_ROWS = ("experiments", "validation", "effects")
_CURVES = ("curves", "validation_curves")
_IDENTITY = "states/configuration.json"  #: written when a run starts


def read_results(directory: Path | str) -> Results:
    """Every result in the folder of a run; files of earlier versions of pneurod are read as well.

    A run that failed or was stopped has left some of them: frames of the others have no rows, and `run.failure` and
    `run.finished` say what happened. Raises InputError with one sentence for what is no path, and for a folder that
    does not exist, holds no result, or holds a file that cannot be read.
    """
    folder = given_path(directory, "directory", "results/pneunet")
    contents = {name: _json(folder / f"{name}.json") for name in ("parameters", "run", *_ROWS)}
    _check_there(folder, contents)
    parameters = _mapping(folder, "parameters", contents)
    try:
        if parameters.get("pressures_kPa"):
            check_parameters(parameters)
        frames = parameter_frames(parameters)
        slopes = _slopes(parameters)
        length_mm, mass_g = _number(parameters.get("length_mm")), _number(parameters.get("mass_g"))
    except (KeyError, TypeError, ValueError, AttributeError) as failure:
        raise _unreadable(folder / "parameters.json", failure) from None
    return Results(
        directory=folder,
        run=_record(folder, contents),
        length_mm=length_mm,
        mass_g=mass_g,
        slopes=slopes,
        mesh_error_reason=str(parameters.get("mesh_error_reason", "")),
        **frames,
        **{name: _rows(folder, name, contents) for name in _ROWS},
        **{name: _curves(folder, name) for name in _CURVES},
        rods=_rods(folder, parameters),
        arm_law=SavedLaw.read(folder / "law.json").law if (folder / "law.json").is_file() else None,
        pictures=MappingProxyType({path.stem: path for path in sorted((folder / "pictures").glob("*.png"))}),
        verdict=_verdict(folder),
    )


def _check_there(folder: Path, contents: Mapping[str, Any]) -> None:
    """Raises InputError where there is no result."""
    if any(contents[name] for name in ("experiments", "parameters", "run")):
        return
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; give the folder of a run, such as results/pneunet")
    if (folder / _IDENTITY).is_file():
        raise InputError(f"{folder}: its run has no results yet; start it again, and it continues")
    others = [name for name in ("accuracy", "effects_table", "material") if (folder / f"{name}.json").is_file()]
    there = f"holds {others[0]}.json, which is not the result of `pneurod run`" if others else "holds no results"
    raise InputError(f"{folder}: {there}; give the folder of a run")


def _json(path: Path) -> Any:
    """The content with the keys of today, None where there is no file. Raises InputError."""
    try:
        return with_present_keys(json.loads(path.read_text(encoding="utf-8")))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as failure:
        raise InputError(f"{path}: cannot be read ({failure.strerror})") from None
    except ValueError as failure:
        raise _unreadable(path, failure) from None


def _mapping(folder: Path, name: str, contents: Mapping[str, Any]) -> Mapping[str, Any]:
    content = {} if contents[name] is None else contents[name]
    if not isinstance(content, dict):
        raise _unreadable(folder / f"{name}.json", TypeError("no keys"))
    return content


def _rows(folder: Path, name: str, contents: Mapping[str, Any]) -> pd.DataFrame:
    try:
        rows = contents[name] or []
        return rows_frame(name, validation_rows(rows) if name == "validation" else rows)
    except (TypeError, ValueError, AttributeError) as failure:
        raise _unreadable(folder / f"{name}.json", failure) from None


def _curves(folder: Path, name: str) -> pd.DataFrame:
    path = folder / f"{name}.csv"
    if not path.is_file():
        return rows_frame(name, [])
    try:
        return curves_frame(name, path)
    except OSError as failure:
        raise InputError(f"{path}: cannot be read ({failure.strerror})") from None
    except ValueError as failure:  # pandas derives its own from it
        raise _unreadable(path, failure) from None


def _verdict(folder: Path) -> Verdict:
    try:
        return verdict_of(read_report_results(folder))
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as failure:
        raise InputError(
            f"{folder}: its result files do not belong together ({failure}); repeat the run or restore the files"
        ) from None


def _rods(folder: Path, parameters: Mapping[str, Any]) -> tuple[Any, ...]:
    """The inextensible and the extensible rod; the former stands for both where a file has no eccentricity."""
    if not parameters.get("pressures_kPa"):
        return ()
    extensible = bool(parameters.get("eccentricity"))
    try:
        return pressurised_rod(parameters), pressurised_rod(parameters, extensible)
    except (KeyError, TypeError, ValueError) as failure:
        raise _unreadable(folder / "parameters.json", failure) from None


def _slopes(parameters: Mapping[str, Any]) -> PressureSlopes:
    low, high = parameters.get("linear_range_kPa") or (math.nan, math.nan)
    names = [f"beta{number}_N_mm2_per_kPa{ending}" for number in (1, 2) for ending in ("", "_std")]
    beta1, beta1_std, beta2, beta2_std = (_number(parameters.get(name)) for name in names)
    tested = bool(parameters.get("linear_range_tested", False))
    return PressureSlopes(beta1, beta1_std, beta2, beta2_std, (float(low), float(high)), tested)


def _record(folder: Path, contents: Mapping[str, Any]) -> RunRecord:
    """run.json, or the configuration alone where the run was stopped before it wrote that."""
    content = _mapping(folder, "run", contents) or _json(folder / _IDENTITY) or {}
    try:
        return RunRecord(
            config=MappingProxyType(dict(content.get("config", {}))),
            config_hash=str(content.get("config_hash", "")),
            version=str(content.get("pneurod", "")),
            commit=content.get("commit"),
            python=str(content.get("python", "")),
            solver=tuple(content.get("solver", ())),
            stress_error=_number((content.get("indicator") or {}).get("stress_error")),
            failure=str(content.get("failure", "")),
            **{name: MappingProxyType(dict(content.get(name) or {})) for name in _MAPPINGS},
        )
    except (TypeError, ValueError, AttributeError) as failure:
        raise _unreadable(folder / "run.json", failure) from None


_MAPPINGS = ("packages", "machine", "seconds", "solver_seconds", "factorizations", "degrees_of_freedom", "accuracy")


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


def _unreadable(path: Path, failure: Exception) -> InputError:
    reason = f"the key {failure} is missing" if isinstance(failure, KeyError) else str(failure).partition("\n")[0]
    return InputError(f"{path}: is not a result file of a run: {reason}; repeat the run or restore the file")
