"""Progress reaches the listener from other processes, and is shown on a terminal and in plain lines."""

import io
import re
from typing import Any

import pytest
from rich.console import Console

from pipeline.show.progress import Lines, Terminal, progress_for
from pipeline.store.processes import Processes
from pipeline.store.progress import Message, PassedOn, Progress
from pipeline.store.worker import tell

CALLS: list[tuple[str, tuple[Any, ...]]] = [
    ("stage", ("experiments",)),
    ("experiment", ("II", (17.0, 37.0))),
    ("iteration", ("II", 17.0, 1, 0.5)),
    ("iteration", ("II", 17.0, 2, 1e-7)),
    ("step_done", ("II", 17.0, 3.25)),
    ("step_done", ("II", 37.0, 0.0)),
    ("stopped", ("III", (45.0, 60.0), "the limit is at 41 kPa")),
    ("stage", ("report",)),
]


def report(progress: Progress) -> None:
    for method, arguments in CALLS:
        getattr(progress, method)(*arguments)


class Recorder(Progress):
    """Records every call."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, tuple[Any, ...]]] = []

    def tell(self, message: Message) -> None:
        self.calls.append(tuple(message))


def work() -> None:
    listener = PassedOn(tell)
    report(listener)
    listener.done()


def test_messages_cross_processes() -> None:
    recorder = Recorder()
    with Processes(1, listen=recorder.tell) as pool:
        pool.submit(work).result()
    assert recorder.calls == CALLS


def test_plain_lines_where_there_is_no_terminal() -> None:
    text = io.StringIO()
    progress = progress_for(Console(file=text, width=40))
    assert isinstance(progress, Lines)
    report(progress)
    progress.done()
    lines = text.getvalue().splitlines()
    assert lines[:2] == ["stage: experiments", "experiment II: 17, 37 kPa"]
    assert lines[2:] == [
        "II: 17 kPa (2 iterations, 3.2 s)",
        "II: 37 kPa (already solved)",
        "III stopped before 45 kPa: the limit is at 41 kPa",
        "stage: report",
    ]


def test_a_table_on_a_terminal() -> None:
    text = io.StringIO()
    progress = progress_for(Console(file=text, force_terminal=True, width=120))
    assert isinstance(progress, Terminal)
    for method, arguments in CALLS[:-1]:
        getattr(progress, method)(*arguments)
    progress.done()
    assert "37 kPa reached" in text.getvalue()
    assert text.getvalue().count("experiments: ") >= 1


@pytest.mark.parametrize("stopped", [False, True])
def test_an_experiment_stays_in_the_table_with_the_next_stage_unless_it_has_ended(stopped: bool) -> None:
    text = io.StringIO()
    progress = progress_for(Console(file=text, force_terminal=True, width=120))
    progress.stage("experiments")
    progress.experiment("cell", (17.0, 150.0))
    progress.experiment("II", (17.0, 150.0) if stopped else (17.0,))
    if stopped:
        progress.stopped("II", (150.0,), "the limit is at 64.7 kPa")
    else:
        progress.step_done("II", 17.0, 1.0)
    progress.stage("pictures")
    assert ("II stopped before 150 kPa: the limit is at 64.7 kPa" in text.getvalue()) == stopped
    if not stopped:
        progress.step_done("cell", 17.0, 1.0)
    text.truncate(0)
    progress.done()
    assert "cell" in text.getvalue()
    assert "II" not in text.getvalue()


def test_progress_fits_into_80_columns() -> None:
    """Of lines and of the table, with the longest names and numbers of a run."""
    calls = [
        ("stage", ("kernels (compiled once) (2 of 10)",)),
        ("stage", ("experiments (3 of 10)",)),
        ("experiment", ("III_end_-20.25mm", (12.5, 17.125, 31.0, 45.0))),
        *(("iteration", ("III_end_-20.25mm", 12.5, n, 1.23e-10)) for n in range(1, 100)),
        ("step_done", ("III_end_-20.25mm", 12.5, 1000.0)),
        ("iteration", ("III_end_-20.25mm", 17.125, 14, 1.23e-10)),
    ]
    for terminal in (False, True):
        text = io.StringIO()
        progress = progress_for(Console(file=text, width=300, force_terminal=terminal, color_system=None))
        for method, arguments in calls:
            getattr(progress, method)(*arguments)
        progress.done()
        lines = [re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", line).rstrip() for line in text.getvalue().splitlines()]
        assert any("III_end_-20.25mm" in line for line in lines)
        assert max(map(len, lines)) <= 80, max(lines, key=len)
