"""The command line. Exit status 0 done, 1 failed, 2 wrong input, 130 interrupted.

Everything heavy is imported inside the commands, so that `pneurod --help` answers at once.
"""

import errno
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn, TypeAlias, TypeVar

import typer
from rich.console import Console, RenderableType

from pipeline.errors import InputError, RunFailed
from pipeline.processes import available_cores

if TYPE_CHECKING:
    from pipeline.config.config import Config
    from pipeline.progress import Progress

    Result = TypeVar("Result")
    #: a command that solves: configuration, result folder, jobs, fresh, progress
    Task: TypeAlias = Callable[[Config, Path, int, bool, Progress], Result]

app = typer.Typer(
    help="From the drawing of a pneumatic soft actuator to a rod model that can be trusted.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

ConfigFile = Annotated[Path, typer.Argument(metavar="CONFIG", help="A design in YAML, such as configs/pneunet.yaml.")]
OutFolder = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Result folder. [default: results/NAME]")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value: --set mesh.size='4 mm'. May be repeated."),
]
Jobs = Annotated[
    int | None, typer.Option("--jobs", min=1, help="Experiments at the same time. [default: cores, 3 at most]")
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Delete earlier results in DIR and begin again.")]
Accuracy = Annotated[
    str | None,
    typer.Option("--accuracy", metavar="P%", help="Choose the mesh for this error: --set mesh.size=auto --accuracy 2%"),
]


@app.command()
def run(
    config: ConfigFile,
    out: OutFolder = None,
    settings: Settings = None,
    accuracy: Accuracy = None,
    jobs: Jobs = None,
    fresh: Fresh = False,
) -> None:
    """Mesh, experiments I, II and III, the five parameters, the rod, the report."""
    with _errors_as_sentences():
        design, folder = _design(config, [*(settings or ()), *([f"accuracy={accuracy}"] if accuracy else [])], out)

        from pipeline.run import run as run_design
        from pipeline.terminal import effects_summary

        report = _solve(run_design, design, folder, jobs or min(3, available_cores()), fresh)
        report.raise_if_failed()
        _print(effects_summary(report.effects))
        if report.accuracy:
            _print(report.accuracy.sentence)
        _print(f"report: {folder / 'report.html'}")


@app.command()
def mesh(config: ConfigFile, out: OutFolder = None, settings: Settings = None) -> None:
    """Only the body: DIR/mesh.vtu, volumes and the quality of the elements. [default DIR: results/NAME_mesh]"""
    with _errors_as_sentences():
        design, folder = _design(config, settings, out, "_mesh")

        from pipeline.simulation.scene import Scene
        from pipeline.store.atomic_file import replacing
        from pipeline.store.result_folder import open_folder
        from pipeline.terminal import body_table

        body = Scene.meshed(design).body
        file = open_folder(folder).path("mesh.vtu")
        with replacing(file) as part:
            body.mesh.write(part)
        _print(body_table(file, design.design, body))


@app.command()
def effects(
    config: ConfigFile, out: OutFolder = None, settings: Settings = None, jobs: Jobs = None, fresh: Fresh = False
) -> None:
    """Each effect on and off: what it changes, what it costs. [default DIR: results/NAME_effects]"""
    with _errors_as_sentences():
        design, folder = _design(config, settings, out, "_effects")

        from pipeline.effects_study import compare_effects, contact_sentences
        from pipeline.terminal import effects_comparison

        table = _solve(compare_effects, design, folder, jobs or min(2, available_cores()), fresh)
        _print(effects_comparison(table.rows), *contact_sentences(table.rows))
        _print(f"table: {folder / 'effects_table.json'}")
        if table.failures:
            raise RunFailed("; ".join(table.failures))


@app.command()
def accuracy(
    config: ConfigFile, out: OutFolder = None, settings: Settings = None, jobs: Jobs = None, fresh: Fresh = False
) -> None:
    """Convergence study: error against seconds over meshes, elements and tolerances. [default DIR:
    results/NAME_accuracy]"""
    with _errors_as_sentences():
        design, folder = _design(config, settings, out, "_accuracy")

        from pipeline.accuracy.study import run_study
        from pipeline.accuracy.table import reference_sentences
        from pipeline.terminal import study_table

        study = _solve(run_study, design, folder, jobs or min(2, available_cores()), fresh)
        _print(study_table(study), *reference_sentences(study))
        _print(f"picture: {folder / 'accuracy.html'}")


@app.command()
def cell(
    config: ConfigFile, out: OutFolder = None, settings: Settings = None, jobs: Jobs = None, fresh: Fresh = False
) -> None:
    """The arm's own law from one cell and its two ends, for every load and length. [default DIR: results/NAME_cell]"""
    with _errors_as_sentences():
        design, folder = _design(config, settings, out, "_cell")

        from pipeline.cell.study import measure_law
        from pipeline.cell.table import law_sentences
        from pipeline.terminal import cell_table

        report = _solve(measure_law, design, folder, jobs or 1, fresh)
        _print(cell_table(report.measured), *law_sentences(report))
        _print(f"law: {folder / 'law.json'}, picture: {folder / 'law.html'}")
        report.raise_if_failed()


@app.command()
def rod(
    parameters: Annotated[Path, typer.Argument(metavar="PARAMETERS.json", help="Of a finished run; or a law.json.")],
    pressure: Annotated[str, typer.Option(metavar="P", help="With its unit: '31 kPa'.")],
    force: Annotated[
        str | None, typer.Option(metavar="[FX, FY]", help="Dead force on the end: '[0 N, 0.05 N]'.")
    ] = None,
    moment: Annotated[str, typer.Option(metavar="M", help="Moment on the end: '1 N*mm'.")] = "0 N*mm",
    end_y: Annotated[str | None, typer.Option(metavar="Y", help="Height of the end over the clamp: '0 mm'.")] = None,
    end: Annotated[str | None, typer.Option(metavar="[X, Y]", help="Position of the end from the clamp.")] = None,
    extrapolate: Annotated[bool, typer.Option("--extrapolate", help="Go beyond the identified pressures.")] = False,
    extensible: Annotated[
        bool | None,
        typer.Option(
            "--stretch/--no-stretch",
            help="The rod whose curve stretches, or not; by itself the one that stretches where the free curve of the "
            "arm is longer by more than 0.5 %.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the shape as CSV.")] = None,
) -> None:
    """The rod alone, in milliseconds: its shape under loads."""
    with _errors_as_sentences():
        from pipeline.saved_rod import EndLoads, end_lines, rod_of_file, write_shape

        selected = rod_of_file(parameters, pressure, extrapolate, extensible)
        shape = EndLoads.read(force, moment, end_y, end).shape(selected.rod)
        _print(*end_lines(shape), *filter(None, [selected.warning(shape)]))
        if out is not None:
            write_shape(shape, out)


@app.command()
def material(
    tests: Annotated[list[Path], typer.Argument(metavar="TENSILE.csv...", help="Nominal stress over nominal strain.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder.")] = Path("results/material"),
    nu: Annotated[float, typer.Option(metavar="NU", help="Poisson ratio; it gives rubber its kappa.")] = 0.495,
    up_to: Annotated[str | None, typer.Option(metavar="STRAIN", help="Leave out larger strains: '50 %'.")] = None,
    within: Annotated[str, typer.Option(metavar="ERROR", help="Relative error within which a law holds.")] = "10 %",
    break_strain: Annotated[str, typer.Option("--break", metavar="STRAIN", help="E_L below, E_H above.")] = "150 %",
    density: Annotated[str, typer.Option(metavar="RHO", help="For the configuration; not measured.")] = "1130 kg/m^3",
) -> None:
    """Tensile tests: constants of every law, the stretches it holds for, E_L and E_H."""
    with _errors_as_sentences():
        from pipeline.material.fits import ALL, WIDEST, FitOptions
        from pipeline.material.sentences import caveats, moduli_sentences, yaml_block
        from pipeline.material.study import fit_material
        from pipeline.terminal import law_table

        fits = fit_material(tests, FitOptions.read(nu, density, break_strain, up_to, within), out)
        _print(*moduli_sentences(fits))
        for name in (ALL, WIDEST):
            _print("", law_table(fits, name))
        _print(f"\nfor a configuration, fitted to {WIDEST}:")
        _print(*(yaml_block(fit, density) for fit in fits.usable.values()), "", *caveats(fits))
        _print(f"written: {out / 'material.html'}, material.json, material_curves.csv")


@app.command()
def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a finished run.")],
    to: Annotated[
        str | None, typer.Option("--to", metavar="NAME", help="The format; without it all are named.")
    ] = None,
    pressure: Annotated[str | None, typer.Option(metavar="P", help="With its unit. [default: the highest]")] = None,
) -> None:
    """The identified rod as a file for another rod code."""
    with _errors_as_sentences():
        from pipeline.saved_rod import exported

        _print(f"written: {exported(folder, to, pressure)}")


@app.command()
def doctor() -> None:
    """What is installed, what is missing, and the one command that mends it."""
    with _errors_as_sentences():
        from rich.table import Table

        from pipeline.doctor import examine, remedy

        findings = examine()
        table = Table("", "checked", "result", box=None, pad_edge=False)
        for finding in findings:
            table.add_row("[green]ok[/]" if finding.sound else "[red]no[/]", finding.subject, finding.result)
        _print(table)
        command = remedy(findings)
        if command:
            raise RunFailed(f"something is missing; to mend it: {command}")
        _print("everything pneurod needs is here")


def main() -> None:
    """The console script. A request to end, by a scheduler or a closed terminal, counts as Ctrl-C."""
    for request in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(request, signal.default_int_handler)
    app()


def _design(config: Path, settings: list[str] | None, out: Path | None, suffix: str = "") -> tuple["Config", Path]:
    """The configuration, checked, and the result folder."""
    from pipeline.config.load import load_config

    design = load_config(config, settings or ())
    return design, out or Path("results") / f"{design.name}{suffix}"


def _solve(task: "Task[Result]", design: "Config", folder: Path, jobs: int, fresh: bool) -> "Result":
    """The result of a task, with its progress on the terminal."""
    from pipeline.progress import progress_for

    progress = progress_for(Console())
    try:
        return task(design, folder, jobs, fresh, progress)
    finally:
        progress.done()


def _print(*lines: RenderableType) -> None:
    """Tables and sentences; a sentence is not broken into lines."""
    console = Console()
    for line in lines:
        if isinstance(line, str):
            console.print(line, highlight=False, markup=False, soft_wrap=True)
        else:
            console.print(line, highlight=False)


@contextmanager
def _errors_as_sentences() -> Iterator[None]:
    """End with one sentence on stderr and the exit status of what went wrong."""
    try:
        yield
    except InputError as failure:
        _end(str(failure), 2)
    except RunFailed as failure:
        _end(str(failure), 1)
    except KeyboardInterrupt:
        _end("interrupted; finished results are kept, and the same command continues from there", 130)
    except MemoryError:
        _end("the memory of this machine does not suffice; choose a larger mesh.size or fewer --jobs", 1)
    except BrokenPipeError:
        _end("the output was closed; finished results are kept, and the same command continues from there", 1)
    except OSError as failure:
        if failure.errno is None:  # a library that could not be loaded
            _end(f"{failure}; `pneurod doctor` names the command that mends it", 1)
        file = f"{failure.filename}: " if failure.filename else ""
        _end(f"{file}{failure.strerror}; {_remedy(failure)}; finished results are kept", 1)
    except RuntimeError as failure:
        if "no locator available" not in str(failure):  # numba's message when it finds no folder for its cache
            raise
        _end("no folder for compiled kernels can be written; name one that can: NUMBA_CACHE_DIR=FOLDER", 1)
    except ImportError as failure:
        _end(f"{failure}; `pneurod doctor` names the command that mends it", 1)


def _remedy(failure: OSError) -> str:
    """What to do about a file that could not be read or written."""
    full = {errno.ENOSPC: "make room there", errno.EDQUOT: "make room there", errno.EFBIG: "allow larger files"}
    if failure.errno in full:
        return f"{full[failure.errno]} or give another --out, then the same command again"
    return "give a folder that can be written and files that can be read"


def _end(sentence: str, status: int) -> NoReturn:
    typer.echo(f"pneurod: {sentence}", err=True)
    raise typer.Exit(status) from None
