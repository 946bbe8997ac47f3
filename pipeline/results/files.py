"""The result files of a run, read into `Run` and written from values, by the types of `pipeline.results.values`.

pydantic checks what is read: a file that was edited by hand is refused with the key that is wrong.
"""

import csv
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from pipeline.errors import InputError
from pipeline.results.parameters import RodParameters
from pipeline.results.values import Curve, Effect, Law, Reported, RodError, Run, State
from pipeline.store.formats import FORMAT
from pipeline.store.result_folder import ResultFolder, json_text

#: file -> the type of its content
TYPES: dict[str, Any] = {
    "experiments.json": list[State],
    "validation.json": list[RodError],
    "effects.json": list[Effect],
    "parameters.json": RodParameters,
}
_IDENTITY = "states/configuration.json"  #: written when a run starts


def save_value(folder: ResultFolder, name: str, value: RodParameters | Sequence[State | RodError | Effect]) -> None:
    """Write the content of one of the files in `TYPES`; NaN and infinity become null."""
    content = value if isinstance(value, RodParameters) else list(value)
    folder.save_json(name, TypeAdapter(TYPES[name]).dump_python(content))


def json_schema() -> dict[str, Any]:
    """The JSON schemas of the result files by name; that of law.json has the part that the report reads."""
    return {name: TypeAdapter(kind).json_schema() for name, kind in {**TYPES, "law.json": Law}.items()}


def read_results(directory: Path) -> Run:
    """Every result file in `directory` that is there.

    Raises InputError with one sentence for a folder that does not exist, holds no result, or holds a file that is none
    of this version.
    """
    contents = {path.name: _content(path) for path in sorted(directory.glob("*.json"))}
    _check_there(directory, contents)
    record = _mapping(directory / "run.json", contents.get("run.json"))
    if not record:  # stopped before its report: the configuration alone
        record = _mapping(directory / _IDENTITY, _content(directory / _IDENTITY))
    parameters = _mapping(directory / "parameters.json", contents.get("parameters.json"))
    for name, content in (("run.json", record), ("parameters.json", parameters)):
        _check_format(directory / name, content)
    values = {name: _typed(directory / name, TYPES[name], contents[name]) for name in TYPES if name in contents}
    notes = {
        key: tuple(_typed(directory / "run.json", list[Reported], record.get(key) or []))
        for key in ("failures", "remarks")
    }
    law = contents.get("law.json")
    return Run(
        directory=directory,
        record=record,
        parameters=values.get("parameters.json", RodParameters()),
        states=tuple(values.get("experiments.json", ())),
        curves=_curves(directory / "curves.csv"),
        rod_errors=tuple(values.get("validation.json", ())),
        validation_curves=_curves(directory / "validation_curves.csv"),
        effects=tuple(values.get("effects.json", ())),
        law=None if law is None else _typed(directory / "law.json", Law, law),
        **notes,
    )


def _check_there(directory: Path, contents: Mapping[str, Any]) -> None:
    if any(contents.get(name) for name in ("experiments.json", "parameters.json", "law.json", "run.json")):
        return
    if not directory.is_dir():
        raise InputError(f"{directory}: no such folder; give the folder of a run, such as results/pneunet")
    if (directory / _IDENTITY).is_file():
        raise InputError(f"{directory}: its run has no results yet; start it again, and it continues")
    others = [name for name in ("accuracy.json", "effects_table.json", "material.json") if name in contents]
    there = f"holds {others[0]}, which is not the result of `pneurod run`" if others else "holds no results"
    raise InputError(f"{directory}: {there}; give the folder of a run")


def _content(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as failure:
        raise InputError(f"{path}: cannot be read ({failure.strerror})") from None
    except ValueError as failure:
        raise _unreadable(path, str(failure)) from None


def _mapping(path: Path, content: Any) -> Mapping[str, Any]:
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise _unreadable(path, "it has no keys")
    return content


def _check_format(path: Path, content: Mapping[str, Any]) -> None:
    if content.get("format", FORMAT) != FORMAT:
        raise InputError(f"{path}: has format {content['format']}, and this version reads {FORMAT}; repeat the run")


def _typed(path: Path, kind: Any, content: Any) -> Any:
    try:
        return TypeAdapter(kind).validate_python(content)
    except ValidationError as failure:
        first = failure.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise _unreadable(path, f"{key}: {first['msg']}") from None


def _curves(path: Path) -> tuple[Curve, ...]:
    if not path.is_file():
        return ()
    try:
        with path.open(encoding="utf-8", newline="") as lines:
            table = list(reader := csv.DictReader(lines, strict=True))
        if not reader.fieldnames:
            raise ValueError("it is empty")
        curves: dict[tuple[str, float, str], list[dict[str, str]]] = {}
        for row in table:
            key = row["experiment"], float(row["pressure_kPa"]), row.get("load", "")
            curves.setdefault(key, []).append(row)
        return tuple(_curve(*key, rows) for key, rows in curves.items())
    except (KeyError, ValueError, TypeError, csv.Error) as failure:
        raise _unreadable(path, str(failure)) from None


def _curve(experiment: str, pressure: float, load: str, rows: list[dict[str, str]]) -> Curve:
    names = [name for name in rows[0] if name not in ("experiment", "pressure_kPa", "load")]
    columns = {name: np.array([float(row[name] or "nan") for row in rows]) for name in names}
    return Curve(experiment, pressure, columns, load)


def _unreadable(path: Path, reason: str) -> InputError:
    return InputError(f"{path}: is not a result file of a run: {reason}; repeat the run or restore the file")


if __name__ == "__main__":
    sys.stdout.write(json_text(json_schema()))
