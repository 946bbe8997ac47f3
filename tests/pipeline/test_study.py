"""A study measures what its record lacks, keeps every result at once, and returns all of them in the order of cases."""

from pathlib import Path

import pytest

from pipeline.study import JsonFiles, Study


def square(case: int) -> int:
    """A measurement that a worker process can import."""
    if case < 0:
        raise ArithmeticError("negative")
    return case**2


def record(folder: Path, sources: str = "first") -> JsonFiles[int, int]:
    return JsonFiles(
        lambda case: folder / "results" / f"{case}.json",
        lambda case: f"{case} with the {sources} sources",
        lambda result: {"square": result},
        _read,
    )


def _read(content: dict[str, int]) -> int:
    return content["square"]


def test_results_come_in_order_and_are_kept(tmp_path: Path) -> None:
    study = Study([3, 1, 2], square, record(tmp_path))
    assert study.missing() == [3, 1, 2]
    assert list(study.run()) == [(3, 9), (1, 1), (2, 4)]
    assert study.missing() == []
    record(tmp_path).save(1, 100)
    assert list(study.run()) == [(3, 9), (1, 100), (2, 4)]  # read, not measured


def test_results_of_other_sources_are_measured_again(tmp_path: Path) -> None:
    record(tmp_path).save(3, 100)
    (tmp_path / "results" / "2.json").write_text('{"square": 100}')  # without a key, as before
    later = Study([3, 2], square, record(tmp_path, "later"))
    assert later.missing() == [3, 2]
    assert list(later.run()) == [(3, 9), (2, 4)]
    assert later.missing() == []
    assert Study([3, 2], square, record(tmp_path)).missing() == [3, 2]


def test_a_failed_measurement_loses_no_earlier_result(tmp_path: Path) -> None:
    study = Study([3, -1, 2], square, record(tmp_path))
    with pytest.raises(ArithmeticError):
        list(study.run())
    assert study.missing() == [-1, 2]


def test_missing_cases_are_measured_in_processes(tmp_path: Path) -> None:
    stored = record(tmp_path)
    stored.save(2, 5)
    assert Study([3, 2], square, stored).run_in_processes(1) == [(3, 9), (2, 5)]
