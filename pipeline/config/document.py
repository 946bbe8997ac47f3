"""A YAML file with overrides applied, and the sentences in which it is refused."""

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from pipeline.values.errors import InputError, shortened
from pipeline.values.json_values import Written

Key = tuple[str | int, ...]
#: the dotted key of an override, as messages name it: --set mesh.size
Naming = Callable[[str], str]


def on_command_line(key: str) -> str:
    """The key of an override of the command line."""
    return f"--set {key}"


@dataclass(frozen=True)
class Document:
    """What a file says after the overrides."""

    path: Path
    content: Mapping[str, Written]
    overridden: tuple[Key, ...]  #: the keys that overrides gave
    naming: Naming = on_command_line

    def with_values(self, values: Sequence[tuple[str, Written]], naming: Naming) -> "Document":
        """This document with values put in at dotted keys; texts are parsed as YAML, also in lists and mappings.

        naming: of the keys in messages. Raises InputError for a key without a name or below a value, and for a text
        that is not YAML.
        """
        content = deepcopy(dict(self.content))
        keys = tuple(_override(content, key, value, naming) for key, value in values)
        return Document(self.path, content, (*self.overridden, *keys), naming)

    def without(self, keys: Iterable[str]) -> "Document":
        """This document without what stands at keys, of at most two parts."""
        content = deepcopy(dict(self.content))
        for *outer, last in (key.split(".") for key in keys):
            inside: Any = content.get(outer[0]) if outer else content
            if isinstance(inside, dict):
                inside.pop(last, None)
        return replace(self, content=content)

    @property
    def text(self) -> str:
        """What the file would say, in YAML."""
        return str(yaml.safe_dump(dict(self.content), sort_keys=False, allow_unicode=True, width=120))

    @property
    def has_rows(self) -> bool:
        """True where an entry of the pressures is a list."""
        given = self.content.get("pressures")
        return isinstance(given, list) and any(isinstance(entry, list) for entry in given)

    def wrong(self, key: Key, complaint: str) -> InputError:
        """The refusal of one key."""
        return InputError(self.sentence(key, complaint))

    def sentence(self, key: Key, complaint: str) -> str:
        """File, key and what is wrong there; the override instead of the file if the value came from it."""
        for given in self.overridden:
            if given[: len(key)] == key or key[: len(given)] == given:
                inside = f"{dotted(key)}: " if len(key) > len(given) else ""
                return f"{self.naming(dotted(given))}: {inside}{complaint}"
        return f"{self.path}: {dotted(key)}: {complaint}"

    def first_given(self, keys: Sequence[Key]) -> Key:
        """The one of several keys that was overridden, or the first."""
        given = [key for key in keys if any(other[: len(key)] == key for other in self.overridden)]
        return (given or list(keys))[0]


def read_document(path: Path, overrides: Sequence[str] = ()) -> Document:
    """The YAML mapping in `path`, with every override "a.b=value" of the command line put in. Raises InputError."""
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
    return Document(path, content, ()).with_values([key_and_value(text) for text in overrides], on_command_line)


def _parsed(text: str) -> Any:
    """The content of a YAML text; raises YAMLError."""
    try:
        return yaml.load(text, Loader=_Loader)
    except RecursionError:
        raise yaml.constructor.ConstructorError(problem="is nested too deeply") from None
    except (ValueError, TypeError, AttributeError, LookupError) as failure:  # PyYAML leaves these to its caller
        raise yaml.constructor.ConstructorError(problem=f"has an invalid value ({failure})") from None


def key_and_value(text: str) -> tuple[str, str]:
    """The parts of a KEY=VALUE of the command line. Raises InputError for anything else."""
    key, sign, value = text.partition("=")
    if not sign or not all(name.strip() for name in key.split(".")):
        raise InputError(f"{on_command_line(shortened(text))}: is not KEY=VALUE; for example --set mesh.size='4 mm'")
    return key, value


def _override(content: dict[Any, Any], key: str, value: Any, naming: Naming) -> Key:
    names = tuple(name.strip() for name in key.split("."))
    if not all(names):
        raise InputError(f"{naming(shortened(key))}: is not a key; write one such as mesh.size")
    inside = content
    for depth, name in enumerate(names[:-1], start=1):
        value_there = inside.setdefault(name, {})
        if names[0] == "effects" and depth == 2 and isinstance(value_there, str | bool):
            inside[name] = {"state": value_there}  # `self_contact: auto` beside parameters of the effect
        inside = inside[name]
        if not isinstance(inside, dict):
            raise InputError(f"{naming(dotted(names))}: '{dotted(names[:depth])}' holds a value, not keys")
    try:
        inside[names[-1]] = _read(value)
    except yaml.YAMLError as failure:
        raise InputError(f"{naming(dotted(names))}: {_yaml_complaint(failure)}; write a value such as 4 mm") from None
    return names


def _read(value: Any) -> Any:
    """A value with its texts parsed; raises YAMLError."""
    if isinstance(value, str):
        return _parsed(value)
    if isinstance(value, Mapping):
        return {name: _read(entry) for name, entry in value.items()}
    return [_read(entry) for entry in value] if isinstance(value, list | tuple) else value


def dotted(key: Key) -> str:
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
# YAML 1.1 reads 010 as 8, 1:30 as 90 and 0x10 as 16: texts here, which no number takes
_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)$")
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != "tag:yaml.org,2002:int"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", _INTEGER, list("-+0123456789"))
# YAML 1.1 reads 1e-6 as a text, because it has no decimal point
_EXPONENT = re.compile(r"[-+]?[0-9]+[eE][-+]?[0-9]+$")
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _EXPONENT, list("-+0123456789"))
