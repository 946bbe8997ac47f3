"""The command line: the functions of `pipeline.api`, whose values it prints.

Exit status 0 done, 1 failed, 2 wrong input, 130 interrupted. The functions import everything heavy inside themselves,
so that `pneurod --help` answers at once.
"""

import inspect
import os
import signal
import sys
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer
from rich.console import Console
from typer.core import TyperCommand
from typer.models import ParameterInfo

from pipeline.api import measured, rods, runs, setup, studies
from pipeline.cli.ending import print_lines, with_sentences
from pipeline.cli.shown import (
    show_accuracy,
    show_budget,
    show_calibration,
    show_cell,
    show_comparison,
    show_design,
    show_effects,
    show_export,
    show_file,
    show_findings,
    show_material,
    show_mesh,
    show_results,
    show_shape,
    show_solutions,
    show_sweep,
)

if TYPE_CHECKING:
    from pipeline.api.results import Results
    from pipeline.doctor import Finding
    from pipeline.store.progress import Progress
    from pipeline.study.pairs.run import PairRuns

app = typer.Typer(
    help="From the drawing of a pneumatic soft actuator to a rod model with quantified errors.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


class Init(TyperCommand):
    """`init`, which has the families in its help: they are known only when the geometry is loaded."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """The help with the families of bodies."""
        from pipeline.config.body import BODIES

        for parameter in self.params:
            if parameter.name == "family":
                parameter.help = f"{', '.join(BODIES)}."  # type: ignore[attr-defined]
        super().format_help(ctx, formatter)


def add(function: Callable[..., Any], show: Callable[..., None], name: str = "", cls: Any = None) -> None:
    """Add the command of a function: its arguments with an option are read, and its value is shown.

    show: see `pipeline.cli.shown`. name: of the command, by default that of the function. What was reached by a
    function that fails is shown before the reason.
    """
    own, more = _options(function), _options(show)
    takes_progress = "progress" in inspect.signature(function).parameters
    beside = [key for key in list(inspect.signature(show).parameters)[1:] if key not in more]

    def command(**written: Any) -> None:
        from pipeline.values.errors import RunFailed, on_command_line

        options = {key: written.pop(key) for key in more}
        given = {key: value for key, value in written.items() if value is not None}
        if takes_progress:
            given["progress"] = _listener(options)
        rest = options | {key: written[key] for key in beside}
        with on_command_line():
            try:
                value = function(**given)
            except RunFailed as failure:
                if failure.reached is not None:
                    show(failure.reached, **rest)
                raise
            show(value, **rest)

    command.__signature__ = inspect.Signature([*own.values(), *more.values()])  # type: ignore[attr-defined]
    command.__annotations__ = {}
    text = inspect.getdoc(function) or ""
    app.command(name or function.__name__, cls=cls, help=text.partition("\n\n")[0])(with_sentences(command))


def _options(function: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    """The parameters of a function that have an option, with the type that the command line reads."""
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        value, *metadata = get_args(parameter.annotation) or (None,)
        if metadata and isinstance(metadata[-1], ParameterInfo):
            kind = metadata[0] if len(metadata) > 1 else Path if Path in get_args(value) else value
            default = None if parameter.default == () else parameter.default
            annotation: Any = Annotated[kind | None if default is None else kind, metadata[-1]]
            found[name] = parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=annotation, default=default)
    return found


def _listener(options: Mapping[str, Any]) -> "Progress":
    """The listener to the progress, by the options -q, -v and --json of a command that has them."""
    from pipeline.show.progress import progress_for
    from pipeline.store.progress import Silent

    if options.get("quiet"):
        return Silent()
    return progress_for(Console(stderr=options.get("as_json", False)), verbose=options.get("verbose", False))


@wraps(runs.characterize)
def run(config: Path, **given: Any) -> "Results | PairRuns":
    from pipeline.api.given import document_of
    from pipeline.law.in_space.pressure_lists import has_rows

    document = document_of(config, {}, given.get("settings"))
    # the pressures of two cavities are pairs
    return runs.characterize_pairs(config, **given) if has_rows(document) else runs.characterize(config, **given)


@wraps(setup.doctor)
def doctor() -> "tuple[Finding, ...]":
    print_lines(
        "Checked are the versions of Python and of all packages, a mesh, a picture, the solver of linear "
        "equations, threads and the disk. Nothing is installed or changed; this takes about ten seconds."
    )
    return setup.doctor()


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


app.callback()(show_version)
add(setup.init, show_file, cls=Init)
add(run, show_results, "run")
add(runs.mesh, show_mesh)
add(studies.effects, show_effects)
add(studies.accuracy, show_accuracy)
add(runs.cell, show_cell)
add(studies.design, show_design)
add(studies.sweep, show_sweep)
add(rods.shape, show_shape, "rod")
add(rods.solve, show_solutions)
add(rods.budget, show_budget)
add(measured.compare, show_comparison)
add(measured.calibrate, show_calibration)
add(measured.material, show_material)
add(rods.export, show_export)
add(doctor, show_findings)


def main() -> None:
    """The console script. A request to end, by a scheduler or a closed terminal, counts as Ctrl-C."""
    for name in ("SIGTERM", "SIGHUP"):
        request = getattr(signal, name, None)  # Windows has no SIGHUP
        if request and signal.getsignal(request) is not signal.SIG_IGN:  # as under nohup
            signal.signal(request, signal.default_int_handler)
    _keep_standard_output()
    app()


def _keep_standard_output() -> None:
    """Print through a copy of descriptor 1, which is silenced while Gmsh meshes: progress is shown meanwhile."""
    if sys.stdout is None:  # it was closed before the start
        return
    sys.stdout.flush()
    sys.stdout = os.fdopen(os.dup(1), "w", encoding=sys.stdout.encoding, errors=sys.stdout.errors)
