"""The time that is left, from expected efforts and from those of the steps that have ended."""

import pytest

import pipeline.store.time_left as module
from pipeline.config.load import load_config
from pipeline.law.effort import expected_of
from pipeline.store.time_left import TimeLeft


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [0.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_equal_steps_take_as_long_as_those_that_ended(clock: list[float]) -> None:
    left = TimeLeft({"": [1.0] * 4})
    clock[0] = 10.0
    assert left.end("", 1.0) == "; about 30 s left"
    clock[0] = 40.0
    assert [left.end("", 1.0) for _ in range(3)][-1] == ""


def test_a_kind_is_corrected_by_its_own_steps(clock: list[float]) -> None:
    left = TimeLeft({"cell": [1.0, 1.0], "cell, mesh": [2.0], "tip": [1.0]})
    clock[0] = 3.0
    left.end("cell", 3.0)
    assert left.seconds == pytest.approx(3.0 + 3.0 * (2.0 + 1.0))  # all three times as long as expected
    clock[0] = 5.0
    left.end("tip", 2.0)
    assert left.seconds == pytest.approx(3.0 + 2.5 * 2.0)
    clock[0] = 15.0
    left.end("cell, mesh 2.7 mm", 10.0)
    assert left.seconds == pytest.approx(3.0)


def test_two_workers_halve_the_time(clock: list[float]) -> None:
    left = TimeLeft({"cell": [1.0] * 4})
    clock[0] = 4.0
    left.end("cell", 4.0)
    left.end("cell", 4.0)
    assert left.seconds == pytest.approx(4.0)


def test_kept_steps_say_nothing_about_the_others(clock: list[float]) -> None:
    left = TimeLeft({"cell": [1.0] * 3})
    clock[0] = 1.0
    assert left.end("cell") == ""
    clock[0] = 2.0
    left.end("cell", 2.0)
    assert left.seconds == pytest.approx(2.0)


def test_one_who_waits_is_told_every_five_seconds(clock: list[float]) -> None:
    left, told = TimeLeft({}), list[str]()
    for clock[0], part in ((4.0, 0.1), (6.0, 0.25), (8.0, 0.5), (12.0, 0.75)):
        left.tell(told.append, f"{part:g} s are done", part)
    assert told == ["0.25 s are done; about 18 s left", "0.75 s are done; about 4.0 s left"]


def test_nothing_is_told_before_enough_has_ended(clock: list[float]) -> None:
    left = TimeLeft({"cell": [1.0] * 10}, part=0.2)
    left.announce("cell", 10)
    clock[0] = 5.0
    assert left.end("cell", 1.0) == ""
    assert left.end("cell", 1.0) == "; about 20 s left"


def test_steps_that_are_announced_later_count(clock: list[float]) -> None:
    left = TimeLeft({"cell": [2.0]})
    clock[0] = 1.0
    left.end("cell", 1.0)
    left.announce("cell", 2)
    left.announce("unknown", 5)
    assert left.seconds == pytest.approx(1.0)


def test_a_draft_expects_less_than_a_run() -> None:
    draft, full = (
        expected_of(load_config("configs/pneunet_coarse.yaml", given)) for given in (["draft=true"], ["draft=false"])
    )
    assert set(draft) == {"cell", "clamped end", "tip"}
    assert {"I", "II", "III", "cell, mesh"} < set(full)
    assert sum(map(sum, draft.values())) < 0.2 * sum(map(sum, full.values()))


def test_finer_meshes_of_lower_pressures_are_one_less() -> None:
    """The arm has two pressures, and rest."""
    steps = expected_of(load_config("configs/pneunet_coarse.yaml", []))["cell, mesh"]
    assert [steps.count(effort) for effort in dict.fromkeys(steps)] == [3, 3, 3, 1]
