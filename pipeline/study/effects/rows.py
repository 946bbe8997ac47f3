"""The numbers and the cost of the variants of an effect study, and their changes against the configuration."""

from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.config.config import Config
from pipeline.identify.parameters import Parameters, identify_all
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.values.reasons import render, render_all
from rod.same_pressure import is_among

#: one variant at one pressure, as in effects_table.json
EffectRow = Mapping[str, Any]

#: what is run on a variant, as in a sweep
EFFECTS_RUN = ("effects",)
BASE = "as configured"
#: number of a row -> title of its column
COLUMNS = {
    "kappa_0_middle_per_mm": "κ₀(l/2) 1/mm",
    "alpha1_N_mm2": "α₁ N mm²",
    "alpha2_N_mm2": "α₂ N mm²",
    "d_mm": "d mm",
    "end_force_N": "F N",
}
#: numbers and cost of a row, None where a state or the five parameters they come from is missing
NUMBERS = (
    *("kappa_0_middle_per_mm", "end_force_N", "end_y_II_mm", "alpha1_N_mm2", "alpha2_N_mm2", "d_mm"),
    *("single_line_suffices", "r2_single_line", "r2_two_lines", "stretch_of_curve", "contact"),
)
COST = ("cpu_seconds", "factorizations", "degrees_of_freedom", "states")


def solve_variant(config: Config, context: RunContext) -> tuple[list[dict[str, Any]], list[str]]:
    """II and III: numbers, cost and what is missing at every pressure, and a sentence for each missing one."""
    scene = Scene.meshed(config)
    rows = variant_rows(scene, simulate(scene, context, ("III", "II")))
    return rows, list(dict.fromkeys(row["reason"] for row in rows if row["reason"]))


def variant_rows(scene: Scene, outcomes: Outcomes) -> list[dict[str, Any]]:
    """Numbers, cost and what is missing, at every pressure of the configuration."""
    config, pitch = scene.config, scene.body.pitch
    # by the criterion alone: whether two lines need contact is what this study shows
    parameters, refused = identify_all(outcomes, pitch, config.identification.d_mm, equal_cells=False)
    identified = {at_pressure.pressure_kPa: at_pressure for at_pressure in parameters}
    without = [pressure for pressure in outcomes.reached_kPa if pressure not in identified]
    reasons = dict(zip(without, map(render, refused), strict=True))
    for pressure in config.pressures_kPa:
        if not is_among(outcomes.reached_kPa, pressure):
            stopped = (outcome.why_stopped() for outcome in outcomes if outcome.at(pressure) is None)
            reasons[pressure] = render_all(filter(None, stopped))
    cost = {
        "cpu_seconds": outcomes.cpu_seconds,
        "factorizations": outcomes.factorizations + outcomes.failed_factorizations,
        "degrees_of_freedom": outcomes.degrees_of_freedom,
        "states": len(outcomes.records),
    }
    return [
        {
            "pressure_kPa": pressure,
            **_numbers(outcomes, pressure, pitch, identified.get(pressure)),
            **cost,
            "reason": reasons.get(pressure, ""),
        }
        for pressure in config.pressures_kPa
    ]


def _numbers(outcomes: Outcomes, pressure: float, pitch: float, parameters: Parameters | None) -> dict[str, Any]:
    """From the states at one pressure, as far as they were reached, and the parameters, if there are any."""
    free, loaded = outcomes["II"].at(pressure), outcomes["III"].at(pressure)
    row: dict[str, Any] = {
        **dict.fromkeys(NUMBERS),
        "kappa_0_middle_per_mm": free.kappa_middle(pitch) if free else None,
        "end_force_N": loaded.load.force[1] if loaded else None,
        "end_y_II_mm": free.state.end_mm[1] if free else None,
        "stretch_of_curve": [record.centreline.stretch if record else None for record in (free, loaded)],
        "contact": any("self_contact" in record.effects for record in (free, loaded) if record),
    }
    if parameters is not None:
        row |= {
            "alpha1_N_mm2": parameters.numbers["alpha1"].value,
            "alpha2_N_mm2": parameters.numbers["alpha2"].value,
            "d_mm": parameters.numbers["d"].value if parameters.two_lines else None,
            "single_line_suffices": not parameters.two_lines,
            "r2_single_line": parameters.by_cells.single_line.r2,
            "r2_two_lines": parameters.by_cells.r2,
        }
    return row


def compared(variants: Sequence[tuple[str, str, Sequence[EffectRow]]]) -> list[dict[str, Any]]:
    """Rows of effects_table.json from the rows of (effect, state); changes are relative to those of `BASE`.

    `other_states`: whether more or fewer states were reached than as configured, so that costs differ.
    """
    as_configured = {row["pressure_kPa"]: row for effect, _, rows in variants if effect == BASE for row in rows}
    table = []
    for effect, state, rows in variants:
        for row in rows:
            base = as_configured.get(row["pressure_kPa"], {})
            other_states = None not in (row["states"], base.get("states")) and row["states"] != base["states"]
            changes = {name: _change(row[name], base.get(name)) for name in (*COLUMNS, "cpu_seconds")}
            ends = {"other_states": other_states, "relative_change": changes, "reason": row["reason"]}
            table.append({"effect": effect, "state": state, **row, **ends})
    return table


def _change(value: float | None, reference: float | None) -> float | None:
    return value / reference - 1.0 if value is not None and reference else None
