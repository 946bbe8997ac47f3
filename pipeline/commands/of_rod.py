"""The commands that take an identified rod: rod, export."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.ending import errors_as_sentences, print_lines


def rod(
    parameters: Annotated[Path, typer.Argument(metavar="PARAMETERS.json", help="Of a finished run; or a law.json.")],
    pressure: Annotated[str, typer.Option(metavar="P", help="With its unit: '31 kPa'.")],
    force: Annotated[
        str | None, typer.Option(metavar="[FX, FY]", help="Dead force on the end: '[0 N, 0.05 N]'.")
    ] = None,
    moment: Annotated[str, typer.Option(metavar="M", help="Moment on the end: '1 N*mm'.")] = "0 N*mm",
    end_y: Annotated[
        str | None, typer.Option(metavar="Y", help="Height of the end over the clamped end: '0 mm'.")
    ] = None,
    end: Annotated[str | None, typer.Option(metavar="[X, Y]", help="Position of the end from the clamped end.")] = None,
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
    with errors_as_sentences():
        from pipeline.rods.end_loads import EndLoads, end_lines, write_shape
        from pipeline.rods.saved import rod_of_file

        selected = rod_of_file(parameters, pressure, extrapolate, extensible)
        shape = EndLoads.read(force, moment, end_y, end).shape(selected.rod)
        print_lines(*end_lines(selected, shape), *filter(None, [selected.warning(shape)]))
        if out is not None:
            write_shape(shape, out)


def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a finished run.")],
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="NAME", help="The format, required; without it the command ends with the list of formats."
        ),
    ] = None,
    pressure: Annotated[
        str | None, typer.Option(metavar="P", help="With its unit (default: all identified pressures).")
    ] = None,
    law: Annotated[
        str | None, typer.Option("--law", metavar="five|cell", help="Five parameters, or the arm's own law as a table.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for the files (default: DIR).")
    ] = None,
    smooth: Annotated[bool, typer.Option("--smooth", help="Rest curvature averaged over a cell.")] = False,
    extrapolate: Annotated[bool, typer.Option("--extrapolate", help="Go beyond the identified pressures.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
) -> None:
    """The identified rod as a file for another rod code, with the pressure as its input."""
    with errors_as_sentences():
        from pipeline.rods.export import ExportOptions, exported, left_out

        options = ExportOptions(pressure, law, out, smooth, extrapolate, force)
        print_lines(*(f"written: {file}" for file in exported(folder, to, options)), *left_out(folder, to, options))
