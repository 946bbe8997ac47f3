"""Every key of a configuration with its unit, what is allowed, its default and its meaning, read from its sections."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fem.materials import LAWS
from pipeline.config.body import geometry_section
from pipeline.config.config import Config
from pipeline.config.material import material_section
from pipeline.config.section import FieldInfo, Kind, Section, example_of, kind_of

REQUIRED = "required"
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


@dataclass(frozen=True)
class KeyEntry:
    """One key of the YAML file."""

    key: str  #: dotted
    unit: str
    allowed: str
    default: str  #: as it is written in YAML; REQUIRED, or none
    meaning: str  #: Markdown
    example: str  #: as it is written in YAML

    @property
    def plain_meaning(self) -> str:
        """The meaning without links and code marks."""
        return _LINK.sub(r"\1", self.meaning).replace("`", "")


def general_keys() -> list[KeyEntry]:
    """All keys outside of the effects, those of geometry and materials as sections alone."""
    return [entry for entry in _entries(Config) if not entry.key.startswith("effects.")]


def effect_keys() -> list[KeyEntry]:
    """All keys of the effects."""
    return [entry for entry in _entries(Config) if entry.key.startswith("effects.")]


def geometry_keys(design: Any) -> list[KeyEntry]:
    """The keys of a class of designs."""
    return [entry for entry in _entries(geometry_section(design)) if entry.key != "family"]


def material_keys(law: str) -> list[KeyEntry]:
    """The keys of a material that obeys a law."""
    return [entry for entry in _entries(material_section(LAWS[law])) if entry.key != "law"]


def _entries(keys: type[Section], prefix: str = "") -> Iterator[KeyEntry]:
    for key, field in keys.key_fields().items():
        written = next((kind.keys for kind in field.metadata if isinstance(kind, Kind)), field.annotation)
        if isinstance(written, type) and issubclass(written, Section):
            yield from _entries(written, f"{prefix}{key}.")
        else:  # a value, or a section whose keys depend on what is in it
            yield _entry(prefix + key, field)


def _entry(key: str, field: FieldInfo) -> KeyEntry:
    kind = kind_of(field)
    unit, allowed = (kind.unit, kind.allowed) if kind else ("", "")
    value = None if field.is_required() else field.get_default(call_default_factory=True)
    default = REQUIRED if field.is_required() else _text(value, unit)
    if value is None and default != REQUIRED and "`auto`" in allowed:
        default = "auto"
    needs_example = default in (REQUIRED, "none") or field.examples
    example = example_of(field) if needs_example else default
    return KeyEntry(key, unit, allowed, default, field.description or "", example)


def _text(value: Any, unit: str) -> str:
    """A default as it is written in YAML."""
    if value in (None, (), {}, ""):
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if unit == "mm or N":  # along one axis
        return "none" if value[0] is None else f"{value[0]:g} mm"
    if isinstance(value, tuple):
        return "[" + ", ".join(_text(entry, unit) for entry in value) + "]"
    if isinstance(value, float):
        scaled = value * {"m/s²": 1e-3, "%": 100.0}.get(unit, 1.0)
        number = re.sub(r"^(\d+)e-0?", r"\1.0e-", f"{scaled:g}")  # YAML reads 1e-6 as a text
        return f"{number} {unit.replace('²', '^2')}" if unit not in ("", "1") else number
    return str(value)
