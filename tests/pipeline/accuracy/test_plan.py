"""The discretisation for a requested accuracy, with made-up pilots whose errors are known."""

import re
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from geometry.families.design import expected_tets
from pipeline.accuracy import planning
from pipeline.accuracy.error_model import MESH_FRACTION
from pipeline.accuracy.measure import Cost, Measured, RodNumbers
from pipeline.accuracy.plan import Estimate, Plan, review
from pipeline.accuracy.planning import FINEST, FORMULATION, GRADING, PILOTS, Planned, plan_discretisation
from pipeline.config.automatic_mesh import COARSER, MOST_CHOSEN_TETS
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.errors import InputError
from pipeline.notes import render
from pipeline.progress import Lines
from pipeline.simulation.outcome import Indicator, Outcomes
from pipeline.store.store import open_store
from tests.foreign_bodies import bar, write_surface

EXACT = {"kappa_0_per_mm": -0.016, "alpha2_N_mm2": 400.0, "force_N": 0.03}
#: power of the size with which the made-up errors and indicators fall
ORDER = 1.5


def numbers(size: float, error: float) -> RodNumbers:
    """Numbers of a mesh whose relative error is `error` at 4 mm, and three times that of the indicator."""
    off = error * (size / 4.0) ** ORDER
    return RodNumbers(
        pressure_kPa=17.0,
        **{name: value * (1.0 + off) for name, value in EXACT.items()},
        alpha1_N_mm2=50.0,
        d_mm=10.0,
        end_mm=(100.0, -60.0),
        alpha2_std_N_mm2=0.8,
        stress_error=off / 3.0,
    )


#: of the pilots at 4 mm
ERROR = 0.04


@pytest.fixture
def piloted(monkeypatch: pytest.MonkeyPatch) -> list[Config]:
    """The pilots that were solved."""
    pilots: list[Config] = []

    def made_up(config: Config) -> Measured:
        pilots.append(config)
        cost = Cost(5.0, 5.0, {}, 100.0, 30_000, 9_000, 0.3, 20)
        return Measured("", (numbers(config.mesh.size_mm, ERROR),), cost)

    monkeypatch.setattr(planning, "measure", made_up)
    return pilots


def planned(config: Config, out: Path) -> tuple[Config, Plan]:
    made, _ = decided(config, out)
    assert made.plan is not None
    return made.config, made.plan


def decided(config: Config, out: Path) -> tuple[Planned, str]:
    """What is planned, and what is told before the run."""
    told = StringIO()
    with open_store(out, config) as store:
        return plan_discretisation(config, store, Lines(Console(file=told))), told.getvalue()


def codes(plan: Plan, after: Estimate | None = None) -> list[str]:
    return [remark.code for remark in plan.remarks(after)]


def test_mesh_and_contact_distance_are_planned(configs: Path, tmp_path: Path, piloted: list[Config]) -> None:
    config = load_config(configs / "pneunet_coarse.yaml", ["mesh.size=auto", "accuracy=8 %"])
    applied, plan = planned(config, tmp_path)
    assert [pilot.mesh.size_mm for pilot in piloted] == pytest.approx([fraction * 15.0 for fraction in PILOTS])
    assert {pilot.pressures_kPa for pilot in piloted} == {config.pressures_kPa[:1]}
    assert (applied.mesh.formulation, applied.mesh.grading) == (FORMULATION, GRADING)
    assert applied.pressures_kPa == config.pressures_kPa
    assert plan.sizes.model.order == pytest.approx(ORDER)
    of_mesh = MESH_FRACTION * (0.08 - plan.choice.estimated_of_contact)
    assert 0.9 * of_mesh < max(plan.estimate.estimated.values()) <= of_mesh
    assert applied.effects.self_contact.dhat_mm == plan.choice.contact_dhat_mm
    assert applied.effects.self_contact.dhat_mm == pytest.approx(
        0.04
    )  # the default has a smaller error than contact may have
    assert codes(plan) == ["accuracy_planned", "accuracy_estimated", "accuracy_replaces"]
    assert plan.record(None)["estimated_error"] == pytest.approx(max(plan.estimate.estimated.values()) + 0.014)
    again, kept = planned(config, tmp_path)
    assert (again, kept) == (applied, plan)
    assert len(piloted) == 2  # the kept plan is used the second time


def test_a_given_mesh_size_is_kept_and_its_error_estimated(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=4 mm", "accuracy=0.1 %"])
    applied, plan = planned(config, tmp_path)
    assert applied.mesh.size_mm == 4.0
    assert plan.choice.contact_dhat_mm is None
    assert plan.size_was_given
    assert plan.replaced == ("mesh.formulation: p2p0", "mesh.grading: off")
    assert "accuracy_missed" in codes(plan)
    fine = 0.27 * 9.5
    at_pilot = ERROR * (fine / 4.0) ** ORDER
    expected = ERROR / (1 + at_pilot)  # relative to the number of the pilot
    assert plan.estimate.estimated["force_N"] == pytest.approx(expected, rel=1e-6)


def test_without_contact_the_mesh_may_have_the_whole_error(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    _, plan = planned(config, tmp_path)
    assert 0.95 * MESH_FRACTION * 0.02 < max(plan.estimate.estimated.values()) <= MESH_FRACTION * 0.02


def test_a_coarse_mesh_suffices_for_a_large_error(configs: Path, tmp_path: Path, piloted: list[Config]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=20 %"])
    _, plan = planned(config, tmp_path)
    assert plan.choice.size_mm == pytest.approx(9.5 * PILOTS[0], abs=0.01)


def test_an_accuracy_that_no_size_reaches_is_refused_before_solving(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    settings = ["mesh.size=auto", "accuracy=0.01 %"]
    with pytest.raises(InputError, match=r"accuracy: 0\.01 % cannot be reached") as refused:
        decided(load_config(configs / "semicircular_coarse.yaml", settings), tmp_path)
    size = 9.5 * FINEST * PILOTS[1]
    assert f"{int(100 * size) / 100} mm is the smallest size that is tried" in str(refused.value)
    best = re.search(r"request ([0-9.]+) % or more, or give mesh.size", str(refused.value))
    assert best
    # the same folder may be used for the percentage that is named, and its pilots are there
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", f"accuracy={best[1]} %"])
    made, told = decided(config, tmp_path)
    assert made.plan
    assert made.plan.choice.is_reached
    assert made.plan.choice.size_mm == pytest.approx(size, abs=0.01)
    assert f"for an accuracy of {best[1]} % the mesh has mixed elements" in told
    assert len(piloted) == 2


def test_a_plan_has_at_most_as_many_elements_as_the_mesh_that_the_program_chooses(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    config = load_config(
        configs / "semicircular_single_coarse.yaml", ["mesh.size=auto", "accuracy=0.1 %", "geometry.length=400 mm"]
    )
    with pytest.raises(InputError, match="is the smallest size that is tried") as refused:
        decided(config, tmp_path)
    size = float(str(refused.value).split("cannot be reached: ")[1].split()[0])
    assert expected_tets(size, config.design.extent, config.design.meshed_volume) < 1.1 * MOST_CHOSEN_TETS
    assert size > 1.3 * FINEST * PILOTS[1] * min(config.design.extent)


def test_accuracies_are_compared_before_the_run(configs: Path, tmp_path: Path, piloted: list[Config]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    made, told = decided(config, tmp_path)
    assert made.plan
    assert render(made.plan.costs(config)[0]) in told
    twice, own, half = made.plan.sizes.compared(0.02)
    assert (twice.accuracy, own.accuracy, half.accuracy) == (0.04, 0.02, 0.01)
    assert twice.size_mm > own.size_mm == made.plan.choice.size_mm > half.size_mm
    assert twice.cpu_seconds < own.cpu_seconds < half.cpu_seconds
    assert own.degrees_of_freedom == pytest.approx(30_000 * (0.27 * 9.5 / own.size_mm) ** 1.6, rel=1e-3)
    costs = made.plan.costs(config)
    assert [reason.values["size_mm"] for reason in costs[:3]] == [twice.size_mm, own.size_mm, half.size_mm]
    assert [row["is_reached"] for row in made.plan.record(None)["choices"]] == [True, True, True]  # type: ignore[index, union-attr, call-overload]


def test_an_accuracy_that_the_run_does_not_have_is_refused(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    for settings, sentence in (
        (["law=cell"], "use `pneurod cell CONFIG --accuracy 8%`"),
        (["effects.incompressibility=off", "mesh={size: 4 mm}"], "effects.incompressibility, accuracy: a requested"),
    ):
        config = load_config(configs / "pneunet_coarse.yaml", ["accuracy=8 %", *settings])
        with pytest.raises(InputError, match=re.escape(sentence)):
            decided(config, tmp_path)
    assert not piloted


def test_a_law_that_ends_early_with_mixed_elements_is_named(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    for law, is_named in (("svk", True), ("hencky", False)):
        settings = ["mesh.size=auto", "accuracy=8 %", f"material.law={law}"]
        made, told = decided(load_config(configs / "pneunet_coarse.yaml", settings), tmp_path / law)
        assert [remark.code for remark in made.remarks] == ["accuracy_ends_early"] * is_named
        assert all(render(remark) in told for remark in made.remarks)


def test_the_tolerance_of_the_configuration_is_kept_where_it_is_smaller(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    for given, used in (("1e-9", 1e-9), ("0.001", 2e-5)):
        settings = ["mesh.size=auto", "accuracy=2 %", f"newton.tolerance={given}"]
        applied, _ = planned(load_config(configs / "semicircular_coarse.yaml", settings), tmp_path / given)
        assert applied.newton.tolerance == pytest.approx(used)
    plain = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    assert planned(plain, tmp_path / "plain")[0].newton.tolerance == pytest.approx(2e-5)


def test_estimates_of_an_arm_that_hardly_bends_are_not_reliable(
    configs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def straight(config: Config) -> Measured:
        row = replace(numbers(config.mesh.size_mm, ERROR), kappa_0_per_mm=-1e-4)
        return Measured("", (row,), Cost(5.0, 5.0, {}, 100.0, 30_000, 9_000, 0.3, 20))

    monkeypatch.setattr(planning, "measure", straight)
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=8 %"])
    made, told = decided(config, tmp_path)
    assert made.plan
    assert made.plan.estimate.largest < 0.08
    assert not made.plan.is_reached(None)
    assert codes(made.plan)[-1] == "accuracy_hardly_bent"
    assert "the arm hardly bends (0.01 rad at 20 kPa)" in told


def test_a_large_estimate_is_not_reliable(configs: Path, tmp_path: Path, piloted: list[Config]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=9 mm", "accuracy=8 %"])
    made, told = decided(config, tmp_path)
    assert made.plan
    far = replace(made.plan, choice=replace(made.plan.choice, size_mm=40.0))
    assert codes(far)[-1] == "accuracy_unreliable"
    assert "50 %" not in told


SURFACE = """
name: bar
geometry: {family: own, file: bar.stl, curve: 1.5 mm}
material: {law: svk, E: 1.2 MPa, nu: 0.495}
pressures: [10 kPa]
mesh: {size: 4 mm}
"""


def test_a_closed_surface_stays_without_grading(tmp_path: Path, piloted: list[Config]) -> None:
    write_surface(tmp_path / "bar.stl", bar, 50)
    file = tmp_path / "bar.yaml"
    file.write_text(SURFACE, encoding="utf-8")
    config = load_config(file, ["accuracy=8 %"])
    _, plan = planned(config, tmp_path / "out")
    assert plan.grading == "off"
    assert {pilot.mesh.grading for pilot in piloted} == {"off"}


def test_the_review_after_the_run(configs: Path, tmp_path: Path, piloted: list[Config]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    _, plan = planned(config, tmp_path)
    worst = Indicator(0.01, "III", 37.0, (10.0, 2.0, 6.5))
    after = Estimate({**plan.estimate.estimated, "force_N": 0.025}, 0.0, 0.18, worst)
    assert codes(plan, after)[-3:] == ["accuracy_estimated", "accuracy_missed", "accuracy_identified"]
    assert plan.shortfalls(after) == plan.remarks(after)[-2:]
    assert plan.shortfalls(None) == ()
    record = plan.record(after)
    assert "errors estimated after the run" in str(record["sentence"])
    assert record["after"]["estimated_error"] == 0.025
    assert record["estimated_error"] <= 0.02
    assert review(plan, Outcomes({}), (), None) is None


def test_a_finer_size_is_suggested_where_the_run_misses_the_request(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=5 %"])
    _, plan = planned(config, tmp_path)
    worst = Indicator(0.01, "III", 37.0, (10.0, 2.0, 6.5))
    after = Estimate(dict.fromkeys(EXACT, 0.08), 0.0, 0.01, worst)
    record = plan.record(after)
    assert (record["is_reached"], plan.record(None)["is_reached"]) == (False, True)
    finer = record["finer"]
    assert isinstance(finer, dict)
    # what has 8 % now and falls with ORDER has 5 % there
    estimated = max(plan.estimate.estimated.values())
    assert 0.08 * plan.sizes.model.at(finer["size_mm"])["force_N"] / estimated == pytest.approx(0.05, rel=0.06)
    assert plan.record(Estimate(dict.fromkeys(EXACT, 0.04), 0.0, 0.01, worst))["finer"] is None
    assert plan.record(Estimate(dict.fromkeys(EXACT, 4.0), 0.0, 0.01, worst))["finer"] is None


def test_without_a_requested_accuracy_nothing_changes(configs: Path, tmp_path: Path, piloted: list[Config]) -> None:
    config = load_config(configs / "pneunet_coarse.yaml")
    assert decided(config, tmp_path) == (Planned(config), "")
    assert not piloted


def test_without_pilots_the_run_goes_on_as_without_the_request(
    configs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(planning, "measure", lambda config: Measured("II: inverted", (), None))
    for number, settings in enumerate(([], ["mesh={size: auto}"], ["mesh={size: 4 mm, formulation: p2}"])):
        made, told = decided(
            load_config(configs / "pneunet_coarse.yaml", ["accuracy=8 %", *settings]), tmp_path / str(number)
        )
        plain = load_config(configs / "pneunet_coarse.yaml", settings)
        assert made.plan is None
        assert made.config.mesh == plain.mesh
        (remark,) = made.remarks
        assert remark.code == "accuracy_unknown"
        assert remark.values["why"] == "the pilot with a mesh of 6 mm gave no numbers (II: inverted)"
        assert render(remark) in told
    assert plain.mesh.coarser == COARSER


def test_an_arm_too_short_for_five_parameters_has_no_pilots(
    configs: Path, tmp_path: Path, piloted: list[Config]
) -> None:
    config = load_config(configs / "pneunet_coarse.yaml", ["accuracy=8 %", "geometry.chambers=6"])
    made, _ = decided(config, tmp_path)
    assert not piloted
    assert made.plan is None
    (remark,) = made.remarks  # the elements are those of the configuration
    assert remark.code == "accuracy_unknown"
    assert str(remark.values["why"]).startswith("the arm is too short for five parameters")


@pytest.mark.parametrize(
    ("overrides", "sentence"),
    [
        (["accuracy=2"], "2 has no unit; write an accuracy"),
        (["accuracy=0 %"], "allowed: above 0, at most 20; for example 2 %"),
        (["accuracy=50 %"], "allowed: above 0, at most 20; for example 2 %"),
        (["accuracy=good"], "for example .2 %"),
    ],
)
def test_wrong_accuracies_are_rejected(configs: Path, overrides: list[str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        load_config(configs / "pneunet_coarse.yaml", overrides)
