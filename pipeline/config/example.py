"""A commented configuration to start from: every key with its unit, default and range."""

from collections.abc import Iterator
from dataclasses import replace

from fem.materials import LAWS
from geometry import FAMILIES
from pipeline.config.body import OWN, design_class
from pipeline.config.reference import REQUIRED, KeyEntry, effect_keys, general_keys, geometry_keys, material_keys

_WIDTH = 34


def example(family: str) -> str:
    """The text of a configuration of a body family. Raises KeyError for another name."""
    own = family == OWN
    lines = [
        f"# A design of the family {family} for pneurod. Behind each value: what it means; its unit; what is allowed.",
        "# A line that begins with '# ' and a key is optional and shows the default. Where there is no value to show,",
        "# the line has an example and says so.",
        *(["# The geometry has the keys of a CAD file; a mesh or a surface has others (docs/configuration.md)."] * own),
    ]
    above: tuple[str, ...] = ()
    for entry, live in _entries(family):
        *names, key = entry.key.split(".")
        if tuple(names[:1]) != above[:1] or not names:
            lines.append("")
        mark = "" if live or names[:1] in (["geometry"], ["material"]) or (names == ["mesh"] and not own) else "# "
        for depth, name in enumerate(names):
            if tuple(names[: depth + 1]) != above[: depth + 1]:
                lines.append(f"{mark}{'  ' * depth}{name}:")
        above = tuple(names)
        lines.append(_line(entry, "  " * len(names) + key, live=live))
    text = "\n".join(lines) + "\n"
    return text if own else text.replace("{cavity: 1}", f"{{{FAMILIES[family]().cavities[0]}: 1}}")


def _entries(family: str) -> Iterator[tuple[KeyEntry, bool]]:
    """All keys in the order of the file, and whether they stand in it without a comment mark."""
    own, general = family == OWN, {entry.key: entry for entry in general_keys()}
    law = ", ".join(LAWS) + ", each with its own constants"
    yield replace(general.pop("name"), example=f"my_{family}"), True
    yield KeyEntry("geometry.family", "", "", REQUIRED, "", family), True
    for entry in geometry_keys(design_class(family, "")):
        live = entry.default == REQUIRED if own else entry.default != "none"
        yield replace(entry, key=f"geometry.{entry.key}"), live
    yield KeyEntry("material.law", "", law, REQUIRED, "", "svk"), True
    for entry in material_keys("svk"):
        yield replace(entry, key=f"material.{entry.key}"), entry.key != "holds_between"
    if own or FAMILIES[family]().region_volumes:
        yield general["materials"], False
    yield general.pop("pressures"), True
    for entry in [*general.values(), *effect_keys()]:
        if entry.key not in ("geometry", "material", "materials"):
            yield entry, entry.key == "mesh.size" and not own


def _line(entry: KeyEntry, key: str, *, live: bool) -> str:
    """A key with its value, and a comment."""
    value = entry.example if entry.default in (REQUIRED, "none") else entry.default
    note = {REQUIRED: "required", "none": "an example"}.get(entry.default, "")
    facts = [entry.plain_meaning, entry.unit if entry.unit != "1" else "", entry.allowed.replace("`", ""), note]
    return f"{'' if live else '# '}{f'{key}: {value}':<{_WIDTH + 4}}  # {'; '.join(filter(None, facts))}"
