"""What tests themselves use: the comparison with kept numbers, and folders that all processes share."""

from pathlib import Path

import pytest

from tests.golden import ARITHMETIC, SAME, differences, numbers_of, processor
from tests.shared import SharedFolders


def test_a_number_that_moved_is_found() -> None:
    kept = {"a.json/x/0": 1.0, "a.json/x/1": 1e-9, "a.json/y": 3.0}
    assert differences(kept, dict(kept), SAME) == []
    # the small number of a list is measured against the largest of the list
    assert differences(kept, kept | {"a.json/x/1": 1.1e-9}, SAME) != []
    assert differences(kept, kept | {"a.json/x/1": 1e-9 + 1e-14}, SAME) == []
    assert len(differences(kept, kept | {"a.json/y": 3.1}, 1e-5)) == 1


def test_texts_and_times_are_left_out(tmp_path: Path) -> None:
    for name in ("parameters", "experiments", "validation", "effects", "law", "run"):
        (tmp_path / f"{name}.json").write_text('{"a": [1, "text", null], "seconds": 2.0, "b": {"c": 4.5}}')
    for name in ("curves", "validation_curves"):
        (tmp_path / f"{name}.csv").write_text("experiment,s_mm\nII,0.5\n")
    numbers = numbers_of(tmp_path)
    assert numbers["run.json/a/0"] == 1.0
    assert numbers["run.json/b/c"] == 4.5
    assert numbers["curves.csv/s_mm/0"] == 0.5
    assert not [path for path in numbers if "seconds" in path]


def test_a_processor_that_is_told_to_calculate_as_another_one_is_another_one(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ARITHMETIC:
        monkeypatch.delenv(name, raising=False)
    own = processor()
    for name in ARITHMETIC:
        monkeypatch.setenv(name, "generic")
        assert processor() != own
        monkeypatch.delenv(name)


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
