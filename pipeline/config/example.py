"""A commented configuration to start from, written from the schema: every key with its unit, default and range."""

from dataclasses import fields

from fem.materials import LAWS
from geometry import FAMILIES, CadFile, MeshFile, SurfaceFile
from pipeline.config import schema
from pipeline.config.reference import (
    REQUIRED,
    SECTIONS,
    KeyEntry,
    effect_keys,
    general_keys,
    geometry_keys,
    material_keys,
)
from pipeline.config.schema import MATERIALS, OWN

#: bodies for which there is a file
BODIES = (*FAMILIES, OWN)
#: the optional keys outside of geometry and material that stand in the file of a family without a comment mark
_SHOWN = ("mesh.size",)
_WIDTH = 34


def example(family: str) -> str:
    """The text of a configuration of a body family. Raises KeyError for another name."""
    *others, last = LAWS
    design = CadFile if family == OWN else FAMILIES[family]
    general = {entry.key: entry for entry in general_keys()}
    lines = [
        f"# A design of the family {family} for pneurod. Behind each value: what it means; its unit; what is allowed.",
        "# A line that begins with '# ' and a key is optional and shows the default. Where there is no value to show,",
        "# the line has an example and says so.",
        *(_not_of_other_files() if family == OWN else ()),
        "",
        f"name: my_{family}",
        "",
        "geometry:",
        f"  family: {family}",
        *(_line(entry, "  ", live=_is_live(entry, family)) for entry in geometry_keys(design)),
        "",
        "material:",
        f"  {'law: svk':<{_WIDTH}}# {', '.join(others)} or {last}, each with its own constants",
        *(_line(entry, "  ", live=entry.key != "holds_between") for entry in material_keys("svk")),
        "",
        *([_line(general[MATERIALS], "", live=False), ""] if _has_regions(family) else ()),
        _line(general.pop("pressures"), "", live=True),
        "",
    ]
    for key in ("name", *(entry.key for entry in SECTIONS)):
        del general[key]
    sections: dict[str, list[KeyEntry]] = {}
    for entry in [*general.values(), *effect_keys_in_section()]:
        sections.setdefault(entry.key.rpartition(".")[0], []).append(entry)
    for section, entries in sections.items():
        lines += [*_section(section, entries, () if family == OWN else _SHOWN), ""]
    text = "\n".join(lines).rstrip() + "\n"
    return text if family == OWN else text.replace("{cavity: 1}", f"{{{FAMILIES[family]().cavities[0]}: 1}}")


#: states of effects that auto leaves out, so that the line shows `on`
_SWITCHED_ON = ("effects.gravity.state", "effects.strain_limiting_layer.state")


def _is_live(entry: KeyEntry, family: str) -> bool:
    """Whether a key of the geometry stands in the file without a comment mark."""
    return entry.default == REQUIRED if family == OWN else entry.default != "none"


def _has_regions(family: str) -> bool:
    """Whether parts of the body may be of another material."""
    return family == OWN or bool(FAMILIES[family]().region_volumes)


def _not_of_other_files() -> list[str]:
    """Comments that name the keys which a mesh and a surface do not have."""
    keys = {field.name for field in fields(CadFile)}
    of_mesh, of_filled, of_ready = (
        set(section.model_fields) for section in (schema._Mesh, schema._FilledMesh, schema._ReadyMesh)
    )
    without = {
        "a mesh of tetrahedra": (keys - {field.name for field in fields(MeshFile)}, of_mesh - of_ready),
        "a surface such as STL": (keys - {field.name for field in fields(SurfaceFile)}, of_mesh - of_filled),
    }
    return [
        "# These are the keys for a CAD file.",
        *(
            f"# The file of {what} has no {', '.join(f'geometry.{key}' for key in sorted(geometry))}, "
            f"{', '.join(f'mesh.{key}' for key in sorted(mesh))}."
            for what, (geometry, mesh) in without.items()
        ),
    ]


def effect_keys_in_section() -> list[KeyEntry]:
    """The keys of the effects below `effects`."""
    return [KeyEntry(f"effects.{e.key}", e.unit, e.allowed, e.default, e.meaning, e.example) for e in effect_keys()]


def _section(name: str, entries: list[KeyEntry], shown: tuple[str, ...]) -> list[str]:
    """The keys of a section, one line each; all of a section without a live key are comments."""
    live = [entry.key in shown for entry in entries]
    names = name.split(".") if name else []
    mark = "" if any(live) or not name else "# "
    head = [f"{mark}{'  ' * depth}{part}:" for depth, part in enumerate(names)]
    if names[:1] == ["effects"]:
        head = head[1:] if names[1] != "pressure" else head
    indent = "  " * len(names)
    return [*head, *(_line(entry, indent, live=is_live) for entry, is_live in zip(entries, live, strict=True))]


def _line(entry: KeyEntry, indent: str, *, live: bool) -> str:
    """A key with its value, and a comment."""
    value = entry.example if entry.default in (REQUIRED, "none") else entry.default
    note = {REQUIRED: "required", "none": "an example"}.get(entry.default, "")
    if entry.key in _SWITCHED_ON:
        value, note = "on", "the default is auto, which leaves it off"
    text = f"{'' if live else '# '}{indent}{entry.key.rpartition('.')[2]}: {value}"
    facts = [entry.plain_meaning, entry.unit if entry.unit != "1" else "", entry.allowed.replace("`", ""), note]
    return f"{text:<{_WIDTH + len(indent)}}  # {'; '.join(filter(None, facts))}"
