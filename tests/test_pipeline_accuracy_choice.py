"""What is chosen for an asked accuracy, with pilots whose errors are known because they are made up."""

from pathlib import Path
from typing import Any

import pytest

from pipeline.accuracy import plan as accuracy_choice
from pipeline.accuracy.ladder import Rung
from pipeline.accuracy.plan import (
    FINEST,
    FORMULATION,
    GRADING,
    OF_MESH,
    PILOTS,
    Afterwards,
    Choice,
    afterwards,
    chosen,
)
from pipeline.config.config import Config, load_config
from pipeline.errors import InputError, RunFailed
from pipeline.progress import Silent
from pipeline.simulation.outcome import Indicator, Outcomes
from pipeline.store.store import open_store

EXACT = {"kappa_0_per_mm": -0.016, "alpha2_N_mm2": 400.0, "force_N": 0.03}
#: power of the size with which the made-up errors and indicators fall
ORDER = 1.5


def numbers(size: float, error: float) -> dict[str, float]:
    """Numbers of a mesh whose relative error is `error` at 4 mm, and three times that of the indicator."""
    off = error * (size / 4.0) ** ORDER
    found = {key: value * (1.0 + off) for key, value in EXACT.items()}
    return {**found, "alpha2_std_N_mm2": 0.8, "stress_error": off / 3.0}


#: that of the pilots at 4 mm
ERROR = 0.04


@pytest.fixture
def piloted(monkeypatch: pytest.MonkeyPatch) -> list[Rung]:
    """The pilots that were asked for."""
    asked: list[Rung] = []

    def made_up(rung: Rung) -> dict[str, Any]:
        asked.append(rung)
        found = [{"stride": 1, **numbers(rung.config.mesh.size_mm, ERROR)}]
        return {"failure": "", "numbers": found, "degrees_of_freedom": 30_000, "cpu_seconds": 5.0}

    monkeypatch.setattr(accuracy_choice, "measure", made_up)
    return asked


def choice_for(config: Config, out: Path) -> tuple[Config, Choice]:
    with open_store(out, config) as store:
        found, choice = chosen(config, store, Silent())
    assert choice is not None
    return found, choice


def test_the_mesh_and_the_contact_distance_are_chosen(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "pneunet_coarse.yaml", ["mesh.size=auto", "accuracy=8 %"])
    found, choice = choice_for(config, tmp_path)
    assert [rung.config.mesh.size_mm for rung in piloted] == pytest.approx([share * 15.0 for share in PILOTS])
    assert {rung.config.pressures_kPa for rung in piloted} == {config.pressures_kPa[:1]}
    assert (found.mesh.formulation, found.mesh.grading) == (FORMULATION, GRADING)
    assert found.pressures_kPa == config.pressures_kPa
    assert choice.law.order == pytest.approx(ORDER)
    of_mesh = OF_MESH * (0.08 - choice.believed_of_contact)
    assert 0.9 * of_mesh < max(choice.believed.values()) <= of_mesh
    assert found.contact_dhat_mm == choice.contact_dhat_mm
    assert found.contact_dhat_mm == pytest.approx(0.04)  # the default leaves less than the share of contact
    assert choice.sentence(None).endswith("the asked accuracy is kept")
    assert choice.record(None)["believed_error"] == pytest.approx(max(choice.believed.values()) + 0.014)
    again, kept = choice_for(config, tmp_path)
    assert (again, kept) == (found, choice)
    assert len(piloted) == 2  # the second time nothing was solved


def test_a_given_mesh_size_wins_and_its_error_is_told(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=4 mm", "accuracy=0.1 %"])
    found, choice = choice_for(config, tmp_path)
    assert found.mesh.size_mm == 4.0
    assert choice.contact_dhat_mm is None
    assert "mesh.size is given and was kept" in choice.sentence(None)
    assert "the asked accuracy is not reached" in choice.sentence(None)
    fine = 0.27 * 9.5
    at_pilot = ERROR * (fine / 4.0) ** ORDER
    expected = ERROR / (1 + at_pilot)  # relative to the number of the pilot
    assert choice.believed["force_N"] == pytest.approx(expected, rel=1e-6)


def test_without_contact_the_mesh_may_have_it_all(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    _, choice = choice_for(config, tmp_path)
    assert 0.95 * OF_MESH * 0.02 < max(choice.believed.values()) <= OF_MESH * 0.02


@pytest.mark.parametrize(("asked", "size"), [("20 %", PILOTS[0]), ("0.01 %", FINEST * PILOTS[1])])
def test_sizes_end_somewhere(asked: str, size: float, configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", f"accuracy={asked}"])
    _, choice = choice_for(config, tmp_path)
    assert choice.size_mm == pytest.approx(9.5 * size, abs=0.01)


def test_what_is_said_after_the_run(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=auto", "accuracy=2 %"])
    _, choice = choice_for(config, tmp_path)
    worst = Indicator(0.01, "III", 37.0, (10.0, 2.0, 6.5))
    after = Afterwards({**choice.believed, "force_N": 0.025}, 0.0, 0.18, worst)
    said = choice.sentence(after)
    assert "2.5 % in F (the indicator is largest in III at 37 kPa, most of it at (10.0, 2.0, 6.5) mm)" in said
    assert "the asked accuracy is not reached" in said
    assert said.endswith("α₂ is known to ± 18 % from its identification, whatever the mesh")
    record = choice.record(after)
    assert record["after"]["believed_error"] == 0.025
    assert record["believed_error"] <= 0.02
    assert afterwards(choice, Outcomes({}), (), None) is None


def test_nothing_is_chosen_where_nothing_is_asked_for(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "pneunet_coarse.yaml")
    with open_store(tmp_path, config) as store:
        assert chosen(config, store, Silent()) == (config, None)
    assert not piloted


def test_pilots_without_numbers_end_the_run(configs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accuracy_choice, "measure", lambda rung: {"failure": "II: inverted", "numbers": []})
    config = load_config(configs / "pneunet_coarse.yaml", ["mesh.size=auto", "accuracy=8 %"])
    with pytest.raises(RunFailed, match=r"pilot .* II: inverted; give mesh\.size"):
        choice_for(config, tmp_path)


@pytest.mark.parametrize(
    ("overrides", "sentence"),
    [
        (["mesh.size=auto"], "no accuracy is asked for; give --accuracy 2%, or a size"),
        (["accuracy=2"], "2 is no accuracy; write a percentage"),
        (["accuracy=0 %"], "above 0 and at most 20"),
        (["accuracy=50 %"], "above 0 and at most 20"),
        (["accuracy=good"], "for example 2 %"),
    ],
)
def test_what_is_no_accuracy_is_refused(configs: Path, overrides: list[str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        load_config(configs / "pneunet_coarse.yaml", overrides)
