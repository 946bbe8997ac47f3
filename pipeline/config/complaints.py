"""What is wrong with one key of a configuration, in the words of a user."""

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from types import NoneType, UnionType
from typing import Any, get_args, get_origin

from pipeline.errors import quoted

Key = tuple[str | int, ...]

#: last part of pydantic's place of a name that is not a text
_NAME = "[key]"
#: the second half of a value that was written with a decimal comma in { } or [ ]
_AFTER_COMMA = re.compile(r"\d+(\s*[A-Za-z%].*)?")
_OTHERS = "draw another body with them in a CAD program, and give its STEP file (family: own); "
#: what to write instead of a key that belongs to other laws or is a common mistake
_INSTEAD: dict[tuple[str, ...], str] = {
    ("material", "E"): "the law has no E; its initial shear modulus is E / (2 (1 + nu)); ",
    ("material", "mu"): "the law has no mu; E = 2 mu (1 + nu); ",
    ("geometry", "defeature"): "it removes narrow faces of a body from a CAD file; a mesh or a surface has to be made "
    "again without them; ",
    ("geometry", "symmetric"): "it is for bodies from CAD files and meshes: "
    "bodies of the other families are symmetric, and surfaces are meshed as a whole; ",
    ("geometry", "fillet"): f"it rounds the edges of a pneunet; {_OTHERS}",
    **{
        ("geometry", key): f"it is for the chambers of a pneunet; {_OTHERS}"
        for key in ("chamber_lengths", "chamber_heights", "gaps")
    },
}


def close_to(text: Any, allowed: Sequence[str]) -> str:
    """The question whether another text was meant, with a space behind it; empty where none is similar."""
    near = get_close_matches(str(text).lower(), allowed, n=1)
    return f"did you mean '{near[0]}'? " if near else ""


def not_known(value: Any, allowed: Sequence[str]) -> str:
    """The complaint about a name that is not among those allowed."""
    return f"{quoted(value)} is not known; {close_to(value, allowed)}allowed: {', '.join(allowed)}"


def complaints(errors: Sequence[Mapping[str, Any]], model: Any) -> list[tuple[Key, str]]:
    """Keys and complaints of pydantic's errors about `model`, unknown keys first.

    A key that is missing because it is misspelt is named once.
    """
    unknown = [error for error in errors if _is_unknown(error)]
    meant = {(*error["loc"][:-1], _meant(error["loc"], model)) for error in unknown}
    others = [e for e in errors if not _is_unknown(e) and not (e["type"] == "missing" and e["loc"] in meant)]
    return [(_place(error["loc"]), _complaint(error, model)) for error in [*unknown, *others]]


def _place(key: Key) -> Key:
    """The key that a sentence names: the section in which a name is wrong, or the key itself."""
    return key[:-2] if key and key[-1] == _NAME else key


def _is_unknown(error: Mapping[str, Any]) -> bool:
    return error["type"] in ("extra_forbidden", "invalid_key")


def _meant(key: Key, model: Any) -> str | None:
    """The allowed key that an unknown one resembles most."""
    return next(iter(get_close_matches(str(key[-1]), list(keys_below(model, key[:-1])), n=1)), None)


def _complaint(error: Mapping[str, Any], model: Any) -> str:
    kind, key = error["type"], error["loc"]
    if key and key[-1] == _NAME:
        return f"{quoted(error['input'])} is not a name; write it in quotes"
    if _is_unknown(error):
        return _unknown(key, model)
    if kind == "missing":
        return f"is missing; for example '{key[-1]}: {_example(model, key)}'"
    if kind == "value_error":
        return str(error["ctx"]["error"])
    if kind == "literal_error":
        allowed = str(error["ctx"]["expected"]).replace("'", "")
        meant = close_to(error["input"], re.split(", | or ", allowed))
        return f"{quoted(error['input'])} is not allowed; {meant}allowed: {allowed}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        if keys := keys_below(model, key):
            return f"must hold keys; allowed here: {', '.join(keys)}"
        return f"must hold names, for example {_example(model, key)}"
    if kind in ("tuple_type", "list_type"):
        return f"must be a list, for example {_list_example(model, key)}"
    if kind in ("string_type", "string_too_short"):
        return f"{quoted(error['input'])} is not a text; for example '{_example(model, key)}'"
    if kind == "string_pattern_mismatch":
        return f"{quoted(error['input'])} is not a name; allowed: letters, digits, '_', '-' and '.'"
    return f"{error['msg']}; given: {quoted(error['input'])}"


def _unknown(key: Key, model: Any) -> str:
    allowed = list(keys_below(model, key[:-1]))
    near = _meant(key, model)
    if near is None and _AFTER_COMMA.fullmatch(str(key[-1])):
        return "unknown key; a comma separates two values here: write decimals with a point, for example 4.5 mm"
    instead = _INSTEAD.get(tuple(map(str, key)), "")
    hint = f"did you mean '{near}'? " if near else ""
    return f"unknown key; {instead}{hint}allowed here: {', '.join(allowed)}"


def keys_below(model: Any, key: Key) -> Mapping[str, Any]:
    """The fields allowed below `key`."""
    keys: Mapping[str, Any] = model.model_fields
    for name in key:
        field = keys.get(str(name))  # an entry of a list has none
        keys = getattr(_section(field.annotation), "model_fields", {}) if field else {}
    return keys


def _section(annotation: Any) -> Any:
    """The type of a field, without the None of a section that may be left out."""
    if get_origin(annotation) is not UnionType:
        return annotation
    return next(part for part in get_args(annotation) if part is not NoneType)


def _list_example(model: Any, key: Key) -> str:
    """That of the key, or of the one that it is an entry of."""
    for length in range(len(key), 0, -1):
        field = keys_below(model, key[: length - 1]).get(str(key[length - 1]))
        if (examples := _examples(field)) and "[" in examples[0]:
            return examples[0]
    return "[17 kPa, 37 kPa]"


def _examples(field: Any) -> list[str]:
    """Of a field; where it may be left out, those of the kind that it has otherwise."""
    if field is None:
        return []
    kinds = [part for kind in get_args(field.annotation) for part in getattr(kind, "__metadata__", ())]
    return [str(example) for part in (field, *kinds) for example in getattr(part, "examples", None) or ()]


def _example(model: Any, key: Key) -> str:
    while isinstance(key[-1], int):  # of an entry of a list that of the list
        key = key[:-1]
    field = keys_below(model, key[:-1])[str(key[-1])]
    if examples := _examples(field):
        return examples[0]
    if hasattr(field.annotation, "model_fields"):
        return "{" + ", ".join(f"{name}: ..." for name in field.annotation.model_fields) + "}"
    return "..."
