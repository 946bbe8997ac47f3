"""Functions of Python and commands are the same; a wrong value of a key that a command does not use stops none."""

import inspect
import types
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

import pneurod
from pipeline.cli import app
from pipeline.config.document import read_document
from pipeline.config.load import UNUSED, checked, for_command
from pipeline.results.files import read_results
from pipeline.study.sweep.points import Point
from pipeline.study.sweep.spec import points_of, read_sweep
from pipeline.study.wishes.spec import read_wishes
from pipeline.values.errors import InputError
from pipeline.values.reasons import render
from tests.coarse import COARSE, copy_with
from tests.commands import done

COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]
#: commands whose functions are called otherwise
OTHER_NAMES = {"run": "characterize", "rod": "shape"}
#: options that say how values are printed
PRINTED = {"quiet", "as_json"}


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_a_command_is_a_function_with_its_arguments(name: str) -> None:
    function = getattr(pneurod, OTHER_NAMES.get(name, name))
    arguments = inspect.signature(function).parameters
    picture = {"out"} if name == "compare" else set()  # of the command alone
    assert {parameter.name for parameter in COMMANDS[name].params} - PRINTED - picture - {"help"} <= set(arguments)
    help_of_function = " ".join((inspect.getdoc(function) or "").partition("\n\n")[0].split())
    assert " ".join(COMMANDS[name].help.split()) == help_of_function
    assert help_of_function.split()[0] not in ("A", "An", "The", "What", "How")


def test_a_rod_of_a_folder_and_the_pressure_for_a_wish() -> None:
    found = pneurod.shape(COARSE, "31 kPa", force="[0 N, 0.01 N]", rod="five")
    done("rod", str(COARSE), "--pressure", "31 kPa", "--force", "[0 N, 0.01 N]")
    assert found.shape.force[1] == pytest.approx(0.01)
    wished = pneurod.solve(str(COARSE), angle="90 deg", rod="five").solutions
    assert wished[0].angle_deg == pytest.approx(90.0)
    table = pneurod.read_results(COARSE).pressure_for(angle=90.0, kind="five")
    assert table.pressure_kPa.to_list() == [at.pressure_kPa for at in wished]
    assert str(found).splitlines() == found.lines
    assert str(pneurod.solve(COARSE, angle=90.0, rod="five")).startswith(wished[0].text)
    numbers = pneurod.shape(COARSE, 31.0, force=(0.0, 0.01), moment=0.5, rod="five")
    assert numbers.shape.end == pneurod.shape(COARSE, "31 kPa", force="0.01 N", moment="0.5 N*mm", rod="five").shape.end


def test_files_are_written_from_python(tmp_path: Path) -> None:
    file = pneurod.init("semicircular", tmp_path / "arm.yaml")
    meshed = pneurod.mesh(file, tmp_path / "mesh", settings={"mesh.size": "6 mm"})
    assert meshed.file == tmp_path / "mesh" / "mesh.vtu"
    assert meshed.file.is_file()
    assert meshed.body.mesh.volume > 0.0
    with pytest.raises(pneurod.InputError, match="exists; give another out, or force=True to replace it"):
        pneurod.init("semicircular", file)
    done = pneurod.export(COARSE, "csv", rod="five", out=tmp_path / "rod")
    assert all(path.is_file() for path in done.files)


def test_a_failure_has_what_was_reached(tmp_path: Path, configs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failures = [{"code": "stopped", "values": {}, "where": None, "text": "experiment II stopped: a limit point."}]
    folder = copy_with(tmp_path / "out", "run.json", lambda content: {**content, "failures": failures})
    monkeypatch.setattr("pipeline.run.run", lambda *_: types.SimpleNamespace(results=read_results(folder)))
    with pytest.raises(pneurod.RunFailed, match="a limit point") as failed:
        pneurod.characterize(configs / "pneunet_coarse.yaml", folder)
    assert isinstance(failed.value.reached, pneurod.Results)
    assert failed.value.reached.directory == failed.value.directory == folder


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


def test_help_tells_arguments_alone() -> None:
    arguments = str(inspect.signature(pneurod.move))
    assert "Annotated" not in arguments
    assert "seconds: float = 3.0" in arguments
