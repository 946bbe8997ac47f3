"""The five parameters in the files of other rod codes.

M = alpha (kappa - kappa_0) + m0 is alpha (kappa - kappa_rest) with kappa_rest = kappa_0 - m0/alpha, so every code with
a bending stiffness and a rest curvature per node can represent them, for loaded rods (see `rod.law`). CSV and JSON are
in mm and N like everything here; the files of other codes are in m, kg, s, as those expect. The rod lies in the plane
x, y, clamped at the origin, and bends about z.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rod.errors import RodError
from rod.export.arm import Arm
from rod.export.chain import write_mujoco, write_somo
from rod.export.pyelastica import write_pyelastica
from rod.export.tables import write_csv, write_json, write_sorosim


@dataclass(frozen=True)
class Format:
    """How an arm is written for one program."""

    name: str  #: of the file, with {} for the pressures
    write: Callable[[Arm, Path], None]
    one_pressure: bool = False  #: whether every pressure needs a file of its own
    beside: tuple[str, ...] = ()  #: suffixes of further files with the same name
    from_rest: bool = False  #: whether its arm is straight without pressure, and bends from there to the lowest one
    has_kappa_0: bool = False  #: whether it has the shape without load beside the rest curvature of a loaded rod


#: what `pneurod export --to` offers
EXPORTS: dict[str, Format] = {
    "csv": Format("rod_{}.csv", write_csv, has_kappa_0=True),
    "json": Format("rod_{}.json", write_json, has_kappa_0=True),
    "pyelastica": Format("rod_pyelastica_{}.py", write_pyelastica, from_rest=True),
    "mujoco": Format("rod_mujoco_{}.xml", write_mujoco, from_rest=True),
    "somo": Format("rod_somo_{}.yaml", write_somo, one_pressure=True, beside=(".urdf",)),
    "sorosim": Format("rod_sorosim_{}.mat", write_sorosim),
}


def export_files(arm: Arm, target: str, folder: Path) -> dict[Path, Arm]:
    """The files that `export_arm` writes, with what is in each. Raises `RodError` for a target not in EXPORTS."""
    if target not in EXPORTS:
        raise RodError(f"{target!r} is not among the formats of export: {', '.join(EXPORTS)}.")
    form = EXPORTS[target]
    parts = [arm.single(k) for k in range(len(arm.pressures))] if form.one_pressure else [arm]
    return {folder / form.name.format(part.label): part for part in parts}


def export_arm(arm: Arm, target: str, folder: Path) -> list[Path]:
    """Write the arm for one of EXPORTS into the folder and return the files. Raises `RodError` for another target."""
    files = export_files(arm, target, folder)
    for path, part in files.items():
        EXPORTS[target].write(part, path)
    return [path.with_suffix(suffix) for path in files for suffix in (path.suffix, *EXPORTS[target].beside)]
