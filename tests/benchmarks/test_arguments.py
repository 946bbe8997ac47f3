"""Scripts in benchmarks/ answer a wrong command line in a sentence, with exit status 2, before anything is solved."""

import importlib
import os
import sys
from pathlib import Path

import pytest

WRONG = {
    "cell_limit": ([],),
    "exports": (["x"],),
    "foreign": (["x"],),
    "kills": (["x"],),
    "law_work": ([],),
    "limit": (["x"],),
    "loads_along": (["x"],),
    "run": ([],),
    "space": (["x"],),
    "three_chambers": (["x"],),
}


def test_every_script_is_among_these() -> None:
    folder = Path(__file__).resolve().parent.parent.parent / "benchmarks"
    scripts = {path.stem for path in folder.glob("*.py") if "__main__" in path.read_text(encoding="utf-8")}
    assert scripts == set(WRONG)


@pytest.mark.parametrize(("name", "arguments"), [(name, words) for name in WRONG for words in WRONG[name]])
def test_a_wrong_command_line_is_refused(
    name: str, arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])  # some scripts change it, and the number of threads
    for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
        monkeypatch.setenv(variable, os.environ.get(variable, "1"))
    script = importlib.import_module(f"benchmarks.{name}")
    monkeypatch.setattr(sys, "argv", [f"{name}.py", *(word.format(tmp=tmp_path) for word in arguments)])
    with pytest.raises(SystemExit) as ended:
        script.main()
    assert ended.value.code == 2
    assert "error: " in capsys.readouterr().err
