"""The command line. Exit status 0 done, 1 failed, 2 wrong input, 130 interrupted.

Everything heavy is imported inside the commands, so that `pneurod --help` answers at once.
"""

import errno
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console
from rich.table import Table

from pipeline.errors import InputError, RunFailed

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
Fresh = Annotated[bool, typer.Option("--fresh", help="Forget what DIR holds and begin again.")]


Accuracy = Annotated[
    str | None,
    typer.Option(
        "--accuracy", metavar="P%", help="Look for the mesh with this error: --set mesh.size=auto --accuracy 2%"
    ),
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
    """The whole story: mesh, experiments I, II and III, the five parameters, the rod, the report."""
    with _plain_endings():
        from pipeline.config.config import load_config
        from pipeline.progress import progress_for

        design = load_config(config, [*(settings or ()), *([f"accuracy={accuracy}"] if accuracy else [])])
        folder = out or Path("results") / design.name

        from pipeline.run import run as run_story
        from pipeline.terminal import effects_summary

        console = Console()
        progress = progress_for(console)
        try:
            report = run_story(design, folder, jobs or min(3, len(os.sched_getaffinity(0))), fresh, progress)
        finally:
            progress.done()
        report.raise_if_failed()
        console.print(effects_summary([state.row() for state in report.effects]), highlight=False)
        if report.accuracy:
            console.print(report.accuracy.sentence, highlight=False, soft_wrap=True)
        console.print(f"report: {folder / 'report.html'}", highlight=False, soft_wrap=True)


@app.command()
def mesh(config: ConfigFile, out: OutFolder = None, settings: Settings = None) -> None:
    """Only the body: DIR/mesh.vtu, volumes and the quality of the elements. [default DIR: results/NAME_mesh]"""
    with _plain_endings():
        from pipeline.config.config import load_config

        design = load_config(config, settings or ())
        folder = out or Path("results") / f"{design.name}_mesh"

        from pipeline.simulation.scene import Scene
        from pipeline.store.atomic_file import beside
        from pipeline.terminal import body_table

        body = Scene.meshed(design).body
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with beside(folder / "mesh.vtu") as place:
                body.mesh.write(place)
        except OSError as failure:
            raise InputError(f"--out {folder}: cannot be written ({failure.strerror}); give another folder") from None
        Console().print(body_table(folder / "mesh.vtu", design.design, body), highlight=False, soft_wrap=True)


@app.command()
def effects(
    config: ConfigFile, out: OutFolder = None, settings: Settings = None, jobs: Jobs = None, fresh: Fresh = False
) -> None:
    """Each effect on and off: what it changes, what it costs. [default DIR: results/NAME_effects]"""
    with _plain_endings():
        from pipeline.config.config import load_config
        from pipeline.progress import progress_for

        design = load_config(config, settings or ())
        folder = out or Path("results") / f"{design.name}_effects"

        from pipeline.effects_study import compare_effects, contact_sentences
        from pipeline.terminal import effects_comparison

        console = Console()
        progress = progress_for(console)
        try:
            table = compare_effects(design, folder, jobs or min(2, len(os.sched_getaffinity(0))), fresh, progress)
        finally:
            progress.done()
        console.print(effects_comparison(table.rows), highlight=False)
        for sentence in contact_sentences(table.rows):
            console.print(sentence, highlight=False, soft_wrap=True)
        console.print(f"table: {folder / 'effects_table.json'}", highlight=False, soft_wrap=True)
        if table.failures:
            raise RunFailed("; ".join(table.failures))


@app.command()
def accuracy(
    config: ConfigFile, out: OutFolder = None, settings: Settings = None, jobs: Jobs = None, fresh: Fresh = False
) -> None:
    """What accuracy costs: error against seconds over meshes, elements and tolerances. [default DIR:
    results/NAME_accuracy]"""
    with _plain_endings():
        from pipeline.config.config import load_config
        from pipeline.progress import progress_for

        design = load_config(config, settings or ())
        folder = out or Path("results") / f"{design.name}_accuracy"

        from pipeline.accuracy.study import run_study
        from pipeline.accuracy.table import reference_sentences
        from pipeline.terminal import study_table

        console = Console()
        progress = progress_for(console)
        try:
            study = run_study(design, folder, jobs or min(2, len(os.sched_getaffinity(0))), fresh, progress)
        finally:
            progress.done()
        console.print(study_table(study), highlight=False)
        for sentence in reference_sentences(study):
            console.print(sentence, highlight=False, soft_wrap=True)
        console.print(f"picture: {folder / 'accuracy.html'}", highlight=False, soft_wrap=True)


@app.command()
def rod(
    parameters: Annotated[Path, typer.Argument(metavar="PARAMETERS.json", help="Of a finished run.")],
    pressure: Annotated[str, typer.Option(metavar="P", help="With its unit: '31 kPa'.")],
    force: Annotated[
        str | None, typer.Option(metavar="[FX, FY]", help="Dead force on the end: '[0 N, 0.05 N]'.")
    ] = None,
    moment: Annotated[str, typer.Option(metavar="M", help="Moment on the end: '1 N*mm'.")] = "0 N*mm",
    end_y: Annotated[str | None, typer.Option(metavar="Y", help="Height of the end over the clamp: '0 mm'.")] = None,
    end: Annotated[str | None, typer.Option(metavar="[X, Y]", help="Place of the end from the clamp.")] = None,
    extrapolate: Annotated[bool, typer.Option("--extrapolate", help="Go beyond the identified pressures.")] = False,
    extensible: Annotated[bool, typer.Option("--stretch", help="The extensible rod, whose curve stretches.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the shape as CSV.")] = None,
) -> None:
    """The rod alone, in milliseconds: its shape under loads."""
    with _plain_endings():
        from pipeline.saved_rod import equilibrium, rod_at, shape_table
        from pipeline.store.atomic_file import write_whole

        chosen = rod_at(parameters, pressure, extrapolate, extensible)
        shape = equilibrium(chosen.rod, force=force, moment=moment, end_y=end_y, end=end)
        table = Table.grid(padding=(0, 2))
        table.add_row("end", f"x = {shape.x[-1]:.3f} mm, y = {shape.y[-1]:.3f} mm from the clamp")
        table.add_row("end angle", f"{shape.theta[-1]:.4f} rad")
        table.add_row("end force", f"[{shape.force[0]:.5g}, {shape.force[1]:.5g}] N")
        table.add_row("moment at the clamp", f"{shape.moment[0]:.5g} N mm")
        Console().print(table, highlight=False, soft_wrap=True)
        if chosen.moment_range is not None and (warning := chosen.moment_range.warning(shape)):
            Console().print(warning, highlight=False, soft_wrap=True)
        if out is not None:
            write_whole(out, shape_table(shape).encode())


@app.command()
def material(
    tests: Annotated[list[Path], typer.Argument(metavar="TENSILE.csv...", help="Nominal stress over nominal strain.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder.")] = Path("results/material"),
    nu: Annotated[float, typer.Option(metavar="NU", help="Poisson ratio; it gives rubber its kappa.")] = 0.495,
    up_to: Annotated[str | None, typer.Option(metavar="STRAIN", help="Leave out larger strains: '50 %'.")] = None,
    within: Annotated[str, typer.Option(metavar="SHARE", help="Error up to which a law may be used.")] = "10 %",
    break_strain: Annotated[str, typer.Option("--break", metavar="STRAIN", help="Between E_L and E_H.")] = "150 %",
    density: Annotated[str, typer.Option(metavar="RHO", help="For the configuration; not measured.")] = "1130 kg/m^3",
) -> None:
    """Tensile tests: constants of every law, the stretches it holds for, E_L and E_H."""
    with _plain_endings():
        from pipeline.material.fits import ALL, WIDEST, FitOptions
        from pipeline.material.sentences import caveats, moduli_sentences, yaml_block
        from pipeline.material.study import fit_material
        from pipeline.terminal import law_table

        fits = fit_material(tests, FitOptions.read(nu, density, break_strain, up_to, within), out)
        console = Console()
        for line in moduli_sentences(fits):
            console.print(line, highlight=False)
        for name in (ALL, WIDEST):
            console.print("", law_table(fits, name), highlight=False)
        console.print(f"\nfor a configuration, fitted to {WIDEST}:", highlight=False)
        for line in (yaml_block(fit, density) for fit in fits.usable.values()):
            console.print(line, highlight=False, soft_wrap=True)
        for sentence in ("", *caveats(fits)):
            console.print(sentence, highlight=False)
        console.print(f"written: {out / 'material.html'}, material.json, material_curves.csv", soft_wrap=True)


@app.command()
def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a finished run.")],
    to: Annotated[str, typer.Option("--to", metavar="NAME", help="csv, json, pyelastica, mujoco, somo or sorosim.")],
    pressure: Annotated[str | None, typer.Option(metavar="P", help="With its unit. [default: the highest]")] = None,
) -> None:
    """The identified rod as a file for another rod code."""
    with _plain_endings():
        from pipeline.saved_rod import exported

        Console().print(f"written: {exported(folder, to, pressure)}", highlight=False, soft_wrap=True)


@app.command()
def doctor() -> None:
    """What is installed, what is missing, and the one command that mends it."""
    with _plain_endings():
        from pipeline.doctor import examine, remedy

        console = Console()
        table = Table("", "what", "found", box=None, pad_edge=False)
        findings = examine()
        for finding in findings:
            table.add_row("[green]ok[/]" if finding.sound else "[red]no[/]", finding.subject, finding.found)
        console.print(table, highlight=False)
        command = remedy(findings)
        if command:
            raise RunFailed(f"something is missing; to mend it: {command}")
        console.print("everything pneurod needs is here", highlight=False)


def main() -> None:
    """The console script. A request to end, by a scheduler or a closed terminal, counts as Ctrl-C."""
    for request in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(request, signal.default_int_handler)
    app()


@contextmanager
def _plain_endings() -> Iterator[None]:
    """End with one sentence on stderr and the exit status of what went wrong."""
    try:
        yield
    except InputError as failure:
        _end(str(failure), 2)
    except RunFailed as failure:
        _end(str(failure), 1)
    except KeyboardInterrupt:
        _end("interrupted; what is finished is kept, and the same command goes on from there", 130)
    except MemoryError:
        _end("the memory of this machine does not suffice; choose a larger mesh.size or fewer --jobs", 1)
    except BrokenPipeError:
        _end("nobody reads the output any more; what is finished is kept, and the same command goes on from there", 1)
    except OSError as failure:
        if failure.errno is None:  # a library that could not be loaded
            _end(f"{failure}; `pneurod doctor` names the command that mends it", 1)
        place = f"{failure.filename}: " if failure.filename else ""
        _end(f"{place}{failure.strerror}; {_remedy(failure)}; what is finished is kept", 1)
    except RuntimeError as failure:
        if "no locator available" not in str(failure):  # numba's words, while it loads the kernels
            raise
        _end("compiled kernels can be kept nowhere; name a folder you may write to: NUMBA_CACHE_DIR=FOLDER", 1)
    except ImportError as failure:
        _end(f"{failure}; `pneurod doctor` names the command that mends it", 1)


def _remedy(failure: OSError) -> str:
    """What to do about a file that could not be read or written."""
    full = {errno.ENOSPC: "make room there", errno.EDQUOT: "make room there", errno.EFBIG: "allow larger files"}
    if failure.errno in full:
        return f"{full[failure.errno]} or give another --out, then the same command again"
    return "give a folder you may write to and files you may read"


def _end(sentence: str, status: int) -> NoReturn:
    typer.echo(f"pneurod: {sentence}", err=True)
    raise typer.Exit(status) from None
