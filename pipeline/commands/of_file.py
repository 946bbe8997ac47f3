"""The command that writes a configuration to start from: init."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.ending import errors_as_sentences, print_lines
from pipeline.errors import InputError


def init(
    family: Annotated[
        str,
        typer.Argument(
            metavar="[FAMILY]", help="pneunet, semicircular, semicircular_single, bisected_circle, rectangular, own."
        ),
    ] = "pneunet",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="File to write (default: my_FAMILY.yaml).")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
) -> None:
    """A commented configuration to start from: every key with its unit, default and range."""
    with errors_as_sentences():
        from pipeline.config.body import BODIES
        from pipeline.config.example import example
        from pipeline.config.section import not_known
        from pipeline.store.atomic_file import write_atomic
        from pipeline.store.result_folder import open_file

        if family not in BODIES:
            raise InputError(f"FAMILY: {not_known(family, BODIES)}")
        file = out or Path(f"my_{family}.yaml")
        if file.exists() and not force:
            raise InputError(f"{file}: exists; give another --out, or --force to replace it")
        write_atomic(open_file(file), example(family).encode())
        print_lines(f"written: {file}; change it and check the body with `pneurod mesh {file}`")
