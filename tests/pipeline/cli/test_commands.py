"""The command line: exit status, one sentence on stderr, no traceback for a mistake of the user."""

import json
import os
import shutil
import signal
import subprocess
import sys
import types
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import pytest
import typer

from pipeline import doctor
from pipeline.cli import app
from pipeline.cli import commands as cli
from pipeline.cli.ending import print_lines
from pipeline.config.load import load_config
from pipeline.doctor import Finding
from pipeline.results.files import read_results
from pipeline.results.verdict import verdict_of
from pipeline.store.progress import Progress
from pipeline.store.store import open_store
from pipeline.values.errors import RunFailed
from pipeline.values.table import Table
from tests.coarse import COARSE as DATA
from tests.coarse import copy_with
from tests.commands import call, done, refused

Task = Callable[[object, Path, int, bool, Progress], object]


@pytest.fixture
def coarse(configs: Path) -> str:
    return str(configs / "pneunet_coarse.yaml")


@pytest.fixture
def replace_run(monkeypatch: pytest.MonkeyPatch) -> Callable[[Task], None]:
    """Replace `pipeline.run.run` by another function."""

    def put(function: Task) -> None:
        stand_in = types.ModuleType("pipeline.run")
        stand_in.run = function  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "pipeline.run", stand_in)

    return put


@pytest.mark.parametrize("name", [command.name or command.callback.__name__ for command in app.registered_commands])
def test_the_help_of_a_command_is_shown_in_full(name: str) -> None:
    words = " ".join(done(name, "--help").split())
    command = typer.main.get_command(app).commands[name]
    texts = [command.help, *(parameter.help for parameter in command.params if parameter.help)]
    assert [text for text in texts if " ".join(text.split()) not in words] == []


def test_run_passes_its_options_on(replace_run: Callable[[Task], None], coarse: str, tmp_path: Path) -> None:
    calls = []

    def task(*arguments: object) -> object:
        calls.append(arguments)
        return types.SimpleNamespace(results=read_results(DATA))

    replace_run(task)
    out = shutil.copytree(DATA, tmp_path / "out")
    result = call("run", coarse, "--out", str(out), "--set", "mesh.size=3 mm", "--jobs", "2", "--fresh")
    assert result.exit_code == 0
    [(config, folder, jobs, fresh, progress)] = calls
    assert (config.mesh.size_mm, folder, jobs, fresh) == (3.0, out, 2, True)
    assert hasattr(progress, "step_done")
    assert "report.html" in result.stdout
    call("run", coarse)
    assert calls[1][1] == Path("results/pneunet_coarse")


@pytest.mark.parametrize("option", ["", "-q", "--quiet", "--json"])
def test_the_verdict_ends_a_run(replace_run: Callable[[Task], None], coarse: str, tmp_path: Path, option: str) -> None:
    """The same lines in every form; with --json nothing else is on standard output, and -q prints the verdict alone."""
    results = shutil.copytree(DATA, tmp_path / "out")

    def task(config: object, out: Path, jobs: int, fresh: bool, progress: Progress) -> object:
        progress.stage("experiments")
        return types.SimpleNamespace(results=read_results(out))

    replace_run(task)
    result = call("run", coarse, "--out", str(results), *([option] if option else []))
    assert result.exit_code == 0, result.stderr
    verdict = verdict_of(read_results(results))
    if option == "--json":
        assert json.loads(result.stdout)["lines"] == list(verdict.lines)
        assert "stage: experiments" in result.stderr
        return
    lines = result.stdout.splitlines()
    assert lines[-1] == f"report: {results / 'report.html'}"
    first = lines.index(verdict.lines[0])
    assert tuple(lines[first : first + len(verdict.lines)]) == verdict.lines
    quiet = option in ("-q", "--quiet")
    assert (len(lines) == len(verdict.lines) + 1) == quiet
    assert any("287.1 ± 0.5" in line and "183 ± 24" in line for line in lines) == (not quiet)
    assert ("stage: experiments" in lines) == (not quiet)


def test_the_verdict_of_a_failed_run_is_shown_before_the_reason(
    replace_run: Callable[[Task], None], coarse: str, tmp_path: Path
) -> None:
    reason = "experiment II stopped before 45 kPa"
    failures = [{"code": "stopped", "values": {}, "where": None, "text": f"{reason}: a limit point at 41 kPa."}]
    results = copy_with(tmp_path / "out", "run.json", lambda content: {**content, "failures": failures})

    replace_run(lambda *arguments: types.SimpleNamespace(results=read_results(results)))
    result = call("run", coarse, "--out", str(results), "-q")
    told = f"pneurod: {reason}: a limit point at 41 kPa. What was reached is in {results}.\n"
    assert (result.exit_code, result.stderr) == (1, told)
    assert result.stdout.count("a limit point at 41 kPa") == 1


def test_the_version() -> None:
    assert done("--version") == f"pneurod {metadata.version('pneurod')}\n"


def test_wrong_input_in_a_process_of_its_own(coarse: str) -> None:
    command = [sys.executable, "-m", "pipeline", "run", coarse, "--set", "material.nu=0.6"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=Path(coarse).parent.parent)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("pneurod: --set material.nu: 0.6 is not allowed")
    assert len(done.stderr.splitlines()) == 1


def test_without_a_folder_for_compiled_kernels(coarse: str, tmp_path: Path) -> None:
    nowhere = {**os.environ, "NUMBA_CACHE_LOCATOR_CLASSES": "IPythonCacheLocator"}  # as where no folder can be written
    command = [sys.executable, "-m", "pipeline", "run", coarse, "--out", str(tmp_path)]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=Path(coarse).parent.parent, env=nowhere
    )
    assert done.returncode == 1
    assert "no folder for compiled kernels can be written; name one that can: NUMBA_CACHE_DIR=" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def raising(error: BaseException) -> Task:
    def start_and_raise(config: object, out: Path, jobs: int, fresh: bool, progress: Progress) -> None:
        progress.stage("experiments")
        raise error

    return start_and_raise


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (RunFailed("the body cannot bear 1000 kPa"), 1, "the body cannot bear 1000 kPa"),
        (KeyboardInterrupt(), 130, "interrupted; finished results are kept, and the same command continues from there"),
        (OSError(28, "No space left on device", "out/a.json"), 1, "out/a.json: No space left on device"),
        (OSError("libGLU.so.1: cannot open"), 1, "libGLU.so.1: cannot open; `pneurod doctor` names the command"),
        (ImportError("No module named 'gmsh'"), 1, "No module named 'gmsh'; `pneurod doctor` names the command"),
        (MemoryError(), 1, "the memory of this machine does not suffice"),
    ],
)
def test_a_failed_run_ends_with_a_sentence(
    replace_run: Callable[[Task], None], coarse: str, tmp_path: Path, error: BaseException, status: int, message: str
) -> None:
    replace_run(raising(error))
    assert refused("run", coarse, "--out", str(tmp_path), status=status).startswith(message)


def test_mesh_writes_the_body_and_its_quality(coarse: str, tmp_path: Path) -> None:
    settings = ("geometry.chambers=2", "mesh.size=5 mm", "mesh.formulation=auto")
    printed = done("mesh", coarse, "--out", str(tmp_path), *(word for given in settings for word in ("--set", given)))
    assert (tmp_path / "mesh.vtu").stat().st_size > 1000
    output = " ".join(printed.split())
    for text in ("22 mm", "from the drawing", "radius ratio", "tetrahedra", "five parameters need an arm of 65 mm"):
        assert text in output
    assert "material svk, Young's modulus 1.2 MPa at rest" in output
    assert "formulation p2p0, because mixed elements, though more accurate, end early" in output
    assert "size 5 mm" not in output  # it was given


def test_mesh_names_the_volume_of_every_cavity(configs: Path, tmp_path: Path) -> None:
    config = str(configs / "bisected_circle_coarse.yaml")
    printed = done("mesh", config, "--out", str(tmp_path), "--set", "geometry.length=40 mm", "--set", "mesh.size=6 mm")
    design = load_config(config, ["geometry.length=40 mm"]).design
    assert len(design.cavities) == 2
    for name, drawn in design.cavity_volumes.items():
        (line,) = [line for line in printed.splitlines() if line.startswith(f"{name} ")]
        assert line.rstrip().endswith(f"mm3 in the full body; from the drawing {drawn:.7g}")


def test_mesh_does_not_replace_the_body_of_another_configuration(
    coarse: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is refused before meshing, which may take minutes."""
    with open_store(tmp_path, load_config(coarse)) as store:
        store.save_json("law.json", {})
    monkeypatch.setattr("pipeline.simulate.scene.Scene.meshed", lambda config: pytest.fail("it is meshed"))
    message = refused("mesh", coarse, "--out", str(tmp_path), "--set", "geometry.chambers=2")
    assert message.endswith("holds the results of a run with another configuration; give another --out")
    assert not (tmp_path / "mesh.vtu").exists()


def test_no_number_of_a_table_is_cut_off(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    cells = tuple(f"{k}.123 ± 0.456" for k in range(6))
    print_lines(Table(tuple(f"column {k}" for k in range(6)), (cells,)), Table(("no",), ()))
    shown = capsys.readouterr().out
    assert all(cell in shown for cell in cells)
    assert "no" not in shown
    assert len(shown.splitlines()) == 2


#: the commands that write; CONFIG and RESULTS are replaced
WRITING: dict[str, list[str]] = {
    "init": ["init"],
    **{name: [name, "CONFIG"] for name in ("run", "mesh", "effects", "accuracy", "cell")},
    "sweep": ["sweep", "examples/sweep.yaml"],
    "design": ["design", "examples/wish_semicircular.yaml"],
    "export": ["export", "RESULTS", "--to", "csv"],
    "rod": ["rod", "RESULTS/parameters.json", "--pressure", "31 kPa"],
    "material": ["material", "configs/elastosil_m4601_yeoh.csv"],
}


@pytest.mark.parametrize("command", WRITING)
def test_a_place_that_cannot_be_written_is_named(
    command: str, coarse: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file is where a folder should be: root, too, cannot write there."""
    monkeypatch.chdir(Path(coarse).parent.parent)
    (tmp_path / "file").write_text("")
    given = {"CONFIG": coarse, "RESULTS": str(DATA), "RESULTS/parameters.json": str(DATA / "parameters.json")}
    arguments = [given.get(argument, argument) for argument in WRITING[command]]
    for out in (tmp_path / "file" / "out", tmp_path / "file" / "out" / "deeper"):
        message = refused(*arguments, "--out", str(out))
        assert message.startswith(f"--out {tmp_path / 'file'}")
        assert message.endswith(f"cannot be written ({tmp_path / 'file'} is a file); give a folder you may write to")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_file_is_not_written_over_a_folder_and_its_folder_is_made(tmp_path: Path) -> None:
    assert refused("init", "--force", "--out", str(tmp_path)) == f"--out {tmp_path}: is a folder; give a file"
    done("init", "--out", str(tmp_path / "new" / "arm.yaml"))
    assert (tmp_path / "new" / "arm.yaml").is_file()


def test_export_of_a_missing_folder_makes_none(tmp_path: Path) -> None:
    message = refused("export", str(tmp_path / "typo"), "--to", "csv")
    assert message.startswith(f"{tmp_path / 'typo'}: no such folder")
    assert not (tmp_path / "typo").exists()


def test_doctor_on_this_machine() -> None:
    result = call("doctor")
    assert result.exit_code == 0, result.output
    for subject in ("Python", "gmsh", "pictures", "linear solver", "threads", "rods", "disk"):
        assert subject in result.stdout
    assert result.stdout.count("ok") >= 20
    assert result.stdout.startswith("Checked are ")


def test_doctor_names_the_one_command(monkeypatch: pytest.MonkeyPatch) -> None:
    findings = [
        Finding("Python", True, "3.11"),
        Finding("gmsh", False, "libGLU.so.1: cannot open shared object file", "apt-get install -y libglu1-mesa"),
        Finding("pictures", False, "ended by signal 11", "apt-get install -y libglu1-mesa"),
        Finding("numpy", False, "not installed", "make setup"),
    ]
    monkeypatch.setattr(doctor, "examine", lambda: findings)
    mends = "apt-get install -y libglu1-mesa && make setup"
    assert refused("doctor", status=1) == f"something is missing; to mend it: {mends}"


def test_doctor_tells_a_missing_system_library_from_a_missing_package(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(error: str) -> Finding:
        done = subprocess.CompletedProcess([], 1, "", f"Traceback\n{error}\n")
        monkeypatch.setattr(doctor.subprocess, "run", lambda *arguments, **options: done)
        return doctor.check("gmsh")

    library = failing("OSError: libGLU.so.1: cannot open shared object file: No such file or directory")
    assert not library.sound
    assert all(package in library.mends for package in doctor.system_packages())
    assert failing("ModuleNotFoundError: No module named 'gmsh'").mends == "make setup"
    monkeypatch.setattr(doctor, "__file__", "/usr/lib/python3/pipeline/doctor.py")  # no clone of the sources
    assert failing("ModuleNotFoundError: No module named 'gmsh'").mends == "pip install --upgrade 'pneurod[solve]'"


def test_doctor_blames_no_installation_for_a_busy_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    def wait(command: list[str], **options: float) -> None:
        raise subprocess.TimeoutExpired(command, options["timeout"])

    monkeypatch.setattr(doctor.subprocess, "run", wait)
    found = doctor.check("threads")
    assert (found.sound, found.mends) == (True, "")
    assert found.result == "no answer within 10 minutes: busy, so this is not known"


def test_doctor_checks_rods_alone_where_no_solver_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    light = dict.fromkeys(doctor.required(""), "99")
    monkeypatch.setattr(doctor, "installed", light.get)
    monkeypatch.setattr(doctor, "check", lambda subject: Finding(subject, True, "seen"))
    subjects = [finding.subject for finding in doctor.examine()]
    assert {"solver", "rods"} <= set(subjects)
    assert not {"gmsh", "scikit-fem", "linear solver"} & set(subjects)


def test_a_closed_terminal_does_not_end_what_was_started_with_nohup(monkeypatch: pytest.MonkeyPatch) -> None:
    handlers = {signal.SIGTERM: signal.SIG_DFL, signal.SIGHUP: signal.SIG_IGN}
    monkeypatch.setattr(signal, "getsignal", handlers.__getitem__)
    monkeypatch.setattr(signal, "signal", handlers.__setitem__)
    monkeypatch.setattr(cli, "_keep_standard_output", lambda: None)
    monkeypatch.setattr(cli, "app", lambda: None)
    cli.main()
    assert handlers == {signal.SIGTERM: signal.default_int_handler, signal.SIGHUP: signal.SIG_IGN}


@pytest.mark.parametrize(
    ("name", "default"),
    [
        *(("run", "results/NAME"), ("mesh", "results/NAME_mesh"), ("effects", "results/NAME_effects")),
        *(("accuracy", "results/NAME_accuracy"), ("cell", "results/NAME_cell"), ("sweep", "results/NAME")),
        *(("run", "number of cores, at most 3"), ("effects", "number of cores, at most 2"), ("cell", "1")),
        *(("accuracy", "number of cores, at most 2"), ("sweep", "number of cores")),
        *(("export", "DIR"), ("export", "all pressures of the rod"), ("init", "my_FAMILY.yaml")),
    ],
)
def test_the_help_shows_the_defaults_that_the_program_finds(name: str, default: str) -> None:
    assert f"(default: {default})" in " ".join(done(name, "--help").split())
