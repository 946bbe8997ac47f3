"""Sections of a configuration that are described in Python: a body or a material, and settings by their keys."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any, ClassVar, dataclass_transform

from pipeline.values.errors import InputError, quoted
from pipeline.values.json_values import Written, plain

_SETTING = 'a text such as "6 mm", a plain number, true or false, or a list of these'


@dataclass_transform(kw_only_default=True, frozen_default=True, eq_default=False, field_specifiers=(field,))
class Description:
    """One section of a configuration: a frozen dataclass whose fields are keys; None for those with their defaults.

    Raises InputError, naming the key, for a value that no key can have. What a key must be is checked with the whole
    configuration.
    """

    #: the key that says what is described, and its value
    choice: ClassVar[tuple[str, str] | None] = None

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True, kw_only=True, eq=False, repr=False)(cls)

    def __post_init__(self) -> None:
        keys = [key.name for key in fields(self)]  # type: ignore[arg-type]
        given = {key: value for key in keys if (value := getattr(self, key)) is not None}
        object.__setattr__(self, "_given", MappingProxyType(dict(given_settings(given, str))))

    @property
    def given(self) -> Mapping[str, Written]:
        """The values that are given, by key."""
        return self._given  # type: ignore[attr-defined]

    @property
    def values(self) -> Mapping[str, Written]:
        """The section: what is described, and the values that are given."""
        return {**dict([self.choice] if self.choice else []), **self.given}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and isinstance(other, Description) and other.values == self.values

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{key}={value!r}' for key, value in self.given.items())})"


class Body(Description):
    """A body: a family with its dimensions, or a file."""


class Material(Description):
    """A law of the material and its constants, or a rubber by its name."""

    density: str | None = None  #: "1130 kg/m^3"
    holds_between: Sequence[float] | None = None  #: smallest and largest stretch for which the law holds
    #: lost over stored energy of a vibration: a number, or {"value": 0.12, "from": "1 Hz", "to": "10 Hz"}
    loss_factor: float | Mapping[str, Written] | None = None
    relaxation: Sequence[Mapping[str, Written]] | None = None  #: branches such as {"g": 0.08, "tau": "0.9 s"}


def given_settings(given: Any, naming: Callable[[str], str] | None = None) -> list[tuple[str, Written]]:
    """The keys and values of `settings`, arrays as lists. Raises InputError, naming the key, for what is none."""
    if given is None:
        return []
    if not isinstance(given, Mapping):
        raise InputError('settings: give values by their keys, for example {"mesh.size": "6 mm"}')
    for key in given:
        if not isinstance(key, str):
            raise InputError(f'settings: {quoted(key)} is not a key; keys are texts such as "mesh.size"')
    return [(key, _setting(value, (naming or setting_name)(key))) for key, value in given.items()]


def setting_name(key: str) -> str:
    """One of the settings, as messages name it: settings["mesh.size"]."""
    return f'settings["{key}"]'


def _setting(value: Any, name: str) -> Any:
    entry = plain(value)
    if isinstance(entry, str | float | int):
        return entry
    if isinstance(entry, Mapping):
        return {key: _setting(inner, name) for key, inner in entry.items()}
    if isinstance(entry, Sequence) and not isinstance(entry, bytes | bytearray):
        return [_setting(inner, name) for inner in entry]
    raise InputError(f"{name}: {quoted(value)} is not allowed; give {_SETTING}")
