"""A whole run from two checkouts in turn: wall and processor time, memory, stages, and whether the results agree.

    python benchmarks/run.py OTHER [--config configs/pneunet.yaml] [--rounds 3] [--busy-ok]

Every run is `pneurod run` in a new process and a new result folder; the two checkouts take turns, and the one that
begins changes from round to round. Processor time, page faults and memory are those of the run with all its workers;
the memory is what its processes have together, shared pages counted once, read twice a second (which takes a fortieth
of a core). Before the first round each checkout solves a small arm, which compiles the kernels. Both are run by the
Python of this program.
A machine on which others work is refused, unless --busy-ok is given: wall times are worth nothing there, processor
times little.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.peers import load  # noqa: E402  (the rooms stand beside this folder)
from tests.golden import differences, numbers_of  # noqa: E402

#: between two looks at the memory, s
INTERVAL = 0.5
#: largest difference that rounding makes, over the largest number of a list
ROUNDING = 1e-8
SMALL = """
name: small
geometry: {family: pneunet, chambers: 8}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [20 kPa]
mesh: {size: 8 mm, formulation: p2p0, grading: off}
validation: {forces: [[0 N, 0.01 N]]}
"""


@dataclass(frozen=True)
class Spent:
    """What one run took."""

    wall: float  #: s
    processor: float  #: s, workers included
    memory: float  #: MB, largest of all its processes together
    faults: int  #: pages that the system had to hand out
    stages: dict[str, float]  #: s of wall time, by name


def main() -> int:
    """Run, compare and print; 1 where the results differ by more than rounding makes them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("other", type=Path, help="another checkout, with which this one is compared")
    parser.add_argument("--config", type=Path, default=HERE / "configs" / "pneunet.yaml")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--jobs", type=int, help="of every run; by default what `pneurod run` takes")
    parser.add_argument("--busy-ok", action="store_true", help="measure although others work on the machine")
    options = parser.parse_args()
    checkouts = {"other": options.other.resolve(), "this": HERE}
    arguments = [str(options.config.resolve()), *(["--jobs", str(options.jobs)] if options.jobs else [])]
    spent: dict[str, list[Spent]] = {name: [] for name in checkouts}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        small = folder / "small.yaml"
        small.write_text(SMALL, encoding="utf-8")
        for name, checkout in checkouts.items():
            measured(checkout, [str(small)], folder / f"small_{name}")
        for number in range(options.rounds):
            say(f"round {number + 1}: {state_of_machine(options.busy_ok)}")
            for name in sorted(checkouts, reverse=number % 2 == 1):
                run = measured(checkouts[name], arguments, folder / f"{name}_{number}")
                spent[name].append(run)
                say(f"  {name}: {run.wall:.1f} s, processor {run.processor:.1f} s, {run.memory:.0f} MB")
        before, now = (numbers_of(folder / f"{name}_0") for name in checkouts)
    say("")
    for line in table(spent["other"], spent["this"]):
        say(line)
    lines = [*differences(before, now, ROUNDING), *sorted(before.keys() ^ now.keys())]
    say("\n".join(["", *lines[:20], f"{len(lines)} of {len(now)} numbers differ or are in one of both"]))
    return 1 if lines else 0


def state_of_machine(busy_ok: bool) -> str:
    """What others do on it, in words; the program ends where that is too much."""
    busy = load.busy_cores()
    if busy > load.MAX_BUSY and not busy_ok:
        sys.exit(f"others use {busy:.2f} cores; wait until they have ended, or give --busy-ok")
    return f"others use {busy:.2f} of {os.cpu_count()} cores"


def measured(checkout: Path, arguments: Sequence[str], out: Path) -> Spent:
    """One run into a new folder."""
    command = [sys.executable, "-m", "pipeline", "run", *arguments, "--out", str(out), "--quiet"]
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    begin = time.perf_counter()
    with (out.with_suffix(".log")).open("wb") as log:
        process = subprocess.Popen(command, cwd=checkout, env=environment, stdout=log, stderr=log)
    largest: list[float] = [0.0]
    watcher = threading.Thread(target=watch, args=(psutil.Process(process.pid), largest), daemon=True)
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    watcher.join()
    if process.returncode:
        message = out.with_suffix(".log").read_text(encoding="utf-8").strip()
        sys.exit(f"{checkout}: the run ended with status {process.returncode}: {message}")
    stages = json.loads((out / "run.json").read_text(encoding="utf-8"))["seconds"]
    return Spent(wall, usage.ru_utime + usage.ru_stime, largest[0], usage.ru_minflt, stages)


def watch(process: psutil.Process, largest: list[float]) -> None:
    """Keep the largest memory of a process and its children, MB, shared pages counted once, until it ends."""
    with suppress(psutil.NoSuchProcess):
        while process.status() != psutil.STATUS_ZOMBIE:
            memory = 0.0
            for each in [process, *process.children(recursive=True)]:
                with suppress(psutil.NoSuchProcess, psutil.AccessDenied):  # it has ended
                    memory += each.memory_full_info().pss / 2**20
            largest[0] = max(largest[0], memory)
            time.sleep(INTERVAL)


def table(other: Sequence[Spent], this: Sequence[Spent]) -> Iterator[str]:
    """Medians with their ranges, and the ratio of the medians."""
    yield "| | other | this | this / other |"
    yield "|---|---:|---:|---:|"
    rows: list[tuple[str, Callable[[Spent], float]]] = [
        ("wall s", lambda run: run.wall),
        ("processor s", lambda run: run.processor),
        ("memory MB", lambda run: run.memory),
        ("page faults, thousands", lambda run: run.faults / 1000),
    ]
    names = dict.fromkeys(name for run in (*other, *this) for name in run.stages)
    rows += [(f"{name} s", lambda run, name=name: run.stages.get(name, 0.0)) for name in names]  # type: ignore[misc]
    for title, value in rows:
        before, now = ([value(run) for run in all_of] for all_of in (other, this))
        middle = statistics.median(before)
        ratio = f"{statistics.median(now) / middle:.2f}" if middle else ""
        yield f"| {title} | {median_and_range(before)} | {median_and_range(now)} | {ratio} |"


def median_and_range(values: Sequence[float]) -> str:
    """As text."""
    return f"{statistics.median(values):.1f} ({min(values):.1f} to {max(values):.1f})"


def say(text: str) -> None:
    """One line, at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
