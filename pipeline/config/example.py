"""A commented configuration to start from, written from the schema: every key with its unit, default and range."""

from fem.materials import LAWS
from geometry import FAMILIES, CadFile
from pipeline.config.reference import REQUIRED, KeyEntry, effect_keys, general_keys, geometry_keys, material_keys
from pipeline.config.schema import OWN

#: bodies for which there is a file
BODIES = (*FAMILIES, OWN)
#: the optional keys that stand in the file without a comment mark
_SHOWN = ("pressures", "mesh.size")
_WIDTH = 34


def example(family: str) -> str:
    """The text of a configuration of a body family. Raises KeyError for another name."""
    *others, last = LAWS
    design = CadFile if family == OWN else FAMILIES[family]
    general = {entry.key: entry for entry in general_keys()}
    lines = [
        f"# A design of the family {family} for pneurod. Behind each value: what it means; its unit; what is allowed.",
        "# A line that begins with '# ' and a key is optional; it shows the default, or an example if there is none.",
        "",
        f"name: my_{family}",
        "",
        "geometry:",
        f"  family: {family}",
        *(_line(entry, "  ", live="list" not in entry.allowed) for entry in geometry_keys(design)),
        "",
        "material:",
        f"  {'law: svk':<{_WIDTH}}# {', '.join(others)} or {last}, each with its own constants",
        *(_line(entry, "  ", live=True) for entry in material_keys("svk")),
        "",
        _line(general.pop("pressures"), "", live=True),
        "",
    ]
    del general["name"]
    sections: dict[str, list[KeyEntry]] = {}
    for entry in [*general.values(), *effect_keys_in_section()]:
        sections.setdefault(entry.key.rpartition(".")[0], []).append(entry)
    for section, entries in sections.items():
        lines += [*_section(section, entries), ""]
    text = "\n".join(lines).rstrip() + "\n"
    return text if family == OWN else text.replace("{cavity: 1}", f"{{{FAMILIES[family]().cavities[0]}: 1}}")


#: states of effects that auto leaves out: their sections act once they are no comments any more
_SWITCHED_ON = ("effects.gravity.state", "effects.strain_limiting_layer.state")


def effect_keys_in_section() -> list[KeyEntry]:
    """The keys of the effects below `effects`."""
    return [KeyEntry(f"effects.{e.key}", e.unit, e.allowed, e.default, e.meaning, e.example) for e in effect_keys()]


def _section(name: str, entries: list[KeyEntry]) -> list[str]:
    """The keys of a section, one line each; all of a section without a live key are comments."""
    live = [entry.key in _SHOWN or entry.default == REQUIRED for entry in entries]
    names = name.split(".") if name else []
    mark = "" if any(live) or not name else "# "
    head = [f"{mark}{'  ' * depth}{part}:" for depth, part in enumerate(names)]
    if names[:1] == ["effects"]:
        head = head[1:] if names[1] != "pressure" else head
    indent = "  " * len(names)
    return [*head, *(_line(entry, indent, live=shown) for entry, shown in zip(entries, live, strict=True))]


def _line(entry: KeyEntry, indent: str, *, live: bool) -> str:
    """A key with its value, and a comment."""
    value = entry.example if entry.default in (REQUIRED, "none") else entry.default
    value = "on" if entry.key in _SWITCHED_ON else value
    text = f"{'' if live else '# '}{indent}{entry.key.rpartition('.')[2]}: {value}"
    facts = [entry.plain_meaning, entry.unit if entry.unit != "1" else "", entry.allowed.replace("`", "")]
    return f"{text:<{_WIDTH + len(indent)}}  # {'; '.join(filter(None, facts))}"
