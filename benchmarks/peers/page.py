"""The tables of docs/peers.md."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from string import Template

from benchmarks.markdown import table
from benchmarks.peers.problem import REFERENCE
from benchmarks.peers.runs import OWN, Peer, Run, Session, Spread, checked, fresh, ratios, warm

TEMPLATE = Path(__file__).with_name("page.md")
#: the peers of the table of ratios
WITH_RATIOS = ("NGSolve", "FElupe", "scikit-fem and SciPy", "CalculiX")

Seconds = Callable[[Run], float]
Latest = Mapping[tuple[str, str], Sequence[Run]]


def latest(runs: Sequence[Run]) -> dict[tuple[str, str], list[Run]]:
    """(peer, path): its runs in the last session that had any."""
    keys = dict.fromkeys((run.peer, run.path) for run in runs)
    last = {key: max(run.session for run in runs if (run.peer, run.path) == key) for key in keys}
    return {key: [run for run in runs if (run.peer, run.path, run.session) == (*key, last[key])] for key in keys}


def machines(runs: Sequence[Run]) -> list[str]:
    """On which machines something was run, the last one first."""
    return list(dict.fromkeys(run.machine for run in sorted(runs, key=lambda run: run.session, reverse=True)))


def processor(machine: str) -> str:
    """The name of its processor alone."""
    return machine.partition(",")[0].replace("(R)", "").replace(" Processor", "")


def costs(peers: Sequence[Peer], path: str, session: Session) -> str:
    """Cost of the path for each of the peers, and its ratio to the first of them in the same rounds."""
    head = ["", "increments (failed)", "factorizations", "fresh: CPU s", "fresh / pneurod"]
    head += ["warm: CPU s", "warm / pneurod", "peak MB", "rounds", "measured"]
    measured = latest(session.runs)
    rows = []
    for peer in peers:
        runs = measured.get((peer.name, path))
        if runs is None or runs[0].outcome.note:
            missing = session.missing.get(peer.name, "not run") if path in peer.paths else "not run"
            why = missing if runs is None else stopped(runs[0])
            rows.append([peer.name, why, *[""] * (len(head) - 2)])
            continue
        spent = checked(runs).outcome
        counts = [f"{spent.increments} ({spent.failed})", f"{spent.factorizations}"]
        peak = f"{median(run.peak for run in runs):.0f}"
        seconds = [text for way in (fresh, warm) for text in _seconds(peers[0], runs, session, way)]
        rows.append([peer.name, *counts, *seconds, peak, f"{len(runs)}", _when(runs[0])])
    return table(head, rows)


def _when(run: Run) -> str:
    return f"{run.date}, {processor(run.machine)}"


def _seconds(first: Peer, runs: Sequence[Run], session: Session, way: Seconds) -> tuple[str, str]:
    """CPU seconds of a peer, and their ratio to those of the first."""
    return Spread.of([way(run) for run in runs]).text(), ratio(first, runs, session, way).text()


def ratio(first: Peer, runs: Sequence[Run], session: Session, way: Seconds) -> Spread:
    """Seconds of runs of one peer on one path over those of the first peer in the same rounds."""
    return ratios(runs, [run for run in session.runs if (run.peer, run.path) == (first.name, runs[0].path)], way)


def stopped(run: Run) -> str:
    """Where an incomplete path stopped, and what that cost."""
    reached = max(map(float, run.outcome.answers), default=0.0)
    spent = run.outcome
    return f"stopped above {reached:g} kPa after {spent.factorizations} factorizations, {spent.solve_cpu:.0f} s CPU"


def answers(peers: Sequence[Peer], measured: Latest) -> str:
    """Tip and volume at the four pressures, and their distance from the reference."""
    head = ["", "p kPa", "u_x mm", "u_y mm", "V mm³", "error of u mm", "error of u %", "error of V %"]
    rows = []
    for pressure, (x, y, volume) in REFERENCE.items():
        rows.append(["reference", f"{pressure:g}", f"{x:.6f}", f"{y:.6f}", f"{volume:.4f}", "", "", ""])
        for peer in peers:
            runs = measured.get((peer.name, "four"))
            if not runs or f"{pressure:g}" not in runs[0].outcome.answers:
                continue
            answer = runs[0].outcome.answers[f"{pressure:g}"]
            off, long = distance(answer, (x, y, volume)), (x * x + y * y) ** 0.5
            rows.append([peer.name, f"{pressure:g}", f"{answer[0]:.6f}", f"{answer[1]:.6f}", f"{answer[2]:.4f}"])
            rows[-1] += [f"{off:.1e}", f"{100 * off / long:.1e}", f"{100 * abs(answer[2] / volume - 1):.1e}"]
    return table(head, rows)


def distance(computed: Sequence[float], true: Sequence[float]) -> float:
    """Between two positions of the tip, mm."""
    return float(((computed[0] - true[0]) ** 2 + (computed[1] - true[1]) ** 2) ** 0.5)


def loads(runs: Sequence[Run]) -> str:
    """How busy the machine was before the rounds of each session, and how far wall and CPU seconds were apart."""
    sentences = []
    for date, machine in sorted({run.session for run in runs}, reverse=True):
        session = [run for run in runs if run.session == (date, machine)]
        stretch = median(run.wall / run.cpu for run in session)
        rounds = {run.number: run.busy for run in session if run.busy is not None}
        known = ", ".join(f"{busy:.2f}" for _, busy in sorted(rounds.items()))
        before = f"before its rounds other programs used {known} cores" if known else "without a check of the load"
        sentences.append(f"{date}, {machine}: {before}; wall seconds were {stretch:.2f} times the CPU seconds.")
    return "\n".join(f"- {sentence}" for sentence in sentences)


def larger(session: Session) -> str:
    """What pneurod was measured on besides."""
    head = ["", "degrees of freedom", "factorizations", "CPU s", "s per factorization", "peak GB", "measured"]
    rows = [
        [
            case.name,
            f"{case.unknowns}",
            f"{case.factorizations}",
            f"{case.cpu:.1f}",
            f"{case.factorization:.2f}",
            f"{case.peak:.2f}",
            case.date,
        ]
        for case in session.own
    ]
    return table(head, rows)


def on_each_machine(peers: Sequence[Peer], session: Session) -> str:
    """Ratios of CPU seconds on each machine, medians with their range."""
    head = ["code", "processor", "factorizations to 5, 17, 31 and 45 kPa", "fresh", "warm"]
    head += ["factorizations to 45 kPa without intermediate pressures", "fresh", "warm"]
    rows = []
    for name in WITH_RATIOS:
        for machine in machines([run for run in session.runs if run.peer == name]):
            measured = latest([run for run in session.runs if run.machine == machine])
            row = [name, processor(machine)]
            for path in ("four", "straight"):
                runs = measured.get((name, path))
                if runs is None:
                    row += ["not run", "", ""]
                    continue
                shown = (ratio(peers[0], runs, session, way) for way in (fresh, warm))
                row += [f"{checked(runs).outcome.factorizations}", *(_short(spread) for spread in shown)]
            rows.append(row)
    first = [f"{checked(latest(session.runs)[OWN, path]).outcome.factorizations}" for path in ("four", "straight")]
    return table(head, [[OWN, "", first[0], "1", "1", first[1], "1", "1"], *rows])


def _short(spread: Spread) -> str:
    """To two or three digits."""
    return spread.text(0 if spread.median >= 20.0 or spread.median == 1.0 else 1)


def page(peers: Sequence[Peer], session: Session) -> str:
    """docs/peers.md."""
    measured, listed = latest(session.runs), []
    for peer in peers:
        if runs := measured.get((peer.name, peer.paths[0])):
            listed.append([peer.name, runs[0].outcome.package, runs[0].outcome.solver])
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        ratios=on_each_machine(peers, session),
        loads=loads(session.runs),
        packages=table(["", "package", "factorizes with"], listed),
        four=costs(peers, "four", session),
        straight=costs(peers, "straight", session),
        larger=larger(session),
        answers=answers(peers, measured),
    )
