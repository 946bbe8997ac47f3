"""Twenty coarse designs: a sweep on two workers against the same work one after the other in one process.

    python benchmarks/sweep.py [points] [workers] > table

Each point is experiments I, II and III of the pneu-net at two pressures on a coarse mesh, with another wall and height
of the chambers. The process that does one after the other has as many threads as the machine has cores, as a single
run has; a second one has one thread, as each worker has. Kernels are compiled before, and each of these processes
solves one point before its clock starts. The sweep is `pneurod sweep` from its start to its exit, with all imports, the
start of the workers, the table and the picture. Only a machine without other load gives a meaningful ratio.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
# the rooms stand beside this folder
sys.path.insert(0, str(HERE))

from benchmarks.arguments import count, parser_of  # noqa: E402
from pipeline.processes import THREADS, available_cores  # noqa: E402
from pipeline.sweep.points import Point, points_of  # noqa: E402
from pipeline.sweep.spec import read_sweep  # noqa: E402

SWEEP = """
name: benchmark
base: {base}
run: [I, II, III]
set: {{mesh.size: 5 mm, pressures: [10 kPa, 20 kPa]}}
latin_hypercube:
  points: {points}
  seed: 1
  axes:
    geometry.wall: {{from: 1 mm, to: 1.4 mm}}
    geometry.chamber_height: {{from: 10 mm, to: 14 mm}}
"""


def say(line: str) -> None:
    """Write a line to standard output."""
    sys.stdout.write(f"{line}\n")


def one_after_the_other(file: Path, out: Path) -> float:
    """Seconds for all points in this process, after one of them that does not count."""
    from pipeline.store.state_key import NUMBER_SOURCES, result_key
    from pipeline.sweep.points import work_key
    from pipeline.sweep.task import PointTask
    from pipeline.sweep.work import work_on

    sweep = read_sweep(file)
    sources = result_key("", NUMBER_SOURCES)
    points = [point for point in points_of(sweep) if isinstance(point, Point)]

    def solve(point: Point, folder: str) -> None:
        key = work_key(sources, point.config, sweep.run)
        record = work_on(PointTask(out / folder / point.name, point.config, sweep.run, key, sources))
        if record.status != "finished":
            sys.exit(f"{point.name}: {record.reason}")

    solve(points[0], "before")
    begin = time.perf_counter()
    for point in points:
        solve(point, "points")
    return time.perf_counter() - begin


def in_own_process(file: Path, out: Path, threads: int) -> float:
    """The same in a process with this many threads."""
    environment = {**os.environ, **dict.fromkeys(THREADS, str(threads))}
    command = [sys.executable, __file__, "--alone", str(file), str(out)]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True)
    if ended.returncode:
        sys.exit(ended.stderr)
    return float(ended.stdout)


def as_sweep(file: Path, out: Path, jobs: int) -> float:
    """Seconds of `pneurod sweep` from its start to its exit."""
    command = [sys.executable, "-m", "pipeline", "sweep", str(file), "--out", str(out), "--jobs", str(jobs)]
    begin = time.perf_counter()
    ended = subprocess.run(command, cwd=HERE, capture_output=True, text=True)
    if ended.returncode:
        sys.exit(ended.stderr)
    return time.perf_counter() - begin


def main() -> None:
    """Print the seconds of the three and their ratios."""
    parser = parser_of(__doc__)
    parser.add_argument("points", nargs="?", type=count, default=20)
    parser.add_argument("workers", nargs="?", type=count, default=2)
    parser.add_argument("--alone", type=Path, nargs=2, metavar=("FILE", "OUT"), help="one after the other, here")
    given = parser.parse_args()
    if given.alone:
        say(f"{one_after_the_other(*given.alone):.3f}")
    else:
        compare(given.points, given.workers)


def compare(points: int, jobs: int) -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "sweep.yaml"
        file.write_text(SWEEP.format(base=HERE / "configs" / "pneunet_coarse.yaml", points=points), encoding="utf-8")
        cores = available_cores()
        alone = {threads: in_own_process(file, folder / f"alone{threads}", threads) for threads in {1, cores}}
        spent = as_sweep(file, folder / "sweep", jobs)
        say(f"{points} designs, {cores} cores, {time.strftime('%Y-%m-%d')}, load {os.getloadavg()[0]:.1f}\n")
        say("| how | s | over the sweep |\n|---|---:|---:|")
        for threads, seconds in sorted(alone.items()):
            say(f"| one process, {threads} threads, one after the other | {seconds:.1f} | {seconds / spent:.2f} |")
        say(f"| sweep, {jobs} workers of one thread | {spent:.1f} | 1 |")


if __name__ == "__main__":
    main()
