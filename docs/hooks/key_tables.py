"""The tables of the page of all keys, from the sections of a configuration.

`python docs/hooks/key_tables.py docs/configuration.md` writes them between the lines `<!-- keys: NAME -->` and
`<!-- end of keys -->`; a test compares them.
"""

import re
import sys
from pathlib import Path

from fem.materials import LAWS
from pipeline.config.body import DESIGNS
from pipeline.config.reference import REQUIRED, KeyEntry, effect_keys, general_keys, geometry_keys, material_keys
from pipeline.config.rubbers import FORMS, RUBBERS

_MARKED = re.compile(r"<!-- keys: (\w+) -->\n.*?<!-- end of keys -->", re.DOTALL)


def _cell(text: str) -> str:
    """A default in a table."""
    return text if text in (REQUIRED, "none") else f"`{text}`"


def key_table(entries: list[KeyEntry]) -> str:
    """The keys as a Markdown table."""
    lines = ["| key | unit | allowed | default | meaning |", "|---|---|---|---|---|"]
    lines += [f"| `{e.key}` | {e.unit} | {e.allowed} | {_cell(e.default)} | {e.meaning} |" for e in entries]
    return "\n".join(lines)


def _material_table() -> str:
    """One row per key of all laws, with the laws that take it."""
    rows: dict[tuple[str, ...], list[str]] = {}  # the laws by what stands in the other columns
    for law in LAWS:
        for entry in material_keys(law):
            rows.setdefault((entry.key, entry.unit, entry.allowed, entry.meaning), []).append(law)
    lines = ["| key | unit | allowed | laws | meaning |", "|---|---|---|---|---|"]
    lines.append(f"| `law` | | {_listed(list(LAWS))} | all | law of the solid ([materials](materials.md)) |")
    named = "a [rubber with known constants](materials.md#rubbers-by-name), instead of `law` and its constants"
    lines.append(f"| `name` | | {_listed(list(RUBBERS))} | all | {named} |")
    form = (
        "whose constants these are: before the powers of Ogden's law μ/α (`ogden`, `ansys`), 2 μ/α² (`abaqus`) or μ/α² "
        "(`febio`); `g` of `relaxation` are parts of the modulus at once with `abaqus` and `ansys`"
    )
    lines.append(f"| `form` | | {_listed(list(FORMS))} | all | {form} |")
    for (key, unit, allowed, meaning), laws in rows.items():
        names = "all" if len(laws) == len(LAWS) else _listed(laws)
        lines.append(f"| `{key}` | {unit} | {allowed} | {names} | {meaning} |")
    return "\n".join(lines)


def _listed(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def tables() -> dict[str, str]:
    """The tables of the page by name."""
    return {
        "general": key_table(general_keys()),
        "material": _material_table(),
        "effects": key_table(effect_keys()),
        **{name: key_table(geometry_keys(design)) for name, design in DESIGNS.items()},
    }


def with_tables(page: str) -> str:
    """A page with its tables as the sections give them."""
    current = tables()
    return _MARKED.sub(lambda m: f"<!-- keys: {m[1]} -->\n\n{current[m[1]]}\n\n<!-- end of keys -->", page)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(with_tables(target.read_text(encoding="utf-8")), encoding="utf-8")
