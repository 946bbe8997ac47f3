"""A commented configuration to start from: the keys that a design needs, or every key, with units and ranges."""

from collections.abc import Iterator
from dataclasses import replace

from fem.materials import LAWS
from geometry import FAMILIES
from pipeline.config.body import BODIES, OWN, design_class
from pipeline.config.reference import REQUIRED, KeyEntry, effect_keys, general_keys, geometry_keys, material_keys
from pipeline.config.rubbers import RUBBERS
from pipeline.config.section import not_known
from pipeline.values.errors import InputError

_WIDTH = 34


#: the rubber of the file, and pressures that it bears
RUBBER, PRESSURES, VALIDATION = "dragon_skin_30", "[2 kPa, 8 kPa, 14 kPa]", "[11 kPa]"
#: keys that are shown though most designs do without them: thread about the arm, and a sheet in it
OFFERED = ("effects.hoops.state", "effects.hoops.threads", "effects.strain_limiting_layer.state")
#: of neo-Hooke's law, for the file with every key
MODULUS = "0.2 MPa"


def example(family: str, *, every: bool = False) -> str:
    """The text of a configuration of a body family, with every key or those of most designs.

    Raises InputError for another name.
    """
    if family not in BODIES:
        raise InputError(f"FAMILY: {not_known(family, BODIES)}")
    own = family == OWN
    lines = [
        f"# A design of the family {family} for pneurod. Behind each value: what it means; its unit; what is allowed.",
        *(_ABOUT_ALL if every else [f"# These keys suffice; `pneurod init {family} --all` writes every key."]),
        *(["# The geometry has the keys of a CAD file; a mesh or a surface has others (docs/configuration.md)."] * own),
    ]
    above: tuple[str, ...] = ()
    for entry, live in _entries(family) if every else _first_entries(family):
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


_ABOUT_ALL = (
    "# A line that begins with '# ' and a key is optional and shows the default. Where there is no value to show,",
    "# the line has an example and says so.",
)


def _first_entries(family: str) -> Iterator[tuple[KeyEntry, bool]]:
    """The keys of most designs: those that stand without a comment mark, with a rubber by name."""
    names = f"one of {', '.join(RUBBERS)}; or law and its constants"
    for entry, live in _entries(family):
        if entry.key == "material.law":
            yield KeyEntry("material.name", "", names, REQUIRED, "constants of a published test", RUBBER), True
        elif (live and not entry.key.startswith("material.")) or entry.key in OFFERED:
            yield entry, live


def _entries(family: str) -> Iterator[tuple[KeyEntry, bool]]:
    """All keys in the order of the file, and whether they stand in it without a comment mark."""
    own, general = family == OWN, {entry.key: entry for entry in general_keys()}
    law = f"{', '.join(LAWS)}, each with its own constants; or name: {RUBBER} and others instead"
    yield replace(general.pop("name"), example=f"my_{family}"), True
    yield KeyEntry("geometry.family", "", "", REQUIRED, "", family), True
    for entry in geometry_keys(design_class(family, "")):
        live = entry.default == REQUIRED if own else entry.default != "none"
        yield replace(entry, key=f"geometry.{entry.key}"), live
    yield KeyEntry("material.law", "", law, REQUIRED, "", "neo_hooke"), True
    for entry in material_keys("neo_hooke"):
        shown = replace(entry, example=MODULUS) if entry.key == "mu" else entry
        yield replace(shown, key=f"material.{entry.key}"), entry.key in ("mu", "density")
    if own or FAMILIES[family]().region_volumes:
        yield general["materials"], False
    yield replace(general.pop("pressures"), default="none", example=PRESSURES), True
    for entry in [*general.values(), *effect_keys()]:
        if entry.key not in ("geometry", "material", "materials"):
            shown = replace(entry, example=VALIDATION) if entry.key == "validation.pressures" else entry
            yield shown, entry.key == "mesh.size" and not own


def _line(entry: KeyEntry, key: str, *, live: bool) -> str:
    """A key with its value, and a comment."""
    value = entry.example if entry.default in (REQUIRED, "none") else entry.default
    note = {REQUIRED: "required", "none": "an example"}.get(entry.default, "")
    facts = [entry.plain_meaning, entry.unit if entry.unit != "1" else "", entry.allowed.replace("`", ""), note]
    return f"{'' if live else '# '}{f'{key}: {value}':<{_WIDTH + 4}}  # {'; '.join(filter(None, facts))}"
