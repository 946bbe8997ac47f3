"""What tells about the installation: the command doctor and the option --version."""

from typing import Annotated

import typer

from pipeline.commands.ending import errors_as_sentences, print_lines
from pipeline.errors import RunFailed


def _print_version(requested: bool) -> None:
    if requested:
        from importlib.metadata import version

        print_lines(f"pneurod {version('pneurod')}")
        raise typer.Exit


def show_version(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="The version of pneurod.")
    ] = False,
) -> None:
    """The options of `pneurod` itself."""


def doctor() -> None:
    """What is installed, what is missing, and the one command that installs it. Nothing is installed or changed.

    It compares the version of every package with the one that is required, meshes one chamber, draws a picture, solves
    two equations, starts the threads and writes a file that it removes again.
    """
    with errors_as_sentences():
        print_lines(
            "Checked are the versions of Python and of all packages, a mesh, a picture, the solver of linear "
            "equations, threads and the disk. Nothing is installed or changed; this takes about ten seconds."
        )
        from rich.table import Table

        from pipeline.doctor import examine, remedy

        findings = examine()
        table = Table("", "checked", "result", box=None, pad_edge=False)
        for finding in findings:
            table.add_row("[green]ok[/]" if finding.sound else "[red]no[/]", finding.subject, finding.result)
        print_lines(table)
        command = remedy(findings)
        if command:
            raise RunFailed(f"something is missing; to mend it: {command}")
        print_lines("everything pneurod needs is here")
