"""The comparison with other solvers: problem, step control, medians and tables. No timings."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers import load
from benchmarks.peers.problem import Body, Outcome, PathResult, busy_threads, thread_seconds
from benchmarks.peers.runs import Peer, Run, RunFailed, Spread, check_threads, checked, fresh, measured, ratios, warm
from benchmarks.peers.stepping import NoEquilibrium, Stepping, newton
from benchmarks.peers.tables import costs
from benchmarks.run import Spent, table


@pytest.fixture(scope="module")
def body() -> Body:
    return Body.read()


def run(
    peer: str, path: str = "four", solve: float = 1.0, factorizations: int = 10, note: str = "", number: int = 1
) -> Run:
    answers = {"5": (-0.33955159, -11.09217995, 3705.51217)}
    outcome = Outcome(f"{peer} 1.0", "LU", answers, 4, 1, factorizations, 0.5, solve, solve, 1, note)
    return Run(peer, path, outcome, solve + 0.5, solve + 0.6, 100.0, number)


def test_middles_of_edges_lie_between_their_ends(body: Body) -> None:
    ends = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]]
    x = body.points[body.cells]
    assert x[:, 4:] == pytest.approx(x[:, ends].mean(axis=2))
    assert len(body.points) == 8732  # vertices and edges, each once
    assert np.unique(body.cells).size == len(body.points)


def test_the_volume_between_quadratic_faces_is_exact(body: Body) -> None:
    rest = np.zeros_like(body.points)
    assert body.volume(rest) == pytest.approx(body.mesh.enclosed_volume("cavity"))
    bent = 0.004 * body.points[:, :1] ** 2 * [0.0, 1.0, 0.0]  # shears the cross sections: no change of volume
    assert body.volume(bent) == pytest.approx(body.volume(rest))
    assert body.volume(body.points * [0.1, 0.2, 0.3]) == pytest.approx(1.1 * 1.2 * 1.3 * body.volume(rest))


def test_the_answer_is_that_of_the_tip(body: Body) -> None:
    moved = np.tile([1.0, -2.0, 0.0], (len(body.points), 1))
    assert body.answer(moved) == pytest.approx((1.0, -2.0, body.volume(moved)))


def test_the_stepping_grows_halves_and_stops_at_the_asked_pressures() -> None:
    tried = []

    def equilibrium(pressure: float, guess: np.ndarray) -> tuple[np.ndarray, int]:
        tried.append((pressure, float(guess[0])))
        if pressure - 2.0 * len(good) > 4.0:
            raise NoEquilibrium("too far")
        good.append(pressure)
        return np.array([10.0 * pressure]), 3

    good: list[float] = []
    stepping = Stepping(first=1.0, growth=2.0, quick=4, iterations=8, predict=True)
    result = stepping.walk([5.0, 12.0], np.zeros(1), equilibrium, lambda u: (float(u[0]), 0.0, 0.0), lambda: len(tried))
    assert [pressure for pressure, _ in tried] == [1.0, 3.0, 5.0, 12.0, 8.5, 12.0]
    assert [guess for _, guess in tried] == [0.0, 30.0, 50.0, 120.0, 85.0, 120.0]  # the response is a line
    answers = {5.0: (50.0, 0.0, 0.0), 12.0: (120.0, 0.0, 0.0)}
    assert result == PathResult(answers, increments=5, failed=1, factorizations=6)


def test_ratios_are_formed_within_a_round() -> None:
    """The second round ran on a slower machine: both took twice as long, and the ratio is the same."""
    ours = [run("a", solve=2.0), run("a", solve=4.0, number=2)]
    theirs = [run("b", solve=20.0), run("b", solve=40.0, number=2)]
    assert ratios(theirs, ours, warm) == Spread(10.0, 10.0, 10.0)
    assert ratios(theirs, ours, fresh) == Spread.of([20.5 / 2.5, 40.5 / 4.5])
    with pytest.raises(ValueError, match="b, four: no round in which pneurod ran too"):
        ratios([run("b", number=3)], ours, warm)


def test_a_path_computed_by_threads_at_the_same_time_is_refused() -> None:
    alone = run("a").outcome
    check_threads("a", "four", alone)
    check_threads("a", "four", replace(alone, threads=2))  # one after the other
    with pytest.raises(
        RunFailed, match=r"a, four: more than one thread computed \(1.90 s of CPU in 1.00 s by 2 threads"
    ):
        check_threads("a", "four", replace(alone, threads=2, solve_cpu=1.9))


def test_newton_finds_a_root_and_says_why_not() -> None:
    def residual(x):
        return x**2 - 2.0, float(abs(x[0] ** 2 - 2.0))

    root, taken = newton(np.array([1.0]), 8, residual, lambda x, r: -r / (2 * x), 1e-12)
    assert root == pytest.approx(2.0**0.5)
    assert taken == 5
    with pytest.raises(NoEquilibrium, match="after 2 iterations"):
        newton(np.array([1.0]), 2, residual, lambda x, r: -r / (2 * x), 1e-12)
    with pytest.raises(NoEquilibrium, match="without bound after 1"):
        newton(np.array([1.0]), 8, residual, lambda x, r: x * np.inf, 1e-12)


def test_a_path_that_cannot_go_on_ends_with_its_reason() -> None:
    def equilibrium(pressure: float, guess: np.ndarray) -> tuple[np.ndarray, int]:
        raise NoEquilibrium("no way")

    stepping = Stepping(first=1.0, growth=2.0, quick=4, iterations=8, predict=False)
    result = stepping.walk([5.0], np.zeros(1), equilibrium, lambda u: (0.0, 0.0, 0.0), lambda: 7)
    assert result == PathResult({}, increments=0, failed=7, factorizations=7, note="no way")


def test_runs_that_counted_differently_are_no_sample() -> None:
    assert checked([run("a"), run("a", solve=2.0)]) == run("a")
    with pytest.raises(ValueError, match="different numbers of factorizations"):
        checked([run("a"), run("a", factorizations=11)])


def test_threads_that_compute_are_counted() -> None:
    before = {"1": 2.0, "2": 0.5}
    assert busy_threads(before, {"1": 12.0, "2": 0.55, "3": 0.0}) == 1
    assert busy_threads(before, {"1": 7.0, "2": 0.5, "3": 4.0}) == 2
    assert busy_threads({}, {}) == 1
    assert thread_seconds() == {} or max(thread_seconds().values()) > 0.0


def test_a_round_on_a_busy_machine_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(load.psutil, "cpu_count", lambda: 2)
    monkeypatch.setattr(load.psutil, "cpu_percent", lambda interval: 5.0)
    assert load.check_load() == pytest.approx(0.1)
    monkeypatch.setattr(load.psutil, "cpu_percent", lambda interval: 10.0)
    with pytest.raises(load.Busy, match=r"use 0\.20 cores; a round begins with at most 0\.15"):
        load.check_load()


def test_a_peer_that_fails_says_so() -> None:
    with pytest.raises(RunFailed, match=r"x, four: exit status 1: .*by_nobody"):
        measured(Peer("x", "by_nobody"), "four", sys.executable, 1)


def test_the_table_of_costs_names_ratios_and_what_is_missing() -> None:
    peers = [Peer("pneurod", "by_a"), Peer("slow", "by_b"), Peer("stuck", "by_c"), Peer("absent", "by_d")]
    runs = [run("pneurod", solve=2.0), run("slow", solve=30.0), run("stuck", note="no equilibrium")]
    runs += [run("pneurod", solve=4.0, number=2), run("slow", solve=40.0, number=2)]
    lines = costs(peers, "four", runs, {"absent": "not installed: `apt-get install it`"}).splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    assert {len(row) for row in cells} == {9}
    assert cells[3][:5] == ["slow", "4 (1)", "10", "35.5 (30.5 to 40.5)", "10.6 (9.0 to 12.2)"]
    assert cells[3][5:] == ["35.0 (30.0 to 40.0)", "12.5 (10.0 to 15.0)", "100", "2"]
    assert cells[4][1].startswith("stopped above 5 kPa after 10 factorizations")
    assert cells[5][:2] == ["absent", "not installed: `apt-get install it`"]


def test_medians_and_their_ratio_are_in_the_table() -> None:
    other = [Spent(wall, 2.0 * wall, 100.0, 5000, {"experiments": wall}) for wall in (10.0, 12.0, 20.0)]
    this = [Spent(6.0, 18.0, 90.0, 500, {"experiments": 3.0, "pictures": 1.0})]
    lines = list(table(other, this))
    assert "| wall s | 12.0 (10.0 to 20.0) | 6.0 (6.0 to 6.0) | 0.50 |" in lines
    assert "| experiments s | 12.0 (10.0 to 20.0) | 3.0 (3.0 to 3.0) | 0.25 |" in lines
    assert lines[-1] == "| pictures s | 0.0 (0.0 to 0.0) | 1.0 (1.0 to 1.0) |  |"
