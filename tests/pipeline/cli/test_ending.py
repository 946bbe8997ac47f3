"""Interrupted runs: killed, terminated by a signal, or stopped by a full disk."""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import fem
from pipeline.store.result_folder import MADE, ResultFolder
from tests.pipeline.store.test_processes import own_processes

HERE = Path(__file__).resolve().parent.parent.parent.parent
SHORT = """
name: short
geometry: {family: pneunet, chambers: 8}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [4 kPa, 7 kPa, 10 kPa]
law: five
validation: off
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
effects: {self_contact: off}
"""
PRESSURES = ", ".join(f"{4.0 + 0.05 * step:g} kPa" for step in range(121))
LONG = ("--set", f"pressures=[{PRESSURES}]", "--set", "mesh.size=4 mm")
"""Options for minutes of work: a run is ended long before, however late that is on a busy machine."""
PATIENCE = 300.0
"""Seconds in which what is waited for must happen."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    fem.compile_kernels("p2p0")  # in a fresh clone all kernels of this run are written into a cache here
    directory = tmp_path_factory.mktemp("endings")
    (directory / "short.yaml").write_text(SHORT, encoding="utf-8")
    return directory


@contextmanager
def started(
    folder: Path, out: str = "out", *options: str, largest_file: int = resource.RLIM_INFINITY
) -> Iterator[subprocess.Popen[str]]:
    """A run that may write files of so many bytes at most, as on a disk that is full; it ends with the block."""
    command = [sys.executable, "-m", "pipeline", "run", str(folder / "short.yaml"), "--out", str(folder / out)]
    with subprocess.Popen(
        [*command, "--jobs", "2", *options],
        cwd=HERE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file)),
    ) as run:
        try:
            yield run
        finally:
            run.kill()


def ended(run: subprocess.Popen[str]) -> tuple[int, str]:
    """Its exit status and its sentence."""
    _, message = run.communicate(timeout=PATIENCE)
    assert "Traceback" not in message
    return run.returncode, message


def workers(run: subprocess.Popen[str]) -> list[int]:
    """The processes of its experiments."""
    return own_processes(run.pid)


def until_reached(run: subprocess.Popen[str]) -> None:
    """Wait until a pressure is reached that no earlier run had reached."""
    assert run.stdout is not None
    for line in run.stdout:
        if " iterations, " in line:
            return
    raise AssertionError(f"the run ended: {run.stderr.read() if run.stderr else ''}")


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def states(folder: Path, out: str = "out") -> Iterator[Path]:
    yield from (folder / out / "states").glob("*.npz")


def test_a_disk_without_room_for_a_state_is_named(folder: Path) -> None:
    with started(folder, largest_file=20_000) as run:
        status, message = ended(run)
    assert status == 1
    assert message.startswith("pneurod: ")
    assert "kPa.npz: File too large; allow larger files or give another --out" in message
    assert message.count("\n") == 1
    assert not list(states(folder))


def test_workers_end_with_a_main_process_that_is_killed(folder: Path) -> None:
    with started(folder, "no main", *LONG) as run:
        until_reached(run)
        orphans = workers(run)
        assert len(orphans) == 2
    wait_for(lambda: not any(Path(f"/proc/{worker}").exists() for worker in orphans))
    assert list(states(folder, "no main"))


def test_a_worker_that_is_killed_ends_the_run_in_a_sentence(folder: Path) -> None:
    with started(folder, "lost worker", *LONG) as run:
        until_reached(run)
        os.kill(workers(run)[0], signal.SIGKILL)
        status, message = ended(run)
    assert status == 1
    assert "was ended from outside" in message
    assert message.count("\n") == 1


def test_a_request_to_end_is_an_interrupt(folder: Path) -> None:
    with started(folder, "interrupted", *LONG) as run:
        until_reached(run)
        run.send_signal(signal.SIGTERM)
        assert ended(run) == (
            130,
            "pneurod: interrupted; finished results are kept, and the same command continues from there\n",
        )


@pytest.mark.slow
def test_without_room_for_the_report_all_else_is_there(folder: Path) -> None:
    with started(folder, largest_file=1_200_000) as run:
        status, message = ended(run)
    assert status == 1
    assert f"{folder / 'out' / 'report.html'}: File too large" in message
    assert message.count("\n") == 1
    assert len(list(states(folder))) == 9
    for path in states(folder):
        with np.load(path, allow_pickle=False) as arrays:
            assert np.isfinite(arrays["displacement"]).all()
    store = ResultFolder(folder / "out")
    assert len(store.read_json("experiments.json")) == 9
    assert store.read_json("parameters.json")["pressures_kPa"] == [4.0, 7.0, 10.0]
    left = {path.name for path in (folder / "out").rglob("*") if path.is_file()}
    assert "report.html" not in left
    assert {name for name in left if name.startswith(".")} == {MADE}
