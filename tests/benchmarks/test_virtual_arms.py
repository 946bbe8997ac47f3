"""Virtual arms: how they are drawn, the files of their bench, and the table."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.virtual_arms.bench import WHAT, write_measured, write_true
from benchmarks.virtual_arms.designs import MEASURED, PREDICTED, STIFFNESS, THIN_MM, arms
from benchmarks.virtual_arms.measured import Measurement, Row
from benchmarks.virtual_arms.predicted import Judged, Prediction
from benchmarks.virtual_arms.table import share, summary
from pipeline.answers.measured.table import read_measurements
from pipeline.config.load import load_config


def test_arms_of_a_seed_differ_from_their_drawings() -> None:
    drawn = arms(1, 8)
    assert drawn[:3] == arms(1, 3)
    assert len({arm.family for arm in drawn}) == 4
    assert len({arm.law_name for arm in drawn}) == 8
    for arm in drawn:
        laws = [str(one["material"]["law"]) for one in (arm.drawing, arm.built)]
        assert laws.count("yeoh") == 1
        assert STIFFNESS[0] <= arm.stiffness <= STIFFNESS[1]
        assert len(arm.changes_mm) == 3
        for key, change in arm.changes_mm.items():
            value = float(str(arm.drawing["geometry"][key]).split()[0])
            assert abs(change) <= max(0.1, 0.08 * min(value, THIN_MM)) + 1e-3


def test_a_built_arm_is_a_configuration(tmp_path: Path) -> None:
    arm = arms(1, 1)[0]
    path = tmp_path / "built.yaml"
    path.write_text(str(arm.built).replace("'", '"').replace("False", "false"), encoding="utf-8")
    config = load_config(path)
    assert config.pressures_kPa == tuple(sorted({*arm.measured_kPa, *arm.predicted_kPa}))
    assert arm.loaded_kPa in config.pressures_kPa


def test_the_files_of_the_bench(tmp_path: Path) -> None:
    arm = arms(1, 1)[0]
    free = [
        Row("II", pressure, (60.0 - k, -float(k)), -2.0 * k, (0.0, 0.0))
        for k, pressure in enumerate((*arm.measured_kPa, *arm.predicted_kPa))
    ]
    loaded = (
        Row("dead", arm.loaded_kPa, (50.0, -9.0), -20.0, (0.01, -0.02)),
        Row("III", arm.loaded_kPa, (58.0, 0.0), 3.0, (0.0, 0.05)),
    )
    measurement = Measurement((*free, *loaded), (), 0.0)
    write_measured(arm, measurement, tmp_path / "measured.csv")
    write_true(arm, measurement, tmp_path / "true.csv")
    known, true = (read_measurements(tmp_path / name) for name in ("measured.csv", "true.csv"))
    assert len(known.rows) == len(MEASURED)
    assert len(true.rows) == len(PREDICTED) + 2 == len(WHAT)
    offs = [row.values["tip_x"] - one.tip_mm[0] for row, one in zip(known.rows, free, strict=False)]
    assert 0.0 < float(np.abs(offs).max()) < 1.5
    assert true.rows[2].state.force_N == (0.01, -0.02)
    write_measured(arm, measurement, tmp_path / "loaded.csv", loaded=True)
    more = read_measurements(tmp_path / "loaded.csv")
    assert [row.values for row in more.rows[:-1]] == [row.values for row in known.rows]
    assert more.rows[-1].state == true.rows[2].state
    assert more.rows[-1].values["tip_x"] != true.rows[2].values["tip_x"]
    assert true.rows[3].values == {"reaction": 0.05}


def test_shares_of_uniform_levels_are_as_stated() -> None:
    rng = np.random.default_rng(0)
    predictions = [Prediction(WHAT[k % 4], 0.2, 0.01, tuple(rng.uniform(size=2))) for k in range(4000)]
    for probability in (0.5, 0.9):
        assert share(predictions, probability) == pytest.approx(probability, abs=0.02)
    text = summary([Judged("arm", "pneunet", ("svk", "yeoh"), (1.0, 1.1), tuple(predictions))])
    assert "20 %, 20 %" in text
    assert "1 %, 1 %" in text
