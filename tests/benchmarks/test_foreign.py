"""The table of bodies from files: runs are kept until the program changes, and the table says its version."""

from pathlib import Path

import pytest

from benchmarks import foreign
from benchmarks.foreign import MARKS, Ran
from tests.foreign_bodies import Tried

BODY = Tried("arm.stl", "a surface", "unit: mm")


def test_kept_runs_belong_to_the_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    solved: list[str] = []

    def solve(results: Path, tried: Tried) -> Ran:
        solved.append(tried.file)
        return Ran("", elements=100 + len(solved))

    docs = tmp_path / "page.md"
    docs.write_text(f"before\n\n{MARKS[0]}\nold\n{MARKS[1]}\n", encoding="utf-8")
    for name, value in (("solve", solve), ("write_tried", lambda folder: [BODY]), ("DOCS", docs)):
        monkeypatch.setattr(foreign, name, value)
    monkeypatch.setattr(foreign, "written_with", lambda: "Written with the sources of commit abc1234.")

    def table() -> str:
        foreign.main()
        return docs.read_text(encoding="utf-8")

    monkeypatch.setattr("sys.argv", ["foreign.py", str(tmp_path / "results")])
    first = table()
    assert "| a surface | `unit: mm` | 101 |" in first
    assert first.endswith(f"|\n\nWritten with the sources of commit abc1234.\n\n{MARKS[1]}\n")
    assert table() == first
    monkeypatch.setattr(foreign, "key_of", lambda *words: "of other sources")
    assert "| a surface | `unit: mm` | 102 |" in table()
    assert solved == ["arm.stl"] * 2
    monkeypatch.setattr("sys.argv", ["foreign.py", str(tmp_path / "results"), "nosuch.stl"])
    with pytest.raises(SystemExit):
        foreign.main()
    assert "there is no body nosuch.stl; there are arm.stl" in capsys.readouterr().err
