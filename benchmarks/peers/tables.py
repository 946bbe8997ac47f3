"""What the runs of the peers cost and computed, as tables."""

from collections.abc import Callable, Mapping, Sequence
from statistics import median

from benchmarks.markdown import table
from benchmarks.peers.problem import REFERENCE
from benchmarks.peers.runs import Peer, Run, Spread, checked, fresh, ratios, warm

Seconds = Callable[[Run], float]


def runs_of(runs: Sequence[Run], peer: str, path: str) -> list[Run]:
    """The runs of one peer on one path."""
    return [run for run in runs if (run.peer, run.path) == (peer, path)]


def costs(peers: Sequence[Peer], path: str, runs: Sequence[Run], missing: Mapping[str, str]) -> str:
    """Cost of the path for each of the peers, and its ratio to the first of them in the same rounds."""
    head = ["", "increments (failed)", "factorizations", "fresh: CPU s", "fresh / pneurod"]
    head += ["warm: CPU s", "warm / pneurod", "peak MB", "rounds"]
    own, rows = runs_of(runs, peers[0].name, path), []
    for peer in peers:
        made = runs_of(runs, peer.name, path)
        if not made or made[0].outcome.note:
            why = stopped(made[0]) if made else missing.get(peer.name, "not run")
            rows.append([peer.name, why, *[""] * (len(head) - 2)])
            continue
        spent = checked(made).outcome
        counts = [f"{spent.increments} ({spent.failed})", f"{spent.factorizations}"]
        ways: tuple[Seconds, ...] = (fresh, warm)
        seconds = [s.text() for way in ways for s in (Spread.of([way(run) for run in made]), ratios(made, own, way))]
        rows.append([peer.name, *counts, *seconds, f"{median(run.peak for run in made):.0f}", f"{len(made)}"])
    return table(head, rows)


def stopped(run: Run) -> str:
    """Where an incomplete path stopped, and what that cost."""
    reached = max(map(float, run.outcome.answers), default=0.0)
    spent = run.outcome
    return f"stopped above {reached:g} kPa after {spent.factorizations} factorizations, {spent.solve_cpu:.0f} s CPU"


def answers(peers: Sequence[Peer], runs: Sequence[Run]) -> str:
    """Tip and volume at the four pressures, and their distance from the reference."""
    head = ["", "p kPa", "u_x mm", "u_y mm", "V mm³", "error of u mm", "error of u %", "error of V %"]
    rows = []
    for pressure, (x, y, volume) in REFERENCE.items():
        rows.append(["reference", f"{pressure:g}", f"{x:.6f}", f"{y:.6f}", f"{volume:.4f}", "", "", ""])
        for peer in peers:
            made = runs_of(runs, peer.name, "four")
            if not made or f"{pressure:g}" not in made[0].outcome.answers:
                continue
            answer = made[0].outcome.answers[f"{pressure:g}"]
            off, long = distance(answer, (x, y, volume)), (x * x + y * y) ** 0.5
            rows.append([peer.name, f"{pressure:g}", f"{answer[0]:.6f}", f"{answer[1]:.6f}", f"{answer[2]:.4f}"])
            rows[-1] += [f"{off:.1e}", f"{100 * off / long:.1e}", f"{100 * abs(answer[2] / volume - 1):.1e}"]
    return table(head, rows)


def distance(computed: Sequence[float], true: Sequence[float]) -> float:
    """Between two positions of the tip, mm."""
    return float(((computed[0] - true[0]) ** 2 + (computed[1] - true[1]) ** 2) ** 0.5)
