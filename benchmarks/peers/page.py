"""The tables of docs/peers.md."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from string import Template

from benchmarks.peers.problem import REFERENCE
from benchmarks.peers.runs import Peer, Run, Session, middle

TEMPLATE = Path(__file__).with_name("page.md")


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table; the first column to the left, the others to the right."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def medians(runs: Sequence[Run]) -> dict[tuple[str, str], Run]:
    """(peer, path): the middle of its runs."""
    keys = dict.fromkeys((run.peer, run.path) for run in runs)
    return {key: middle([run for run in runs if (run.peer, run.path) == key]) for key in keys}


def costs(peers: Sequence[Peer], path: str, measured: Mapping[tuple[str, str], Run], missing: Mapping[str, str]) -> str:
    """Cost of the path for each of the peers, and its ratio to the first of them."""
    head = ["", "increments (failed)", "factorizations", "CPU s", "wall s", "CPU / pneurod"]
    head += ["set-up CPU s", "whole process CPU s", "whole / pneurod", "peak MB"]
    first = measured[peers[0].name, path]
    rows = []
    for peer in peers:
        run = measured.get((peer.name, path))
        if run is None or run.outcome.note:
            why = missing.get(peer.name, "not run") if run is None else stopped(run)
            rows.append([peer.name, why, *[""] * (len(head) - 2)])
            continue
        spent = run.outcome
        rows.append(
            [
                peer.name,
                f"{spent.increments} ({spent.failed})",
                f"{spent.factorizations}",
                f"{spent.solve_cpu:.1f}",
                f"{spent.solve_wall:.1f}",
                f"{spent.solve_cpu / first.outcome.solve_cpu:.1f}",
                f"{spent.set_up_cpu:.1f}",
                f"{run.cpu:.1f}",
                f"{run.cpu / first.cpu:.1f}",
                f"{run.peak:.0f}",
            ]
        )
    return table(head, rows)


def stopped(run: Run) -> str:
    """Where an incomplete path stopped, and what that cost."""
    reached = max(map(float, run.outcome.answers), default=0.0)
    spent = run.outcome
    return f"stopped above {reached:g} kPa after {spent.factorizations} factorizations, {spent.solve_cpu:.0f} s CPU"


def answers(peers: Sequence[Peer], measured: Mapping[tuple[str, str], Run]) -> str:
    """Tip and volume at the four pressures, and their distance from the reference."""
    head = ["", "p kPa", "u_x mm", "u_y mm", "V mm³", "error of u mm", "error of u %", "error of V %"]
    rows = []
    for pressure, (x, y, volume) in REFERENCE.items():
        rows.append(["reference", f"{pressure:g}", f"{x:.6f}", f"{y:.6f}", f"{volume:.4f}", "", "", ""])
        for peer in peers:
            run = measured.get((peer.name, "four"))
            if run is None or f"{pressure:g}" not in run.outcome.answers:
                continue
            got = run.outcome.answers[f"{pressure:g}"]
            off, long = distance(got, (x, y, volume)), (x * x + y * y) ** 0.5
            rows.append([peer.name, f"{pressure:g}", f"{got[0]:.6f}", f"{got[1]:.6f}", f"{got[2]:.4f}"])
            rows[-1] += [f"{off:.1e}", f"{100 * off / long:.1e}", f"{100 * abs(got[2] / volume - 1):.1e}"]
    return table(head, rows)


def distance(got: Sequence[float], true: Sequence[float]) -> float:
    """Between two positions of the tip, mm."""
    return float(((got[0] - true[0]) ** 2 + (got[1] - true[1]) ** 2) ** 0.5)


def shared(runs: Sequence[Run]) -> str:
    """A warning where the processor was not free: one thread's wall seconds are then more than its CPU seconds."""
    stretch = median(run.wall / run.cpu for run in runs)
    if stretch < 1.3:
        return ""
    return (
        f" **Other programs ran at the same time**: wall seconds are {stretch:.1f} times the CPU seconds, and these are"
        " higher than on a free machine. Ratios are less sure than the digits suggest."
    )


def page(peers: Sequence[Peer], session: Session) -> str:
    """docs/peers.md."""
    measured = medians(session.runs)
    listed = []
    for peer in peers:
        runs = [run for run in session.runs if run.peer == peer.name and run.path == peer.paths[0]]
        if runs:
            listed.append([peer.name, runs[0].outcome.package, runs[0].outcome.solver, str(len(runs))])
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        machine=session.machine,
        shared=shared(session.runs),
        packages=table(["", "package", "factorizes with", "runs"], listed),
        four=costs(peers, "four", measured, session.missing),
        straight=costs(peers, "straight", measured, session.missing),
        answers=answers(peers, measured),
    )
