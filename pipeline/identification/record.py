"""The content of parameters.json."""

from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.config.config import Config
from pipeline.identification.added_pressures import covered_range, quantities_of
from pipeline.identification.parameters import DEFAULT, Parameters
from pipeline.store.formats import FORMAT
from rod import Identification, Interval, LinearRange, rest_curvature

ESTIMATORS = (DEFAULT, "gaussian_process", "rod_fit")

_NUMBERS = {"alpha1": "N_mm2", "alpha2": "N_mm2", "m01": "N_mm", "m02": "N_mm", "d": "mm"}


def parameters_record(config: Config, found: Sequence[Parameters]) -> dict[str, Any]:
    """The numbers of the rod at the top, those of all three estimators under `estimators`."""
    mass = config.material.density_tonne_mm3 * config.design.solid_volume
    cells = [p.by_cells for p in found]
    return {
        "format": FORMAT,
        "design": config.record()["geometry"],
        "material": config.record()["material"],
        "length_mm": config.design.length,
        "mass_g": mass * 1e6,
        "pressures_kPa": [p.pressure_kPa for p in found],
        "estimator": DEFAULT,
        **_columns([p.numbers for p in found]),
        "d_is_at_most": [_at_most(p.numbers["d"], p) for p in found],
        **_linear(found),
        "single_line_alpha_N_mm2": [one.single_line.alpha.value for one in cells],
        "single_line_alpha_N_mm2_std": [one.single_line.alpha.std for one in cells],
        "single_line_m0_N_mm": [one.single_line.m0.value for one in cells],
        "single_line_suffices": [not one.two_lines for one in cells],
        "r2_two_lines": [one.r2 for one in cells],
        "r2_single_line": [one.single_line.r2 for one in cells],
        "observations": [one.observations for one in cells],
        "mesh_error": _mesh_error(config, found),
        "moment_range_N_mm": [[p.moment_range.low, p.moment_range.high] for p in found],
        "eccentricity": _eccentricity(found),
        "estimators": {name: _estimator(name, found) for name in ESTIMATORS},
        "kappa_0": _profiles(found),
        "dimensionless": _dimensionless(found, config.design.length, mass * 9810.0),
        "profile_over_d": [
            {"pressure_kPa": p.pressure_kPa, "d_mm": p.by_cells.profile[:, 0], "rms_per_mm": p.by_cells.profile[:, 1]}
            for p in found
        ],
    }


def _columns(numbers: Sequence[Mapping[str, Interval] | None]) -> dict[str, list[Any]]:
    """Lists over the pressures; null where nothing was found."""
    columns: dict[str, list[Any]] = {}
    for name, unit in _NUMBERS.items():
        intervals = [None if one is None else one[name] for one in numbers]
        columns[f"{name}_{unit}"] = [one and one.value for one in intervals]
        columns[f"{name}_{unit}_std"] = [one and one.std for one in intervals]
        columns[f"{name}_{unit}_95"] = [one and [one.low, one.high] for one in intervals]
    return columns


def _mesh_error(config: Config, found: Sequence[Parameters]) -> dict[str, Any] | None:
    """What the mesh contributes to the deviations of the rod's numbers, None where no second mesh tells."""
    if config.mesh.coarser is None or not any(p.mesh_std for p in found):
        return None
    columns = {f"{name}_{unit}_std": [p.mesh_std.get(name) for p in found] for name, unit in _NUMBERS.items()}
    return {"sizes_mm": [config.mesh.size_mm, config.mesh.coarser * config.mesh.size_mm], **columns}


def _eccentricity(found: Sequence[Parameters]) -> dict[str, Any]:
    """The eccentricity of the neutral axis, the rest stretch, and the five numbers of the rod that has them."""
    if not found:
        return {}
    return {
        "eccentricity_mm": [p.extension.eccentricity for p in found],
        "eccentricity_mm_std": [p.extension.eccentricity_std for p in found],
        **_columns([p.extensible_numbers for p in found]),
        "rest_stretch": [p.extension.rest_stretch for p in found],
    }


def _at_most(d: Interval, parameters: Parameters) -> bool:
    return bool(d.value <= 1.001 * parameters.shortest_break)


def _estimator(name: str, found: Sequence[Parameters]) -> dict[str, list[Any]]:
    """Two lines at every pressure, whether one suffices, and how many independent observations there were."""
    estimates = [p.estimates.get(name) for p in found]
    columns = _columns([None if one is None else {n: getattr(one, n) for n in _NUMBERS} for one in estimates])
    columns["d_is_at_most"] = [
        None if one is None else _at_most(one.d, p) for one, p in zip(estimates, found, strict=True)
    ]
    lines = [one for one in estimates if isinstance(one, Identification)]
    if len(lines) == len(found):
        columns["single_line_suffices"] = [not one.two_lines for one in lines]
        columns["single_line_alpha_N_mm2"] = [one.single_line.alpha.value for one in lines]
        columns["observations"] = [one.observations for one in lines]
    return columns


def _linear(found: Sequence[Parameters]) -> dict[str, Any]:
    """beta1, beta2 over the linear range (over all pressures where there is none), and how straight everything is."""
    covered = covered_range(found)
    record: dict[str, Any] = {"linear_range_kPa": None, "linear_range_tested": False, "straightness": []}
    for number in ("1", "2"):
        record[f"beta{number}_N_mm2_per_kPa"] = record[f"beta{number}_N_mm2_per_kPa_std"] = None
    if len(found) < 2:
        return record
    pressures, quantities = quantities_of(found)
    if covered is not None:
        record["linear_range_kPa"], record["linear_range_tested"] = [covered.low, covered.high], covered.tested
    lines = LinearRange.over(pressures, quantities).lines if covered is None else covered.lines
    for number in ("1", "2"):
        line = lines[f"alpha{number}"]
        record[f"beta{number}_N_mm2_per_kPa"], record[f"beta{number}_N_mm2_per_kPa_std"] = line.slope, line.slope_std
    record["straightness"] = [
        {
            "quantity": name,
            "slope_per_kPa": line.slope,
            "at_0_kPa": line.intercept,
            "values": quantities[name][0],
            "off_the_line": [
                value / (line.slope * p + line.intercept) - 1.0
                for p, value in zip(pressures, quantities[name][0], strict=True)
            ],
        }
        for name, line in lines.items()
    ]
    return record


def _dimensionless(found: Sequence[Parameters], length: float, weight: float) -> list[Mapping[str, Any]]:
    return [
        {
            "pressure_kPa": p.pressure_kPa,
            "s_over_length": p.by_cells.points[:, 0] / length,
            "delta_kappa_times_length": p.by_cells.points[:, 1] * length,
            "moment_over_m_g_length": p.by_cells.points[:, 3] / (weight * length),
        }
        for p in found
    ]


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
        "middle_per_mm": [p.kappa_0_middle for p in found],
    }
