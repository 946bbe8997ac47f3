"""What is chosen for an asked accuracy, with pilots whose errors are known because they are made up."""

from pathlib import Path
from typing import Any

import pytest

from pipeline import accuracy_choice
from pipeline.accuracy_choice import FORMULATION, GRADING, OF_MESH, ORDER, PILOTS, Choice, chosen, size_for
from pipeline.config import Config, load_config
from pipeline.failure import InputError, RunFailed
from pipeline.progress import Silent
from pipeline.rungs import Rung
from pipeline.store import open_store

EXACT = {"kappa_0_per_mm": -0.016, "alpha2_N_mm2": 400.0, "force_N": 0.03}


def numbers(size: float, error: float) -> dict[str, float]:
    """Numbers of a mesh whose relative error is `error` at 4 mm and falls with the usual power of the size."""
    return {key: value * (1.0 + error * (size / 4.0) ** ORDER) for key, value in EXACT.items()}


def test_finer_meshes_for_smaller_errors() -> None:
    coarse, fine = numbers(6.0, 0.01), numbers(4.0, 0.01)
    asked = [0.05, 0.01, 0.005, 0.0025]
    sizes = [size_for(one, coarse, fine, (6.0, 4.0)) for one in asked]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == 6.0  # never coarser than the first pilot
    halved = (0.5 ** (1 / ORDER)) * sizes[1]
    assert sizes[2] == pytest.approx(halved, abs=0.01)
    assert size_for(1e-9, coarse, fine, (6.0, 4.0)) == pytest.approx(accuracy_choice.FINEST * 4.0, abs=0.01)
    assert size_for(0.01, fine, fine, (6.0, 4.0)) == 6.0


@pytest.fixture
def piloted(monkeypatch: pytest.MonkeyPatch) -> list[Rung]:
    """The pilots that were asked for."""
    asked: list[Rung] = []

    def made_up(rung: Rung) -> dict[str, Any]:
        asked.append(rung)
        found = [{"stride": 1, **numbers(rung.config.mesh.size_mm, 0.04)}]
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
    assert 0.9 * OF_MESH * 0.08 < max(choice.believed.values()) <= OF_MESH * 0.08
    assert found.contact_dhat_mm == choice.contact_dhat_mm
    assert 0.0 < found.contact_dhat_mm <= 0.2
    assert choice.largest <= 0.08
    assert choice.sentence().endswith("the asked accuracy is kept")
    assert choice.record()["believed_error"] == choice.largest
    again, kept = choice_for(config, tmp_path)
    assert (again, kept.record()) == (found, choice.record())
    assert len(piloted) == 2  # the second time nothing was solved


def test_a_given_mesh_size_wins_and_its_error_is_told(configs: Path, tmp_path: Path, piloted: list[Rung]) -> None:
    config = load_config(configs / "semicircular_coarse.yaml", ["mesh.size=4 mm", "accuracy=0.1 %"])
    found, choice = choice_for(config, tmp_path)
    assert found.mesh.size_mm == 4.0
    assert choice.contact_dhat_mm is None
    assert "mesh.size is given and was kept" in choice.sentence()
    assert choice.sentence().endswith("the asked accuracy is not reached")
    fine = 0.27 * 9.5
    assert choice.believed["force_N"] == pytest.approx(0.04 / (1 + 0.04 * (fine / 4.0) ** ORDER))


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
