"""Blocks of the pages that commands of the program print, with the law that is kept in tests/data.

`python docs/hooks/printed.py` writes what stands between `<!-- made by: pneurod ... -->` and `<!-- end -->`; a test
compares them. Commands run in the order of the pages, in a folder with the files
that the pages say to save, such as `arm.csv`.
"""

import gzip
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

from typer.testing import CliRunner

HERE = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(HERE))
try:
    from benchmarks.markdown import Made, made, write_made
    from pipeline.cli import app
finally:
    sys.path.pop(0)

KEPT = HERE / "tests" / "data" / "pneunet_coarse_cell"
#: a file that a page shows: its name is the last one before the block of code
_SHOWN = re.compile(r"`(\w+\.(?:csv|yaml))`(?: beside it)?:\n\n((?:    [^\n]*\n)+)")
#: a line about what is being solved or tried
_PROGRESS = re.compile(r"^(stage|experiment .*|note: \d+\. \w+): |\(\d+\.\d s\)$|; about .* left$")
#: commands that take a minute, and what needs their results
LONG = ("pneurod calibrate ", "pneurod design ", "pneurod compare results/my_arm ")


def blocks() -> list[Made]:
    """Those of commands of the program."""
    return [block for block in made() if block.command.startswith("pneurod ")]


def prepare(folder: Path) -> None:
    """Put the kept law, the configurations, the files of the pages and a drawn arm into a folder."""
    cell = folder / "results" / KEPT.name
    cell.mkdir(parents=True)
    (cell / "law.json").write_bytes(gzip.decompress((KEPT / "law.json.gz").read_bytes()))
    shutil.copyfile(KEPT / "run.json", cell / "run.json")
    (folder / "configs").symlink_to(HERE / "configs")
    for page in {block.page for block in blocks()}:
        for name, rows in _SHOWN.findall(page.read_text(encoding="utf-8")):
            (folder / name).write_text(re.sub(r"^    ", "", rows, flags=re.MULTILINE), encoding="utf-8")
    printed("pneurod init semicircular", folder)


def printed(command: str, folder: Path) -> str:
    """What a command prints in a folder, without its progress, as a block of code.

    RuntimeError: it does not end with status 0.
    """
    with chdir(folder):
        ended = CliRunner().invoke(app, shlex.split(command)[1:], env={"COLUMNS": "120"})
    if ended.exit_code:
        raise RuntimeError(f"{command}: {ended.output}")
    lines = [line.rstrip() for line in ended.stdout.strip("\n").split("\n") if not _PROGRESS.search(line)]
    return "\n".join(f"    {line}" if line else "" for line in lines)


def all_printed(folder: Path, quick: bool) -> Iterator[tuple[Made, str]]:
    """Each block with what its command prints now; quick: without those of commands that take a minute."""
    prepare(folder)
    for block in blocks():
        if not (quick and block.command.startswith(LONG)):
            yield block, printed(block.command, folder)


if __name__ == "__main__":
    with TemporaryDirectory() as temporary:
        for old, new in all_printed(Path(temporary), quick=False):
            write_made(old.command, new)
            sys.stdout.write(f"{old.page.name}: {old.command}\n")
