"""Each effect on and off: what it changes in the numbers of the rod, and what it costs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.config.config import FULLY_INTEGRATED, Config
from pipeline.context import RunContext
from pipeline.identification.parameters import identify_all
from pipeline.identification.record import parameters_record
from pipeline.progress import Progress
from pipeline.simulation.scene import GAP, Scene, is_on
from pipeline.simulation.simulate import simulate
from pipeline.store.store import open_store

BASE = "as configured"
#: key of a row -> how its column is called
COLUMNS = {
    "kappa_0_middle_per_mm": "κ₀(l/2) 1/mm",
    "alpha1_N_mm2": "α₁ N mm²",
    "alpha2_N_mm2": "α₂ N mm²",
    "d_mm": "d mm",
    "end_force_N": "F N",
}


@dataclass(frozen=True)
class Variant:
    """A configuration and what was changed in it."""

    effect: str  #: BASE, or the effect that was changed
    state: str  #: what it was changed to; empty for BASE
    config: Config

    @property
    def name(self) -> str:
        """self_contact off"""
        return f"{self.effect} {self.state}".strip()

    @property
    def folder(self) -> str:
        """Where its results stand in the folder of the comparison: the configuration itself in that folder."""
        return f"{self.effect}_{self.state}" if self.state else "."


def compare_effects(
    config: Config, out: Path, jobs: int, fresh: bool, progress: Progress
) -> tuple[list[dict[str, Any]], list[str]]:
    """Run II and III with each effect on and off; one row per variant and pressure, also in `out`/effects_table.json.

    The second list says in sentences which pressures were not reached. Raises InputError for a body that cannot be
    meshed or a folder that cannot be used.
    """
    rows: list[dict[str, Any]] = []
    failures: list[str] = []
    with open_store(out, config, fresh=fresh) as store:
        for variant in variants(Scene.meshed(config)):
            progress.stage(variant.name)
            if variant.effect == BASE:
                found, refused = _rows(variant, RunContext(store, jobs, progress))
            else:
                with open_store(out / variant.folder, variant.config, fresh=fresh) as own:
                    found, refused = _rows(variant, RunContext(own, jobs, progress))
            rows += found
            failures += refused
            store.save_json("effects_table.json", _compared(rows))
    return _compared(rows), failures


def variants(scene: Scene) -> list[Variant]:
    """The configuration, and the ones that differ from it in one effect.

    Pressure is not among them: without it there is no arm that bends. Contact is left out where no faces can meet, the
    half body where the body is whole, the layer where the mesh has no faces for it. Linear elements know no
    way to treat incompressibility and give place to quadratic ones.
    """
    config, body = scene.config, scene.body
    flipped = {
        "incompressibility": "on" if config.mesh.formulation in FULLY_INTEGRATED else "off",
        "gravity": "off" if is_on(config, "gravity") else "on",
    }
    if config.contact_faces or GAP in body.mesh.faces:
        flipped["self_contact"] = "auto" if config.effects["self_contact"] == "off" else "off"
    if body.half or config.effects["symmetry"] == "off":
        flipped["symmetry"] = "off" if body.half else "auto"
    if len(body.mesh.plane(1, body.curve_y)):
        flipped["strain_limiting_layer"] = "off" if is_on(config, "strain_limiting_layer") else "on"
    changed = [
        Variant(effect, {"auto": "on"}.get(state, state), config.with_effect(effect, state))
        for effect, state in flipped.items()
    ]
    return [Variant(BASE, "", config), *sorted(changed, key=lambda variant: list(config.effects).index(variant.effect))]


def _rows(variant: Variant, context: RunContext) -> tuple[list[dict[str, Any]], list[str]]:
    """The rows of one variant, and a sentence for all that is missing in them."""
    config = variant.config
    scene = Scene.meshed(config)
    outcomes = simulate(scene, context, ("III", "II"))
    found, refused = identify_all(outcomes, scene.body.pitch)
    record = parameters_record(config, found)
    cost = {
        "seconds": outcomes.seconds.total,
        "factorizations": outcomes.factorizations,
        "degrees_of_freedom": outcomes.degrees_of_freedom,
    }
    rows = [
        {
            "effect": variant.effect,
            "state": variant.state,
            "pressure_kPa": one.pressure_kPa,
            "kappa_0_middle_per_mm": record["kappa_0"]["middle_per_mm"][k],
            "end_force_N": one.loaded.load.force[1],
            "end_y_II_mm": one.free.summary.end_mm[1],
            **{name: record[name][k] for name in ("alpha1_N_mm2", "alpha2_N_mm2")},
            "d_mm": None if record["single_line_suffices"][k] else record["d_mm"][k],  # one line has no break
            **{name: record[name][k] for name in ("single_line_suffices", "r2_single_line", "r2_two_lines")},
            "stretch_of_curve": [one.free.centreline.stretch, one.loaded.centreline.stretch],
            **cost,
        }
        for k, one in enumerate(found)
    ]
    return rows, [f"{variant.name}: {sentence}" for sentence in [*outcomes.failures, *refused]]


def _compared(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows with the relative change of each number against the row of the configuration at the same pressure."""
    base = {row["pressure_kPa"]: row for row in rows if row["effect"] == BASE}
    compared = []
    for row in rows:
        reference = base.get(row["pressure_kPa"])
        change = {name: _change(row[name], reference[name] if reference else None) for name in COLUMNS}
        compared.append({**row, "relative_change": change})
    return compared


def _change(value: float | None, reference: float | None) -> float | None:
    return value / reference - 1.0 if value is not None and reference else None


def about_contact(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Whether the two slopes come from chambers that touch, in one sentence per pressure; none without such a pair."""
    by_state: dict[float, dict[str, Mapping[str, Any]]] = {}
    for row in rows:
        if row["effect"] in (BASE, "self_contact"):
            by_state.setdefault(row["pressure_kPa"], {})[row["state"]] = row
    sentences = []
    for pressure, found in by_state.items():
        if len(found) == 2:
            without = found.get("off", found[""])
            touching = found.get("on", found[""])
            sentences.append(f"{pressure:g} kPa: with contact {_slopes(touching)}; without it {_slopes(without)}")
    return sentences


def _slopes(row: Mapping[str, Any]) -> str:
    alpha1, alpha2 = row["alpha1_N_mm2"], row["alpha2_N_mm2"]
    if row["single_line_suffices"]:
        return f"one line suffices, alpha = {alpha1:.4g} N mm2"
    return f"alpha1 = {alpha1:.4g}, alpha2 = {alpha2:.4g} N mm2, d = {row['d_mm']:.3g} mm"
