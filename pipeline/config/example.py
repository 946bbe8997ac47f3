"""A commented configuration to start from, written from the schema: every key with its unit, default and range."""

from fem.materials import LAWS
from geometry import FAMILIES, CadFile, MeshFile, SurfaceFile
from pipeline.config.automatic_mesh import NO_KEYS
from pipeline.config.body import OWN
from pipeline.config.reference import REQUIRED, KeyEntry, effect_keys, general_keys, geometry_keys, material_keys

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
        *([_line(general["materials"], "", live=False), ""] if _has_regions(family) else ()),
        _line(general.pop("pressures"), "", live=True),
        "",
    ]
    for key in ("name", "geometry", "material", "materials"):
        del general[key]
    sections: dict[str, list[KeyEntry]] = {}
    for entry in [*general.values(), *effect_keys()]:
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
    keys = {entry.key for entry in geometry_keys(CadFile)}
    lines = ["# These are the keys for a CAD file."]
    for what, design in {"a mesh of tetrahedra": MeshFile, "a surface such as STL": SurfaceFile}.items():
        missing = sorted(f"geometry.{key}" for key in keys - {entry.key for entry in geometry_keys(design)})
        missing += sorted(f"mesh.{key}" for key in NO_KEYS[design])
        lines.append(f"# The file of {what} has no {', '.join(missing)}.")
    return lines


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
