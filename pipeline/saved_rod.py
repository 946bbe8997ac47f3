"""The identified rod alone: from parameters.json to shapes in milliseconds, and to files of other rod codes."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.config.units import FORCE, LENGTH, MOMENT, PRESSURE, Dimension, convert
from pipeline.errors import InputError, RunFailed
from pipeline.store.formats import with_present_keys
from rod import (
    EXPORTS,
    Arm,
    Extension,
    FiveParameters,
    MomentRange,
    PressurisedRod,
    Rod,
    RodError,
    RodSolution,
    export,
)

_LAW = ("alpha1_N_mm2", "alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm")


def read_rod(path: Path, extensible: bool = False) -> tuple[PressurisedRod, Mapping[str, Any]]:
    """The rod of a parameters.json over its pressures, extensible or not, and the file's content with present keys.

    Raises InputError.
    """
    try:
        content = with_present_keys(json.loads(path.read_text(encoding="utf-8")))
        rod = pressurised_rod(content, extensible)
    except OSError as failure:
        raise InputError(f"{path}: cannot be read ({failure.strerror}); give the parameters.json of a run") from None
    except (KeyError, TypeError, ValueError) as failure:
        said = f"the key {failure} is missing" if isinstance(failure, KeyError) else str(failure)
        raise InputError(f"{path}: is not the parameters.json of a finished run: {said}") from None
    return rod, content


def pressurised_rod(content: Mapping[str, Any], extensible: bool = False) -> PressurisedRod:
    """The rod of the content of a parameters.json. Raises KeyError, TypeError or ValueError for one that has none."""
    profile = content["kappa_0"]
    of_rod = content["eccentricity"] if extensible else content
    stretches = zip(of_rod["rest_stretch"], of_rod["eccentricity_mm"], strict=True) if extensible else ()
    return PressurisedRod(
        length=float(content["length_mm"]),
        pressures=np.array(content["pressures_kPa"], dtype=float),
        laws=tuple(FiveParameters(*row) for row in zip(*(of_rod[key] for key in _LAW), strict=True)),
        s=np.array(profile["s_mm"], dtype=float),
        kappa_0=np.array(profile["kappa_0_per_mm"], dtype=float),
        theta0=np.array(profile["theta0_rad"], dtype=float),
        extensions=tuple(Extension(np.array(profile["s_mm"]), np.array(rest), e) for rest, e in stretches),
        moment_ranges=tuple(MomentRange(*ends) for ends in content.get("moment_range_N_mm", ())),
    )


@dataclass(frozen=True)
class Chosen:
    """The rod of a file at one pressure."""

    rod: Rod
    moment_range: MomentRange | None  #: of the loaded curve behind its parameters, None where the file has none
    content: Mapping[str, Any]  #: of the file


def rod_at(path: Path, pressure: str, extrapolate: bool, extensible: bool = False) -> Chosen:
    """The rod at a pressure written with its unit, clamped as the material curve begins. Raises InputError."""
    rod, content = read_rod(path, extensible)
    value = _value("--pressure", pressure, PRESSURE)
    try:
        chosen = rod.at(value, extrapolate=extrapolate)
    except RodError as failure:
        raise InputError(f"--pressure {pressure}: {failure} Give --extrapolate to go beyond it.") from None
    return Chosen(chosen, rod.moment_range_at(value, extrapolate=extrapolate), content)


def equilibrium(rod: Rod, *, force: str | None, moment: str, end_y: str | None, end: str | None) -> RodSolution:
    """The shape under loads written with their units, positions relative to the clamp.

    Raises InputError for loads that cannot be read and RunFailed where there is no equilibrium.
    """
    given = {
        "force": None if force is None else _pair("--force", force, FORCE),
        "end": None if end is None else _pair("--end", end, LENGTH),
        "end_y": None if end_y is None else _value("--end-y", end_y, LENGTH),
    }
    try:
        return rod.solve(**given, moment=_value("--moment", moment, MOMENT))  # type: ignore[arg-type]
    except RodError as failure:
        raise RunFailed(str(failure)) from None


def exported(folder: Path, target: str, pressure: str | None) -> Path:
    """Write the rod of a result folder for another code; the highest pressure where none is given."""
    if target not in EXPORTS:
        raise InputError(f"--to {target}: allowed are {', '.join(EXPORTS)}")
    rod, content = read_rod(folder / "parameters.json")
    chosen = rod_at(folder / "parameters.json", pressure or f"{rod.pressures[-1]} kPa", False)
    modulus = float(content["material"].get("E", 1.0))
    area = float(content["mass_g"]) / (rod.length * 1e6 * float(content["material"]["density_tonne_mm3"]))
    try:
        return export(Arm(chosen.rod, float(content["mass_g"]), float(np.sqrt(area / np.pi)), modulus), target, folder)
    except RodError as failure:
        raise RunFailed(str(failure)) from None


def shape_table(shape: RodSolution) -> str:
    """The shape as CSV: s_mm, x_mm, y_mm, theta_rad, kappa_per_mm, moment_N_mm."""
    columns = (shape.s, shape.x, shape.y, shape.theta, shape.kappa, shape.moment)
    rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
    return "\n".join(["s_mm,x_mm,y_mm,theta_rad,kappa_per_mm,moment_N_mm", *rows]) + "\n"


def _value(option: str, text: str, dimension: Dimension) -> float:
    try:
        return convert(text, dimension)
    except ValueError as failure:
        raise InputError(f"{option}: {failure}") from None


def _pair(option: str, text: str, dimension: Dimension) -> tuple[float, float]:
    values = text.strip().removeprefix("[").removesuffix("]").split(",")
    if len(values) != 2:
        raise InputError(f"{option}: '{text}' is not a pair; write it as [{dimension.example}, {dimension.example}]")
    return _value(option, values[0], dimension), _value(option, values[1], dimension)
