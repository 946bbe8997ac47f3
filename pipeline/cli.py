"""The command line. Exit status 0 done, 1 failed, 2 wrong input, 130 interrupted.

The commands are in `pipeline/commands/`. They import everything heavy inside their functions, so that `pneurod --help`
answers at once.
"""

import os
import signal
import sys

import typer

from pipeline.commands.of_design import accuracy, cell, effects, mesh, run
from pipeline.commands.of_file import init
from pipeline.commands.of_installation import doctor, show_version
from pipeline.commands.of_material import material
from pipeline.commands.of_rod import export, rod
from pipeline.commands.of_sweep import sweep

app = typer.Typer(
    help="From the drawing of a pneumatic soft actuator to a rod model with quantified errors.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

app.callback()(show_version)
for command in (init, run, mesh, effects, accuracy, cell, sweep, rod, material, export, doctor):
    app.command()(command)


def main() -> None:
    """The console script. A request to end, by a scheduler or a closed terminal, counts as Ctrl-C."""
    for request in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(request) is not signal.SIG_IGN:  # as under nohup
            signal.signal(request, signal.default_int_handler)
    _keep_standard_output()
    app()


def _keep_standard_output() -> None:
    """Print through a copy of descriptor 1, which is silenced while Gmsh meshes: progress is shown meanwhile."""
    if sys.stdout is None:  # it was closed before the start
        return
    sys.stdout.flush()
    sys.stdout = os.fdopen(os.dup(1), "w", encoding=sys.stdout.encoding, errors=sys.stdout.errors)
