"""A YAML file with overrides applied, and the one sentence in which it is refused."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import yaml

from pipeline.errors import InputError, quoted, shortened

Key = tuple[str | int, ...]


@dataclass(frozen=True)
class Document:
    """What a file says after the overrides."""

    path: Path
    content: Mapping[str, Any]
    overridden: tuple[Key, ...]  #: the keys that `--set` gave

    def wrong(self, key: Key, complaint: str) -> InputError:
        """The refusal of one key; it names `--set` where the value came from there."""
        for given in self.overridden:
            if given[: len(key)] == key or key[: len(given)] == given:
                inside = f"{_dotted(key)}: " if len(key) > len(given) else ""
                return InputError(f"--set {_dotted(given)}: {inside}{complaint}")
        return InputError(f"{self.path}: {_dotted(key)}: {complaint}")

    def choice(self, key: tuple[str, str], allowed: tuple[str, ...]) -> str:
        """The text at `section.name`, one of `allowed`."""
        section, name = key
        if section not in self.content:
            raise self.wrong((section,), f"is missing; for example '{section}: {{{name}: {allowed[0]}, ...}}'")
        inside = self.content[section]
        if not isinstance(inside, Mapping):
            raise self.wrong((section,), f"must hold keys, for example '{section}: {{{name}: {allowed[0]}, ...}}'")
        if name not in inside:
            raise self.wrong(key, f"is missing; allowed: {', '.join(allowed)}")
        if inside[name] not in allowed:
            raise self.wrong(key, f"{quoted(inside[name])} is not known; allowed: {', '.join(allowed)}")
        return str(inside[name])

    def refusal(self, errors: Sequence[Mapping[str, Any]], model: Any) -> InputError:
        """The first of pydantic's errors about `model` as one sentence, with the number of the others.

        Unknown keys come first: a misspelt key is also a missing one.
        """
        first = min(errors, key=lambda error: error["type"] != "extra_forbidden")
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        return self.wrong(first["loc"], _complaint(first, model) + more)

    def wrong_together(self, keys: tuple[Key, ...], complaint: str) -> InputError:
        """The refusal of values that do not go together; it names the one that `--set` gave, or the first."""
        given = [key for key in keys if key in self.overridden]
        return self.wrong((given or list(keys))[0], complaint)


def read_document(path: Path, overrides: Sequence[str] = ()) -> Document:
    """The YAML mapping in `path` with every "a.b=value" of `overrides` put in; values are parsed as YAML."""
    try:
        content = _parsed(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a configuration such as configs/pneunet.yaml") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text in UTF-8; give a YAML file") from None
    except OSError as failure:
        raise InputError(f"{path}: cannot be read: {failure.strerror}; give a readable YAML file") from None
    except yaml.YAMLError as failure:
        raise InputError(f"{path}: {_yaml_complaint(failure)}; write 'key: value' lines in YAML") from None
    if not isinstance(content, dict):
        raise InputError(f"{path}: holds no keys; a configuration starts with 'name: ...' and 'geometry: ...'")
    keys = tuple(_override(content, text) for text in overrides)
    return Document(path, content, keys)


def _parsed(text: str) -> Any:
    """The content of a YAML text; raises YAMLError."""
    try:
        return yaml.load(text, Loader=_Loader)
    except RecursionError:
        raise yaml.constructor.ConstructorError(problem="is nested too deeply") from None
    except (ValueError, TypeError, AttributeError, LookupError) as failure:  # PyYAML leaves these to its caller
        raise yaml.constructor.ConstructorError(problem=f"has an invalid value ({failure})") from None


def _override(content: dict[Any, Any], text: str) -> Key:
    dotted, sign, value = text.partition("=")
    names = tuple(name.strip() for name in dotted.split("."))
    if not sign or not all(names):
        raise InputError(f"--set {shortened(text)}: is not KEY=VALUE; for example --set mesh.size='4 mm'")
    inside = content
    for depth, name in enumerate(names[:-1], start=1):
        inside = inside.setdefault(name, {})
        if not isinstance(inside, dict):
            raise InputError(f"--set {_dotted(names)}: '{_dotted(names[:depth])}' holds a value, not keys")
    try:
        inside[names[-1]] = _parsed(value)
    except yaml.YAMLError as failure:
        complaint = f"{_yaml_complaint(failure)}; for example --set mesh.size='4 mm'"
        raise InputError(f"--set {_dotted(names)}: {complaint}") from None
    return names


def _complaint(error: Mapping[str, Any], model: Any) -> str:
    kind, key = error["type"], error["loc"]
    if kind in ("extra_forbidden", "invalid_key"):
        allowed = list(_keys(model, key[:-1]))
        near = get_close_matches(str(key[-1]), allowed, n=1)
        hint = f"did you mean '{near[0]}'? " if near else ""
        return f"unknown key; {hint}allowed here: {', '.join(allowed)}"
    if kind == "missing":
        return f"is missing; for example '{key[-1]}: {_example(model, key)}'"
    if kind == "value_error":
        return str(error["ctx"]["error"])
    if kind == "literal_error":
        return f"{quoted(error['input'])} is not allowed; allowed: {error['ctx']['expected'].replace(chr(39), '')}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return f"must hold keys; allowed here: {', '.join(_keys(model, key))}"
    if kind in ("tuple_type", "list_type"):
        return "must be a list, for example [17 kPa, 37 kPa]"
    if kind in ("string_type", "string_too_short"):
        return f"{quoted(error['input'])} is not a text; for example '{_example(model, key)}'"
    if kind == "string_pattern_mismatch":
        return f"{quoted(error['input'])} is not a name; allowed: letters, digits, '_', '-' and '.'"
    return f"{error['msg']}; given: {quoted(error['input'])}"


def _keys(model: Any, key: Key) -> Mapping[str, Any]:
    """The fields allowed below `key`."""
    keys: Mapping[str, Any] = model.model_fields
    for name in key:
        keys = keys[str(name)].annotation.model_fields
    return keys


def _example(model: Any, key: Key) -> str:
    field = _keys(model, key[:-1])[str(key[-1])]
    if field.examples:
        return str(field.examples[0])
    if hasattr(field.annotation, "model_fields"):
        return "{" + ", ".join(f"{name}: ..." for name in field.annotation.model_fields) + "}"
    return "..."


def _dotted(key: Key) -> str:
    """mesh.size, or pressures[2] for the second of a list."""
    text = ""
    for part in key:
        name = shortened(str(part))
        text += f"[{part + 1}]" if isinstance(part, int) else f".{name}" if text else name
    return text


def _yaml_complaint(failure: yaml.YAMLError) -> str:
    mark = getattr(failure, "problem_mark", None)
    where = f"line {mark.line + 1}: " if mark is not None else ""
    return f"{where}{getattr(failure, 'problem', None) or 'is not YAML'}"


class _Loader(yaml.SafeLoader):
    """YAML's safe types; a key given twice is refused."""


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Hashable, Any]:
    keys: set[Any] = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node)
        if not isinstance(key, Hashable):
            raise yaml.constructor.ConstructorError(None, None, "a list or mapping as key", key_node.start_mark)
        if key in keys:
            raise yaml.constructor.ConstructorError(None, None, f"key '{key}' given twice", key_node.start_mark)
        keys.add(key)
    return yaml.SafeLoader.construct_mapping(loader, node, deep=True)


_Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)
