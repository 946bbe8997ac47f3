"""From centrelines to the five numbers per pressure, by cell averages and by a Gaussian process side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pipeline.config import Config
from pipeline.simulate import Outcome, Record
from rod import (
    Curvature,
    Identification,
    Moment,
    Rod,
    RodError,
    cell_averaged,
    gaussian_process,
    identify,
    moment_from_force,
    shared_smoothing,
    straightness,
)
from rod.fit import rest_curvature

__all__ = ["Parameters", "identify_all", "parameters_record"]

Array = NDArray[np.float64]

NUMBERS = ("alpha1", "alpha2", "m01", "m02", "d")
UNITS = {"alpha1": "N_mm2", "alpha2": "N_mm2", "m01": "N_mm", "m02": "N_mm", "d": "mm"}


@dataclass(frozen=True)
class Parameters:
    """What one pressure gives: curvatures with and without load, moment, and the numbers of two estimators."""

    pressure_kPa: float
    free: Record  #: experiment II
    loaded: Record  #: experiment III
    kappa_0: Curvature  #: cell-averaged, of II
    kappa: Curvature  #: cell-averaged, of III
    moment: Moment
    by_cells: Identification  #: the numbers the rod is given
    by_process: Identification  #: the same from a Gaussian process, for comparison

    @property
    def rod(self) -> Rod:
        """The rod with these numbers, clamped as the material curve begins in II."""
        theta0, profile = rest_curvature(self.free.centreline)
        curve = self.free.centreline
        return Rod(curve.length, profile, self.by_cells.law, theta0, (float(curve.x[0]), float(curve.y[0])))


def identify_all(outcomes: Mapping[str, Outcome], pitch: float) -> tuple[tuple[Parameters, ...], tuple[str, ...]]:
    """The numbers at every pressure reached in both II and III, and a sentence for each where there are none."""
    free = {record.pressure_kPa: record for record in outcomes["II"].records}
    loaded = {record.pressure_kPa: record for record in outcomes["III"].records}
    found, refused = [], []
    for pressure in sorted(free.keys() & loaded.keys()):
        try:
            found.append(_identified(pressure, free[pressure], loaded[pressure], pitch))
        except RodError as failure:
            refused.append(f"no five numbers at {pressure:g} kPa: {failure}")
    return tuple(found), tuple(refused)


def _identified(pressure: float, free: Record, loaded: Record, pitch: float) -> Parameters:
    curves = (free.centreline, loaded.centreline)
    moment = moment_from_force(loaded.centreline, loaded.end_force, loaded.end_couple)
    kappa_0, kappa = (cell_averaged(curve, pitch) for curve in curves)
    smoothing = shared_smoothing(curves, pitch)
    smooth_0, smooth = (gaussian_process(curve, smoothing) for curve in curves)
    return Parameters(
        pressure_kPa=pressure,
        free=free,
        loaded=loaded,
        kappa_0=kappa_0,
        kappa=kappa,
        moment=moment,
        by_cells=identify(kappa_0, kappa, moment),
        by_process=identify(smooth_0, smooth, moment),
    )


def parameters_record(config: Config, found: Sequence[Parameters]) -> dict[str, Any]:
    """The content of parameters.json."""
    length = config.design.length
    mass = config.material.density_tonne_mm3 * config.design.solid_volume
    weight = mass * 9810.0
    record: dict[str, Any] = {
        "design": config.record()["geometry"],
        "material": config.record()["material"],
        "length_mm": length,
        "mass_g": mass * 1e6,
        "pressures_kPa": [p.pressure_kPa for p in found],
        "estimator": "cell_averaged",
    }
    record.update(_numbers([p.by_cells for p in found]))
    record.update(_slopes(record, found))
    record["one_line_alpha_N_mm2"] = [p.by_cells.one_line.alpha.value for p in found]
    record["one_line_alpha_N_mm2_std"] = [p.by_cells.one_line.alpha.std for p in found]
    record["one_line_m0_N_mm"] = [p.by_cells.one_line.m0.value for p in found]
    record["one_line_suffices"] = [not p.by_cells.two_lines for p in found]
    record["r2_two_lines"] = [p.by_cells.r2 for p in found]
    record["r2_one_line"] = [p.by_cells.one_line.r2 for p in found]
    record["observations"] = [p.by_cells.observations for p in found]
    record["kappa_0"] = _profiles(found)
    record["dimensionless"] = [
        {
            "pressure_kPa": p.pressure_kPa,
            "s_over_length": p.by_cells.points[:, 0] / length,
            "delta_kappa_times_length": p.by_cells.points[:, 1] * length,
            "moment_over_m_g_length": p.by_cells.points[:, 3] / (weight * length),
        }
        for p in found
    ]
    record["profile_over_d"] = [
        {"pressure_kPa": p.pressure_kPa, "d_mm": p.by_cells.profile[:, 0], "rms_per_mm": p.by_cells.profile[:, 1]}
        for p in found
    ]
    record["gaussian_process"] = _numbers([p.by_process for p in found])
    return record


def _numbers(identified: Sequence[Identification]) -> dict[str, list[float]]:
    columns: dict[str, list[float]] = {}
    for name in NUMBERS:
        key = f"{name}_{UNITS[name]}"
        columns[key] = [getattr(one, name).value for one in identified]
        columns[f"{key}_std"] = [getattr(one, name).std for one in identified]
    return columns


def _slopes(record: Mapping[str, Any], found: Sequence[Parameters]) -> dict[str, Any]:
    """beta1, beta2 and the pressures between which alpha is linear; null below two pressures."""
    pressures = record["pressures_kPa"]
    slopes: dict[str, Any] = {"linear_range_kPa": None}
    lines = []
    for number in ("1", "2"):
        key = f"beta{number}_N_mm2_per_kPa"
        slopes[key] = slopes[f"{key}_std"] = None
        if len(found) > 1:
            line = straightness(pressures, record[f"alpha{number}_N_mm2"], record[f"alpha{number}_N_mm2_std"])
            slopes[key], slopes[f"{key}_std"] = line.slope, line.slope_std
            lines.append(line)
    if lines and all(line.straight for line in lines):
        slopes["linear_range_kPa"] = [pressures[0], pressures[-1]]
    return slopes


def _profiles(found: Sequence[Parameters]) -> dict[str, Any]:
    """kappa_0(s, p) of the rod: at the nodes of the curve, as the shape of II has it, and averaged over cells."""
    if not found:
        return {}
    rows = [rest_curvature(p.free.centreline) for p in found]
    return {
        "s_mm": rows[0][1][:, 0],
        "theta0_rad": [theta for theta, _ in rows],
        "kappa_0_per_mm": [profile[:, 1] for _, profile in rows],
        "cell_s_mm": found[0].kappa_0.s,
        "cell_averaged_per_mm": [p.kappa_0.kappa for p in found],
        "middle_per_mm": [float(np.interp(p.kappa_0.length / 2, p.kappa_0.s, p.kappa_0.kappa)) for p in found],
    }
