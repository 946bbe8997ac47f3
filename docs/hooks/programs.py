"""The page of an example program: its cells as text and code, converted by jupytext."""

from pathlib import Path

import jupytext


def program_page(path: Path) -> str:
    """The program in `path` as Markdown, with a line that says how it is run."""
    text = jupytext.writes(jupytext.read(path), fmt="md")
    body = text.rpartition("\n---\n")[2] if text.startswith("---") else text
    return f"{body.strip()}\n\nThe program is `examples/{path.name}`; `make examples` runs all of them.\n"
