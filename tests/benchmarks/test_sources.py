"""Published numbers name the version of the program that they are from, changes that were not committed included."""

import shutil
import subprocess
from pathlib import Path

import pytest

from benchmarks.sources import commit_of_sources

GIT = shutil.which("git")


@pytest.mark.skipif(GIT is None, reason="without git there is no commit")
def test_a_commit_is_marked_where_the_sources_differ_from_it(tmp_path: Path) -> None:
    def git(*arguments: str) -> str:
        command = [str(GIT), "-C", str(tmp_path), "-c", "user.name=x", "-c", "user.email=x", *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    git("init", "--quiet")
    for name in ("rod/law.py", "docs/page.md"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text("first\n")
    git("add", "--all")
    git("commit", "--quiet", "--message", "first")
    first = git("log", "-1", "--format=%h")
    (tmp_path / "docs" / "page.md").write_text("a page is no source\n")
    git("commit", "--quiet", "--all", "--message", "second")
    assert commit_of_sources(tmp_path) == first
    (tmp_path / "rod" / "law.py").write_text("changed\n")
    assert commit_of_sources(tmp_path) == f"{first}+"


def test_outside_a_clone_there_is_no_commit(tmp_path: Path) -> None:
    assert commit_of_sources(tmp_path) == "unknown"
