"""The formats for other programs: an arm as chains of hinges and springs, or as tables.

CSV and JSON are in mm and N like everything here; the files of other programs are in m, kg, s, as those expect. The arm
lies in the plane x, y, clamped at the origin, and bends about z.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rod.errors import RodError
from rod.export.mujoco import write_mujoco
from rod.export.program import write_pyelastica
from rod.export.robot import Robot
from rod.export.somo import write_somo
from rod.export.tables import write_sorosim


@dataclass(frozen=True)
class Format:
    """How an arm is written for one program."""

    name: str  #: of the file, with {} for the pressures
    write: Callable[[Robot, Path], None]
    is_linear: bool = False  #: whether its springs are straight, those of the arm without load at each pressure
    has_shear: bool = False  #: whether the program has the shear of the arm itself
    one_pressure: bool = False  #: whether every pressure needs a file of its own
    beside: tuple[str, ...] = ()  #: suffixes of further files with the same name


#: the programs that take an arm with its mass
PROGRAMS: dict[str, Format] = {
    "mujoco": Format("rod_mujoco_{}.xml", write_mujoco, beside=(".py",)),
    "pyelastica": Format("rod_pyelastica_{}.py", write_pyelastica, has_shear=True),
    "somo": Format("rod_somo_{}.yaml", write_somo, is_linear=True, one_pressure=True, beside=(".urdf",)),
    "sorosim": Format("rod_sorosim_{}.mat", write_sorosim, is_linear=True),
}
#: what `pneurod export --to` offers
EXPORTS = ("csv", "json", *PROGRAMS)


def export_files(robot: Robot, target: str, folder: Path) -> dict[Path, Robot]:
    """The main files that `export_robot` writes, with what is in each. Raises `RodError` for an unknown program."""
    if target not in PROGRAMS:
        raise RodError(f"{target!r} is not among the programs of export: {', '.join(PROGRAMS)}.")
    form = PROGRAMS[target]
    parts = [robot.single(pressure) for pressure in robot.pressures] if form.one_pressure else [robot]
    return {folder / form.name.format(part.label): part for part in parts}


def with_beside(paths: list[Path], target: str) -> list[Path]:
    """Main files with those that a program has beside each."""
    return [path.with_suffix(suffix) for path in paths for suffix in (path.suffix, *PROGRAMS[target].beside)]


def export_robot(robot: Robot, target: str, folder: Path) -> list[Path]:
    """Write the arm for one of `PROGRAMS` into the folder and return the files.

    Raises `RodError` for another program, and where the arm has no mass.
    """
    files = export_files(robot, target, folder)
    _ = robot.body
    for path, part in files.items():
        PROGRAMS[target].write(part, path)
    return with_beside(list(files), target)
