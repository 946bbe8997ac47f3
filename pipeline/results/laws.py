"""The laws of `rod` as the content of law.json, and back: each field under the key that stands with its type.

    kappa: Annotated[Array, "kappa_per_mm", "k"]

has the key kappa_per_mm and one axis; a letter is the same number in all fields of a row. A key such as clamp.curves
stands in a table of its own. Rows with `"form": "after_snap"` are those of the law after a limit of the pressure.
Arrays that are empty by default may be missing. pydantic checks what is read.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass, replace
from functools import lru_cache
from typing import Annotated, Any, TypeVar, get_args, get_origin

import numpy as np
from pydantic_core import CoreSchema, SchemaValidator
from pydantic_core import core_schema as schema

from geometry.arrays import Array
from pipeline.values.json_values import Json, JsonObject, ReadObject
from rod.arm_law.curves import key_of
from rod.arm_law.kinds import Saved
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import PairLaw, fractions_of
from rod.arm_law.quantities import key_in_files

#: of the file; raised when a key changes its meaning
FORMAT = 5
READ = (4, FORMAT)  #: in format 4 no law has two forms
AFTER_SNAP = "after_snap"  #: the form of a row of the swollen arm; other rows have none

Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)  # arrays inside
class _Ray:
    direction: Annotated[float, "direction"]
    law: Annotated[ArmLaw, "law"]


@dataclass(frozen=True, eq=False)  # arrays inside
class _Rays:
    cavities: Annotated[tuple[str, ...], "cavities"]
    error_between: Annotated[float | None, "error_between"]
    rays: Annotated[tuple[_Ray, ...], "rays"]


def law_record(law: Saved) -> JsonObject:
    """The contents of law.json but for how the law was measured."""
    records: dict[str, Callable[[Any], JsonObject]] = {ArmLaw.kind: _plane_record, PairLaw.kind: _record_of_pairs}
    return {"format": FORMAT, "kind": law.kind, **records.get(law.kind, record_of)(law)}


def _record_of_pairs(law: PairLaw) -> JsonObject:
    rays: list[JsonObject] = []
    for direction, of_ray in zip(law.directions, law.laws, strict=True):
        rays.append({"direction": direction, "fractions": fractions_of(direction), "law": _plane_record(of_ray)})
    return {"cavities": law.cavities, "error_between": law.error_between, "rays": rays}


def _plane_record(law: ArmLaw) -> JsonObject:
    """With the pressures, and the derivatives of what follows from the curves."""
    derivatives = {}
    for name, rate in law.rates.items():
        numbers = {key_in_files(number): row.tolist() for number, row in law.derivative(name).items()}
        derivatives[name] = {**numbers, "unit": rate.unit, **record_of(rate)}
    record: JsonObject = {**record_of(law), "derivatives": derivatives}
    if law.swollen:
        record = _joined(record, record_of(law.swollen))
    lengths = {key: record[key] for key in ("pitch_mm", "first_middle_mm", "length_mm")}
    return {**lengths, "pressures_kPa": [*law.pressures], **record}


def _joined(first: Any, after: Any) -> Any:
    """A record with the rows of the swollen form at the end of each of its tables."""
    if isinstance(first, Mapping):
        return {key: _joined(held, after.get(key)) if after else held for key, held in first.items()}
    rows = [{"form": AFTER_SNAP, **row} for row in after or ()] if _is_table(first) else []
    return [*first, *rows] if rows else first


def _of_form(content: Any, form: str) -> Any:
    """A record with those rows of its tables that belong to a form."""
    if isinstance(content, Mapping):
        return {key: _of_form(held, form) for key, held in content.items()}
    if _is_table(content):
        return [row for row in content if not isinstance(row, Mapping) or row.get("form", "") == form]
    return content


def _is_table(content: Any) -> bool:
    return isinstance(content, list) and bool(content) and isinstance(content[0], Mapping)


def _both_forms(record: Any, read: Callable[[Any], ArmLaw]) -> ArmLaw:
    """The law of the form from rest with that after the snap, where a record has rows of it."""
    law, swollen = read(_of_form(record, "")), _of_form(record, AFTER_SNAP)
    if not (isinstance(record, Mapping) and swollen.get("curves")):
        return law
    form = read(swollen)
    rates = {name: rate for name, rate in form.rates.items() if rate.cells}
    return replace(law, swollen=replace(form, rates=rates, limit=None, back=None))


def record_of(value: Any) -> dict[str, Json]:
    """The fields of a value that have a key, arrays as lists."""
    record: dict[str, Json] = {}
    tables: dict[str, dict[str, Json]] = {"": record}
    for field, key in _keyed(type(value)):
        held = getattr(value, field.name)
        if field.default_factory is MISSING or np.size(held) or isinstance(held, Mapping):
            table, _, last = key.rpartition(".")
            if table not in tables:
                record[table] = tables[table] = {}
            tables[table][last] = _plain(held)
    return record


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        return record_of(value)
    if isinstance(value, Mapping):
        return {key: _plain(held) for key, held in value.items()}
    if isinstance(value, tuple):
        return [_plain(held) for held in value]
    return value.tolist() if isinstance(value, np.ndarray) else value


def law_of_record(record: ReadObject) -> Saved:
    """The law that `law_record` wrote. Raises ValueError, with the key, for anything else."""
    kinds: dict[Any, type[Any]] = {law.kind: law for law in get_args(Saved)}
    if record.get("format") not in READ or record.get("kind") not in kinds:
        raise ValueError(f"it is no law of an arm in format {FORMAT}")
    if record["kind"] == PairLaw.kind:
        found = value_of(_Rays, record)
        laws = tuple(_checked(ray.law) for ray in found.rays)
        return PairLaw(found.cavities, tuple(ray.direction for ray in found.rays), laws, found.error_between)
    if record["kind"] == ArmLaw.kind:
        return _checked(value_of(ArmLaw, record))
    return value_of(kinds[record["kind"]], record)


def _checked(law: ArmLaw) -> ArmLaw:
    """The law. Raises ValueError, with the key, for a length or a rigidity that is not positive."""
    found = {"pitch_mm": law.pitch, "first_middle_mm": law.first_middle, "length_mm": law.length}
    for k, cell in enumerate(law.cells):
        found[f"curves.{k}.axial_rigidity_N"] = cell.axial_rigidity.min()
        found[f"curves.{k}.shear_rigidity_N"] = cell.shear_rigidity.min()
        # a cell whose walls buckle has a negative rigidity beyond, but not near the state without moment
        at_rest = cell.rigidity[np.abs(cell.moment).argmin()]
        found[f"curves.{k}.rigidity_N_mm2"] = at_rest if cell.rigidity.all() else 0.0
    for key, value in found.items():
        if value <= 0.0:
            raise ValueError(f"{key}: must be positive, and has {value:g}")
    return law


def value_of(kind: type[Value], record: Any) -> Value:
    """A value from what `record_of` made of it. Raises ValueError, with the key, for anything else."""
    known: Any = kind
    return _validator(known).validate_python(record)


@lru_cache
def _validator(kind: Any) -> SchemaValidator:
    return SchemaValidator(_row(kind))


def _keyed(kind: type[Any]) -> Iterator[tuple["Field[Any]", str]]:
    return ((field, key) for field in fields(kind) if (key := key_of(field)))


def _row(kind: type[Any]) -> CoreSchema:
    """Of a dataclass whose arrays agree in the lengths of their axes."""
    columns = []
    for field, key in _keyed(kind):
        of_type, _, *shape = get_args(field.type)
        content = _array(of_type, len(shape)) if get_origin(of_type) is np.ndarray else _content(of_type)
        if field.default_factory is not MISSING:
            content = schema.with_default_schema(content, default_factory=field.default_factory)
        elif field.default is not MISSING:
            content = schema.with_default_schema(content, default=field.default)
        path: list[str | int] = [*key.split(".")]
        columns.append(schema.dataclass_field(field.name, content, validation_alias=path))
    arguments = schema.dataclass_args_schema(kind.__name__, columns)
    made = schema.dataclass_schema(
        kind, arguments, [field.name for field in fields(kind)], post_init=hasattr(kind, "__post_init__")
    )
    whole = schema.no_info_after_validator_function(_agreeing, made)
    return schema.no_info_wrap_validator_function(_both_forms, whole) if kind is ArmLaw else whole


def _content(kind: Any) -> CoreSchema:
    """Of a number, a text, a value, several ones, or None."""
    if is_dataclass(kind):
        return _row(kind)  # type: ignore[arg-type]
    if kind is float:
        return schema.float_schema(strict=True, allow_inf_nan=False)
    if kind is str:
        return schema.str_schema()
    several = get_args(kind)
    if get_origin(kind) is Mapping:
        return schema.dict_schema(schema.str_schema(), _content(several[1]))
    if several[-1] is type(None):
        return schema.nullable_schema(_content(several[0]))
    if several[-1] is ...:
        return schema.no_info_after_validator_function(tuple, schema.list_schema(_content(several[0])))
    return schema.tuple_schema([_content(one) for one in several])


def _array(kind: Any, axes: int) -> CoreSchema:
    """Of finite numbers in nested lists of equal length."""
    dtype = get_args(get_args(kind)[1])[0]

    def read(value: Any) -> Array:
        try:
            array = np.array(value)
        except ValueError:
            array = np.array("")  # lists of different lengths
        if array.dtype.kind not in "fiub" or not np.isfinite(array).all() or array.ndim != axes or not array.size:
            lists = "lists of equal length with " if axes > 1 else ""
            raise ValueError(f"must be {lists}finite numbers" if axes else "must be a finite number")
        return array.astype(dtype)

    return schema.no_info_plain_validator_function(read)


def _agreeing(value: Any) -> Any:
    """The value, whose arrays have as many numbers as most others of the same letter."""
    shapes, counts = {}, dict[str, Counter[int]]()
    for field, key in _keyed(type(value)):
        lengths = np.shape(getattr(value, field.name)) if (axes := get_args(field.type)[2:]) else ()
        if 0 not in lengths:
            shapes[key] = lengths, axes
            for axis, length in zip(axes, lengths, strict=True):
                counts.setdefault(axis, Counter())[length] += 1
    usual = {axis: axis if isinstance(axis, int) else seen.most_common(1)[0][0] for axis, seen in counts.items()}
    for key, (lengths, axes) in shapes.items():
        expected = tuple(usual[axis] for axis in axes)
        if lengths != expected:
            sizes = (" × ".join(map(str, shape)) for shape in (expected, lengths))
            raise ValueError("{} must be {} numbers, and has {}".format(key, *sizes))
    return value
