"""Result files are read into values by their types; wrong ones are refused in one sentence."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from pipeline.results.files import TYPES, json_schema, read_results, save_value
from pipeline.store.result_folder import ResultFolder
from pipeline.values.errors import InputError
from pipeline.values.formats import CONVERGED
from pipeline.values.run import RodError, State
from tests.coarse import COARSE, coarse_run


def test_every_file_is_read() -> None:
    run = coarse_run()
    assert run.pressures_kPa == run.reached_kPa == run.identified_kPa == (17.0, 37.0)
    assert run.length_mm == 112.0
    assert len(run.states) == 6
    assert {state.status for state in run.states} == {CONVERGED}
    assert run.rods == ("five", "arm_law")
    assert sum(error.sample == "out" for error in run.errors_of("arm_law")) == 5
    curve = run.curve("II", 37.0)
    assert curve is not None
    assert run.bending_deg(37.0) == pytest.approx(140.2, abs=0.1)
    assert np.isnan(run.bending_deg(20.0))
    assert run.curve("II", 20.0) is None
    assert run.validation_curves[0].load == "end at +11.2 mm"
    assert run.law.pressures_kPa == (0.0, 17.0, 37.0)
    assert run.parameters.alpha2_N_mm2[1] == pytest.approx(448.2, abs=0.1)
    assert run.finished


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    """Infinity becomes null, which stands for a number that does not exist."""
    rows = (State("II", 10.0, end_x_mm=1.5, reaction_N=(0.0, 2.0), min_gap_mm=np.inf), State("III", 10.0))
    save_value(ResultFolder(tmp_path), "experiments.json", rows)
    again = read_results(tmp_path).states
    assert again[0].reaction_N == (0.0, 2.0)
    assert np.isnan(again[0].min_gap_mm)
    assert repr(again[1]) == repr(rows[1])


def test_folders_without_results_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder; give the folder of a run"):
        read_results(tmp_path / "missing")
    with pytest.raises(InputError, match="holds no results"):
        read_results(tmp_path)
    (tmp_path / "accuracy.json").write_text("{}")
    with pytest.raises(InputError, match=r"holds accuracy\.json, which is not the result of `pneurod run`"):
        read_results(tmp_path)
    (tmp_path / "states").mkdir()
    (tmp_path / "states" / "configuration.json").write_text("{}")
    with pytest.raises(InputError, match="its run has no results yet"):
        read_results(tmp_path)


@pytest.mark.parametrize("names", [("experiments.json",), ("run.json",), ("parameters.json", "curves.csv")])
def test_half_finished_folders_give_what_is_there(names: tuple[str, ...], tmp_path: Path) -> None:
    for name in names:
        shutil.copy(COARSE / name, tmp_path)
    run = read_results(tmp_path)
    assert bool(run.states) == ("experiments.json" in names)
    assert run.finished == ("run.json" in names)
    assert bool(run.identified_kPa) == bool(run.curves) == ("curves.csv" in names)


def test_the_schema_has_every_column() -> None:
    schema = json.loads(json.dumps(json_schema()))
    assert set(schema) == set(TYPES)
    for name, kind in (("experiments.json", State), ("validation.json", RodError)):
        columns = schema[name]["$defs"][kind.__name__]["properties"]
        assert set(columns) == set(kind.__dataclass_fields__)
