"""The wheel contains every source file and every file that the sources read, and runs where there are no sources."""

import json
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent.parent
ROOMS = ("geometry", "fem", "rod", "pipeline", "pneurod")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built of the sources as they are."""
    folder = tmp_path_factory.mktemp("wheel")
    sources = folder / "sources"
    for room in ROOMS:
        for path in (HERE / room).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                copy = sources / path.relative_to(HERE)
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_bytes(path.read_bytes())
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        (sources / name).write_bytes((HERE / name).read_bytes())
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"]
    subprocess.run([*command, str(folder), str(sources)], check=True, capture_output=True, text=True)
    [built] = folder.glob("*.whl")
    return built


def test_the_wheel_holds_every_source_file(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        inside = {name for name in archive.namelist() if name.partition("/")[0] in ROOMS}
    sources = {
        str(path.relative_to(HERE))
        for room in ROOMS
        for path in (HERE / room).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert len(sources) > 130
    assert inside == sources


DESIGN = """
name: short
geometry: {family: pneunet, chambers: 7}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [10 kPa]
law: five
validation: off
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
"""


@dataclass(frozen=True)
class Installed:
    """The wheel in a virtual environment of its own, far from the sources."""

    python: Path  #: the interpreter of the environment
    packages: Path  #: its site-packages
    folder: Path  #: an empty folder to work in

    def ended(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """The interpreter with these arguments in the empty folder, without the variables of this process and git."""
        environment = {"PATH": str(self.python.parent), "HOME": str(self.folder), "COLUMNS": "120"}
        for library in sorted((Path(sys.prefix) / "lib").glob("libmkl_rt.so*")):
            environment["PYPARDISO_MKL_RT"] = str(library)  # it stands outside site-packages
        command = [str(self.python), *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=self.folder, env=environment)

    def output(self, *arguments: str) -> str:
        """What it prints; it must succeed."""
        done = self.ended(*arguments)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """A fresh environment with the wheel; the libraries are those of the environment that runs the tests."""
    folder = tmp_path_factory.mktemp("elsewhere")
    subprocess.run([sys.executable, "-m", "venv", str(folder / "venv")], check=True)
    python = folder / "venv" / "bin" / "python"
    install = [str(python), "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", str(wheel)]
    subprocess.run(install, check=True, capture_output=True, text=True)
    [packages] = (folder / "venv" / "lib").glob("python*/site-packages")
    # a path file adds the libraries, and not what their own path files add: no editable installation of the sources
    (packages / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    (folder / "work").mkdir()
    return Installed(python, packages, folder / "work")


@pytest.mark.slow
def test_the_installed_package_is_the_one_that_is_imported(installed: Installed) -> None:
    program = f"import {', '.join(ROOMS)}\nprint(*(room.__file__ for room in ({', '.join(ROOMS)})), sep='\\n')"
    files = [Path(line) for line in installed.output("-c", program).splitlines()]
    assert len(files) == len(ROOMS)
    assert all(file.is_relative_to(installed.packages) for file in files)


@pytest.mark.slow
def test_the_console_script_and_the_doctor_work_anywhere(installed: Installed) -> None:
    script = str(installed.python.parent / "pneurod")
    assert "characterize" not in installed.output(script, "--help")
    assert "Usage: pneurod" in installed.output(script, "--help")
    assert "everything pneurod needs is here" in installed.output("-m", "pneurod", "doctor")


#: read, bent, moved, asked and exported, with a finder that knows no package of the solver
RODS = """
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {absent}:
            raise ModuleNotFoundError(f'No module named {{name!r}}', name=name)
sys.meta_path.insert(0, Absent())
import pneurod
arm = pneurod.read_results('stored')
print(arm.rod(20.0).solve(force=(0.0, -0.01)).s[-1], len(arm.move('20 kPa', seconds=0.02)))
print(pneurod.solve(arm, angle='20 deg').solutions[0].pressure_kPa > 0.0, arm.export('csv', out='rod')[0].name)
try:
    pneurod.mesh('design.yaml')
except ModuleNotFoundError as refused:
    print(refused)
"""


@pytest.mark.slow
def test_rods_of_a_stored_folder_need_no_package_of_the_solver(installed: Installed) -> None:
    shutil.copytree(HERE / "tests" / "data" / "results_coarse", installed.folder / "stored")
    absent = ("skfem", "ipctk", "pypardiso", "gmsh", "trimesh", "pyvista", "vtkmodules", "dask", "distributed")
    said = installed.output("-c", RODS.format(absent=(*absent, "matplotlib"))).splitlines()
    assert said[1].startswith("True ")
    assert said[2] == "bodies and finite elements need the solver, which pip install 'pneurod[solve]' brings"


@pytest.mark.slow
def test_a_design_runs_far_from_the_sources(installed: Installed) -> None:
    """Templates are inside, states have a key without a clone, and the commit is unknown without git."""
    (installed.folder / "design.yaml").write_text(DESIGN, encoding="utf-8")
    script, command = str(installed.python.parent / "pneurod"), ("run", "design.yaml", "--out", "results")
    assert "report: results/report.html" in installed.output(script, *command)
    results = installed.folder / "results"
    record = json.loads((results / "run.json").read_text(encoding="utf-8"))
    assert record["commit"] is None
    assert record["pneurod"] == metadata.version("pneurod")
    parameters = json.loads((results / "parameters.json").read_text(encoding="utf-8"))
    assert parameters["alpha2_N_mm2"][0] > 0.0
    assert "<h1>" in (results / "report.html").read_text(encoding="utf-8")
    states = {path: path.stat().st_mtime_ns for path in (results / "states").glob("*.npz")}
    assert {path.name for path in states} == {"I_10kPa.npz", "II_10kPa.npz", "III_10kPa.npz"}
    with np.load(results / "states" / "III_10kPa.npz") as state:
        assert len(str(state["state_key"])) == 64
    installed.output(script, *command)
    assert {path: path.stat().st_mtime_ns for path in states} == states  # read, not solved again
    program = "import pneurod\nprint(pneurod.read_results('results').parameters['alpha2_N_mm2'].iloc[0])"
    assert float(installed.output("-c", program)) == parameters["alpha2_N_mm2"][0]


@pytest.mark.slow
@pytest.mark.parametrize("editable", [False, True])
def test_a_type_checker_sees_the_types_of_the_installed_package(
    installed: Installed, wheel: Path, editable: bool
) -> None:
    program = installed.folder / "program.py"
    if editable:  # the sources beside the wheel, in place of what the wheel holds
        build = "from setuptools.build_meta import build_editable; print(build_editable('.'))"
        command = [sys.executable, "-W", "ignore", "-c", build]
        built = subprocess.run(command, check=True, capture_output=True, text=True, cwd=wheel.parent / "sources")
        path = wheel.parent / "sources" / built.stdout.split()[-1]
        installed.output("-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--force-reinstall", str(path))
        assert not (installed.packages / "pneurod").exists()
    program.write_text(
        "import pneurod\n"
        "law = pneurod.FiveParameters(alpha1=2.0, alpha2=1.0, m01=0.1, m02=-0.05, d=0.13)\n"
        "reveal_type(pneurod.Rod(1.0, 2.0, law).solve(force=(0.5, -1.0)).s)\n"
        "reveal_type(pneurod.read_results('results').length_mm)\n"
        "pneurod.characterise\n",
        encoding="utf-8",
    )
    options = ["--python-executable", str(installed.python), "--cache-dir", str(installed.folder / "cache")]
    command = [sys.executable, "-m", "mypy", "--no-incremental", *options, program.name]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=installed.folder)
    errors = [line for line in done.stdout.splitlines() if ": error: " in line and str(program.name) in line]
    assert "ndarray" in done.stdout
    assert 'Revealed type is "float"' in done.stdout.replace("builtins.", "")
    assert len(errors) == 1
    assert 'has no attribute "characterise"' in errors[0]
