"""The result files of a run, read into `Run` and written from values, by the types of `pipeline.values.run`.

pydantic checks what is read: a file that was edited by hand is refused with the key that is wrong.
"""

import csv
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import TypeAdapter, ValidationError

from pipeline.results.laws import law_of_record
from pipeline.store.result_folder import ResultFolder, json_text
from pipeline.values.errors import InputError, argument, quoted
from pipeline.values.formats import CURVE_COLUMNS, FORMAT
from pipeline.values.json_values import JsonObject
from pipeline.values.law import DeliveredLaw, LawMetadata
from pipeline.values.parameters import RodParameters
from pipeline.values.record import RunRecord
from pipeline.values.run import Curve, Effect, RodError, Run, State
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import fractions_of
from rod.errors import RodError as NoRod

Value = TypeVar("Value")
#: file -> its content, as pydantic reads and writes it
TYPES: dict[str, TypeAdapter[Any]] = {
    "experiments.json": TypeAdapter(tuple[State, ...]),
    "validation.json": TypeAdapter(tuple[RodError, ...]),
    "effects.json": TypeAdapter(tuple[Effect, ...]),
    "parameters.json": TypeAdapter(RodParameters),
    "law.json": TypeAdapter(LawMetadata),
    "run.json": TypeAdapter(RunRecord),
}
#: the arm's own law
LAW = "law.json"
#: the same on the mesh on which the whole arm is solved; absent where law.json has it
LAW_ON_MESH_OF_ARM = "law_on_mesh_of_arm.json"
CURVES, VALIDATION_CURVES = "curves.csv", "validation_curves.csv"
_KEYS = ("experiment", "pressure_kPa")
_FORCE = ("force_x_N", "force_y_N")  #: dead, on the end; empty for another load
_IDENTITY = "states/configuration.json"  #: written when a run starts
#: what is wrong by the type of an error of pydantic
_WRONG = {
    **dict.fromkeys(("list_type", "tuple_type"), "must be a list"),
    **dict.fromkeys(("dataclass_type", "dict_type", "mapping_type"), "must have keys"),
    "missing": "is missing",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "greater_than": "must be positive",
}


def save_value(folder: ResultFolder, name: str, value: Value) -> Value:
    """Write the content of one of the files in `TYPES`, and return it as it is read: NaN and infinity become null."""
    text = json_text(TYPES[name].dump_python(value))
    folder.save_text(name, text)
    return TYPES[name].validate_json(text)


def replace_draft(folder: ResultFolder, *, draft: bool) -> None:
    """Remove the law of a draft, unless another draft follows. Raises InputError for a draft of what has a full law."""
    known = _content(folder.directory / LAW) or {}
    if draft and known and not known.get("draft"):
        given, remedy = argument("out", folder.directory), f"give another {argument('out')}"
        raise InputError(f"{given}: holds a law that is no draft; {remedy}, or {argument('fresh', True)} to replace it")
    if not draft and known.get("draft"):
        folder.path(LAW).unlink()


def save_curves(folder: ResultFolder, curves: Sequence[Curve], *, has_loads: bool = False) -> None:
    """Write the curves of a run, or those of its validation, which have columns for the load."""
    name = VALIDATION_CURVES if has_loads else CURVES
    rows: list[tuple[Any, ...]] = []
    for curve in curves:
        table = np.column_stack([curve[column] for column in CURVE_COLUMNS[len(_KEYS) :]])
        load = (curve.load, *(curve.force_N or ("", ""))) if has_loads else ()
        rows += [(*load, curve.experiment, curve.pressure_kPa, *values) for values in table.tolist()]
    folder.save_rows(name, (*(("load", *_FORCE) if has_loads else ()), *CURVE_COLUMNS), rows)


def folder_of(direction: float) -> str:
    """What the folder of a ratio of two pressures is called: 1_to_0.25."""
    one, other = fractions_of(direction)
    return f"{one:.6g}_to_{other:.6g}"


def read_run(path: Path) -> Run:
    """A result folder; or a parameters.json, with the run.json beside it; or a law.json alone. Raises InputError."""
    return _read_rod(path) if path.is_file() else read_results(path)


def _read_rod(file: Path) -> Run:
    content, beside = _content(file), file.with_name("run.json")
    if _is_law(content):
        return Run(file.parent, law=_law(file, content))
    if not isinstance(content, Mapping) or "pressures_kPa" not in content:
        raise InputError(f"{file}: has no rod; give the folder of a run, its parameters.json or its law.json")
    return Run(file.parent, _typed(beside, "run.json", _content(beside) or {}), _parameters(file, content))


def read_law(path: Path) -> DeliveredLaw:
    """The law of a file, or of the law.json of a folder. Raises InputError."""
    file = path / LAW if path.is_dir() else path
    return _law(file, _content(file))


def read_plane_law(path: Path) -> ArmLaw:
    """The law of an arm with one pressure; path as of `read_law`. Raises InputError for another kind of law, too."""
    law = read_law(path)
    if law.plane is None:
        raise InputError(f"{path}: has the pressures of {', '.join(law.law.cavities)}; give a law of one pressure")
    return law.plane


def json_schema() -> JsonObject:
    """The JSON schemas of the result files by name; that of law.json has what stands beside the law."""
    return {name: adapter.json_schema() for name, adapter in TYPES.items()}


def read_results(directory: Path) -> Run:
    """Every result file in `directory` that is there.

    The folder of a design has them in that of its run. Raises InputError with one sentence for a folder that does not
    exist, holds no result, or holds a file that is none of this version.
    """
    if (directory / "design.json").is_file() and (directory / "run").is_dir():
        directory /= "run"
    contents = {path.name: _content(path) for path in sorted(directory.glob("*.json"))}
    _check_there(directory, contents)
    if not contents.get("run.json"):  # stopped before its report: the configuration alone
        contents["run.json"] = _content(directory / _IDENTITY) or {}
    parameters = _parameters(directory / "parameters.json", contents.pop("parameters.json", {}))
    typed = [name for name in TYPES if name in contents and name != LAW]
    values = {name: _typed(directory / name, name, contents[name]) for name in typed}
    return Run(
        directory=directory,
        record=values["run.json"],
        parameters=parameters,
        states=values.get("experiments.json", ()),
        curves=_curves(directory / CURVES),
        rod_errors=values.get("validation.json", ()),
        validation_curves=_curves(directory / VALIDATION_CURVES),
        effects=values.get("effects.json", ()),
        law=_law(directory / LAW, contents[LAW]) if LAW in contents else None,
    )


def _check_there(directory: Path, contents: Mapping[str, object]) -> None:
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
        raise _unreadable(path, failure) from None


def _typed(path: Path, name: str, content: Any) -> Any:
    found = content.get("format", FORMAT) if isinstance(content, dict) else FORMAT
    if found != FORMAT:
        raise InputError(f"{path}: has format {quoted(found)}, and this version reads {FORMAT}; repeat the run")
    try:
        return TYPES[name].validate_python(content)
    except ValidationError as failure:
        raise _unreadable(path, failure) from None


def _parameters(path: Path, content: Any) -> RodParameters:
    parameters: RodParameters = _typed(path, "parameters.json", content)
    try:
        if parameters.pressures_kPa:
            parameters.rods()
    except NoRod as failure:
        raise _unreadable(path, failure) from None
    return parameters


def _law(path: Path, content: Any) -> DeliveredLaw:
    if not _is_law(content):
        missing = "cannot be read (No such file or directory)"
        raise InputError(f"{path}: {missing if content is None else 'is not the law of an arm'}; give that of a run")
    try:
        return DeliveredLaw(**vars(TYPES[LAW].validate_python(content)), law=law_of_record(content))
    except ValueError as failure:
        raise _unreadable(path, failure) from None


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
        raise _unreadable(path, failure) from None


def _curve(experiment: str, pressure: float, load: str, rows: list[dict[str, str]]) -> Curve:
    names = [name for name in rows[0] if name not in (*_KEYS, "load", *_FORCE)]
    columns = {name: np.array([float(row[name] or "nan") for row in rows]) for name in names}
    x, y = (rows[0].get(name) for name in _FORCE)
    return Curve(experiment, pressure, columns, load, (float(x), float(y)) if x and y else ())


def _unreadable(path: Path, failure: Exception) -> InputError:
    reason = str(failure).rstrip(".")
    if isinstance(failure, json.JSONDecodeError):
        reason = f"line {failure.lineno} is not JSON"
    elif isinstance(failure, ValidationError):
        first = failure.errors()[0]
        raised = str(first.get("ctx", {}).get("error", "")).rstrip(".")
        key = ".".join(map(str, first["loc"]))
        reason = ": ".join(filter(None, (key, raised or _WRONG.get(first["type"], first["msg"]))))
    return InputError(f"{path}: is not a result file of a run: {reason}; repeat the run or restore the file")


if __name__ == "__main__":
    sys.stdout.write(json_text(json_schema()))


def _is_law(content: Any) -> bool:
    """Whether the content of a file is the law of an arm rather than the parameters of a rod."""
    return isinstance(content, Mapping) and "kind" in content
