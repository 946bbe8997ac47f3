"""What the benchmark of whole runs says about two runs: differences of their numbers, medians with ranges."""

import json
from pathlib import Path

import pytest

from benchmarks.run import Spent, largest_difference, table


def written(folder: Path, rows: object) -> Path:
    folder.mkdir()
    (folder / "experiments.json").write_text(json.dumps(rows), encoding="utf-8")
    return folder


def test_a_difference_is_over_the_largest_number_of_its_column(tmp_path: Path) -> None:
    """Forces that are zero but for rounding count as zero, and seconds do not count."""
    rows = [{"force": [2.0, 1e-16], "seconds": 1.0}, {"force": [4.0, 3e-16], "seconds": 2.0}]
    other = [{"force": [2.002, 2e-16], "seconds": 5.0}, {"force": [4.0, 0.0], "seconds": 9.0}]
    same, changed = (written(tmp_path / name, content) for name, content in (("a", rows), ("b", other)))
    assert largest_difference(same, same) == (0.0, "")
    difference, where = largest_difference(same, changed)
    assert difference == pytest.approx(0.002 / 4.0)
    assert where == "experiments.json/0/force/0"


def test_results_that_one_run_lacks_are_named(tmp_path: Path) -> None:
    first = written(tmp_path / "a", [{"force": 1.0}])
    assert largest_difference(first, written(tmp_path / "b", [{"force": 1.0, "moment": 2.0}]))[0] == 1.0
    (tmp_path / "c").mkdir()
    assert largest_difference(first, tmp_path / "c") == (1.0, "experiments.json is missing")


def test_medians_and_their_ratio_are_in_the_table() -> None:
    other = [Spent(wall, 2.0 * wall, 100.0, 5000, {"experiments": wall}) for wall in (10.0, 12.0, 20.0)]
    this = [Spent(6.0, 18.0, 90.0, 500, {"experiments": 3.0, "pictures": 1.0})]
    lines = list(table(other, this))
    assert "| wall s | 12.0 (10.0 to 20.0) | 6.0 (6.0 to 6.0) | 0.50 |" in lines
    assert "| experiments s | 12.0 (10.0 to 20.0) | 3.0 (3.0 to 3.0) | 0.25 |" in lines
    assert lines[-1] == "| pictures s | 0.0 (0.0 to 0.0) | 1.0 (1.0 to 1.0) |  |"
