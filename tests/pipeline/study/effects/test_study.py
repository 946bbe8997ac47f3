"""The study of effects where something is missing: a density, five parameters, a variant, a pressure, the time."""

import io
import json
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from contextlib import nullcontext
from pathlib import Path

import pytest
from pydantic import TypeAdapter
from rich.console import Console

import fem
from pipeline.cli.ending import text_table
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.show.progress import Lines
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.study.effects import study as effects_study
from pipeline.study.effects.rows import BASE, EffectRow, compared, effects_table
from pipeline.study.effects.study import EffectsTable, compare_effects, variants
from pipeline.study.sweep import study, work
from pipeline.study.sweep.numbers import rows_of_variant
from pipeline.study.sweep.points import Point, PointResult
from pipeline.values.errors import InputError, RunFailed
from tests.solved import alone

SHORT = """
name: short
geometry: {family: pneunet, chambers: 3}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [2 kPa]
validation: off
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT, encoding="utf-8")
    return path


def run_of(config: Config, out: Path, fresh: bool = False) -> tuple[EffectsTable, str]:
    """The table, and what was said meanwhile."""
    said = io.StringIO()
    table = compare_effects(config, out, 1, fresh, Lines(Console(file=said, width=200)))
    return table, said.getvalue()


def printed(rows: Sequence[EffectRow]) -> str:
    shown = io.StringIO()
    Console(file=shown, width=80).print(text_table(effects_table(rows)))
    return shown.getvalue()


class InThisProcess(Executor):
    """Does a task when it is submitted."""

    def submit(self, fn: Callable[..., PointResult], *arguments: Point) -> "Future[PointResult]":
        future: Future[PointResult] = Future()
        future.set_result(fn(*arguments))
        return future


@pytest.fixture
def two(monkeypatch: pytest.MonkeyPatch) -> None:
    """The configuration and that without contact alone, solved in this process."""
    monkeypatch.setattr(study, "connected", lambda _: nullcontext((InThisProcess(), "this process")))
    monkeypatch.setattr(effects_study, "variants", lambda scene, out: variants(scene, out)[:2])


@pytest.mark.parametrize(
    ("materials", "keys"),
    [
        ("material: {law: svk, E: 1.2 MPa, nu: 0.495}", "give material.density"),
        (
            "material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}\n"
            "materials: {base: {law: svk, E: 2 MPa, nu: 0.495}}",
            "give materials.base.density",
        ),
    ],
)
def test_gravity_is_left_out_where_a_density_is_missing(file: Path, materials: str, keys: str, two: None) -> None:
    file.write_text("\n".join([*(line for line in SHORT.splitlines() if "material:" not in line), materials]))
    config = load_config(file)
    assert "gravity" not in [variant.setting["effect"] for variant in variants(Scene.meshed(config), file.parent)]
    _, said = run_of(config, file.parent / "out")
    assert f"note: gravity is not varied: no density is given; {keys}, for example 1130 kg/m^3" in said


def test_an_arm_without_five_parameters_has_its_other_numbers(file: Path, two: None) -> None:
    table, said = run_of(load_config(file), file.parent / "out")
    assert "note: five parameters need an arm of" in said
    assert "; curvature, force and end are compared without them" in said
    assert [row.variant for row in table.rows] == [BASE, "self_contact off"]
    for row in table.rows:
        assert row.kappa_0_middle_per_mm < 0.0
        assert row.end_force_N > 0.0
        assert row.end_y_II_mm == pytest.approx(0.2, abs=0.01)
        assert row.alpha1_N_mm2 is None
        assert row.reason.startswith("no five parameters at 2 kPa: ")
    assert abs(table.rows[1].relative_change["end_force_N"]) < 1e-6
    written = json.loads((file.parent / "out" / "effects_table.json").read_text())
    assert [row["alpha1_N_mm2"] for row in written] == [None, None]
    assert written[1]["reason"] == table.rows[1].reason
    assert table.failures == [f"{row.variant}: {row.reason}" for row in table.rows]


def test_a_variant_that_fails_is_a_row_and_the_others_go_on(
    file: Path, two: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def only_without_contact(scene: Scene, context: RunContext, experiments: tuple[str, ...]) -> Outcomes:
        if scene.config.effects.self_contact.off:
            return simulate(scene, context, experiments)
        raise RunFailed("the faces touch at rest")

    monkeypatch.setattr(work, "simulate", only_without_contact)
    table, _ = run_of(load_config(file), file.parent / "out")
    failed, solved = table.rows
    assert (failed.reason, failed.cpu_seconds, failed.end_force_N) == ("the faces touch at rest", None, None)
    assert solved.factorizations > 0
    assert solved.relative_change["cpu_seconds"] is None
    assert table.failures[0] == "as configured: the faces touch at rest"
    assert "as configured" in printed(table.rows)


def test_fresh_removes_all_of_an_earlier_study_before_anything_is_solved(
    file: Path, two: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = file.parent / "out"
    run_of(load_config(file), out)
    assert len(list(out.glob("points/*/states/II_2kPa.npz"))) == 2
    other = load_config(file, ["material.E=1.3 MPa"])
    with pytest.raises(InputError, match="with another config"):
        run_of(other, out)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(work, "simulate", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run_of(other, out, fresh=True)
    assert json.loads((out / "effects_table.json").read_text()) == []
    assert not list(out.glob("points/*/states/*.npz"))
    table, _ = run_of(other, out)  # the same command without --fresh continues
    assert len(table.rows) == 2
    monkeypatch.setattr(InThisProcess, "submit", None)  # nothing is left to be solved
    assert run_of(other, out)[0] == table


def solved(config: Config, out: Path, *experiments: str) -> Outcomes:
    with alone(out, config) as context:
        return simulate(Scene.meshed(config), context, experiments)


def test_the_time_of_an_experiment_counts_no_kernels_and_is_kept_with_its_states(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compiling(*_: object) -> None:
        end = time.process_time() + 3.0
        while time.process_time() < end:
            pass

    config, out = load_config(file), file.parent / "out"
    solved(config, file.parent / "first", "II")  # loads what is loaded once
    monkeypatch.setattr(fem, "compile_kernels", compiling)
    outcomes = solved(config, out, "II")
    assert 0.0 < outcomes.records[0].cpu_seconds <= outcomes.cpu_seconds < 2.5
    again = solved(config, out, "II")
    assert again.records[0].cpu_seconds == outcomes.records[0].cpu_seconds


def test_the_cost_contains_what_failed_attempts_took(file: Path) -> None:
    config = load_config(file, ["geometry.chambers=1", "pressures=[2 kPa, 1 MPa]"])
    outcomes = solved(config, file.parent / "out", "II", "III")
    failed = sum(outcome.failure.factorizations for outcome in outcomes)
    found = rows_of_variant(Scene.meshed(config), outcomes)
    reached, missed = TypeAdapter(list[EffectRow]).validate_python(found)
    assert failed > 0
    assert reached.factorizations == outcomes.factorizations + failed
    assert reached.cpu_seconds > 2.0 * sum(record.cpu_seconds for record in outcomes.records)
    assert reached.states == 2
    assert (missed.cpu_seconds, missed.states) == (reached.cpu_seconds, reached.states)
    assert missed.end_force_N is None
    assert missed.reason.startswith("experiment II stopped before 1000 kPa")


def test_costs_have_two_digits_and_a_mark_where_other_pressures_were_reached() -> None:
    def variant(effect: str, state: str, seconds: float, *cost: int) -> EffectRow:
        names = ("factorizations", "degrees_of_freedom", "states")
        costs = dict(zip(names, cost, strict=True))
        named = {"effect": effect, "state": state, "cpu_seconds": seconds}
        return EffectRow(2.0, kappa_0_middle_per_mm=-0.001, **named, **costs)

    rows = compared([
        variant(BASE, "", 0.567, 17, 3000, 2),
        variant("gravity", "on", 1.134, 20, 3000, 2),
        variant("symmetry", "off", 123.4, 9, 3000, 1),
    ])  # fmt: skip
    assert [row.other_states for row in rows] == [False, False, True]
    assert rows[1].relative_change["cpu_seconds"] == pytest.approx(1.0)
    assert all(text in printed(rows) for text in ("0.57", "1.1", "+100 %", "120*", "9*", "* reached more or fewer"))
    assert "*" not in printed(rows[:2])
