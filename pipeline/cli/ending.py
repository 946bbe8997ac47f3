"""What every command shares: lines on the terminal, and one sentence with an exit status where it ends early."""

import errno
from collections.abc import Callable
from functools import wraps
from typing import NoReturn, ParamSpec

import rich.table
import typer
from rich.console import Console

from pipeline.store.result_folder import json_text
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.json_values import JsonObject
from pipeline.values.table import Table

P = ParamSpec("P")

#: columns beyond which no table goes
WIDEST = 400


#: a table with so many columns or more has less space between them
CLOSE = 10


def print_lines(*lines: str | Table) -> None:
    """Tables with rows, and sentences; a sentence is not broken into lines, and no number of a table is cut off."""
    console = Console()
    for line in lines:
        if isinstance(line, str):
            console.print(line, highlight=False, markup=False, soft_wrap=True)
        elif line:
            table = text_table(line)
            natural = console.measure(table, options=console.options.update(width=WIDEST)).maximum
            Console(width=max(console.width, natural)).print(table, highlight=False)


def text_table(of: Table) -> rich.table.Table:
    """A table for the terminal; a cell may have several lines, and columns without numbers begin at the left."""
    heads = [head.replace(" (", "\n(") for head in of.heads]
    padding = (0, 2 if len(heads) < CLOSE else 1, 0, 0)
    table = rich.table.Table(*heads, box=None, padding=padding, show_header=any(heads))
    table.caption, table.caption_justify = of.caption or None, "left"
    for number, column in enumerate(table.columns):
        column.justify = "left" if number in of.words else "right"
    for row in of.rows:
        table.add_row(*row)
    return table


def print_sentences(*sentences: str) -> None:
    """Sentences that a terminal breaks between words; in a file or a pipe each is one line."""
    console = Console()
    for sentence in sentences:
        console.print(sentence, highlight=False, markup=False, soft_wrap=not console.is_terminal)


def print_json(value: JsonObject) -> None:
    """One JSON object; NaN and infinity become null."""
    typer.echo(json_text(value), nl=False)


def with_sentences(command: Callable[P, None]) -> Callable[P, None]:
    """A command that ends with one sentence on stderr and the exit status of what went wrong."""

    @wraps(command)
    def ending(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except (Exception, KeyboardInterrupt) as failure:
            if (end := _ending_of(failure)) is None:
                raise
            _end(*end)

    return ending


_REPAIR = "`pneurod doctor` names the command that repairs the installation"
_CONTINUES = "finished results are kept, and the same command continues from there"


def _ending_of(failure: BaseException) -> tuple[str, int] | None:
    """The sentence and the exit status; None for what is no failure of the user, the machine or the run."""
    match failure:
        case KeyboardInterrupt():
            return f"interrupted; {_CONTINUES}", 130
        case MemoryError():
            return "the memory of this machine does not suffice; choose a larger mesh.size or fewer --jobs", 1
        case BrokenPipeError():
            return f"the output was closed; {_CONTINUES}", 1
        case OSError(errno=None) | ImportError():  # a library that could not be loaded
            return f"{failure}; {_REPAIR}", 1
        case OSError():
            file = f"{failure.filename}: " if failure.filename else ""
            return f"{file}{failure.strerror}; {_remedy(failure)}; finished results are kept", 1
        case RuntimeError() if "no locator available" in str(failure):  # numba's, when it finds no folder for its cache
            return "no folder for compiled kernels can be written; name one that can: NUMBA_CACHE_DIR=FOLDER", 1
    match failure:
        case InputError():
            return "\npneurod: ".join(failure.sentences), 2
        case RunFailed():
            return failure.brief, 1
    return None


def _remedy(failure: OSError) -> str:
    """What to do about a file that could not be read or written."""
    full = {errno.ENOSPC: "make room there", errno.EDQUOT: "make room there", errno.EFBIG: "allow larger files"}
    if failure.errno in full:
        return f"{full[failure.errno]} or give another --out, then the same command again"
    return "give a folder that can be written and files that can be read"


def _end(sentence: str, status: int) -> NoReturn:
    typer.echo(f"pneurod: {sentence}", err=True)
    raise typer.Exit(status) from None
