"""Markdown tables of numbers, and the marks between which a command writes them into a page.

<!-- made by: make exports -->

what the command writes

<!-- end -->
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
_MARKED = re.compile(r"(<!-- made by: (.+?) -->\n\n)(.*?)(\n\n<!-- end -->)", re.DOTALL)


class Made(NamedTuple):
    """A block of a page that a command makes."""

    page: Path
    command: str
    text: str


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table; the first column to the left, the others to the right."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def made(root: Path = ROOT) -> Iterator[Made]:
    """All marked blocks of README, the documentation and the studies in a copy of the repository."""
    for page in (
        root / "README.md",
        *sorted(path for name in ("docs", "studies") for path in (root / name).rglob("*.md")),
    ):
        for found in _MARKED.finditer(page.read_text(encoding="utf-8")):
            yield Made(page, found[2], found[3])


def write_made(command: str, text: str, root: Path = ROOT) -> None:
    """Put what a command made between its marks; the text outside them is not changed.

    LookupError: not exactly one page has a block of this command.
    """
    pages = [block.page for block in made(root) if block.command == command]
    if len(pages) != 1:
        raise LookupError(f"{command} has {len(pages)} blocks on the pages, not one")
    page = pages[0].read_text(encoding="utf-8")

    def renewed(mark: re.Match[str]) -> str:
        return mark[1] + text.strip("\n") + mark[4] if mark[2] == command else mark[0]

    pages[0].write_text(_MARKED.sub(renewed, page), encoding="utf-8")
