"""The command line: the functions of `pipeline.api`, whose values it prints.

Exit status 0 done, 1 failed, 2 wrong input, 130 interrupted. The functions import everything heavy inside themselves,
so that `pneurod --help` answers at once.
"""

import atexit
import gc
import inspect
import os
import signal
import sys
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer
from rich.console import Console
from typer.core import TyperCommand
from typer.models import ParameterInfo

import pipeline.cli.shown as shown
from fem.memory import CYCLES_AFTER
from pipeline.api import measured, rods, runs, setup, studies
from pipeline.api.course import document_of
from pipeline.api.options import COMMANDS
from pipeline.cli.ending import print_lines, with_sentences
from pipeline.show.progress import progress_for
from pipeline.store.progress import Progress, Silent
from pipeline.values.errors import RunFailed, on_command_line

if TYPE_CHECKING:
    from pipeline.api.results import Results
    from pipeline.doctor import Finding
    from pipeline.study.pairs.run import PairRuns

app = typer.Typer(
    help="From the drawing of a pneumatic soft actuator to a rod model with quantified errors.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # colours and frames take longer than all the rest of the help
    context_settings={"max_content_width": 120},
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


def add(
    function: Callable[..., Any], shows: Callable[[], Callable[..., None]], name: str = "", cls: Any = None, **more: Any
) -> None:
    """Add the command of a function: its arguments with an option are read, and its value is shown.

    shows: gives the function that shows the value, with the options `more`. name: of the command, by default that of
    the function. What was reached by a function that fails is shown before the reason.
    """
    own = _options(function)
    takes_progress = "progress" in inspect.signature(function).parameters

    def command(**written: Any) -> None:
        options = {key: written.pop(key) for key in more}
        given = {key: value for key, value in written.items() if value is not None}
        if takes_progress:
            given["progress"] = _listener(**options)
        with on_command_line():
            try:
                value = function(**given)
            except RunFailed as failure:
                if failure.reached is not None:
                    _show(failure.reached, shows(), options | written)
                raise
            _show(value, shows(), options | written)

    beside = [
        inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for key, (annotation, default) in more.items()
    ]
    command.__signature__ = inspect.Signature([*own.values(), *beside])  # type: ignore[attr-defined]
    command.__annotations__ = {}
    text = inspect.getdoc(function) or ""
    told = text.partition("\n\n")[0]
    app.command(name or function.__name__, cls=cls, help=told, short_help=told.replace("\n", " ").partition(". ")[0])(
        with_sentences(command)
    )


def _show(value: Any, show: Callable[..., None], written: Mapping[str, object]) -> None:
    """Show a value with those options that its function takes."""
    taken = list(inspect.signature(show).parameters)[1:]
    show(value, **{key: written[key] for key in taken if key in written})


def _options(function: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    """The parameters of a function that have an option, with the type that the command line reads."""
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        value, *metadata = get_args(function.__annotations__.get(name)) or (None,)
        if metadata and isinstance(metadata[-1], ParameterInfo):
            kind = metadata[0] if len(metadata) > 1 else Path if Path in get_args(value) else value
            default = None if parameter.default == () else parameter.default
            annotation: Any = Annotated[kind | None if default is None else kind, metadata[-1]]
            found[name] = parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=annotation, default=default)
    return found


def _listener(quiet: bool = False, as_json: bool = False, **_: object) -> Progress:
    """The listener to the progress, by the options -q and --json of a command that has them."""
    return Silent() if quiet else progress_for(Console(stderr=as_json))


@wraps(runs.characterize)
def run(config: Path, **given: Any) -> "Results | PairRuns":
    document = document_of(config, {}, given.get("settings"))
    # the pressures of two cavities are pairs
    return runs.characterize_pairs(config, **given) if document.has_rows else runs.characterize(config, **given)


@wraps(setup.doctor)
def doctor() -> "tuple[Finding, ...]":
    print_lines(
        "Checked are the versions of Python and of all packages, a mesh, a picture, the solver of linear "
        "equations, threads and the disk. Nothing is installed or changed; this takes about ten seconds."
    )
    return setup.doctor()


def _print_version(requested: bool) -> None:
    if requested:
        print_lines(f"pneurod {setup.checks().installed('pneurod')}")
        raise typer.Exit


def show_version(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="The version of pneurod.")
    ] = False,
) -> None:
    """The options of `pneurod` itself."""


def _solved() -> ModuleType:
    """The functions that show what finite elements gave: they load the solver, which has been loaded by then."""
    import pipeline.cli.shown_solved as shown_solved

    return shown_solved


QUIET = Annotated[bool, typer.Option("-q", "--quiet", help="No progress, only the verdict.")], False
JSON = (
    Annotated[bool, typer.Option("--json", help="The verdict as JSON on standard output; progress on stderr.")],
    False,
)
SOLUTIONS = Annotated[bool, typer.Option("--json", help="The solutions as JSON.")], False
PICTURE = (
    Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The picture (default: DIR/compared_MEASURED.html).")
    ],
    None,
)

app.callback()(show_version)
add(setup.init, lambda: shown.show_file, cls=Init)
add(run, lambda: _solved().show_results, "run", quiet=QUIET, as_json=JSON)
add(runs.mesh, lambda: _solved().show_mesh)
add(studies.effects, lambda: _solved().show_effects)
add(studies.accuracy, lambda: _solved().show_accuracy)
add(runs.cell, lambda: _solved().show_cell)
add(studies.design, lambda: _solved().show_design, quiet=QUIET)
add(studies.sweep, lambda: _solved().show_sweep)
for name, function in COMMANDS.items():
    add(function, lambda: lambda value: print_lines(*value.lines), name)
add(rods.solve, lambda: shown.show_solutions, as_json=SOLUTIONS)
add(rods.budget, lambda: shown.show_budget)
add(measured.compare, lambda: shown.show_comparison, out=PICTURE)
add(measured.calibrate, lambda: shown.show_calibration)
add(measured.material, lambda: shown.show_material)
add(doctor, lambda: shown.show_findings)


def main() -> None:
    """The console script. A request to end, by a scheduler or a closed terminal, counts as Ctrl-C."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # on its small matrices threads only keep workers from cores
    gc.set_threshold(CYCLES_AFTER)
    atexit.register(gc.freeze)  # else Python looks for cycles among all objects of the libraries before it ends
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
