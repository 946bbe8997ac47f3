"""What every command shares: lines on the terminal, and one sentence with an exit status where it ends early."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NoReturn

import typer
from rich.console import Console, RenderableType

from pipeline.errors import InputError, RunFailed

if TYPE_CHECKING:
    from pipeline.store.json_values import JsonObject


#: columns beyond which no table goes
WIDEST = 400


def print_lines(*lines: RenderableType) -> None:
    """Tables and sentences; a sentence is not broken into lines, and no number of a table is cut off."""
    console = Console()
    for line in lines:
        if isinstance(line, str):
            console.print(line, highlight=False, markup=False, soft_wrap=True)
        else:
            natural = console.measure(line, options=console.options.update(width=WIDEST)).maximum
            Console(width=max(console.width, natural)).print(line, highlight=False)


def print_sentences(*sentences: str) -> None:
    """Sentences that a terminal breaks between words; in a file or a pipe each is one line."""
    console = Console()
    for sentence in sentences:
        console.print(sentence, highlight=False, markup=False, soft_wrap=not console.is_terminal)


def print_json(value: "JsonObject") -> None:
    """One JSON object; NaN and infinity become null."""
    from pipeline.store.result_folder import json_text

    typer.echo(json_text(value), nl=False)


@contextmanager
def errors_as_sentences() -> Iterator[None]:
    """End with one sentence on stderr and the exit status of what went wrong."""
    try:
        yield
    except InputError as failure:
        _end("\npneurod: ".join(failure.sentences), 2)
    except RunFailed as failure:
        _end(failure.brief, 1)
    except KeyboardInterrupt:
        _end("interrupted; finished results are kept, and the same command continues from there", 130)
    except MemoryError:
        _end("the memory of this machine does not suffice; choose a larger mesh.size or fewer --jobs", 1)
    except BrokenPipeError:
        _end("the output was closed; finished results are kept, and the same command continues from there", 1)
    except OSError as failure:
        if failure.errno is None:  # a library that could not be loaded
            _end(f"{failure}; `pneurod doctor` names the command that repairs the installation", 1)
        file = f"{failure.filename}: " if failure.filename else ""
        _end(f"{file}{failure.strerror}; {_remedy(failure)}; finished results are kept", 1)
    except RuntimeError as failure:
        if "no locator available" not in str(failure):  # numba's message when it finds no folder for its cache
            raise
        _end("no folder for compiled kernels can be written; name one that can: NUMBA_CACHE_DIR=FOLDER", 1)
    except ImportError as failure:
        _end(f"{failure}; `pneurod doctor` names the command that repairs the installation", 1)


def _remedy(failure: OSError) -> str:
    """What to do about a file that could not be read or written."""
    full = {errno.ENOSPC: "make room there", errno.EDQUOT: "make room there", errno.EFBIG: "allow larger files"}
    if failure.errno in full:
        return f"{full[failure.errno]} or give another --out, then the same command again"
    return "give a folder that can be written and files that can be read"


def _end(sentence: str, status: int) -> NoReturn:
    typer.echo(f"pneurod: {sentence}", err=True)
    raise typer.Exit(status) from None
