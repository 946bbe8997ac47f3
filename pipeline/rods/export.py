"""The rod of a result folder in the files of other rod codes."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from pipeline.cell.saved import SavedLaw
from pipeline.config.units import PRESSURE
from pipeline.errors import InputError, RunFailed
from pipeline.results.files import read_results
from pipeline.rods.choice import refuse_out_of_plane
from pipeline.rods.options import option_value
from pipeline.rods.saved import SavedRod
from pipeline.store.result_folder import open_folder
from rod import EXPORTS, Arm, RodError, export_arm
from rod.export.arm import divide_pressures
from rod.export.formats import export_files
from rod.export.tables import unloaded_distance
from rod.pressurised_rod import IDENTIFIED
from rod.same_pressure import as_known

#: the laws of a result folder that can be exported
LAWS = ("five", "cell")


@dataclass(frozen=True)
class ExportOptions:
    """What `pneurod export` was asked for beside the folder and the format."""

    pressure: str | None = None  #: with its unit; None for all identified pressures
    law: str | None = None  #: one of LAWS; None for the five parameters, or for the only law there is
    out: Path | None = None  #: folder of the files; None for the result folder
    smooth: bool = False  #: kappa_0 averaged over a cell instead of that with its ripple
    extrapolate: bool = False  #: beyond the identified pressures
    force: bool = False  #: replace files that exist


def exported(folder: Path, target: str | None, options: ExportOptions) -> list[Path]:
    """Write the rod of a result folder for another code and return the files.

    Raises InputError for an unknown target, which it answers with the known ones, for other options that do not fit and
    for files that exist or a folder that cannot be written, and RunFailed where the target cannot take the rod.
    """
    if target not in EXPORTS:
        raise InputError(f"--to{'' if target is None else f' {target}'}: allowed are {', '.join(EXPORTS)}")
    if options.law not in (None, *LAWS):
        raise InputError(f"--law {options.law}: allowed are {', '.join(LAWS)}")
    if folder.is_file():
        raise InputError(f"{folder}: is a file; give the folder of the run, {folder.parent}")
    if (folder / "run.json").is_file():
        refuse_out_of_plane(read_results(folder))
    into = options.out or folder
    if _takes_law(folder, options):
        return [_law_table(folder / "law.json", target, into, options)]
    try:
        arm = _arm(folder / "parameters.json", options)
        arm = arm.smoothed() if options.smooth else arm
        for path in export_files(arm, target, into):
            _refuse_existing(path, options)
        return export_arm(arm, target, open_folder(into).directory)
    except RodError as failure:
        raise RunFailed(str(failure)) from None


def left_out(folder: Path, target: str | None, options: ExportOptions) -> list[str]:
    """Sentences on numbers that are not identified ones, and on what the exported rod leaves out: its stretch and its
    shape without load; none for a law.

    Raises as `exported`.
    """
    path = folder / "parameters.json"
    if target is None or _takes_law(folder, options):
        return []
    saved = SavedRod.read(path, extensible=False)
    pressures = [options.pressure] if options.pressure else [f"{known:g} kPa" for known in saved.rods.pressures]
    selected = {pressure: saved.at(pressure, options.extrapolate) for pressure in pressures}
    sentences = list(dict.fromkeys(note for rod in selected.values() for note in rod.notes))
    if SavedRod.has_extensible(path):
        stretching = SavedRod.read(path, extensible=True)
        apart = {
            p: math.dist(rod.solve().end, stretching.at(p, options.extrapolate).solve().end)
            for p, rod in selected.items()
        }
        sentences.append(
            f"The exported rod is inextensible (five). {_unloaded('the rod that stretches (five_extensible)', apart)}."
        )
    if not saved.rods.straight_without_pressure:
        below = ", nor a pressure below those of the file, where its arm becomes straight"
        below = below if EXPORTS[target].from_rest else ""
        sentences.append(
            "kappa_0 contains what bends the arm besides the pressure of the run (its weight, a constant pressure in a "
            f"cavity): do not apply that once more in the other program{below}."
        )
    if any(saved.rods.weight):
        sentences.append(
            "The exported rod keeps the moments that its weight has without load; how they change when a load moves it "
            "is left out (pneurod rod has it)."
        )
    if not EXPORTS[target].has_kappa_0:
        apart = {p: unloaded_distance(rod) for p, rod in selected.items()}
        sentences.append(
            "The file describes a loaded rod, with the rest curvature kappa_0 - m0/alpha. "
            f"{_unloaded('the five parameters', apart)}; csv and json have kappa_0, the curvature without load, too."
        )
    return sentences


def _unloaded(other: str, apart: Mapping[str, float]) -> str:
    """How far the end of the exported rod without load is from that of another rod at most, with the pressure.

    apart: the distances in mm by pressure, at least one.
    """
    worst = max(apart, key=lambda pressure: apart[pressure])
    at_most = "up to " if len(apart) > 1 else ""
    return f"Without load its end is {at_most}{apart[worst]:.3g} mm from that of {other} at {worst}"


def _takes_law(folder: Path, options: ExportOptions) -> bool:
    only_law = not (folder / "parameters.json").is_file() and (folder / "law.json").is_file()
    return options.law == "cell" or (options.law is None and only_law)


def _arm(path: Path, options: ExportOptions) -> Arm:
    """The inextensible rod of a parameters.json: no format takes a stretch that follows the curvature."""
    saved, origin = SavedRod.read(path, extensible=False), IDENTIFIED
    if options.pressure is None:
        pressures = tuple(float(pressure) for pressure in saved.rods.pressures)
        rods = tuple(saved.rods.at(pressure) for pressure in pressures)
        deviations: Mapping[str, tuple[float, ...]] = saved.deviations
    else:
        pressures = (as_known(saved.rods.pressures, option_value("--pressure", options.pressure, PRESSURE)),)
        if pressures[0] <= 0.0:
            raise InputError(
                f"--pressure {options.pressure}: is not exported; give one above 0 kPa, at which the arm is at rest"
            )
        rods, deviations = (saved.at(options.pressure, options.extrapolate),), saved.deviations_at(pressures[0])
        origin = saved.rods.origin_at(pressures[0])
    radius = math.sqrt(saved.area_mm2 / math.pi)
    arm = Arm(
        pressures,
        rods,
        saved.mass_g,
        radius,
        saved.modulus_MPa,
        origin=origin,
        deviations=deviations,
        smooth=saved.smooth(pressures),
    )
    if len(pressures) == 1:
        return arm
    more = divide_pressures(pressures)
    between = tuple(saved.rods.at(pressure) for pressure in more)
    return replace(arm, finer=replace(arm, pressures=more, rods=between, deviations={}, smooth=saved.smooth(more)))


def _law_table(path: Path, target: str, into: Path, options: ExportOptions) -> Path:
    """The arm's own law as a table."""
    if options.extrapolate or options.smooth:
        raise InputError("--extrapolate, --smooth: are for the five parameters; the arm's own law takes neither")
    saved = SavedLaw.read(path)
    value = None if options.pressure is None else option_value("--pressure", options.pressure, PRESSURE)
    try:
        file = into / saved.file_name(target, value)
        _refuse_existing(file, options)
        open_folder(into)
        saved.export(target, file, value)
    except RodError as failure:
        raise InputError(f"--pressure {options.pressure}: {failure}") from None
    return file


def _refuse_existing(path: Path, options: ExportOptions) -> None:
    if path.exists() and not options.force:
        raise InputError(f"{path}: exists; give another --out, or --force to replace it")
