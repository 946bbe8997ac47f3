"""Runs that are killed at random times and continued, compared with an uninterrupted run.

    python benchmarks/kills.py [--kills 50] [--seed 1] [--keep DIR]

Every signal is SIGKILL, alternately to the main process alone, whose workers must then end by themselves, and to the
process group; every third resumed run is killed as well. The times are spread over the duration of the uninterrupted
run, one at random in each part, so that mesh, experiments, identification, pictures and report are all hit. The same
command must then succeed with the results of the uninterrupted run, equal to the last bit except for the seconds.
"""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from tests.golden import numbers_of  # noqa: E402  (the rooms stand beside this folder)

SCENE = """
name: kills
geometry: {{family: pneunet, chambers: 8, wall: {wall}}}
material: {{law: {law}, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}}
pressures: [8 kPa, 24 kPa]
mesh: {{size: 8 mm, formulation: p2p0, grading: off}}
law: five
"""
#: walls of 1 mm touch before 18 kPa, those of 1.5 mm do not; the former is validated as well
SCENES = {
    "contact": SCENE.format(wall="1 mm", law="svk") + "validation: {end_y: [5 mm]}\n",
    "no contact": SCENE.format(wall="1.5 mm", law="hencky") + "validation: off\n",
}
#: what a state holds of wall and processor time
CLOCKS = ("seconds", "spent", "cpu_seconds")
PATIENCE = 10.0
"""Seconds after which no process of a killed run may be alive."""


@dataclass(frozen=True)
class Reference:
    """A run that nobody interrupted."""

    scene: str
    config: Path
    seconds: float
    results: dict[str, Any]


@dataclass(frozen=True)
class Running:
    """A run that was started; its process is the first of a session of its own."""

    process: subprocess.Popen[bytes]
    log: Path

    @classmethod
    def start(cls, config: Path, out: Path) -> "Running":
        out.mkdir(exist_ok=True)
        log = out.with_suffix(".log")
        command = [sys.executable, "-m", "pipeline", "run", str(config), "--out", str(out), "--jobs", "2"]
        with log.open("ab") as file:
            process = subprocess.Popen(command, cwd=HERE, stdout=file, stderr=file, start_new_session=True)
        return cls(process, log)

    def ended_within(self, seconds: float) -> bool:
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def kill(self, group: bool) -> str:
        """Kill the process alone or its whole group; what it was doing then."""
        stages = [line for line in self.log.read_text().splitlines() if line.startswith("stage: ")]
        (os.killpg if group else os.kill)(self.process.pid, signal.SIGKILL)
        self.process.wait()
        return stages[-1].removeprefix("stage: ") if stages else "start"

    def left_alive(self) -> bool:
        """Whether a process of the session lives on for longer than PATIENCE."""
        deadline = time.monotonic() + PATIENCE
        while in_session(self.process.pid):
            if time.monotonic() > deadline:
                return True
            time.sleep(0.1)
        return False


def main() -> int:
    """Kill, resume, compare, count; 0 when all results are equal."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="new folder for the runs, a temporary one by default")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        references = [uninterrupted(folder, scene) for scene in SCENES]
        endings = list(interrupted(folder, references, options.kills, random.Random(options.seed)))
    for verdict, count in Counter(endings).items():
        say(f"{count} x {verdict}")
    equal = endings.count("equal")
    say(f"{options.kills} kills, {equal} equal results")
    return 0 if equal == options.kills else 1


def uninterrupted(folder: Path, scene: str) -> Reference:
    """A complete run, twice, because the first one may compile the kernels; both must agree."""
    config = folder / f"{scene.replace(' ', '_')}.yaml"
    config.write_text(SCENES[scene], encoding="utf-8")
    runs = []
    for name in ("first", "second"):
        begin, out = time.monotonic(), config.with_name(f"{config.stem}_{name}")
        run = Running.start(config, out)
        if run.process.wait() != 0:
            raise SystemExit(f"the uninterrupted run failed: {run.log.read_text().splitlines()[-1]}")
        runs.append(Reference(scene, config, time.monotonic() - begin, results_of(out)))
    first, second = runs
    say(f"{scene}: {second.seconds:.1f} s uninterrupted, two such runs are {compared(first.results, second.results)}")
    return second


def interrupted(folder: Path, references: list[Reference], count: int, chance: random.Random) -> Iterator[str]:
    """The verdict on each killed run."""
    parts = chance.sample(range(count), count)
    for number, part in enumerate(parts):
        reference, group, twice = references[number % len(references)], number % 4 < 2, number % 3 == 2
        out = folder / f"run_{number:03d}"
        killed, events = [], []
        moments = [(part + chance.random()) / count, *([0.7 * chance.random()] if twice else [])]
        while moments:
            moment = moments.pop(0)
            run = Running.start(reference.config, out)
            if not run.ended_within(moment * reference.seconds):
                events.append(f"killed at {moment:.0%} ({run.kill(group)})")
                killed.append(run)
            elif not killed:  # this run was faster than the uninterrupted one; another one, killed earlier
                shutil.rmtree(out)
                moments.insert(0, 0.8 * moment)
        last = Running.start(reference.config, out)  # at once, while workers of the killed run may still be alive
        status = last.process.wait()
        verdict = compared(reference.results, results_of(out)) if status == 0 else f"exit status {status}"
        if any(run.left_alive() for run in (*killed, last)):
            verdict = "workers outlived their run"
        say(f"{number + 1:3d} {reference.scene}, {'group' if group else 'main'}, {', '.join(events)}: {verdict}")
        yield verdict


def in_session(leader: int) -> list[int]:
    """The living processes of the session that `leader` opened (Linux)."""
    processes = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, session = stat.read_text().rpartition(")")[2].split()[:4]
        except (OSError, ValueError):
            continue
        if int(session) == leader and state != "Z":
            processes.append(int(stat.parent.name))
    return processes


def results_of(out: Path) -> dict[str, Any]:
    """All numbers of a run but the seconds: those of its tables, and the arrays of its states."""
    results: dict[str, Any] = {name: v for name, v in numbers_of(out).items() if not name.startswith("run.json")}
    for path in sorted((out / "states").glob("*.npz")):
        with np.load(path, allow_pickle=False) as arrays:
            state = {name: arrays[name].tolist() for name in arrays.files}
        state |= json.loads(state.pop("others", "{}"))
        results.update((f"{path.name}/{name}", value) for name, value in state.items() if name not in CLOCKS)
    return results


def compared(results: dict[str, Any], others: dict[str, Any]) -> str:
    """`equal`, or where the first difference is."""
    names = sorted(results.keys() | others.keys())
    different = [name for name in names if name not in results or name not in others or results[name] != others[name]]
    return f"different at {different[0]}" if different else "equal"


def say(text: str) -> None:
    """One line, at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
