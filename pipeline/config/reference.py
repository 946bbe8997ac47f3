"""Every key of a configuration with its unit, what is allowed, its default and its meaning, read from the schema.

The meaning of a key is the comment beside it in `pipeline/config/schema.py` or in the class of the body.
`python -m pipeline.config.reference docs/configuration.md` writes the tables of that page, between the lines
`<!-- keys: NAME -->` and `<!-- end of keys -->`; a test compares them.
"""

import inspect
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, get_args, get_type_hints

from fem.materials import LAWS
from geometry import FAMILIES, CadFile, MeshFile, SurfaceFile
from pipeline.config import schema
from pipeline.config.kinds import Written

#: the keys of a material beside the constants of its law
MATERIAL = {
    "law": "law of the solid ([materials](materials.md))",
    "density": "mass per volume; for gravity, the mass of the arm and M/(m g l), which are left out without it",
    "holds_between": "smallest and largest stretch for which the law describes the solid, as `pneurod material` writes "
    "them; beyond them a run says so",
    "nu": "Poisson's ratio, which can be given instead of `kappa`",
}
REQUIRED = "required"
_MARKED = re.compile(r"<!-- keys: (\w+) -->\n.*?<!-- end of keys -->", re.DOTALL)
_COMMENT = re.compile(r"^    (\w+): [^#\n]*  #: (.*)$", re.MULTILINE)
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


@dataclass(frozen=True)
class KeyEntry:
    """One key of the YAML file."""

    key: str  #: dotted, below its section
    unit: str
    allowed: str
    default: str  #: as it is written in YAML; REQUIRED, or none
    meaning: str  #: Markdown
    example: str  #: as it is written in YAML

    @property
    def plain_meaning(self) -> str:
        """The meaning without links and code marks."""
        return _LINK.sub(r"\1", self.meaning).replace("`", "")


#: the sections whose keys depend on the family of the body and on the law
SECTIONS = (
    KeyEntry("geometry", "", "a section", REQUIRED, "`family` of the body and its [dimensions](#geometry)", "{}"),
    KeyEntry("material", "", "a section", REQUIRED, "`law` of the material and its [constants](#material)", "{}"),
    KeyEntry(
        schema.MATERIALS,
        "",
        "a section for each region",
        "none",
        "[regions](#a-base-of-another-material) of another material than the rest of the body",
        "{base: {law: svk, E: 5 MPa, nu: 0.495, density: 1130 kg/m^3}}",
    ),
)


def general_keys() -> list[KeyEntry]:
    """All keys outside of the effects, those of geometry and materials as sections alone."""
    sections = {
        "end": schema._End,
        "identification": schema._Identification,
        "mesh": schema._Mesh,
        "validation": schema._Validation,
        "newton": schema._Newton,
    }
    entries = []
    for entry in _entries(schema._Document, skip=(*sections, "effects")):
        entries.append(entry)
        if entry.key == "name":
            entries += SECTIONS
        if entry.key == "pressures":
            entries += [e for name in ("end", "mesh") for e in _entries(sections[name], f"{name}.")]
    return entries + [
        e for name in ("newton", "identification", "validation") for e in _entries(sections[name], f"{name}.")
    ]


def effect_keys() -> list[KeyEntry]:
    """All keys of the effects."""
    sections = {name: field.annotation for name, field in schema._Effects.model_fields.items()}
    return [entry for name, section in sections.items() for entry in _entries(section, f"{name}.")]


def geometry_keys(design: Any) -> list[KeyEntry]:
    """The keys of a class of designs."""
    kinds, meanings = get_type_hints(schema.geometry_model(design), include_extras=True), _comments(design)
    drawn = design in FAMILIES.values()
    entries = []
    for field in fields(design):
        written = _written(kinds[field.name])
        length = "at least 0" if field.default == 0.0 else "above 0"
        allowed = length if drawn and written.allowed == "any" else written.allowed
        value = schema.default_of(field, REQUIRED)
        default = value if value == REQUIRED else _text(value, written.unit)
        example = _OWN_EXAMPLES[field.name] if default in (REQUIRED, "none") else default
        entries.append(KeyEntry(field.name, written.unit, allowed, default, meanings[field.name], example))
    return entries


def material_keys(law: str) -> list[KeyEntry]:
    """The keys of a material that obeys a law: its constants, and what every material has."""
    kinds, meanings = schema.material_model(law).__annotations__, LAWS[law].meanings()
    entries = []
    for name in [*kinds]:
        written = _written(kinds[name])
        optional = name not in meanings or (schema.BULK in kinds and name == schema.BULK)
        default = "none" if optional else REQUIRED
        meaning = meanings.get(name) or MATERIAL[name]
        example = _EXAMPLES.get(name) or _kind_example(kinds[name])
        entries.append(KeyEntry(name, written.unit, written.allowed, default, meaning, example))
    return [entry for entry in entries if entry.key != "law"]


#: values of the example file
_EXAMPLES = {
    "E": "1.2 MPa",
    "mu": "0.4 MPa",
    "kappa": "20 MPa",
    "holds_between": "[0.7, 1.9]",
    **schema.EXAMPLES,
}
_OWN_EXAMPLES = {
    "file": "finger.step",
    "clamp": "0 mm",
    "tip": "80 mm",
    "curve": "1 mm",
    "symmetric": "true",
    "air": "{cavity: [40 mm, 7 mm, 0 mm]}",
    "parts": "{base: [20 mm, 1 mm, 0 mm]}",
    "cell": "8 mm",
    "defeature": "0.1 mm",
    "chamber_lengths": f"[{', '.join(['8 mm'] * 11)}]",
    "chamber_heights": f"[{', '.join(['12 mm'] * 11)}]",
    "gaps": f"[{', '.join(['2 mm'] * 12)}]",
}


def _entries(section: Any, prefix: str = "", skip: tuple[str, ...] = ()) -> Iterator[KeyEntry]:
    kinds, meanings = get_type_hints(section, include_extras=True), _comments(section)
    for name, field in section.model_fields.items():
        if name in skip:
            continue
        written = _written(kinds[name])
        default = REQUIRED if field.is_required() else _text(field.default, written.unit)
        if field.default is None and "`auto`" in written.allowed:
            default = "auto"
        example = str(field.examples[0]) if field.examples else _kind_example(kinds[name]) or default
        yield KeyEntry(prefix + name, written.unit, written.allowed, default, meanings[name], example)


def _metadata(kind: Any, of: type) -> Any:
    """The last metadata of a class in a kind of value, also inside a union; None where there is none."""
    own = [value for value in getattr(kind, "__metadata__", ()) if isinstance(value, of)]
    return own[-1] if own else next(filter(None, (_metadata(inner, of) for inner in get_args(kind))), None)


def _written(kind: Any) -> Written:
    return _metadata(kind, Written) or Written("", "")


def _kind_example(kind: Any) -> str:
    info = _metadata(kind, type(schema.pydantic.Field(examples=[""])))
    return str(info.examples[0]) if info is not None and info.examples else ""


def _comments(section: Any) -> dict[str, str]:
    """The comments `#: ...` beside the fields of a class and of the classes it is derived from."""
    texts: dict[str, str] = {}
    for kind in reversed(section.__mro__):
        if kind.__module__.partition(".")[0] in ("pipeline", "geometry"):
            texts |= dict(_COMMENT.findall(inspect.getsource(kind)))
    return texts


def _text(value: Any, unit: str) -> str:
    """A default as it is written in YAML."""
    if value is None or value in ((), {}):
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return "[" + ", ".join(_text(entry, unit) for entry in value) + "]"
    if isinstance(value, float):
        scaled = value * 1e-3 if unit == "m/s²" else value
        number = re.sub(r"^(\d+)e-0?", r"\1.0e-", f"{scaled:g}")  # YAML reads 1e-6 as a text
        return f"{number} {unit.replace('²', '^2')}" if unit not in ("", "1") else number
    return str(value)


def _cell(text: str) -> str:
    """A default in a table."""
    return text if text in (REQUIRED, "none") else f"`{text}`"


def key_table(entries: list[KeyEntry], prefix: str = "") -> str:
    """The keys as a Markdown table."""
    lines = ["| key | unit | allowed | default | meaning |", "|---|---|---|---|---|"]
    for e in entries:
        lines.append(f"| `{prefix}{e.key}` | {e.unit} | {e.allowed} | {_cell(e.default)} | {e.meaning} |")
    return "\n".join(lines)


def _material_table() -> str:
    """One row per key of all laws, with the laws that take it."""
    rows = ["| key | unit | allowed | laws | meaning |", "|---|---|---|---|---|"]
    rows.append(f"| `law` | | {', '.join(f'`{law}`' for law in LAWS)} | all | {MATERIAL['law']} |")
    entries = {law: {entry.key: entry for entry in material_keys(law)} for law in LAWS}
    for key in dict.fromkeys(key for of_law in entries.values() for key in of_law):
        laws: dict[str, list[str]] = {}  # by what stands in the other columns
        for law in LAWS:
            if key in entries[law]:
                entry = entries[law][key]
                row = f"| `{key}` | {entry.unit} | {entry.allowed} | LAWS | {entry.meaning} |"
                laws.setdefault(row, []).append(law)
        for row, names in laws.items():
            rows.append(row.replace("LAWS", "all" if len(names) == len(LAWS) else ", ".join(f"`{n}`" for n in names)))
    return "\n".join(rows)


def tables() -> dict[str, str]:
    """The tables of the page by name."""
    bodies = {**FAMILIES, "own_cad": CadFile, "own_mesh": MeshFile, "own_surface": SurfaceFile}
    return {
        "general": key_table(general_keys()),
        "material": _material_table(),
        "effects": key_table(effect_keys(), "effects."),
        **{name: key_table(geometry_keys(design)) for name, design in bodies.items()},
    }


def with_tables(page: str) -> str:
    """A page with its tables as the schema gives them."""
    current = tables()
    return _MARKED.sub(lambda m: f"<!-- keys: {m[1]} -->\n\n{current[m[1]]}\n\n<!-- end of keys -->", page)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(with_tables(target.read_text(encoding="utf-8")), encoding="utf-8")
