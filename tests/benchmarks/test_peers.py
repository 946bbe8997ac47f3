"""The comparison with other solvers: problem, step control, medians and tables. No timings."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers.problem import Body, Outcome, PathResult
from benchmarks.peers.runs import Run, RunFailed, Spread, check_threads, fresh, ratios, warm
from benchmarks.peers.stepping import NoEquilibrium, Stepping


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
