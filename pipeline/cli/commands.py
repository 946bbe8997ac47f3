"""The command line. Exit status 0 done, 1 failed, 2 wrong input, 130 interrupted.

Commands import everything heavy inside their functions, so that `pneurod --help` answers at once. Those that solve a
design are in `pipeline.cli.design`.
"""

import os
import signal
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from pipeline.cli.design import accuracy, cell, design, effects, mesh, run
from pipeline.cli.ending import print_json, print_lines, print_sentences, with_sentences
from pipeline.cli.measurement import calibrate, compare
from pipeline.store.worker import available_cores

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


def init(
    family: Annotated[str, typer.Argument(metavar="[FAMILY]")] = "pneunet",
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="(default: my_FAMILY.yaml).")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
    every: Annotated[bool, typer.Option("--all", help="With every key, its default and its range.")] = False,
) -> None:
    """A commented configuration to start from: a body, a rubber by name and pressures."""
    from pipeline.config.body import BODIES
    from pipeline.config.example import example
    from pipeline.config.section import not_known
    from pipeline.store.atomic_file import write_atomic
    from pipeline.store.result_folder import open_file
    from pipeline.values.errors import InputError

    if family not in BODIES:
        raise InputError(f"FAMILY: {not_known(family, BODIES)}")
    file = out or Path(f"my_{family}.yaml")
    if file.exists() and not force:
        raise InputError(f"{file}: exists; give another --out, or --force to replace it")
    write_atomic(open_file(file), example(family, every=every).encode())
    print_lines(f"written: {file}; change it and check the body with `pneurod mesh {file}`")


Kind = Annotated[
    str | None,
    typer.Option(
        "--rod",
        metavar="law|five|five_extensible",
        help="The arm's own law, or five parameters; by default the rod that the verdict recommends.",
    ),
]
Orientation = Annotated[
    str | None,
    typer.Option(
        metavar="O", help="hanging, lying, standing, '30 deg' that it rises, or gravity as '[X, Y]': with its weight."
    ),
]
TipMass = Annotated[str | None, typer.Option(metavar="M", help="A mass that hangs on the end: '20 g'.")]


def rod(
    path: Annotated[
        Path, typer.Argument(metavar="DIR", help="Results of a run; or a parameters.json or law.json alone.")
    ],
    pressure: Annotated[str, typer.Option(metavar="P", help="With its unit: '31 kPa', or '[20 kPa, 5 kPa]'.")],
    force: Annotated[
        str | None, typer.Option(metavar="[FX, FY]", help="Dead force: '[0 N, 0.05 N]', in space with FZ.")
    ] = None,
    moment: Annotated[
        str, typer.Option(metavar="M", help="Moment on the end: '1 N*mm', in space '[MX, MY, MZ]'.")
    ] = "0 N*mm",
    end_y: Annotated[str | None, typer.Option(metavar="Y", help="Height of the end over the clamp: '0 mm'.")] = None,
    end: Annotated[
        str | None, typer.Option(metavar="[X, Y]", help="Position of the end from the clamp, in space with Z.")
    ] = None,
    orientation: Orientation = None,
    tip_mass: TipMass = None,
    kind: Kind = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the shape as CSV.")] = None,
) -> None:
    """The rod alone, in milliseconds: its shape under loads."""
    from pipeline.answers.rods.choice import rod_of_path
    from pipeline.answers.rods.end_loads import EndLoads, Weight, end_lines, rod_at, write_shape

    loads = EndLoads.read(force, moment, end_y, end, Weight.read(orientation, tip_mass))
    chosen = rod_of_path(path, kind)
    selected = rod_at(chosen, pressure)
    shape = loads.shape(selected)
    print_lines(*end_lines(selected, shape, chosen.error_text))
    if out is not None:
        write_shape(shape, out)


def solve(
    path: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a run; or a law.json alone.")],
    tip: Annotated[str | None, typer.Option(metavar="[X, Y]", help="Place of the end: '[30 mm, -40 mm]'.")] = None,
    angle: Annotated[str | None, typer.Option(metavar="A", help="How far the arm bends: '90 deg'.")] = None,
    force: Annotated[str | None, typer.Option(metavar="F", help="Force on the held end, upwards: '0.05 N'.")] = None,
    at_height: Annotated[str | None, typer.Option(metavar="Y", help="Height at which it is held: '0 mm'.")] = None,
    orientation: Orientation = None,
    tip_mass: TipMass = None,
    kind: Kind = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="FILE", help="Page with the tips it reaches, up to --tip-mass.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The solutions as JSON.")] = False,
) -> None:
    """The pressure for a place of the end, an angle, or a force."""
    from dataclasses import asdict

    from pipeline.answers.rods.choice import rod_of_path
    from pipeline.answers.rods.end_loads import Weight
    from pipeline.answers.rods.pressures import Wish, pressures_for
    from pipeline.results.options import write_new

    wish = Wish.read(tip, angle, force, at_height, Weight.read(orientation, tip_mass))
    rods = rod_of_path(path, kind)
    found = pressures_for(rods, wish)
    if picture is not None:
        from pipeline.answers.rods.tips import tips_page

        write_new(picture, tips_page(rods, wish, found))
    if as_json:
        print_json({"solutions": [asdict(at) for at in found]})
    else:
        print_lines(*(at.text for at in found), *rods.notes)


def budget(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a run or of `pneurod cell`.")],
    pressure: Annotated[
        str | None, typer.Option(metavar="P", help="Of the table, with its unit (default: the highest one).")
    ] = None,
    tolerances: Annotated[
        list[str] | None,
        typer.Option("--tolerance", metavar="KEY=VALUE", help="geometry.wall='0.1 mm', process=printed. Repeatable."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The picture (default: DIR/budget.html).")
    ] = None,
) -> None:
    """What the tolerances of a built arm do: by how much each moves the tip, the curvature, the rigidity, the force."""
    from pipeline.answers.budget import budget_for, budget_table

    found, picture = budget_for(folder, pressure, tolerances or (), out)
    print_lines(budget_table(found), f"picture: {picture}")


def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a finished run.")],
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="NAME", help="The format, required; without it the command ends with the list of formats."
        ),
    ] = None,
    pressure: Annotated[
        str | None, typer.Option(metavar="P", help="With its unit (default: all pressures of the rod).")
    ] = None,
    rod: Annotated[
        str | None,
        typer.Option(
            "--rod",
            metavar="law|five",
            help="Which rod (default: the one with the arm's own law where there is one).",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for the files (default: DIR).")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
) -> None:
    """The rod to take as a file for another program, with the pressure as its input."""
    from pipeline.answers.rods.export import ExportOptions, exported

    done = exported(folder, to, ExportOptions(pressure, rod, out, force))
    print_lines(*(f"written: {file}" for file in done.files), *done.sentences)


def material(
    tests: Annotated[list[Path], typer.Argument(metavar="TENSILE.csv...", help="Files of tensile tests.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder.")] = Path("results/material"),
    run: Annotated[
        Path | None, typer.Option("--for", metavar="DIR", help="Results of a run: the stretches that its arm needs.")
    ] = None,
    length: Annotated[str | None, typer.Option(metavar="L", help="At rest, for extensions: '33 mm'.")] = None,
    area: Annotated[str | None, typer.Option(metavar="A", help="At rest, for forces: '16 mm^2'.")] = None,
    cycle: Annotated[int, typer.Option(metavar="N", min=0, help="A later loading than the first one.")] = 0,
    start: Annotated[str | None, typer.Option("--from", metavar="STRAIN", help="Leave out smaller strains.")] = None,
    up_to: Annotated[str | None, typer.Option(metavar="STRAIN", help="Leave out larger strains: '50 %'.")] = None,
    within: Annotated[str, typer.Option(metavar="ERROR", help="Relative error within which a law holds.")] = "10 %",
    nu: Annotated[float, typer.Option(metavar="NU", help="Poisson ratio; it gives rubber its kappa.")] = 0.495,
    density: Annotated[str | None, typer.Option(metavar="RHO", help="For the configuration: '1070 kg/m^3'.")] = None,
) -> None:
    """Tensile tests: the law to take, its constants, and the stretches over which it can be used."""
    from pipeline.answers.material.page import law_table
    from pipeline.answers.material.record import fit_material
    from pipeline.answers.material.study import FitOptions
    from pipeline.values.errors import RunFailed

    texts = {"--length": length, "--area": area, "--from": start, "--up-to": up_to, "--within": within}
    found = fit_material(tests, FitOptions.read({**texts, "--density": density}, nu, cycle, run), out)
    print_sentences(*(f"Note: {note}" for note in found.notes))
    if not found.judged.usable:
        raise RunFailed(" ".join(found.words))
    print_lines("", *found.words, "", found.line, "", law_table(found))
    print_lines(f"\nwritten: {out / 'material.html'} (picture), material.json (all laws as lines), material_curves.csv")


def sweep(
    files: Annotated[list[Path], typer.Argument(metavar="SWEEP...", help="Base configuration and axes in YAML.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Result folder; of several: DIR/NAME (default: results/NAME)."),
    ] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="Of Dask, instead of own workers.")] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes (default: number of cores).")] = None,
    memory: Annotated[str | None, typer.Option(metavar="SIZE", help="Of each worker (default: equal parts).")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Delete earlier results in DIR and begin again.")] = False,
) -> None:
    """Many designs: a base configuration and axes, every point a run of its own, one table, on all cores or on Dask."""
    from pipeline.values.errors import InputError

    if scheduler is not None and (jobs is not None or memory is not None):
        raise InputError("--scheduler: its workers are started apart; leave out --jobs and --memory")

    from pipeline.study.sweep.spec import read_sweep
    from pipeline.study.sweep.study import Course, run_sweeps
    from pipeline.study.sweep.workers import LocalWorkers

    sweeps = [read_sweep(file) for file in files]
    workers = scheduler or LocalWorkers.of(jobs or available_cores(), memory)
    parent = out or Path("results")
    folders = [parent / sweep.name if out is None or len(sweeps) > 1 else out for sweep in sweeps]
    requests = list(zip(sweeps, folders, strict=True))
    reports = run_sweeps(requests, Course(workers, fresh, print_lines))
    for report in reports:
        folder = report.directory
        print_lines(f"{report.sentence()}; table: {folder / 'sweep.csv'}, picture: {folder / 'sweep.html'}")
    for report in reports:
        report.raise_if_failed()


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
    from pipeline.values.errors import RunFailed

    print_lines(
        "Checked are the versions of Python and of all packages, a mesh, a picture, the solver of linear "
        "equations, threads and the disk. Nothing is installed or changed; this takes about ten seconds."
    )
    from pipeline.doctor import examine, findings_table, remedy

    findings = examine()
    print_lines(findings_table(findings))
    command = remedy(findings)
    if command:
        raise RunFailed(f"something is missing; to mend it: {command}")
    print_lines("everything pneurod needs is here")


app.callback()(show_version)
app.command(cls=Init)(with_sentences(init))
OF_DESIGNS = (run, mesh, effects, accuracy, cell, design, sweep)
for command in (*OF_DESIGNS, rod, solve, budget, compare, calibrate, material, export, doctor):
    app.command()(with_sentences(command))


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
