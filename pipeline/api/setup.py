"""Before the first run: a configuration to start from, and the installation."""

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.api.course import given_choice, given_path
from pipeline.store.atomic_file import write_atomic
from pipeline.store.result_folder import open_file
from pipeline.values.errors import InputError, RunFailed, argument

if TYPE_CHECKING:
    from pipeline.doctor import Finding

__all__ = ["doctor", "init"]


def init(
    family: Annotated[str, typer.Argument(metavar="[FAMILY]")] = "pneunet",
    out: Annotated[Path | str | None, typer.Option("--out", metavar="FILE", help="(default: my_FAMILY.yaml).")] = None,
    *,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
    every: Annotated[bool, typer.Option("--all", help="With every key, its default and its range.")] = False,
) -> Path:
    """Write a commented configuration to start from: a body, a rubber by name and pressures.

    Raises `pneurod.InputError` for another family and a file that exists.
    """
    from pipeline.config.example import example

    text = example(family, every=given_choice(every, "every"))
    file = Path(f"my_{family}.yaml") if out is None else given_path(out, "out", "arm.yaml")
    if file.exists() and not given_choice(force, "force"):
        raise InputError(f"{file}: exists; give another {argument('out')}, or {argument('force', True)} to replace it")
    write_atomic(open_file(file), text.encode())
    return file


def checks() -> ModuleType:
    """The checks of the installation: only who asks for them waits for their libraries."""
    import pipeline.doctor as checks

    return checks


def doctor() -> "tuple[Finding, ...]":
    """Check what is installed, what is missing, and the one command that installs it. Nothing is installed or changed.
    It compares the version of every package with the one that is required, meshes one chamber, draws a picture, solves
    two equations, starts the threads and writes a file that it removes again.

    Raises `pneurod.RunFailed` where something is missing.
    """
    findings = tuple(checks().examine())
    if command := checks().remedy(findings):
        raise RunFailed(f"something is missing; to mend it: {command}").with_reached(findings)
    return findings
