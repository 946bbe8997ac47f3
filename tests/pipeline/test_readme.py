"""README.md is correct: its configuration is read, its commands and targets exist, its table is complete."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from geometry import PneuNet
from pipeline.cli import app
from pipeline.config.load import load_config
from pipeline.store.provenance import pinned

HERE = Path(__file__).resolve().parent.parent.parent


@pytest.fixture
def readme() -> str:
    return (HERE / "README.md").read_text(encoding="utf-8")


def test_the_configuration_is_the_arm_of_the_paper(readme: str, tmp_path: Path) -> None:
    [block] = re.findall(r"```yaml\n(.*?)```", readme, flags=re.DOTALL)
    (tmp_path / "arm.yaml").write_text(block, encoding="utf-8")
    config = load_config(tmp_path / "arm.yaml")
    assert config.design == PneuNet()
    assert config.pressures_kPa == (5.0, 17.0, 31.0, 45.0)


@pytest.mark.slow
def test_the_python_block_runs_as_it_stands(readme: str, tmp_path: Path) -> None:
    [block] = re.findall(r"```python\n(.*?)```", readme, flags=re.DOTALL)
    assert "import pneurod" in readme[:4000]  # on the first screen
    (tmp_path / "block.py").write_text(block, encoding="utf-8")
    shutil.copytree(HERE / "configs", tmp_path / "configs")
    environment = {**os.environ, "PYTHONPATH": str(HERE)}
    command = [sys.executable, "-W", "error", "block.py"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert re.search(r"^1 +20\.0 +\d+\.\d+ +\d+\.\d+", ended.stdout, flags=re.MULTILINE)
    assert re.search(r"^end at \(\d+\.\d, -?\d+\.\d\) mm, turned by -?\d\.\d+ rad$", ended.stdout, flags=re.MULTILINE)
    assert (tmp_path / "results" / "short_arm" / "report.html").is_file()


def test_commands_and_options_are_there(readme: str) -> None:
    lines = re.findall(r"^    \.venv/bin/pneurod (\w+)(.*?)#", readme, flags=re.MULTILINE)
    registered = {command.name or command.callback.__name__ for command in app.registered_commands}
    assert {command for command, _ in lines} == registered
    assert "run" in registered
    for command, arguments in lines:
        shown = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).stdout
        for option in re.findall(r"--\w+", arguments):
            assert option in shown


def test_targets_are_there(readme: str) -> None:
    texts = [readme, (HERE / "CONTRIBUTING.md").read_text(encoding="utf-8")]
    named = {target for text in texts for target in re.findall(r"^    make ([\w-]+)", text, flags=re.MULTILINE)}
    targets = set(re.findall(r"^([a-z-]+):", (HERE / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    assert {"pneunet", "test", "lint", "types"} <= named <= targets


def test_every_dependency_has_its_reason(readme: str) -> None:
    table = readme.partition("## Dependencies")[2].partition("##")[0]
    reasons = {
        name: reason
        for names, reason in re.findall(r"^\| (.+?) \| (.+?) \|$", table, flags=re.MULTILINE)
        for name in names.split(", ")
    }
    project = (HERE / "pyproject.toml").read_text(encoding="utf-8")
    pinned_there = re.findall(r'^    "([\w-]+)==', project, flags=re.MULTILINE)
    assert len(pinned_there) > 20
    assert set(reasons) - {"package"} == set(pinned_there)


def test_everything_installed_is_pinned() -> None:
    locked = (HERE / "requirements.lock").read_text(encoding="utf-8")
    names = {name.lower() for name in re.findall(r"^([\w.-]+)==\S+$", locked, flags=re.MULTILINE)}
    assert {name.lower() for name in pinned()} <= names
    assert len(names) > 50
    assert "http" not in locked
