"""Progress reaches the listener from other processes, and is shown on a terminal and in plain lines."""

import io
import multiprocessing
import pickle
from typing import Any

import pytest
from rich.console import Console

from pipeline.progress import Lines, Message, Progress, Silent, Terminal, ToQueue, progress_for, relayed

CALLS: list[tuple[str, tuple[Any, ...]]] = [
    ("stage", ("experiments",)),
    ("experiment", ("II", (17.0, 37.0))),
    ("iteration", ("II", 17.0, 1, 0.5)),
    ("iteration", ("II", 17.0, 2, 1e-7)),
    ("step_done", ("II", 17.0, 3.25)),
    ("step_done", ("II", 37.0, 0.0)),
    ("stage", ("report",)),
]


def report(progress: Progress) -> None:
    for method, arguments in CALLS:
        getattr(progress, method)(*arguments)


class Recorder:
    """Records every call."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, tuple[Any, ...]]] = []

    def __getattr__(self, method: str) -> Any:
        return lambda *arguments: self.calls.append((method, arguments))


def work(queue: Any) -> None:
    listener = ToQueue(queue)
    report(listener)
    listener.done()


def test_messages_cross_processes() -> None:
    context = multiprocessing.get_context("spawn")
    recorder = Recorder()
    queue = context.Queue()
    with relayed(queue, recorder):
        worker = context.Process(target=work, args=(queue,))
        worker.start()
        worker.join()
    assert recorder.calls == CALLS
    assert worker.exitcode == 0
    assert pickle.loads(pickle.dumps(Message("stage", ("mesh",)))) == ("stage", ("mesh",))


def test_plain_lines_where_there_is_no_terminal() -> None:
    text = io.StringIO()
    progress = progress_for(Console(file=text, width=40))
    assert isinstance(progress, Lines)
    report(progress)
    progress.done()
    lines = text.getvalue().splitlines()
    assert lines[:2] == ["stage: experiments", "experiment II: 17, 37 kPa"]
    assert lines[2].startswith("experiment II: 17 kPa reached (2 Newton iterations, 3.2 s); about ")
    assert lines[3].startswith("experiment II: 37 kPa reached (stored by an earlier run); about 0.0 s left")
    assert lines[4] == "stage: report"


def test_a_table_on_a_terminal() -> None:
    text = io.StringIO()
    progress = progress_for(Console(file=text, force_terminal=True, width=120))
    assert isinstance(progress, Terminal)
    report(progress)
    progress.done()
    shown = text.getvalue()
    assert "experiment II" in shown
    assert "37 kPa reached, 2 Newton iterations in total" in shown
    assert shown.count("report: ") >= 1


def test_silent_progress_prints_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    progress: Progress = Silent()
    report(progress)
    progress.done()
    assert capfd.readouterr() == ("", "")
