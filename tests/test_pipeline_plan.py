"""The discretisation for a requested accuracy, with made-up pilots whose errors are known."""

from pathlib import Path

import pytest

from pipeline.accuracy import plan as plan_module
from pipeline.accuracy.ladder import Rung
from pipeline.accuracy.plan import (
    FINEST,
    FORMULATION,
    GRADING,
    MESH_FRACTION,
    PILOTS,
    Plan,
    Review,
    plan_discretisation,
    review,
)
from pipeline.accuracy.result import Cost, RodNumbers, RungResult
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.errors import InputError, RunFailed
from pipeline.progress import Silent
from pipeline.simulation.outcome import Indicator, Outcomes
from pipeline.store.store import open_store

EXACT = {"kappa_0_per_mm": -0.016, "alpha2_N_mm2": 400.0, "force_N": 0.03}
#: power of the size with which the made-up errors and indicators fall
ORDER = 1.5


def numbers(size: float, error: float) -> RodNumbers:
    """Numbers of a mesh whose relative error is `error` at 4 mm, and three times that of the indicator."""
    off = error * (size / 4.0) ** ORDER
    return RodNumbers(
        pressure_kPa=17.0,
        stride=1,
        fit_seconds=0.0,
        points=80,
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
def piloted(monkeypatch: pytest.MonkeyPatch) -> list[Rung]:
    """The pilots that were solved."""
    pilots: list[Rung] = []

    def made_up(rung: Rung) -> RungResult:
        pilots.append(rung)
        cost = Cost(5.0, 5.0, {}, 100.0, 30_000, 9_000, 0.3, 20)
        return RungResult("", (numbers(rung.config.mesh.size_mm, ERROR),), cost)

    monkeypatch.setattr(plan_module, "measure", made_up)
    return pilots


def planned(config: Config, out: Path) -> tuple[Config, Plan]:
    with open_store(out, config) as store:
        applied, plan = plan_discretisation(config, store, Silent())
    assert plan is not None
    return applied, plan


def test_mesh_and_contact_distance_are_planned(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "pneunet_coarse.yaml", ["mesh.size=auto", "accuracy=8 %"])
    applied, plan = planned(config, tmp_path)
    assert [rung.config.mesh.size_mm for rung in piloted] == pytest.approx([fraction * 15.0 for fraction in PILOTS])
    assert {rung.config.pressures_kPa for rung in piloted} == {config.pressures_kPa[:1]}
    assert (applied.mesh.formulation, applied.mesh.grading) == (FORMULATION, GRADING)
    assert applied.pressures_kPa == config.pressures_kPa
    assert plan.error_model.order == pytest.approx(ORDER)
    of_mesh = MESH_FRACTION * (0.08 - plan.estimated_of_contact)
    assert 0.9 * of_mesh < max(plan.estimate.estimated.values()) <= of_mesh
    assert applied.effects.self_contact.dhat_mm == plan.contact_dhat_mm
    assert applied.effects.self_contact.dhat_mm == pytest.approx(
        0.04
    )  # the default has a smaller error than contact may have
    assert plan.sentence(None).endswith("the requested accuracy is reached")
    assert plan.record(None)["estimated_error"] == pytest.approx(max(plan.estimate.estimated.values()) + 0.014)
    again, kept = planned(config, tmp_path)
    assert (again, kept) == (applied, plan)
    assert len(piloted) == 2  # the kept plan is used the second time


def test_a_given_mesh_size_is_kept_and_its_error_estimated(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=4 mm", "accuracy=0.1 %"])
    applied, plan = planned(config, tmp_path)
    assert applied.mesh.size_mm == 4.0
    assert plan.contact_dhat_mm is None
    assert "mesh.size was given and is kept" in plan.sentence(None)
    assert plan.replaced == ("mesh.formulation: p2p0", "mesh.grading: off")
    assert "(instead of mesh.formulation: p2p0 and mesh.grading: off: the estimates" in plan.sentence(None)
    assert "the requested accuracy is not reached" in plan.sentence(None)
    fine = 0.27 * 9.5
    at_pilot = ERROR * (fine / 4.0) ** ORDER
    expected = ERROR / (1 + at_pilot)  # relative to the number of the pilot
    assert plan.estimate.estimated["force_N"] == pytest.approx(expected, rel=1e-6)


def test_without_contact_the_mesh_may_have_the_whole_error(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    _, plan = planned(config, tmp_path)
    assert 0.95 * MESH_FRACTION * 0.02 < max(plan.estimate.estimated.values()) <= MESH_FRACTION * 0.02


@pytest.mark.parametrize(("requested", "size"), [("20 %", PILOTS[0]), ("0.01 %", FINEST * PILOTS[1])])
def test_planned_sizes_are_bounded(
    requested: str, size: float, configs: Path, tmp_path: Path, piloted: list[Rung]
) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", f"accuracy={requested}"])
    _, plan = planned(config, tmp_path)
    assert plan.size_mm == pytest.approx(9.5 * size, abs=0.01)


def test_the_review_after_the_run(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    _, plan = planned(config, tmp_path)
    worst = Indicator(0.01, "III", 37.0, (10.0, 2.0, 6.5))
    after = Review({**plan.estimate.estimated, "force_N": 0.025}, 0.0, 0.18, worst)
    sentence = plan.sentence(after)
    assert "2.5 % in F (the indicator is largest in III at 37 kPa, most of it at (10.0, 2.0, 6.5) mm)" in sentence
    assert "the requested accuracy is not reached" in sentence
    assert sentence.endswith("the identification of α₂ alone is uncertain by ± 18 %, on every mesh")
    record = plan.record(after)
    assert record["after"]["estimated_error"] == 0.025
    assert record["estimated_error"] <= 0.02
    assert review(plan, Outcomes({}), (), None) is None


def test_without_a_requested_accuracy_nothing_changes(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "pneunet_coarse.yaml")
    with open_store(tmp_path, config) as store:
        assert plan_discretisation(config, store, Silent()) == (config, None)
    assert not piloted


def test_pilots_without_numbers_end_the_run(configs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_module, "measure", lambda rung: RungResult("II: inverted", (), None))
    config = load_config(configs / "pneunet_coarse.yaml", ["mesh.size=auto", "accuracy=8 %"])
    with pytest.raises(RunFailed, match=r"pilot .* II: inverted; give mesh\.size"):
        planned(config, tmp_path)


@pytest.mark.parametrize(
    ("overrides", "sentence"),
    [
        (["accuracy=2"], "2 is no accuracy; write a percentage"),
        (["accuracy=0 %"], "above 0 and at most 20"),
        (["accuracy=50 %"], "above 0 and at most 20"),
        (["accuracy=good"], "for example 2 %"),
    ],
)
def test_wrong_accuracies_are_rejected(configs: Path, overrides: list[str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        load_config(configs / "pneunet_coarse.yaml", overrides)
