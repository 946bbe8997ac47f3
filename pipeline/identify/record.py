"""The parameters of a run as the value of parameters.json."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from geometry.arrays import Array
from pipeline.config.config import Config
from pipeline.identify.mesh_error import RELATIVE, OtherNumbers
from pipeline.identify.parameters import Parameters, decide_together, row_of
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import ReadObject
from pipeline.values.parameters import (
    FiveColumns,
    MeshErrorOfFive,
    RestShape,
    RodParameters,
    TwoLines,
)
from rod import (
    PARAMETER_COLUMNS,
    PARAMETER_NAMES,
    Identification,
    Interval,
    LinearRange,
    Load,
    Quantity,
    linear_range,
    rest_curvature,
)

ESTIMATOR = "cell_averaged"


def parameters_record(
    config: Config,
    parameters: Sequence[Parameters],
    predicted: Sequence[OtherNumbers | str] | None = None,
    coarser: float | None = None,
    mesh_error_reason: str = "",
) -> RodParameters:
    """The numbers of the rod at the top, those of two lines under `estimators`.

    predicted: by the arm's own law; None where it was not made. coarser: size of a second mesh of the whole arm over
    that of the first one, where it tells the error of the mesh.
    """
    drawn: ReadObject = config.record()
    mass = config.mass_tonne
    load = parameters[0].free.load if parameters else Load()
    by_law = [p if isinstance(p, str) else p.lines for p in predicted or ()]
    found = RodParameters(
        format=FORMAT,
        design=drawn["geometry"],
        material=drawn.get("material"),
        materials=drawn.get("materials"),
        solid_volume_mm3=config.design.solid_volume,
        length_mm=config.design.length,
        mass_g=None if mass is None else mass * 1e6,
        pressures_kPa=tuple(p.pressure_kPa for p in parameters),
        straight_without_pressure=config.effects.straight_without_pressure,
        weight_N_per_mm=load.weight[:2],
        weight_height_mm=load.weight_height,
        **vars(_columns([p.numbers for p in parameters], parameters)),
        d_given_mm=config.identification.d_mm,
        mesh_error=_mesh_error(config, parameters, coarser),
        mesh_error_reason=mesh_error_reason,
        moment_range_N_mm=tuple((moments.low, moments.high) for moments in (p.moment_range for p in parameters)),
        estimators={ESTIMATOR: _identified([p.by_cells for p in parameters], parameters)},
        predicted_by_arm_law=None if predicted is None else _identified(by_law, parameters),
        kappa_0=_rest_shape(parameters),
    )
    return _with_single_lines(_with_straight_lines(found, parameters), parameters)


def _with_single_lines(found: RodParameters, parameters: Sequence[Parameters]) -> RodParameters:
    """With the single line beside two, and what speaks for either."""
    single_lines = [p.by_cells.single_line for p in parameters]
    return replace(
        found,
        single_line_alpha_N_mm2=tuple(line.alpha.value for line in single_lines),
        single_line_alpha_N_mm2_std=tuple(line.alpha.std for line in single_lines),
        single_line_m0_N_mm=tuple(line.m0.value for line in single_lines),
        single_line_suffices=tuple(not p.two_lines for p in parameters),
        evidence_for_two_lines=tuple(p.by_cells.evidence for p in parameters),
        evidence_of_choice=tuple(p.evidence for p in parameters),
        two_lines_on_coarser_mesh=tuple(p.two_lines_on_coarser for p in parameters),
        r2_two_lines=tuple(p.by_cells.r2 for p in parameters),
        r2_single_line=tuple(line.r2 for line in single_lines),
        observations=tuple(p.by_cells.observations for p in parameters),
    )


def _columns(numbers: Sequence[Mapping[str, Interval] | None], parameters: Sequence[Parameters]) -> FiveColumns:
    """The five parameters over the pressures; None where there is no number.

    parameters: those that tell whether a d lies at an end of the range in which it was sought.
    """
    rows = [row_of(of_pressure) if of_pressure else {} for of_pressure in numbers]
    names = [f"{column}{part}" for column in PARAMETER_COLUMNS.values() for part in ("", "_std", "_95")]
    columns: dict[str, tuple[Any, ...]] = {name: tuple(row.get(name) for row in rows) for name in names}
    pairs = [(i and i["d"], p) for i, p in zip(numbers, parameters, strict=True)]
    at_most = (d and p.given_d is None and bool(d.value <= 1.001 * p.shortest_break) for d, p in pairs)
    at_least = (d and p.given_d is None and bool(d.value >= 0.999 * p.longest_break) for d, p in pairs)
    return FiveColumns(**columns | {"d_is_at_most": tuple(at_most), "d_is_at_least": tuple(at_least)})


def _mesh_error(config: Config, parameters: Sequence[Parameters], coarser: float | None) -> MeshErrorOfFive | None:
    """What the mesh contributes to the deviations of the rod's numbers, None where nothing tells."""
    if not any(p.mesh_std for p in parameters):
        return None
    sizes = (config.mesh.size_mm, *([] if coarser is None else [coarser * config.mesh.size_mm]))
    return MeshErrorOfFive(
        sizes,
        parameters[0].mixed_at_kPa,
        *(tuple(p.mesh_std.get(name) for p in parameters) for name in PARAMETER_COLUMNS),
        *(tuple(p.mesh_errors.get(name) for p in parameters) for name in RELATIVE),
    )


def _numbers(values: Array) -> tuple[float, ...]:
    return tuple(values.tolist())


def _identified(estimates: Sequence[Identification | str], parameters: Sequence[Parameters]) -> TwoLines:
    """Two lines at every pressure, or why there are none, and whether a single one suffices."""
    identified = [e for e in estimates if not isinstance(e, str)]
    every = [None if isinstance(e, str) else {name: getattr(e, name) for name in PARAMETER_NAMES} for e in estimates]
    reasons = tuple(e if isinstance(e, str) else "" for e in estimates)
    found = TwoLines(**vars(_columns(every, parameters)), reason=reasons)
    if len(identified) < len(parameters):
        return found
    return replace(
        found,
        single_line_suffices=tuple(not p.two_lines for p in decide_together(parameters, identified)),
        single_line_alpha_N_mm2=tuple(e.single_line.alpha.value for e in identified),
        observations=tuple(e.observations for e in identified),
    )


def _with_straight_lines(found: RodParameters, parameters: Sequence[Parameters]) -> RodParameters:
    """With beta1, beta2 over the linear range, over all pressures where there is none."""
    pressures, quantities = _quantities_of(parameters)
    covered = linear_range(pressures, quantities)
    lines = covered.lines if covered else {}
    if covered is None and len(parameters) > 1:
        lines = LinearRange.over(pressures, quantities).lines
    first, second = lines.get("alpha1"), lines.get("alpha2")
    return replace(
        found,
        linear_range_kPa=covered and (covered.low, covered.high),
        linear_range_tested=covered is not None and covered.tested,
        beta1_N_mm2_per_kPa=first and first.slope,
        beta1_N_mm2_per_kPa_std=first and first.slope_std,
        beta2_N_mm2_per_kPa=second and second.slope,
        beta2_N_mm2_per_kPa_std=second and second.slope_std,
    )


def _quantities_of(parameters: Sequence[Parameters]) -> tuple[list[float], dict[str, Quantity]]:
    """Pressures (kPa) and what is tested for linearity: alpha1, alpha2 (N mm2) and kappa_0(l/2) (1/mm) with their
    standard deviations."""
    intervals = {name: [p.numbers_without_mesh[name] for p in parameters] for name in ("alpha1", "alpha2")}
    quantities = {name: Quantity([i.value for i in row], [i.std for i in row]) for name, row in intervals.items()}
    middles = [p.kappa_0.middle for p in parameters]
    quantities["kappa_0"] = Quantity(middles, [p.kappa_0.middle_std for p in parameters])
    return [p.pressure_kPa for p in parameters], quantities


def _rest_shape(parameters: Sequence[Parameters]) -> RestShape:
    """kappa_0(s, p) of the rod: at the nodes of the curve, as the shape of II has it, and averaged over cells."""
    if not parameters:
        return RestShape()
    rows = [rest_curvature(p.free.centreline) for p in parameters]
    return RestShape(
        s_mm=_numbers(rows[0][1][:, 0]),
        theta0_rad=tuple(float(theta) for theta, _ in rows),
        kappa_0_per_mm=tuple(_numbers(profile[:, 1]) for _, profile in rows),
        cell_s_mm=_numbers(parameters[0].kappa_0.s),
        cell_averaged_per_mm=tuple(_numbers(p.kappa_0.kappa) for p in parameters),
        middle_per_mm=tuple(p.kappa_0.middle for p in parameters),
    )
