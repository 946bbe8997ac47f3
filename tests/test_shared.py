"""Folders that tests share are made once, and a test that changes one is found."""

from pathlib import Path

import pytest

from tests.shared import SharedFolders


def test_a_folder_is_made_once_and_again_after_a_failure(tmp_path: Path) -> None:
    made: list[Path] = []

    def make(folder: Path) -> None:
        made.append(folder)
        (folder / f"{len(made)}.txt").write_text("text")
        if len(made) == 1:
            raise RuntimeError("interrupted")

    first, second = SharedFolders(tmp_path / "shared"), SharedFolders(tmp_path / "shared")
    with pytest.raises(RuntimeError):
        first.folder("arm", make)
    assert first.folder("arm", make) == second.folder("arm", make)
    assert len(made) == 2
    assert [path.name for path in made[1].iterdir()] == ["2.txt"]


def test_a_file_that_a_test_changed_is_named(tmp_path: Path) -> None:
    shared = SharedFolders(tmp_path / "shared")
    folder = shared.folder("arm", lambda made: (made / "kept.txt").write_text("text"))
    assert shared.changed() == []
    (folder / "kept.txt").write_text("longer text")
    (folder / "new.txt").write_text("text")
    assert shared.changed() == ["arm/kept.txt", "arm/new.txt"]
