"""The numbers of a point for the table of a sweep: one row per pressure, names with units."""

import math
from collections.abc import Iterable

import numpy as np

from pipeline.config.config import Config
from pipeline.identify.compare import Comparison
from pipeline.identify.mesh_error import RELATIVE
from pipeline.identify.parameters import Parameters, identify_all, row_of
from pipeline.law.build import MeasuredLaw
from pipeline.results.unloaded import unloaded_states
from pipeline.simulate.outcome import Outcomes, Record
from pipeline.simulate.scene import Scene
from pipeline.stages import SolvedRun
from pipeline.study.sweep.points import Row
from pipeline.values.law import DRAFT
from pipeline.values.reasons import render, render_all
from rod.arm_law.curves import CellCurve
from rod.same_pressure import is_among, is_same

#: further columns of a state, by their names in experiments.json
_OF_STATE = ("cavity_volume_mm3", "stretch_of_curve", "min_J", "max_stretch", "min_gap_mm", "stress_error")
#: what effects are compared by, and its column among those of the states
_OF_VARIANT = {
    "kappa_0_middle_per_mm": "II_kappa_middle_per_mm", "end_force_N": "III_force_y_N", "end_y_II_mm": "II_end_y_mm",
}  # fmt: skip


def rows_of_run(solved: SolvedRun) -> list[Row]:
    """Experiments, five parameters with the error of the mesh, how far the rods are from the finite elements, the cell
    without moment, and the notes on the design and its results, which are the same at every pressure."""
    outcomes, pitch = solved.outcomes, solved.config.design.pitch
    pressures = sorted({record.pressure_kPa for record in outcomes.records} | set(solved.config.pressures_kPa))
    rows = {pressure: {**_arm(solved.config), "pressure_kPa": pressure} for pressure in pressures}
    for pressure, row in rows.items():
        row |= _states(outcomes, pressure, pitch)
        for parameters in solved.parameters:
            if is_same(parameters.pressure_kPa, pressure):
                row |= _five(parameters)
        row |= _errors(c for c in solved.comparisons if c.in_sample and is_same(c.record.pressure_kPa, pressure))
        row["notes"] = " ".join(remark.text for remark in solved.results.remarks)
    of_cell = rows_of_law(solved.config, solved.arm.measured)
    for pressure, row in zip(solved.config.pressures_kPa, of_cell, strict=True):
        rows[pressure] |= row
    return list(rows.values())


def rows_of_experiments(config: Config, outcomes: Outcomes, remark: str) -> list[Row]:
    """The states of some of the experiments, with a remark on all of them in `notes` if it is not empty."""
    notes: Row = {"notes": remark} if remark else {}
    return [
        {**_arm(config), "pressure_kPa": pressure, **_states(outcomes, pressure, config.design.pitch), **notes}
        for pressure in config.pressures_kPa
    ]


def rows_of_variant(scene: Scene, outcomes: Outcomes) -> list[Row]:
    """What II and III give with an effect on or off, what they cost, and why a number is missing, at every pressure."""
    config = scene.config
    # by the criterion alone: whether two lines need contact is what this study shows
    parameters, refused = identify_all(outcomes, scene.body.pitch, config.identification.d_mm, equal_cells=False)
    identified = {one.pressure_kPa: one for one in parameters}
    without = [pressure for pressure in outcomes.reached_kPa if pressure not in identified]
    reasons = dict(zip(without, map(render, refused), strict=True))
    for pressure in config.pressures_kPa:
        if not is_among(outcomes.reached_kPa, pressure):
            stopped = (outcome.why_stopped() for outcome in outcomes if outcome.at(pressure) is None)
            reasons[pressure] = render_all(filter(None, stopped))
    cost: Row = {
        "cpu_seconds": outcomes.cpu_seconds,
        "factorizations": outcomes.factorizations + sum(one.failure.factorizations for one in outcomes if one.failure),
        "degrees_of_freedom": outcomes.degrees_of_freedom,
        "states": len(outcomes.records),
    }
    rows: list[Row] = []
    for p in config.pressures_kPa:
        states, five = _states(outcomes, p, scene.body.pitch), identified.get(p)
        records = (record for outcome in outcomes if (record := outcome.at(p)))
        row: Row = {"pressure_kPa": p, **{name: states.get(column) for name, column in _OF_VARIANT.items()}}
        row |= {"stretch_of_curve": [states.get(f"{name}_stretch_of_curve") for name in ("II", "III")]}
        row |= {"contact": any("self_contact" in record.effects for record in records)}
        rows.append({**row, **(_lines(five) if five else {}), **cost, "reason": reasons.get(p, "")})
    return rows


def _lines(parameters: Parameters) -> Row:
    """Rigidities and break, and what speaks for two lines."""
    found, two = row_of(parameters.numbers), parameters.two_lines
    return {
        **{name: found[name] for name in ("alpha1_N_mm2", "alpha2_N_mm2")},
        "d_mm": found["d_mm"] if two else None,
        "single_line_suffices": not two,
        "r2_single_line": parameters.by_cells.single_line.r2,
        "r2_two_lines": parameters.by_cells.r2,
    }


def rows_of_law(config: Config, measured: MeasuredLaw | None) -> list[Row]:
    """The cell without moment and the arm without a load at the pressures of the configuration; no numbers where there
    is no law. A draft says so in `notes`."""
    rows: dict[float, Row] = {p: {**_arm(config), "pressure_kPa": p} for p in config.pressures_kPa}
    if measured is not None:
        for cell in (cell for cell in measured.law.cells if cell.pressure in rows):
            rows[cell.pressure] |= _cell(cell)
        for state in unloaded_states(measured.law, config.pressures_kPa):
            x, y = state.tip_mm
            rows[state.pressure_kPa] |= {"law_bending_deg": state.bending_deg, "law_tip_x_mm": x, "law_tip_y_mm": y}
            rows[state.pressure_kPa] |= {"notes": DRAFT} if measured.draft else {}
    return list(rows.values())


def _arm(config: Config) -> Row:
    mass = config.mass_tonne
    return {"length_mm": config.design.length, "mass_g": None if mass is None else 1e6 * mass}


def _states(outcomes: Outcomes, pressure: float, pitch: float) -> Row:
    reached = {outcome.name: record for outcome in outcomes if (record := outcome.at(pressure))}
    free = next((reached[name].state.end_rotation_deg for name in ("II", "I") if name in reached), -1.0)
    states = {name: _state(record, pitch, math.copysign(1.0, free)) for name, record in reached.items()}
    return {f"{name}_{column}": value for name, state in states.items() for column, value in state.items()}


def _state(record: Record, pitch: float, side: float) -> Row:
    curve = record.centreline
    row: Row = {
        "bending_deg": side * record.state.end_rotation_deg,
        "end_x_mm": record.state.end_x_mm,
        "end_y_mm": record.state.end_y_mm,
        "tip_x_mm": float(curve.x[-1] - curve.x[0]),
        "tip_y_mm": float(curve.y[-1] - curve.y[0]),
        "end_angle_rad": curve.end_angle,
        "kappa_middle_per_mm": record.kappa_middle(pitch),
    }
    if record.experiment == "III":
        row |= dict(zip(("force_x_N", "force_y_N"), record.state.reaction_N, strict=True))
    return row | {name: getattr(record.state, name) for name in _OF_STATE}


def _five(parameters: Parameters) -> Row:
    found = {name: number for name, number in row_of(parameters.numbers).items() if not name.endswith("_95")}
    errors: Row = {f"{name}_mesh_error": parameters.mesh_errors.get(name) for name in RELATIVE}
    middle, two = parameters.kappa_0.middle, bool(parameters.two_lines)
    return {"kappa_0_middle_per_mm": middle, **found, "two_lines": two, **errors}


def _errors(comparisons: Iterable[Comparison]) -> Row:
    """Largest distance of each rod over the length and the error of its end force, by experiment and rod."""
    errors = [error for comparison in comparisons for error in comparison.errors if not error.reason]
    row: Row = {}
    for error in errors:
        name = f"{error.experiment}_{error.rod}"
        row[f"{name}_distance_over_length"] = error.distance_over_length
        if error.force_error is not None:
            row[f"{name}_force_error"] = error.force_error
    return row


def _cell(cell: CellCurve) -> Row:
    kappa, stretch, _ = cell.at(0.0)
    row: Row = {"cell_kappa_0_per_mm": kappa, "cell_stretch": stretch}
    for name in ("rigidity", "axial_rigidity", "shear_rigidity"):
        unit = "N_mm2" if name == "rigidity" else "N"
        row[f"cell_{name}_{unit}"] = float(np.interp(0.0, cell.moment, getattr(cell, name)))
    return row
