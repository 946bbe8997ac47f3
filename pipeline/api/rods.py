"""Questions to the rod of a result folder."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.api.course import given_choice, given_path, given_progress
from pipeline.api.options import (
    Amount,
    Folder,
    ForceAt,
    Given,
    HeldAt,
    LineLoad,
    MassAt,
    Orientation,
    Ratio,
    Rod,
    TipMass,
    Vector,
    command,
)
from pipeline.store.progress import Progress

__all__ = ["budget", "export", "move", "shape", "solve"]

if TYPE_CHECKING:
    from pipeline.answers.rods import end_loads, pressures
    from pipeline.answers.rods.budget import Budget
    from pipeline.answers.rods.export import Exported
    from pipeline.answers.rods.motion import ArmMotion


@command("rod")
def shape(
    path: Annotated[
        Given, typer.Argument(metavar="DIR", help="Results of a run; or a parameters.json or law.json alone.")
    ],
    pressure: Annotated[Vector, str, typer.Option(metavar="P", help="With its unit: '31 kPa', or '[20 kPa, 5 kPa]'.")],
    *,
    force: Annotated[
        Vector | None, str, typer.Option(metavar="[FX, FY]", help="Dead force: '[0 N, 0.05 N]', '0.05 N', with FZ.")
    ] = None,
    moment: Annotated[
        Vector, str, typer.Option(metavar="M", help="Moment on the end: '1 N*mm', in space '[MX, MY, MZ]'.")
    ] = "0 N*mm",
    end_y: Annotated[Amount | None, str, typer.Option(metavar="Y", help="Height of the end from the clamp.")] = None,
    end: Annotated[
        Vector | None, str, typer.Option(metavar="[X, Y]", help="Position of the end from the clamp, in space with Z.")
    ] = None,
    force_at: ForceAt = (),
    line_load: LineLoad = (),
    held_at: HeldAt = (),
    orientation: Orientation = None,
    tip_mass: TipMass = None,
    mass_at: MassAt = (),
    rod: Rod = None,
    after_snap: Annotated[
        bool, typer.Option("--after-snap", help="The swollen form, where the arm has two at this pressure.")
    ] = False,
    out: Annotated[Path | str | None, typer.Option("--out", metavar="FILE", help="Write the shape as CSV.")] = None,
) -> "end_loads.RodShape":
    """Solve the rod alone, in milliseconds: its shape under loads.

    Raises `pneurod.InputError` for a wrong argument, and `pneurod.RunFailed` where the rod has no equilibrium.
    """
    from pipeline.answers.rods import choice, end_loads

    loading = end_loads.read_loading(orientation, tip_mass, mass_at, force=force, moment=moment, end_y=end_y, end=end)
    chosen = choice.rod_of_path(given_path(path, "path", "results/arm"), rod)
    chosen = chosen.wanted(after_snap=given_choice(after_snap, "after_snap"))
    selected = end_loads.rod_at(chosen, pressure)
    along = end_loads.read_along(selected.length, force_at, line_load, held_at)
    found = end_loads.shape_under(selected, replace(loading, along=along))
    if out is not None:
        end_loads.write_shape(found, given_path(out, "out", "shape.csv"))
    return end_loads.RodShape(selected, found, chosen.error_text)


@command("move")
def move(
    path: Annotated[Given, typer.Argument(metavar="DIR", help="Results of a run, of `cell` or of `calibrate`.")],
    pressure: Annotated[
        float | str | Path,
        str,
        typer.Option(metavar="P|FILE.csv", help="'20 kPa' from 0 s on, or a file t_s, pressure_kPa."),
    ],
    *,
    seconds: Annotated[float, typer.Option(metavar="T", help="How long, in s.")] = 3.0,
    force: Annotated[
        str | None, typer.Option(metavar="[FX, FY]", help="Dead force on the end from 0 s on: '[0 N, 0.05 N]'.")
    ] = None,
    held_at: HeldAt = (),
    orientation: Orientation = None,
    tip_mass: TipMass = None,
    release: Annotated[
        bool, typer.Option("--release", help="Let the arm go at 0 s: of --force, or else of what held it weightless.")
    ] = False,
    air: Annotated[
        str | None,
        typer.Option(metavar="AIR", help="'flow 1 l/min', 'supply 40 kPa, conductance 20 mm^3/s/kPa' or 'closed'."),
    ] = None,
    rod: Rod = None,
    ratio: Ratio = None,
    out: Annotated[Path | str | None, typer.Option("--out", metavar="DIR2", help="Folder (default: DIR).")] = None,
    progress: "bool | Progress" = False,
) -> "ArmMotion":
    """Move the arm in time: motion.csv, and a picture of the shapes.

    progress: tell it on the terminal, where one waits, or to a `Progress`. Its rubber relaxes as material.relaxation
    and material.loss_factor say. Raises `pneurod.InputError` for a wrong argument, and `pneurod.RunFailed`, which has
    the motion up to the last good time as `reached`.
    """
    from pipeline.answers.rods import choice, end_loads, motion

    loading = end_loads.read_loading(orientation, tip_mass, force=force)
    asked = motion.MotionRequest.read(pressure, seconds, loading, release=given_choice(release, "release"), air=air)
    run = choice.run_along(given_path(path, "path", "results/arm"), ratio)
    target, rods = run.directory if out is None else given_path(out, "out", "results/arm"), choice.choose_rod(run, rod)
    along = end_loads.read_along(rods.law.length, held_at=held_at)
    asked = replace(asked, loading=replace(loading, along=along))
    return motion.move_arm(run, rods, asked, target, given_progress(progress).remark)


def solve(
    path: Annotated[Given, typer.Argument(metavar="DIR", help="Results of a run; or a law.json alone.")],
    *,
    tip: Annotated[Vector | None, str, typer.Option(metavar="[X, Y]", help="Of the end: '[30 mm, -40 mm]'.")] = None,
    angle: Annotated[Amount | None, str, typer.Option(metavar="A", help="How far the arm bends: '90 deg'.")] = None,
    force: Annotated[Amount | None, str, typer.Option(metavar="F", help="On the held end, upwards: '0.05 N'.")] = None,
    at_height: Annotated[Amount | None, str, typer.Option(metavar="Y", help="At which it is held: '0 mm'.")] = None,
    orientation: Orientation = None,
    tip_mass: TipMass = None,
    rod: Rod = None,
    ratio: Ratio = None,
) -> "pressures.Solutions":
    """Find the pressure for a place of the end, an angle, or a force.

    Raises `pneurod.InputError` for a wrong argument and for what is out of reach, with the nearest that is not.
    """
    from pipeline.answers.rods import choice, end_loads, pressures

    loading = end_loads.read_loading(orientation, tip_mass)
    wish = pressures.Wish.read(tip, angle, force, at_height, loading)
    chosen = choice.choose_rod(choice.run_along(given_path(path, "path", "results/arm"), ratio), rod)
    found = pressures.pressures_for(chosen, wish)
    return pressures.Solutions(found, chosen.notes)


def budget(
    folder: Folder,
    *,
    pressure: Annotated[
        Amount | None, str, typer.Option(metavar="P", help="Of the table, with its unit (default: the highest one).")
    ] = None,
    tolerances: Annotated[
        Sequence[str],
        list[str],
        typer.Option("--tolerance", metavar="KEY=VALUE", help="geometry.wall='0.1 mm', process=printed. Repeatable."),
    ] = (),
    ratio: Ratio = None,
    out: Annotated[
        Path | str | None, typer.Option("--out", metavar="FILE", help="The picture (default: DIR/budget.html).")
    ] = None,
) -> "Budget":
    """Find by how much each tolerance of a built arm moves the tip, the curvature, the rigidity and the force.

    tolerances: texts KEY=VALUE, in place of those of the configuration. Raises `pneurod.InputError`.
    """
    from pipeline.answers.rods.budget import budget_for

    picture = None if out is None else given_path(out, "out", "budget.html")
    found, _ = budget_for(given_path(folder, "folder", "results/arm"), pressure, tolerances, picture, ratio)
    return found


@command("export")
def export(
    folder: Annotated[Given, typer.Argument(metavar="DIR", help="Results of a run, of `cell` or of `calibrate`.")],
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="NAME", help="The format, required; without it the command ends with the list of formats."
        ),
    ] = None,
    *,
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
    ratio: Ratio = None,
    out: Annotated[
        Path | str | None, typer.Option("--out", metavar="DIR", help="Folder for the files (default: DIR).")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
) -> "Exported":
    """Export the rod to take as a file for another program, with the pressure as its input.

    Raises `pneurod.InputError` for another format, a rod that it cannot take, and files that exist.
    """
    from pipeline.answers.rods import export as exports

    target = None if out is None else given_path(out, "out", "results/arm")
    options = exports.ExportOptions(pressure, rod, target, given_choice(force, "force"), ratio)
    return exports.exported(given_path(folder, "folder", "results/arm"), to, options)
