"""Effects in a run: half against full body, contact that becomes active, and no cost of effects that are off."""

import io
import json
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import fem
from pipeline.cli.ending import text_table
from pipeline.config.load import load_config
from pipeline.simulate.effects_record import list_effects
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import experiments_of, simulate
from pipeline.store.progress import Silent
from pipeline.study.effects.rows import BASE, effects_table
from pipeline.study.effects.study import compare_effects, variants
from tests.solved import alone

FRESH = """
import json, sys
from dataclasses import replace
from pathlib import Path
from tests.pipeline.simulate.test_effects import SHORT, simulated

single = ("geometry.length=32 mm",)
arms = {"semicircular": SHORT, "semicircular_single": single, "bisected_circle": single, "pneunet": SHORT}
rows = []
for name, overrides in arms.items():
    place = Path(sys.argv[1]) / name
    _, row = simulated(place, f"{name}_coarse", *overrides, "pressures=[5 kPa]")
    rows.append(row["self_contact"])
print(json.dumps([rows, "ipctk" in sys.modules]))
"""


HERE = Path(__file__).resolve().parent.parent.parent.parent
SHORT = ("geometry.chambers=3", "mesh.size=6 mm")


def simulated(
    out: Path, name: str, *overrides: str, experiments: tuple[str, ...] = ("II",)
) -> tuple[Outcomes, dict[str, dict[str, Any]]]:
    """Outcomes, and the rows of effects.json by effect."""
    config = load_config(HERE / "configs" / f"{name}.yaml", overrides)
    scene = Scene.meshed(config)
    with alone(out, config) as context:
        outcomes = simulate(scene, context, experiments)
    assert [outcome.failure for outcome in outcomes] == [None] * len(experiments)
    return outcomes, {state.effect: asdict(state) for state in list_effects(scene, outcomes)}


def ends(outcomes: Outcomes) -> np.ndarray:
    return np.array([record.state.end_mm for record in outcomes.records])


def test_half_and_whole_body_give_the_same_end(tmp_path: Path) -> None:
    pressures = "pressures=[10 kPa, 20 kPa]"
    both = ("II", "III")
    half, on = simulated(tmp_path / "half", "semicircular_coarse", *SHORT, pressures, experiments=both)
    whole, off = simulated(
        tmp_path / "whole", "semicircular_coarse", *SHORT, pressures, "effects.symmetry=off", experiments=both
    )
    assert (on["symmetry"]["state"], off["symmetry"]["state"]) == ("on", "off")
    assert whole["II"].degrees_of_freedom > 1.7 * half["II"].degrees_of_freedom
    assert np.abs(ends(half) - ends(whole)).max() < 1e-6 * 32
    for record, other in zip(half["III"].records, whole["III"].records, strict=True):
        assert record.load.force == pytest.approx(other.load.force, rel=1e-4, abs=1e-8)
        assert record.state.cavity_volume_mm3 == pytest.approx(other.state.cavity_volume_mm3, rel=1e-8)


def test_contact_joins_when_walls_come_near(tmp_path: Path) -> None:
    pressures = "pressures=[5 kPa, 37 kPa]"
    waits, row = simulated(tmp_path / "auto", "pneunet_coarse", *SHORT, pressures)
    always, _ = simulated(tmp_path / "on", "pneunet_coarse", *SHORT, pressures, "effects.self_contact=on")
    never, off = simulated(tmp_path / "off", "pneunet_coarse", *SHORT, pressures, "effects.self_contact=off")
    assert [record.effects for record in waits["II"].records] == [("pressure",), ("pressure", "self_contact")]
    assert row["self_contact"]["reason"] == "walls came within the activation distance of contact: II from 37 kPa"
    assert row["self_contact"]["share_of_time"] > 0.0
    assert np.abs(ends(waits) - ends(always)).max() < 1e-6 * 32
    assert (ends(waits)[0] == ends(never)[0]).all()
    assert np.abs(ends(waits)[1] - ends(never)[1]).max() > 1e-3
    assert (off["self_contact"]["state"], off["self_contact"]["share_of_time"]) == ("off", 0.0)


def test_scenes_without_contact_load_no_contact_code(tmp_path: Path) -> None:
    arguments = [sys.executable, "-c", FRESH, str(tmp_path)]
    done = subprocess.run(arguments, capture_output=True, text=True, check=True, cwd=HERE)
    rows, loaded = json.loads(done.stdout)
    assert [(row["state"], row["share_of_time"]) for row in rows] == [("off", 0.0)] * 4
    assert not loaded


def test_effects_that_are_off_add_nothing(tmp_path: Path) -> None:
    def system(*overrides: str) -> Any:
        short = ["geometry.length=32 mm", "effects.self_contact=off", *overrides]
        config = load_config(HERE / "configs/bisected_circle_coarse.yaml", short)
        scene = Scene.meshed(config)
        experiment = fem.Experiment.of("II", scene.body, 0.0)
        return experiment.model(fem.StVenantKirchhoff(1.2, 0.495), scene.effects(0.02), "p2p0").system()

    plain, every = system(), system("effects.gravity=on", "effects.strain_limiting_layer=on")
    assert [term.effect for term in plain.terms] == ["pressure"]
    # the layer itself, and its slope at the clamp
    assert [term.effect for term in every.terms] == ["pressure", "gravity", *["strain_limiting_layer"] * 2]
    assert plain.size == every.size
    assert plain.storage.pattern.indices.shape == every.storage.pattern.indices.shape


def test_weight_is_whole_at_every_pressure(tmp_path: Path) -> None:
    outcomes, rows = simulated(
        tmp_path, "semicircular_coarse", *SHORT, "pressures=[5 kPa, 10 kPa]", "effects.gravity=on"
    )
    config = load_config(HERE / "configs/semicircular_coarse.yaml", SHORT)
    mass = config.material.density_tonne_mm3 * Scene.meshed(config).body.mesh.volume * 2
    for record in outcomes["II"].records:
        assert record.state.clamp_reaction_N == pytest.approx([0.0, mass * 9810.0], abs=1e-6)
    assert rows["gravity"]["state"] == "on"
    assert rows["gravity"]["reason"].startswith("(0, -9.81, 0) m/s2 at every pressure")


def test_a_free_body_with_weight_is_not_simulated() -> None:
    """The three constraints of I carry no force without gravity; with it the arm would hang on them."""
    plain, heavy = (
        load_config(HERE / "configs/semicircular_coarse.yaml", [f"effects.gravity={state}"]) for state in ("off", "on")
    )
    assert experiments_of(plain) == ("II", "III", "I")
    assert experiments_of(heavy) == ("II", "III")
    assert "no experiment I" in heavy.effects.gravity.reason


def test_layer_keeps_the_length_of_the_curve(tmp_path: Path) -> None:
    names = ("I", "II", "III")
    arguments = ("bisected_circle_coarse", "geometry.length=60 mm", "pressures=[20 kPa]")
    plain, _ = simulated(tmp_path / "plain", *arguments, experiments=names)
    paper, rows = simulated(tmp_path / "paper", *arguments, "effects.strain_limiting_layer=on", experiments=names)
    for name in names:
        assert max(abs(record.state.stretch_of_curve - 1.0) for record in plain[name].records) > 1e-2
        assert max(abs(record.state.stretch_of_curve - 1.0) for record in paper[name].records) < 2e-3
    assert rows["strain_limiting_layer"]["state"] == "on"
    assert rows["strain_limiting_layer"]["share_of_time"] > 0.0


def test_equal_pressures_on_both_sides_do_not_bend_the_bar(tmp_path: Path) -> None:
    bar = ("bisected_circle_coarse", "geometry.length=48 mm", "mesh.size=5 mm", "pressures=[15 kPa]")
    ends_y = []
    for k, lower in enumerate(("0", "1", "15 kPa", "5 kPa")):
        cavities = f"effects.pressure={{cavities: {{cavity: 1, cavity_lower: {lower}}}}}"
        outcomes, _ = simulated(tmp_path / str(k), *bar, cavities)
        ends_y.append(ends(outcomes)[0, 1])
    alone, equal, held, less = ends_y
    assert alone < -0.2
    assert abs(equal) < 0.05 * abs(alone)
    assert held == pytest.approx(equal, abs=1e-6)
    assert alone < less < equal


def test_the_volume_is_that_of_the_cavity_under_pressure_and_the_stretch_counts_what_leaves_the_plane(
    tmp_path: Path,
) -> None:
    bar = ("bisected_circle_coarse", "geometry.length=48 mm", "mesh.size=5 mm", "pressures=[3 kPa, 6 kPa]")
    weight = "effects.gravity={state: on, acceleration: [0 m/s^2, 0 m/s^2, 98.1 m/s^2]}"
    below = "effects.pressure={cavities: {cavity_lower: 1}}"
    plain, _ = simulated(tmp_path / "plain", *bar, below)
    heavy, _ = simulated(tmp_path / "heavy", *bar, below, weight)
    volumes = [record.state.cavity_volume_mm3 for record in plain.records]
    assert volumes[0] < volumes[1]
    sides, straight = heavy.records[0].state, plain.records[0].state
    assert sides.curve_z_mm > 2.0
    planar = heavy.records[0].centreline.stretch
    assert planar < straight.stretch_of_curve - 1e-3
    assert sides.stretch_of_curve == pytest.approx(straight.stretch_of_curve, abs=3e-4)


def test_table_of_effects(tmp_path: Path) -> None:
    coarser = ["geometry.chambers=7", "mesh.size=8 mm", "mesh.grading=off", "pressures=[20 kPa]"]
    config = load_config(HERE / "configs/semicircular_coarse.yaml", coarser)
    assert [tuple(point.setting.values()) for point in variants(Scene.meshed(config), tmp_path)] == [
        *((BASE, ""), ("symmetry", "off"), ("incompressibility", "off"), ("gravity", "on")),
        *(("strain_limiting_layer", "on"), ("hoops", "on")),
    ]
    table = compare_effects(config, tmp_path / "table", 1, False, Silent())
    rows = table.rows
    assert table.failures == []
    written = json.loads((tmp_path / "table" / "effects_table.json").read_text())
    assert written == json.loads(json.dumps([*map(asdict, rows)]))
    by_name = {row.variant: row for row in rows}
    changes = {name: row.relative_change for name, row in by_name.items()}
    assert changes[BASE]["alpha1_N_mm2"] == 0.0
    assert abs(changes["symmetry off"]["end_force_N"]) < 1e-4
    assert changes["strain_limiting_layer on"]["kappa_0_middle_per_mm"] > 0.3
    assert changes["hoops on"]["kappa_0_middle_per_mm"] > 0.3
    assert all(row.cpu_seconds > 0.0 and row.factorizations > 0 and not row.other_states for row in rows)
    assert changes[BASE]["cpu_seconds"] == 0.0
    console = Console(record=True, width=80, file=io.StringIO())
    console.print(text_table(effects_table(rows)))
    shown = console.export_text()
    assert "…" not in shown
    assert all(word in shown for name in by_name for word in name.replace("_", " ").split())
    assert all(text in shown for text in ("single line: whether", " +", "0.0 %"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["semicircular", "semicircular_single", "bisected_circle"])
def test_coarse_parameterization_is_cheap(name: str, tmp_path: Path) -> None:
    for layer in ("off", "on"):
        overrides = [f"effects.strain_limiting_layer={layer}"]
        outcomes, _ = simulated(tmp_path / layer, f"{name}_coarse", *overrides, experiments=("II", "III"))
        assert outcomes.factorizations <= 60
        stretch = [record.state.stretch_of_curve for record in outcomes.records]
        assert layer == "off" or np.abs(np.array(stretch) - 1.0).max() < 2e-3
