"""README.md is short and correct: its commands and targets exist, its program runs."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline.cli import app
from pipeline.store.provenance import required

LONGEST = 25  #: words of a sentence


HERE = Path(__file__).resolve().parent.parent.parent
TEXT = (HERE / "README.md").read_text(encoding="utf-8")


def sentences() -> list[str]:
    """The sentences of README outside of tables, blocks of code and the citation."""
    text = re.sub(r"^```.*?^```", "", TEXT.partition("## Citation")[0], flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\[([^\]]+)\]\([^)]*\)", r"\1", re.sub(r"`[^`]*`", "name", text))
    paragraphs = re.split(r"\n\n|\n- ", re.sub(r"^(\||#|    |!|<).*$", "", text, flags=re.MULTILINE))
    return [part for paragraph in paragraphs for part in re.split(r"(?<=[.:;])\s", " ".join(paragraph.split())) if part]


@pytest.mark.slow
def test_the_python_block_runs_as_it_stands(tmp_path: Path) -> None:
    [block] = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
    (tmp_path / "block.py").write_text(block, encoding="utf-8")
    shutil.copytree(HERE / "configs", tmp_path / "configs")
    environment = {**os.environ, "PYTHONPATH": str(HERE)}
    command = [sys.executable, "-W", "error", "block.py"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert re.search(r"^end at \(\d+\.\d, -?\d+\.\d\) mm, bent by \d+\.\d°$", ended.stdout, flags=re.MULTILINE)
    assert (tmp_path / "results" / "short_arm" / "report.html").is_file()


def test_commands_are_there() -> None:
    named = set(re.findall(r"`pneurod (\w+)", TEXT))
    registered = {command.name or command.callback.__name__ for command in app.registered_commands}
    assert named
    assert named <= registered


def test_targets_are_there() -> None:
    pages = [HERE / "CONTRIBUTING.md", HERE / "docs" / "source.md"]
    texts = [TEXT, *(page.read_text(encoding="utf-8") for page in pages)]
    named = {target for text in texts for target in re.findall(r"^    make ([\w-]+)", text, flags=re.MULTILINE)}
    targets = set(re.findall(r"^([a-z-]+):", (HERE / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    assert {"pneunet", "test", "lint", "types"} <= named <= targets


def test_every_dependency_has_its_reason() -> None:
    table = (HERE / "docs" / "source.md").read_text(encoding="utf-8").partition("## Dependencies")[2]
    rows = re.findall(r"^\| (.+?) \| (.+?) \|$", table, flags=re.MULTILINE)
    named = {name for names, _ in rows for name in names.split(", ")}
    project = (HERE / "pyproject.toml").read_text(encoding="utf-8")
    there = set(re.findall(r'^    "([\w-]+)[>=]=', project, flags=re.MULTILINE))
    assert len(there) > 20
    assert named - {"package"} == there


def test_everything_installed_is_pinned() -> None:
    locked = (HERE / "requirements.lock").read_text(encoding="utf-8")
    names = {name.lower() for name in re.findall(r"^([\w.-]+)==\S+$", locked, flags=re.MULTILINE)}
    assert {name.lower() for name in required()} <= names
    assert len(names) > 50
    assert "http" not in locked


def test_the_readme_is_short() -> None:
    assert len(TEXT.splitlines()) <= 120
    assert len(sentences()) > 20
    assert [sentence for sentence in sentences() if len(sentence.split()) > LONGEST] == []
