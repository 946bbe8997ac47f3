"""The content of parameters.json."""

from collections.abc import Mapping, Sequence

from pipeline.config.config import Config
from pipeline.identification.added_pressures import covered_range, quantities_of
from pipeline.identification.mesh_error import RELATIVE
from pipeline.identification.parameters import DEFAULT, NoFit, Parameters, choices_of
from pipeline.identification.predicted import predicted_numbers
from pipeline.store.formats import FORMAT
from pipeline.store.json_values import Json, JsonObject
from rod import ArmLaw, Identification, Interval, LinearRange, Load, MomentRange, ParameterEstimate, rest_curvature

ESTIMATORS = (DEFAULT, "gaussian_process", "rod_fit")

_NUMBERS = {"alpha1": "N_mm2", "alpha2": "N_mm2", "m01": "N_mm", "m02": "N_mm", "d": "mm"}


def parameters_record(
    config: Config, parameters: Sequence[Parameters], law: ArmLaw | None = None, mesh_error_reason: str = ""
) -> JsonObject:
    """The numbers of the rod at the top, those of all three estimators under `estimators`.

    law: of the arm, which predicts the numbers as well; None where it was not made.
    """
    mass = config.mass_tonne
    single_lines = [p.by_cells.single_line for p in parameters]
    return {
        "format": FORMAT,
        "design": config.record()["geometry"],
        **{key: value for key, value in config.record().items() if key in ("material", "materials")},
        "solid_volume_mm3": config.design.solid_volume,
        "length_mm": config.design.length,
        "mass_g": None if mass is None else mass * 1e6,
        "pressures_kPa": [p.pressure_kPa for p in parameters],
        "straight_without_pressure": config.effects.straight_without_pressure,
        **_weight(parameters),
        "estimator": DEFAULT,
        **_columns([p.numbers for p in parameters]),
        "d_given_mm": config.identification.d_mm,
        "d_is_at_most": [_at_most(p.numbers["d"], p) for p in parameters],
        "d_is_at_least": [_at_least(p.numbers["d"], p) for p in parameters],
        **_linear(parameters),
        "single_line_alpha_N_mm2": [line.alpha.value for line in single_lines],
        "single_line_alpha_N_mm2_std": [line.alpha.std for line in single_lines],
        "single_line_m0_N_mm": [line.m0.value for line in single_lines],
        "single_line_suffices": [not p.two_lines for p in parameters],
        "evidence_for_two_lines": [p.by_cells.evidence for p in parameters],
        "evidence_of_choice": [p.evidence for p in parameters],
        "two_lines_on_coarser_mesh": [p.two_lines_on_coarser for p in parameters],
        "r2_two_lines": [p.by_cells.r2 for p in parameters],
        "r2_single_line": [line.r2 for line in single_lines],
        "observations": [p.by_cells.observations for p in parameters],
        "mesh_error": _mesh_error(config, parameters),
        "mesh_error_reason": mesh_error_reason,
        "moment_range_N_mm": _ranges([p.moment_range for p in parameters]),
        "eccentricity": _eccentricity(parameters),
        "estimators": {name: _estimator(name, parameters) for name in ESTIMATORS},
        **_predicted(parameters, law),
        "kappa_0": _profiles(parameters),
        "dimensionless": _dimensionless(config, parameters),
        "dimensionless_numbers": _dimensionless_numbers(config, parameters),
        "profile_over_d": [
            {"pressure_kPa": p.pressure_kPa, "d_mm": p.by_cells.profile[:, 0], "rms_per_mm": p.by_cells.profile[:, 1]}
            for p in parameters
        ],
    }


def _weight(parameters: Sequence[Parameters]) -> JsonObject:
    """The weight under which the arm has kappa_0, zero without gravity."""
    load = parameters[0].free.load if parameters else Load()
    return {"weight_N_per_mm": list(load.weight), "weight_height_mm": load.weight_height}


def _columns(numbers: Sequence[Mapping[str, Interval] | None]) -> dict[str, Json]:
    """Lists over the pressures; null where there is no number."""
    columns: dict[str, Json] = {}
    for name, unit in _NUMBERS.items():
        intervals = [None if of_pressure is None else of_pressure[name] for of_pressure in numbers]
        columns[f"{name}_{unit}"] = [None if interval is None else interval.value for interval in intervals]
        columns[f"{name}_{unit}_std"] = [None if interval is None else interval.std for interval in intervals]
        columns[f"{name}_{unit}_95"] = [
            None if interval is None else [interval.low, interval.high] for interval in intervals
        ]
    return columns


def _mesh_error(config: Config, parameters: Sequence[Parameters]) -> JsonObject | None:
    """What the mesh contributes to the deviations of the rod's numbers, None where no second mesh tells."""
    if config.mesh.coarser is None or not any(p.mesh_std for p in parameters):
        return None
    columns = {f"{name}_{unit}_std": [p.mesh_std.get(name) for p in parameters] for name, unit in _NUMBERS.items()}
    relative = {f"{name}_relative": [p.mesh_errors.get(name) for p in parameters] for name in RELATIVE}
    sizes = [config.mesh.element_size_mm, config.mesh.coarser * config.mesh.element_size_mm]
    return {"sizes_mm": sizes, "mixed_at_kPa": parameters[0].mixed_at_kPa, **columns, **relative}


def _eccentricity(parameters: Sequence[Parameters]) -> JsonObject:
    """The eccentricity of the neutral axis, the rest stretch, and the five numbers of the rod that has them."""
    if not parameters:
        return {}
    return {
        "eccentricity_mm": [p.extension.eccentricity for p in parameters],
        "eccentricity_mm_std": [p.extension.eccentricity_std for p in parameters],
        **_columns([p.extensible_numbers for p in parameters]),
        "moment_range_N_mm": _ranges([p.extensible_moment_range for p in parameters]),
        "rest_stretch": [p.extension.rest_stretch for p in parameters],
    }


def _ranges(ranges: Sequence[MomentRange]) -> list[Json]:
    return [[moments.low, moments.high] for moments in ranges]


def _predicted(parameters: Sequence[Parameters], law: ArmLaw | None) -> JsonObject:
    """The numbers that the law of the arm predicts, where it was made."""
    if law is None:
        return {}
    return {"predicted_by_arm_law": _identified(predicted_numbers(parameters, law), parameters)}


def _at_most(d: Interval, parameters: Parameters) -> bool:
    return parameters.given_d is None and bool(d.value <= 1.001 * parameters.shortest_break)


def _at_least(d: Interval, parameters: Parameters) -> bool:
    return parameters.given_d is None and bool(d.value >= 0.999 * parameters.longest_break)


def _estimator(name: str, parameters: Sequence[Parameters]) -> dict[str, Json]:
    """Two lines at every pressure, whether one suffices, and how many independent observations there were."""
    return _identified([p.estimates[name] for p in parameters], parameters)


def _identified(estimates: Sequence[ParameterEstimate | NoFit], parameters: Sequence[Parameters]) -> dict[str, Json]:
    """The columns of one estimator, one estimate per pressure."""
    columns = _columns([None if isinstance(e, NoFit) else {n: getattr(e, n) for n in _NUMBERS} for e in estimates])
    for key, is_at_bound in (("d_is_at_most", _at_most), ("d_is_at_least", _at_least)):
        columns[key] = [
            None if isinstance(e, NoFit) else is_at_bound(e.d, p) for e, p in zip(estimates, parameters, strict=True)
        ]
    columns["reason"] = [e.reason if isinstance(e, NoFit) else "" for e in estimates]
    identified = [e for e in estimates if isinstance(e, Identification)]
    if len(identified) == len(parameters):
        columns["single_line_suffices"] = [not choice.two_lines for choice in choices_of(identified, parameters)]
        columns["single_line_alpha_N_mm2"] = [e.single_line.alpha.value for e in identified]
        columns["observations"] = [e.observations for e in identified]
    return columns


def _linear(parameters: Sequence[Parameters]) -> JsonObject:
    """beta1, beta2 over the linear range (over all pressures where there is none), and how straight everything is."""
    covered = covered_range(parameters)
    record: dict[str, Json] = {"linear_range_kPa": None, "linear_range_tested": False, "straightness": []}
    for number in ("1", "2"):
        record[f"beta{number}_N_mm2_per_kPa"] = record[f"beta{number}_N_mm2_per_kPa_std"] = None
    if len(parameters) < 2:
        return record
    pressures, quantities = quantities_of(parameters)
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
            "values": quantities[name].values,
            "off_the_line": [
                value / (line.slope * p + line.intercept) - 1.0
                for p, value in zip(pressures, quantities[name].values, strict=True)
            ],
        }
        for name, line in lines.items()
    ]
    return record


def _dimensionless(config: Config, parameters: Sequence[Parameters]) -> list[JsonObject]:
    """M/(m g l) over (kappa - kappa_0) l with the reference weight; no rows where there is none."""
    weight, length = config.reference_weight, config.design.length
    return [
        {
            "pressure_kPa": p.pressure_kPa,
            "s_over_length": p.by_cells.points[:, 0] / length,
            "delta_kappa_times_length": p.by_cells.points[:, 1] * length,
            "moment_over_m_g_length": p.by_cells.points[:, 3] / (weight[0] * length),
        }
        for p in parameters
        if weight is not None
    ]


def _dimensionless_numbers(config: Config, parameters: Sequence[Parameters]) -> JsonObject | None:
    """The five parameters and kappa_0(l/2) without unit, lists over the pressures; None without a weight."""
    weight, length = config.reference_weight, config.design.length
    if weight is None:
        return None
    newton, of = weight
    moment = newton * length
    units = {"alpha1": moment * length, "alpha2": moment * length, "m01": moment, "m02": moment, "d": length}
    over = {"alpha": "over_m_g_length2", "m0": "over_m_g_length", "d": "over_length"}
    return {
        "weight_N": newton,
        "weight_of": of,
        "kappa_0_middle_times_length": [p.kappa_0_middle * length for p in parameters],
        **{
            f"{name}_{over[name.rstrip('12')]}": [p.numbers[name].value / unit for p in parameters]
            for name, unit in units.items()
        },
    }


def _profiles(parameters: Sequence[Parameters]) -> JsonObject:
    """kappa_0(s, p) of the rod: at the nodes of the curve, as the shape of II has it, and averaged over cells."""
    if not parameters:
        return {}
    rows = [rest_curvature(p.free.centreline) for p in parameters]
    return {
        "s_mm": rows[0][1][:, 0],
        "theta0_rad": [theta for theta, _ in rows],
        "kappa_0_per_mm": [profile[:, 1] for _, profile in rows],
        "cell_s_mm": parameters[0].kappa_0.s,
        "cell_averaged_per_mm": [p.kappa_0.kappa for p in parameters],
        "middle_per_mm": [p.kappa_0_middle for p in parameters],
    }
