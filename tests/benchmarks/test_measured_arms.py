"""Measured arms: their rows, and another arm of the same silicone foretold from a calibration."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.measured_arms.arms import GIVEN, HERE, LONGER, asked, directions
from benchmarks.measured_arms.foretold import OF_RUBBER, Calibrated
from pipeline.answers.measured.predicted import LawRods, Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.config.load import load_config
from tests.measured_arm import LENGTH, arm_law

#: the moduli of the arms over those of their law
SOFTER = 0.8


def test_configurations_are_as_long_as_the_arms() -> None:
    assert load_config(HERE / "c5w7.yaml").design.length == pytest.approx(GIVEN.length)


def test_rows_are_counted_from_their_zero(tmp_path: Path) -> None:
    rows = directions(GIVEN, tmp_path, [12, 36])
    assert [row.state.pressure_kPa for row in rows.rows] == [12.0, 36.0]
    assert Numbers.of(rows).values == pytest.approx([-1.10, -31.30])
    assert {(row.zero_kPa, row.at_y_mm) for row in rows.rows} == {(10.0, -0.25)}
    assert len(directions(LONGER, tmp_path).rows) == 27


def read_of(factor: float, length: float, pressures: list[float], folder: Path) -> Measurements:
    """Rows of an arm with other moduli and another length, by its law."""
    rows = asked(GIVEN, folder, pressures, [0.0] * len(pressures))
    true = Numbers.of(rows).predicted(LawRods(replace(arm_law().scaled(factor), length=length)))
    return asked(GIVEN, folder, pressures, (-true).tolist())


def test_another_arm_of_the_same_silicone_is_foretold(tmp_path: Path) -> None:
    known = read_of(SOFTER, LENGTH, [12.0, 16.0, 20.0, 24.0, 28.0], tmp_path)
    others = read_of(SOFTER, LENGTH + 20.0, [15.0, 25.0, 30.0], tmp_path)
    found = Calibrated.to(arm_law(), {}, known)
    assert np.exp(found.fitted.changes[0]) == pytest.approx(SOFTER, rel=0.02)
    of_same, of_other = found.same.intervals(known), found.for_arm(
        replace(arm_law(), length=LENGTH + 20.0)
    ).intervals(others)  # fmt: skip
    for intervals, rows in ((of_same, known), (of_other, others)):
        values, middle, low, high = Numbers.of(rows).values, *intervals
        assert np.all((low < values) & (values < high))
        np.testing.assert_allclose(middle, values, rtol=0.03)
        assert np.all(high - low < 0.5 * np.abs(values))


def test_dimensions_of_another_arm_are_not_known_better(tmp_path: Path) -> None:
    found = Calibrated.to(arm_law(), {}, read_of(SOFTER, LENGTH, [12.0, 16.0, 20.0, 24.0], tmp_path))
    other = found.for_arm(arm_law())
    for k, unknown in enumerate(found.arm.unknowns):
        if unknown.name not in OF_RUBBER:
            assert other.changes[k] == 0.0
            assert other.posterior.stds[k] == pytest.approx(unknown.std)
    assert other.posterior.stds[0] < found.arm.unknowns[0].std
