"""Arguments that several functions have, with their meaning on the command line.

The command line reads texts, numbers and paths. Where Python takes more, what the command line reads stands between the
type and the option.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Protocol, TypeAlias, TypeVar

import typer

from pipeline.values.table import Table

if TYPE_CHECKING:
    from pipeline.api.described import Body
    from pipeline.values.json_values import Written


class Saved(Protocol):
    """What has left its results in a folder: the value of `read_results`, `characterize`, `cell` or `calibrate`."""

    @property
    def directory(self) -> Path:
        """The folder."""
        ...


#: a number in mm, N, N mm, kPa or degrees, or a text with its unit
Amount: TypeAlias = float | str
Vector: TypeAlias = Amount | Sequence[Amount]
#: a folder or file of results, or the value of the function that wrote it
Given: TypeAlias = Path | str | Saved


class HasLines(Protocol):
    """A value that a terminal shows."""

    @property
    def lines(self) -> Sequence[str | Table]:
        """Sentences and tables, in their order."""


Function = TypeVar("Function", bound=Callable[..., HasLines])
#: functions that `command` made commands, by the names of these
COMMANDS: dict[str, Callable[..., HasLines]] = {}


def command(name: str) -> Callable[[Function], Function]:
    """Make a function a command of the command line, which prints the lines of its value."""

    def named(function: Function) -> Function:
        COMMANDS[name] = function
        return function

    return named


def show_plainly(function: Callable[..., Any]) -> None:
    """Let `help` show the arguments of a function without what the command line needs of them."""
    signature = inspect.signature(function)
    plain = [
        one.replace(annotation=getattr(one.annotation, "__origin__", one.annotation))
        if hasattr(one.annotation, "__metadata__")
        else one
        for one in signature.parameters.values()
    ]
    function.__signature__ = signature.replace(parameters=plain)  # type: ignore[attr-defined]


ConfigFile = Annotated[
    "Path | str | Body", Path, typer.Argument(metavar="CONFIG", help="A design in YAML, such as configs/pneunet.yaml.")
]
Settings = Annotated[
    "Mapping[str, Written] | Sequence[str] | None",
    list[str],
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value: --set mesh.size='4 mm'. May be repeated."),
]
Accuracy = Annotated[
    str | None,
    typer.Option("--accuracy", metavar="P%", help="Error that the mesh may make of the arm's own law: 1%, or off."),
]
Draft = Annotated[
    bool, typer.Option("--draft", help="Only the arm's own law on one mesh, whose error is unknown: seconds.")
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Delete earlier results in DIR and begin again.")]
Orientation = Annotated[
    str | None,
    typer.Option(
        metavar="O", help="hanging, lying, standing, '30 deg' that it rises, or gravity as '[X, Y]': with its weight."
    ),
]
HeldAt = Annotated[
    Sequence[str],
    list[str],
    typer.Option(metavar="S: HELD", help="A support along the arm: '0.5 l: y -3 mm, angle 5 deg'. Repeatable."),
]
ForceAt = Annotated[
    Sequence[str],
    list[str],
    typer.Option(metavar="S: [FX, FY]", help="Dead force along the arm: '0.5 l: [0 N, 0.02 N]'. Repeatable."),
]
LineLoad = Annotated[
    Sequence[str],
    list[str],
    typer.Option(metavar="S to S: [QX, QY]", help="'0.2 l to 0.8 l: [0 N/m, 0.5 N/m]'. Repeatable."),
]
MassAt = Annotated[
    Sequence[str],
    list[str],
    typer.Option(metavar="S: M", help="A mass that hangs along the arm: '0.5 l: 5 g', '56 mm: 5 g'. Repeatable."),
]
TipMass = Annotated[Amount | None, str, typer.Option(metavar="M", help="A mass that hangs on the end: '20 g'.")]
Rod = Annotated[
    str | None,
    typer.Option(
        "--rod",
        metavar="law|five",
        help="The arm's own law, or five parameters; by default the rod that the verdict recommends.",
    ),
]
Ratio = Annotated[
    str | None,
    typer.Option("--ratio", metavar="A:B", help="Of the pressures of a law that has several: 1:0.5."),
]
MeasuredFile = Annotated[Path | str, typer.Argument(metavar="MEASURED.csv", help="Measured rows, see docs/results.md.")]
Align = Annotated[bool, typer.Option("--align", help="Move the rows so that those at rest lie on the rod.")]


def out_option(suffix: str = "") -> Any:
    """The option --out of a result folder."""
    return typer.Option("--out", metavar="DIR", help=f"Result folder (default: results/NAME{suffix}).")


def jobs_option(default: str) -> Any:
    """The option --jobs of worker processes."""
    return typer.Option("--jobs", min=1, help=f"Number of worker processes (default: {default}).")


Folder = Annotated[Given, typer.Argument(metavar="DIR", help="Results of a run or of `pneurod cell`.")]
Out = Annotated[Path | str | None, out_option()]
