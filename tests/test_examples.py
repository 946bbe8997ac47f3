"""The programs in examples/ run, print the expected output, and write the files that they name."""

import os
import re
import subprocess
import sys
from pathlib import Path

import jupytext
import pytest

HERE = Path(__file__).resolve().parent.parent
EXAMPLES = HERE / "examples"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("examples")


@pytest.fixture(scope="module")
def own_arm(folder: Path) -> str:
    return output_of("own_arm", "arm", cwd=folder)


def output_of(name: str, *arguments: str, cwd: Path) -> str:
    """What the program prints on standard output; warnings are errors in it, and standard error must stay empty.

    The errors of its coarse rods, which a `RodWarning` tells, are allowed.
    """
    environment = {**os.environ, "PYTHONPATH": str(HERE), "MPLBACKEND": "agg"}
    command = [
        sys.executable,
        "-W",
        "error",
        "-W",
        "ignore::UserWarning:__main__",  # Python reads -W before it finds the packages: not rod.RodWarning
        str(EXAMPLES / f"{name}.py"),
        *arguments,
    ]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=cwd, env=environment)
    assert (ended.returncode, ended.stderr) == (0, "")
    return ended.stdout


def test_every_example_is_tested() -> None:
    names = {path.stem for path in EXAMPLES.glob("*.py")}
    runs = {"own_arm", "own_material", "own_mesh", "rod_in_pyelastica", "gripper"}
    assert names == {*runs, "compare_materials", "rod_alone"}
    readme = (HERE / "README.md").read_text(encoding="utf-8")
    makefile = (HERE / "Makefile").read_text(encoding="utf-8")
    assert "examples/" in readme
    assert all(name in makefile for name in names)


@pytest.mark.slow  # a whole run; tests/pneurod/test_public_api.py calls what it calls
def test_own_arm_prints_its_parameters_and_draws_them(own_arm: str, folder: Path) -> None:
    table = re.findall(r"^(\d+\.\d) +(\d+\.\d+) +(\d+\.\d+) +(\d+\.\d+)", own_arm, flags=re.MULTILINE)
    assert [row[0] for row in table] == ["10.0", "20.0"]
    assert all(100.0 < float(row[3]) < 1000.0 for row in table)  # alpha2, N mm2
    distances = [float(text) for text in re.findall(r"the rod is within (\d+\.\d) %", own_arm)]
    assert len(distances) == 2
    assert max(distances) < 5.0
    [moved] = re.findall(r"5 g at the tip move it by (-\d+\.\d) mm", own_arm)
    assert -20.0 < float(moved) < -1.0
    assert (folder / "arm" / "own_arm.png").stat().st_size > 10_000
    assert (folder / "arm" / "report.html").is_file()


def test_own_material_meets_its_closed_form(folder: Path) -> None:
    printed = output_of("own_material", cwd=folder)
    rows = re.findall(r"^ +(\d\.\d\d) +(\d\.\d+) MPa +(\d\.\d+) MPa +(-?\d\.\d\d) %$", printed, flags=re.MULTILINE)
    assert [row[0] for row in rows] == ["1.25", "1.50", "1.75", "2.00"]
    assert all(abs(float(row[3])) < 0.1 for row in rows)
    [rest] = re.findall(r"with the change of volume: (-?\d\.\de[-+]\d+)", printed)
    assert abs(float(rest)) < 1e-6


@pytest.mark.slow  # it needs the run of the example before
def test_the_rod_alone_bends_in_milliseconds(own_arm: str, folder: Path) -> None:
    assert own_arm
    printed = output_of("rod_alone", "arm", cwd=folder)
    rows = re.findall(r"^ +(0\.\d{3}) +(-?\d+\.\d\d) +(-?\d+\.\d\d)", printed, flags=re.MULTILINE)
    heights = [float(row[2]) for row in rows]
    assert len(heights) == 6
    assert heights == sorted(heights)  # the larger the force, the higher the tip
    [pace] = re.findall(r"^(\d+\.\d\d) ms per shape$", printed, flags=re.MULTILINE)
    assert float(pace) < 10.0
    assert "own_arm at 15 kPa under 0.05 N: tip at (" in printed


def test_the_rod_alone_needs_no_run(folder: Path) -> None:
    assert "needs F_y = " in output_of("rod_alone", cwd=folder)


@pytest.mark.slow  # two whole runs, as the example before makes one
def test_two_laws_give_two_sets_of_parameters(folder: Path) -> None:
    printed = output_of("compare_materials", "laws", cwd=folder)
    rows = dict(re.findall(r"^(svk|hencky) +(\d+\.\d+)", printed, flags=re.MULTILINE))
    assert set(rows) == {"svk", "hencky"}
    ends = {name: float(y) for name, y in re.findall(r"^(\w+): the free end is at y = (-\d+\.\d) mm$", printed, re.M)}
    assert ends["hencky"] < ends["svk"]  # St. Venant-Kirchhoff is stiffer in tension
    assert (folder / "laws" / "compare_materials.png").stat().st_size > 5_000


def test_the_finite_elements_alone_take_a_mesh_of_the_user(folder: Path) -> None:
    printed = output_of("own_mesh", "block", cwd=folder)
    rows = re.findall(r"^ +(\d+\.\d) +(-\d\.\d{3}) +(\d+\.\d) +(0\.\d{4})$", printed, flags=re.MULTILINE)
    assert [row[0] for row in rows] == ["5.0", "10.0", "15.0", "20.0"]
    heights = [float(row[1]) for row in rows]
    assert heights == sorted(heights, reverse=True)  # downwards, the more the larger the pressure
    [force] = re.findall(r"force on the clamp: (\S+) N", printed)
    assert float(force) < 1e-9


@pytest.mark.slow  # tests/rod/test_export.py runs an exported program
def test_the_rod_has_the_same_shape_in_pyelastica(folder: Path) -> None:
    printed = output_of("rod_in_pyelastica", "elastica", cwd=folder)
    [(distance, part)] = re.findall(r"^largest distance (\d\.\d+) mm, (\d\.\d+) % of the length$", printed, re.M)
    assert float(distance) > 0.0
    assert float(part) < 0.3
    assert (folder / "elastica" / "rod_in_pyelastica.png").stat().st_size > 5_000


def test_two_fingers_hold_and_lift_a_cylinder(folder: Path) -> None:
    printed = output_of("gripper", "gripper", cwd=folder)
    [(lifted, slip)] = re.findall(r"lifted by (\d+\.\d) mm, and slips by (\d\.\d+) mm", printed)
    assert float(lifted) == pytest.approx(38.0, abs=2.0)
    assert float(slip) < 0.1
    [forces] = re.findall(r"press with (\S+) and (\S+) N", printed)
    assert all(0.05 < float(force) < 1.0 for force in forces)
    assert (folder / "gripper" / "gripper.png").stat().st_size > 10_000


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_every_example_opens_as_a_notebook(path: Path) -> None:
    notebook = jupytext.read(path)
    kinds = [cell.cell_type for cell in notebook.cells]
    assert kinds[0] == "markdown"
    assert kinds.count("code") >= 3
    assert notebook.cells[0].source.startswith("# ")
