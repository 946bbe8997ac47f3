"""A wrong value of a key that a command does not use stops no command; other commands refuse it."""

from pathlib import Path
from typing import Any

import pytest
import yaml

import pneurod
from pipeline.config.document import read_document
from pipeline.config.load import UNUSED, checked, for_command
from pipeline.study.sweep.points import Point
from pipeline.study.sweep.spec import points_of, read_sweep
from pipeline.study.wishes.spec import read_wishes
from pipeline.values.errors import InputError
from pipeline.values.reasons import render

ARM: dict[str, Any] = {
    "name": "arm",
    "geometry": {"family": "semicircular", "chambers": 6},
    "material": {"law": "neo_hooke", "mu": "0.1 MPa"},
    "pressures": ["10 kPa", "20 kPa"],
    "mesh": {"size": "6 mm"},
}
#: bad for a run, whose pressures end at 20 kPa
VALIDATION = {"validation": {"pressures": ["50 kPa"], "forces": [["0 N", "0.01 N"]]}}
OUTSIDE = r"validation.pressures: 50 kPa lies outside the pressures of the run"


def written(path: Path, more: dict[str, Any]) -> Path:
    path.write_text(yaml.safe_dump({**ARM, **more}), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("command", "more"),
    [
        ("cell", VALIDATION),
        ("cell", {"identification": {"d": "900 mm"}}),
        ("mesh", VALIDATION),
        ("mesh", {"pressures": [20]}),
        ("mesh", {"law": "seven"}),
        ("design", {"pressures": ["0.05 GPa"]}),
    ],
)
def test_a_wrong_value_of_an_unused_key_is_a_note(tmp_path: Path, command: str, more: dict[str, Any]) -> None:
    document = read_document(written(tmp_path / "arm.yaml", more))
    with pytest.raises(InputError) as refused:
        checked(document)
    config, notes = for_command(command, document, checked)
    assert [render(note) for note in notes] == [
        f"{sentence}; left out, because `pneurod {command}` does not use it" for sentence in refused.value.sentences
    ]
    assert config == checked(document.without(UNUSED[command]))


def test_what_a_command_uses_is_refused_as_before(tmp_path: Path) -> None:
    document = read_document(written(tmp_path / "arm.yaml", {**VALIDATION, "mesh": {"size": "6 N"}, "wal": 1}))
    with pytest.raises(InputError) as refused:
        for_command("cell", document, checked)
    assert len(refused.value.sentences) == 2
    assert not any("validation.pressures" in sentence for sentence in refused.value.sentences)
    right, notes = for_command("cell", read_document(written(tmp_path / "arm.yaml", {})), checked)
    assert (right.pressures_kPa, notes) == ((10.0, 20.0), ())


def test_loads_that_the_cell_uses_are_kept(tmp_path: Path) -> None:
    config, _ = for_command("cell", read_document(written(tmp_path / "arm.yaml", VALIDATION)), checked)
    assert config.validation.forces_N == ((0.0, 0.01),)


def test_mesh_goes_on_and_a_run_does_not(tmp_path: Path) -> None:
    file = written(tmp_path / "arm.yaml", VALIDATION)
    assert pneurod.mesh(file, tmp_path / "mesh").file.is_file()
    with pytest.raises(InputError, match=OUTSIDE):
        pneurod.characterize(file, tmp_path / "run")


def test_a_design_replaces_the_pressures_of_its_base(tmp_path: Path) -> None:
    wish = {
        "name": "wish",
        "base": str(written(tmp_path / "arm.yaml", VALIDATION)),
        "free": {"geometry.wall": {"from": "0.8 mm", "to": "1.6 mm"}},
        "wishes": [{"angle": "5 deg", "at": "8 kPa", "within": "1 deg"}],
    }
    (tmp_path / "wish.yaml").write_text(yaml.safe_dump(wish), encoding="utf-8")
    start = read_wishes(tmp_path / "wish.yaml").start
    assert (start.pressures_kPa, start.validation.pressures_kPa) == ((8.0,), (8.0,))


@pytest.mark.parametrize(("run", "count"), [("cell", 2), ("whole", 0)])
def test_a_sweep_of_cells_leaves_out_what_cells_do_not_use(tmp_path: Path, run: str, count: int) -> None:
    written(tmp_path / "arm.yaml", VALIDATION)
    axes = [{"geometry.wall": ["1 mm", "1.2 mm"]}]
    (tmp_path / "sweep.yaml").write_text(yaml.safe_dump({"name": "s", "base": "arm.yaml", "run": run, "axes": axes}))
    sweep = read_sweep(tmp_path / "sweep.yaml")
    if count:
        assert [isinstance(point, Point) for point in points_of(sweep, tmp_path)] == [True] * count
    else:
        with pytest.raises(InputError, match=OUTSIDE):
            points_of(sweep, tmp_path)
