"""The functions of Python and the commands are the same: names, arguments, errors, and what was reached."""

import inspect
import types
from pathlib import Path

import pytest
import typer

import pneurod
from pipeline.api import options
from pipeline.cli import app
from pipeline.results.files import read_results
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


def test_a_function_is_made_a_command_where_it_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    assert set(options.COMMANDS) == {"rod", "move", "export"}
    assert all(COMMANDS[name].callback is not None for name in options.COMMANDS)
    monkeypatch.setattr(options, "COMMANDS", dict(options.COMMANDS))
    named = options.command("length")(pneurod.shape)
    assert named is pneurod.shape
    assert options.COMMANDS["length"] is pneurod.shape


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


def test_help_tells_arguments_alone() -> None:
    arguments = str(inspect.signature(pneurod.move))
    assert "Annotated" not in arguments
    assert "seconds: float = 3.0" in arguments
