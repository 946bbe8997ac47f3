"""The rod alone: from parameters.json or law.json to shapes under loads, and to files of other rod codes."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.cell.saved import SavedLaw, is_law
from pipeline.config.units import FORCE, LENGTH, MOMENT, PRESSURE, Dimension, convert
from pipeline.errors import InputError, RunFailed
from pipeline.store.atomic_file import write_atomic
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


@dataclass(frozen=True)
class SavedRod:
    """The identified rod of a parameters.json over its pressures, and the arm it belongs to."""

    rods: PressurisedRod
    mass_g: float
    modulus_MPa: float  #: Young's modulus of the material, 1 where its law has none
    density_tonne_mm3: float

    @property
    def radius_mm(self) -> float:
        """Radius of a circular rod with the length and the mass of the arm."""
        area = self.mass_g / (self.rods.length * 1e6 * self.density_tonne_mm3)
        return float(np.sqrt(area / np.pi))

    @staticmethod
    def read(path: Path, extensible: bool | None = None) -> "SavedRod":
        """The inextensible or the extensible rod of a file, also of an earlier format. Raises InputError.

        extensible: None for the rod that stretches where the arm does, see `PressurisedRod.stretches`.
        """
        try:
            content = with_present_keys(json.loads(path.read_text(encoding="utf-8")))
            material = content["material"]
            return SavedRod(
                default_rod(content) if extensible is None else pressurised_rod(content, extensible),
                float(content["mass_g"]),
                float(material.get("E", 1.0)),
                float(material["density_tonne_mm3"]),
            )
        except OSError as failure:
            reason = f"cannot be read ({failure.strerror}); give the parameters.json of a run"
            raise InputError(f"{path}: {reason}") from None
        except (AttributeError, KeyError, TypeError, ValueError) as failure:
            problem = f"the key {failure} is missing" if isinstance(failure, KeyError) else str(failure)
            raise InputError(f"{path}: is not the parameters.json of a finished run: {problem}") from None

    def at(self, pressure: str, extrapolate: bool = False) -> "RodAtPressure":
        """The rod at a pressure written with its unit, clamped as the material curve begins. Raises InputError."""
        value = _value("--pressure", pressure, PRESSURE)
        try:
            rod = self.rods.at(value, extrapolate=extrapolate)
        except RodError as failure:
            raise InputError(f"--pressure {pressure}: {failure} Give --extrapolate to go beyond it.") from None
        return RodAtPressure(rod, self.rods.moment_range_at(value, extrapolate=extrapolate))


@dataclass(frozen=True)
class RodAtPressure:
    """The rod of a file at one pressure."""

    rod: Rod
    moment_range: MomentRange | None  #: of the identification, None where the file has none

    def warning(self, shape: RodSolution) -> str:
        """A sentence where the moments of a shape leave the range of the identification; empty elsewhere."""
        return self.moment_range.warning(shape) if self.moment_range is not None else ""


def rod_of_file(path: Path, pressure: str, extrapolate: bool, extensible: bool | None) -> RodAtPressure:
    """The rod of a parameters.json or of a law.json at a pressure written with its unit. Raises InputError."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        content = None  # the sentence is that of the parameters
    if not is_law(content):
        return SavedRod.read(path, extensible).at(pressure, extrapolate)
    if extrapolate:
        raise InputError("--extrapolate: the arm's own law is not extrapolated; measure it at more pressures")
    try:
        return RodAtPressure(SavedLaw.of(path, content).rod(_value("--pressure", pressure, PRESSURE)), None)
    except RodError as failure:
        raise InputError(f"--pressure {pressure}: {failure}") from None


@dataclass(frozen=True)
class EndLoads:
    """Loads on the end of a rod, positions relative to the clamp; None for what is not prescribed."""

    force: tuple[float, float] | None  #: N
    moment: float  #: N mm
    end_y: float | None  #: mm
    end: tuple[float, float] | None  #: mm

    @staticmethod
    def read(force: str | None, moment: str, end_y: str | None, end: str | None) -> "EndLoads":
        """From the options of the command line, written with units. Raises InputError."""
        return EndLoads(
            None if force is None else _pair("--force", force, FORCE),
            _value("--moment", moment, MOMENT),
            None if end_y is None else _value("--end-y", end_y, LENGTH),
            None if end is None else _pair("--end", end, LENGTH),
        )

    def shape(self, rod: Rod) -> RodSolution:
        """The equilibrium of a rod under these loads. Raises RunFailed where there is none."""
        try:
            return rod.solve(force=self.force, moment=self.moment, end_y=self.end_y, end=self.end)
        except RodError as failure:
            raise RunFailed(str(failure)) from None


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


def default_rod(content: Mapping[str, Any]) -> PressurisedRod:
    """The rod of the content of a parameters.json that stretches if the arm does, else the inextensible one.

    Raises as `pressurised_rod`.
    """
    if content.get("eccentricity"):
        extensible = pressurised_rod(content, extensible=True)
        if extensible.stretches:
            return extensible
    return pressurised_rod(content)


def exported(folder: Path, target: str | None, pressure: str | None) -> Path:
    """Write the rod of a result folder for another code; the highest pressure where none is given.

    Raises InputError for an unknown target, which it answers with the known ones, and RunFailed where the target cannot
    take the rod.
    """
    if target not in EXPORTS:
        raise InputError(f"--to{'' if target is None else f' {target}'}: allowed are {', '.join(EXPORTS)}")
    if not (folder / "parameters.json").is_file() and (folder / "law.json").is_file():
        value = None if pressure is None else _value("--pressure", pressure, PRESSURE)
        try:
            return SavedLaw.read(folder / "law.json").export(target, folder, value)
        except RodError as failure:
            raise InputError(f"--pressure {pressure}: {failure}") from None
    saved = SavedRod.read(folder / "parameters.json", extensible=False)  # no format takes a stretch over the curvature
    rod = saved.at(pressure or f"{saved.rods.pressures[-1]} kPa").rod
    try:
        return export(Arm(rod, saved.mass_g, saved.radius_mm, saved.modulus_MPa), target, folder)
    except RodError as failure:
        raise RunFailed(str(failure)) from None


def end_lines(shape: RodSolution) -> list[str]:
    """Position, angle and force of the end, and the moment at the clamp, one line each."""
    x, y = _material_curve(shape)
    lines = {
        "end": f"x = {x[-1]:.3f} mm, y = {y[-1]:.3f} mm from the clamp",
        "end angle": f"{shape.theta[-1]:.4f} rad",
        "end force": f"[{shape.force[0]:.5g}, {shape.force[1]:.5g}] N",
        "moment at the clamp": f"{shape.moment[0]:.5g} N mm",
    }
    width = max(map(len, lines))
    return [f"{name:<{width}}  {value}" for name, value in lines.items()]


def write_shape(shape: RodSolution, file: Path) -> None:
    """Write the shape as CSV: s_mm, x_mm, y_mm, theta_rad, kappa_per_mm, moment_N_mm."""
    columns = (shape.s, *_material_curve(shape), shape.theta, shape.kappa, shape.moment)
    rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
    write_atomic(file, ("\n".join(["s_mm,x_mm,y_mm,theta_rad,kappa_per_mm,moment_N_mm", *rows]) + "\n").encode())


def _material_curve(shape: RodSolution) -> tuple[Array, Array]:
    """x (n,) and y (n,) of the material curve at the positions of a shape, mm."""
    if shape.beside is None:
        return shape.x, shape.y
    x, y = shape.positions(shape.s).T
    return x, y


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
