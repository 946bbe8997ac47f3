"""Numbers of the pages are those of commands: blocks between marks name a command that exists, and it prints them."""

import importlib.util
import math
import re
import sys
from pathlib import Path

import pytest

from benchmarks.markdown import made, write_made
from pipeline.cli import app

HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE / "docs" / "hooks"))
try:
    import printed
finally:
    sys.path.pop(0)

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def unit_of(number: str) -> float:
    """One in the last digit of a printed number, of the second one where it has fewer."""
    value = abs(float(number))
    mantissa, _, power = number.partition("e")
    last = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
    return min(last, 10.0 ** (math.floor(math.log10(value)) - 1)) if value else last


def check(block: printed.Made, now: str) -> None:
    """The same words, and numbers that differ by one in their last digit at most."""
    words = [re.sub(r"[\s-]+", " ", NUMBER.sub("#", text)) for text in (block.text, now)]
    assert words[1] == words[0], block.command
    for old, new in zip(NUMBER.findall(block.text), NUMBER.findall(now), strict=True):
        assert float(new) == pytest.approx(float(old), abs=1.01 * unit_of(old)), f"{block.command}: {old}, now {new}"


def test_every_block_has_a_command_that_exists() -> None:
    targets = re.findall(r"^([a-z-]+):", (HERE / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    registered = [command.name or command.callback.__name__ for command in app.registered_commands]
    commands = [block.command for block in made()]
    assert len(commands) == len(set(commands)) > 10
    for command in commands:
        program, *words = command.split()
        if program == "python":
            assert words[0] == "-m", command
            assert importlib.util.find_spec(words[1]), command
        else:
            assert words[0] in {"make": targets, "pneurod": registered}[program], command


def test_a_mark_that_begins_has_an_end() -> None:
    pages = [HERE / "README.md", *(path for room in ("docs", "studies") for path in (HERE / room).rglob("*.md"))]
    texts = [page.read_text(encoding="utf-8") for page in pages]
    for mark in ("<!-- made by: ", "<!-- end -->"):
        assert sum(text.count(mark) for text in texts) == len(list(made()))


def test_a_command_writes_its_block_and_nothing_else(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("before\n\n<!-- made by: make a -->\n\nold\n\n<!-- end -->\n\nbetween\n\n", encoding="utf-8")
    write_made("make a", "    new\n", tmp_path)
    assert page.read_text(encoding="utf-8") == (
        "before\n\n<!-- made by: make a -->\n\n    new\n\n<!-- end -->\n\nbetween\n\n"
    )
    with pytest.raises(LookupError, match="make b has 0 blocks"):
        write_made("make b", "new", tmp_path)


@pytest.mark.parametrize("quick", [True, pytest.param(False, marks=pytest.mark.slow)], ids=["quick", "all"])
def test_commands_print_what_the_pages_say(quick: bool, tmp_path: Path) -> None:
    """With the law that is kept in tests/data, which `pneurod cell configs/pneunet_coarse.yaml` measured."""
    blocks = list(printed.all_printed(tmp_path, quick))
    assert len(blocks) >= 3
    for block, now in blocks:
        check(block, now)
