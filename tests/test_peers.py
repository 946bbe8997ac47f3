"""The comparison with other solvers: problem, step control, CalculiX's files, medians and tables. No timings."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.peers import by_calculix, page
from benchmarks.peers.__main__ import PEERS
from benchmarks.peers.problem import Body, Outcome, PathResult
from benchmarks.peers.runs import Peer, Run, RunFailed, Session, measured, middle, plan
from benchmarks.peers.stepping import NoEquilibrium, Stepping, newton

DOCS = Path(__file__).resolve().parent.parent / "docs"


@pytest.fixture(scope="module")
def body() -> Body:
    return Body.read()


def run(peer: str, path: str = "four", solve: float = 1.0, factorizations: int = 10, note: str = "") -> Run:
    answers = {"5": (-0.33955159, -11.09217995, 3705.51217)}
    outcome = Outcome(f"{peer} 1.0", "LU", answers, 4, 1, factorizations, 0.5, solve, solve, note)
    return Run(peer, path, outcome, cpu=solve + 0.5, wall=solve + 0.6, peak=100.0)


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


def test_a_path_that_cannot_go_on_ends_with_its_reason() -> None:
    def equilibrium(pressure: float, guess: np.ndarray) -> tuple[np.ndarray, int]:
        raise NoEquilibrium("no way")

    stepping = Stepping(first=1.0, growth=2.0, quick=4, iterations=8, predict=False)
    result = stepping.walk([5.0], np.zeros(1), equilibrium, lambda u: (0.0, 0.0, 0.0), lambda: 7)
    assert result == PathResult({}, increments=0, failed=7, factorizations=7, note="no way")


def test_the_deck_loads_every_face_of_the_cavity_once(body: Body) -> None:
    lines = list(by_calculix.deck(body, [5.0, 45.0]))
    assert lines.count("*END STEP") == 2
    loads = [line.split(",") for line in lines if ",P" in line and not line.startswith("*")]
    assert len(loads) == 2 * len(body.mesh.faces["cavity"])
    faces = set()
    for element, face, pressure in loads:
        assert float(pressure) in (0.005, 0.045)
        corners = body.mesh.tets[int(element) - 1][by_calculix.FACES[int(face[1]) - 1]]
        faces.add(tuple(sorted(corners.tolist())))
    assert faces == {tuple(sorted(face)) for face in body.mesh.faces["cavity"].tolist()}


def test_what_calculix_prints_is_read(body: Body, tmp_path: Path) -> None:
    rows = "\n".join(f"{k + 1:10d}  1.000000E+00 -2.000000E+00  0.000000E+00" for k in range(len(body.points)))
    title = " displacements (vx,vy,vz) for set ALL and time  0.1000000E+01"
    (tmp_path / "arm.dat").write_text(f"\n{title}\n\n{rows}\n")
    (tmp_path / "arm.sta").write_text(
        "SUMMARY OF JOB INFORMATION\n  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME\n"
        "     1          1     1U    8  0.000000E+00  0.000000E+00  0.200000E+00\n"
        "     1          1     2     2  0.100000E+01  0.100000E+01  0.100000E+01\n"
    )
    line = "     1     1     1 {:5d}        0  0.3730E+04  0.1000E+03  0.0000E+00  0.0000E+00\n"
    head = "  STEP   INC  ATT   ITER     CONT.   RESID.        CORR.      RESID.      CORR.\n"
    (tmp_path / "arm.cvg").write_text(head + "".join(line.format(k) for k in range(1, 11)))
    result = by_calculix.results_in(tmp_path, "arm", body, [5.0, 17.0])
    assert result.answers[5.0] == pytest.approx((1.0, -2.0, body.volume(np.zeros_like(body.points))))
    assert (result.increments, result.failed, result.factorizations) == (1, 1, 10)
    assert result.note == "CalculiX gave up"


def test_runs_are_interleaved_and_go_on_where_they_stopped() -> None:
    peers = [Peer("a", "by_a"), Peer("b", "by_b", repetitions=1, paths=("four",))]
    names = [(peer.name, path) for peer, path in plan(peers, 2, [])]
    assert names == [("a", "four"), ("a", "straight"), ("b", "four"), ("a", "four"), ("a", "straight")]
    left = [(peer.name, path) for peer, path in plan(peers, 2, [run("a"), run("b"), run("a")])]
    assert left == [("a", "straight"), ("a", "straight")]


def test_the_middle_of_runs_is_their_median() -> None:
    runs = [run("a", solve=seconds) for seconds in (1.0, 5.0, 2.0)]
    assert middle(runs).outcome.solve_cpu == 2.0
    assert middle(runs).cpu == 2.5
    with pytest.raises(ValueError, match="different numbers of factorizations"):
        middle([run("a"), run("a", factorizations=11)])


def test_a_peer_that_fails_says_so() -> None:
    with pytest.raises(RunFailed, match=r"x, four: exit status 1: .*by_nobody"):
        measured(Peer("x", "by_nobody"), "four", sys.executable)


def test_the_table_of_costs_names_ratios_and_what_is_missing() -> None:
    peers = [Peer("ours", "by_a"), Peer("slow", "by_b"), Peer("stuck", "by_c"), Peer("absent", "by_d")]
    runs = [run("ours", solve=2.0), run("slow", solve=30.0), run("stuck", note="no equilibrium")]
    result = page.medians(runs)
    lines = page.costs(peers, "four", result, {"absent": "not installed: `apt-get install it`"}).splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    assert {len(row) for row in cells} == {10}
    assert cells[3] == ["slow", "4 (1)", "10", "30.0", "30.0", "15.0", "0.5", "30.5", "12.2", "100"]
    assert cells[4][1].startswith("stopped above 5 kPa after 10 factorizations")
    assert cells[5][:2] == ["absent", "not installed: `apt-get install it`"]


def test_the_page_warns_of_a_processor_that_was_not_free() -> None:
    assert page.shared([run("a"), run("b")]) == ""
    assert "wall seconds are 4.0 times" in page.shared([replace(run("a"), wall=6.0)])


def test_a_session_is_kept_whole(tmp_path: Path) -> None:
    session = Session("a machine", [run("a"), run("a", path="straight")], {"b": "not installed"})
    session.save(tmp_path / "peers.json")
    assert Session.load(tmp_path / "peers.json") == session
    assert [path.name for path in tmp_path.iterdir()] == ["peers.json"]


def test_the_page_is_that_of_the_kept_runs() -> None:
    session = Session.load(DOCS / "peers.json")
    assert PEERS[0].name in {run.peer for run in session.runs} <= {peer.name for peer in PEERS}
    assert (DOCS / "peers.md").read_text(encoding="utf-8") == page.page(PEERS, session)
