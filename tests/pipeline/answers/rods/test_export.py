"""The rod to take in the files of other programs: which rod, its error, and one sentence for what does not fit."""

import json
import re
import runpy
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import pneurod
from fem.materials import LAWS, Constant
from pipeline.answers.rods.export import distance, judged, references
from pipeline.answers.rods.solid import solid_of, young_modulus
from pipeline.results.files import read_results
from pipeline.show.drawing import write_fields
from rod import Relaxation, RodError
from rod.load import Load
from rod.weight import Mass
from tests.coarse import COARSE, coarse_run, copy_with
from tests.commands import done, refused
from tests.measured_arm import result_folder, with_body
from tests.pipeline.answers.rods.test_budget import scaled_law
from tests.rod.arm_law.test_space_law import LENGTH as LENGTH_IN_SPACE
from tests.rod.arm_law.test_space_law import law as law_in_space

#: constants of any law
VALUES: dict[Constant, Any] = {
    Constant.STRESS: 0.01,
    Constant.POSITIVE_STRESS: 0.4,
    Constant.POISSON_RATIO: 0.45,
    Constant.STRESSES: (0.4,),
    Constant.EXPONENTS: (2.0,),
}


def error_in(out: str) -> float:
    """The error of the file over the length."""
    [percent] = re.findall(r"Error of the file: ([\d.e-]+) % of the length", out)
    return 0.01 * float(percent)


@pytest.mark.parametrize("target", ["csv", "json", "pyelastica", "mujoco", "somo", "sorosim"])
def test_the_rod_to_take_is_written_with_its_error(tmp_path: Path, target: str) -> None:
    command = ("export", str(COARSE), "--to", target, "--out", str(tmp_path))
    out = done(*command)
    written = [Path(line[9:]) for line in out.splitlines() if line.startswith("written: ")]
    assert sorted(written) == sorted(tmp_path.iterdir())
    if target == "csv":
        assert "json has both ends of the arm" in out
    else:
        assert error_in(out) < 0.01
    assert ("loss factor 0.1 (the default of material.loss_factor)" in out) == (target in ("mujoco", "pyelastica"))
    before = {file: file.read_bytes() for file in written}
    assert "exists; give another --out, or --force" in refused(*command)
    assert {file: file.read_bytes() for file in written} == before
    if target == "mujoco":  # the module alone is a file that exists, too
        written[0].unlink()
        refused(*command)
        assert not written[0].exists()


def test_a_dead_force_is_told_by_its_numbers() -> None:
    run = read_results(COARSE)
    pushed = replace(run.validation_curves[0], experiment="dead", load="in other words", force_N=(0.0, -0.002))
    found = [*references(replace(run, validation_curves=(*run.validation_curves, pushed)))]
    assert (found[-1].force, found[-1].load) == ((0.0, -0.002), "0, -0.002 N")
    assert len(found) == len([*references(run)]) + 1  # those of a held end are none


def test_the_stated_error_is_the_largest_one(tmp_path: Path) -> None:
    """The json of the chain, unloaded, at the pressures of II, against the finite elements."""
    out = done("export", str(COARSE), "--to", "json", "--out", str(tmp_path))
    [file] = tmp_path.iterdir()
    chain = json.loads(file.read_text())["chain"]
    found = []
    for state in references(read_results(COARSE)):
        k = chain["pressures_kPa"].index(state.pressure_kPa)
        turn = np.cumsum(np.array(chain["angle_rad"][k])[chain["kind"], chain["rest"]])
        where = np.array(chain["base_m"][k]) + np.zeros((len(turn), 2))
        legs, points = np.array(chain["legs_m"][k]), np.array(chain["points_m"][k])
        matrices = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        where[1:] += np.cumsum(np.einsum("ijk,kj->ki", matrices[..., :-1], legs), axis=0)
        where += np.einsum("ijk,kj->ki", matrices, points)
        s = 1e3 * np.array(chain["s_m"])
        found.append(distance(1e3 * where, s, state, s[-1]))
    assert len(found) > 1
    assert max(found) == pytest.approx(error_in(out), rel=0.05)


def test_the_five_parameters_are_written_on_request_and_their_error_is_larger(tmp_path: Path) -> None:
    command = ("export", str(COARSE), "--to", "mujoco", "--out", str(tmp_path))
    law, five = (error_in(done(*command, "--rod", rod)) for rod in ("law", "five"))
    assert five > 5.0 * law
    assert {file.name for file in tmp_path.glob("*.xml")} == {"rod_mujoco_0_to_37kPa.xml", "rod_mujoco_17_to_37kPa.xml"}


def test_a_short_finger_without_five_parameters_is_exported(tmp_path: Path) -> None:
    def without(content: dict[str, Any]) -> dict[str, Any]:
        kept = ("format", "material", "solid_volume_mm3", "length_mm", "mass_g")
        return {**{key: content[key] for key in kept}, "pressures_kPa": []}

    folder = copy_with(tmp_path / "arm", "parameters.json", without)
    rows = json.loads((folder / "validation.json").read_text())
    (folder / "validation.json").write_text(json.dumps([row for row in rows if row["rod"] == "arm_law"]))
    for target in ("mujoco", "pyelastica", "json"):
        done("export", str(folder), "--to", target)
    sentence = refused("export", str(folder), "--to", "mujoco", "--rod", "five", "--force")
    assert "holds no parameters of a rod" in sentence


@pytest.mark.parametrize("name", sorted(LAWS))
@pytest.mark.parametrize("given", [{}, {"holds_between": [0.8, 1.4], "loss_factor": 0.25}], ids=["", "with_range"])
def test_every_material_law_is_exported(tmp_path: Path, name: str, given: dict[str, Any]) -> None:
    constants = {key: VALUES[kind] for key, kind in LAWS[name].constants().items()}
    constants |= {"kappa": 20.0} if "kappa" in constants else {}

    def change(content: dict[str, Any]) -> None:
        content["material"] = {"law": name, **constants, "density_tonne_mm3": 1e-9, **given}

    folder = copy_with(tmp_path / "arm", "parameters.json", change)
    for options in ((), ("--rod", "five")):
        out = done("export", str(folder), "--to", "pyelastica", *options)
        assert f"loss factor {given.get('loss_factor', 0.1)}" in out


@pytest.mark.parametrize(("target", "above"), [("mujoco", "more"), ("pyelastica", "less")])
def test_relaxing_rubber_damps_an_export_as_at_its_first_vibration(tmp_path: Path, target: str, above: str) -> None:
    """A branch whose loss factor falls with the frequency; without one nothing is said."""
    branch = {"relaxation_g": [0.3], "relaxation_tau_s": [0.5]}
    folder = copy_with(tmp_path / "arm", "parameters.json", lambda content: content["material"].update(branch))
    out = done("export", str(folder), "--to", target)
    told = re.search(r"Damping: loss factor ([\d.]+) at the first vibration", out)
    frequency = float(pneurod.read_results(folder).frequencies["frequency_1_Hz"].mean())
    assert float(told[1]) == pytest.approx(float(Relaxation((0.3,), (0.5,)).loss_factor(frequency)), rel=0.25)
    assert f"Higher vibrations lose {above} there than the rubber" in out
    assert "Higher vibrations" not in done("export", str(COARSE), "--to", target, "--out", str(tmp_path))


@pytest.mark.slow
def test_every_law_that_pneurod_material_fits_is_run_and_exported(tmp_path: Path) -> None:
    """All laws, from the tensile tests to a file that is near its rod."""
    tensile = str(COARSE.parents[2] / "configs" / "elastosil_m4601_yeoh.csv")
    done("material", tensile, "--density", "1130 kg/m^3", "--out", str(tmp_path / "material"))
    laws = json.loads((tmp_path / "material" / "material.json").read_text(encoding="utf-8"))["laws"]
    lines = [law["yaml"].removeprefix("material:") for law in laws if law["yaml"]]  # none for hencky and svk
    assert {name for name in LAWS if any(f"law: {name}" in line for line in lines)} == set(LAWS) - {"hencky", "svk"}
    for number, line in enumerate(lines):
        folder, config = tmp_path / f"run_{number}", tmp_path / f"arm_{number}.yaml"
        config.write_text(
            f"name: arm\ngeometry: {{family: pneunet, chambers: 4}}\nmaterial: {line}\npressures: [6 kPa]\n"
            "mesh: {size: 8 mm, formulation: p2p0}\nlaw: cell\naccuracy: 'off'\nvalidation: 'off'\n",
            encoding="utf-8",
        )
        done("run", str(config), "--out", str(folder))
        for target in ("mujoco", "pyelastica", "json", "csv", "somo", "sorosim"):
            out = done("export", str(folder), "--to", target)
            found = re.findall(r"deviates from its rod by at most ([\d.e-]+) %", out)
            assert all(float(percent) < 1.0 for percent in found), line
            assert found or target in ("csv", "json")


def test_a_law_that_turns_against_its_moment_cannot_be_a_chain(tmp_path: Path) -> None:
    def change(content: dict[str, Any]) -> None:
        for curve in content["clamp"]["curves"]:
            curve["rotation_rad"] = [-value for value in np.linspace(0.0, 3.0, len(curve["rotation_rad"]))]

    folder = copy_with(tmp_path / "arm", "law.json", change)
    assert "does not turn as its moment" in refused("export", str(folder), "--to", "mujoco")


def test_one_pressure_has_a_file_of_its_own(tmp_path: Path) -> None:
    command = ("export", str(COARSE), "--out", str(tmp_path), "--to")
    for target, names in {
        "mujoco": {"rod_mujoco_27kPa.xml", "rod_mujoco_27kPa.py"},
        "somo": {"rod_somo_27kPa.yaml", "rod_somo_27kPa.urdf"},
        "json": {"law_27kPa.json"},
    }.items():
        done(*command, target, "--pressure", "27 kPa")
        assert names <= {file.name for file in tmp_path.iterdir()}


def test_the_section_of_a_body_is_that_of_its_mesh(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    shutil.copytree(COARSE, folder)
    round_one = solid_of(read_results(folder))
    assert round_one.section.width == pytest.approx(2.0 * round_one.radius)
    # half a box of 112 x 10 x 6 mm in five tetrahedra, from y = -2 mm on
    corners = np.array([[x, y, z] for x in (0.0, 112.0) for y in (-2.0, 8.0) for z in (0.0, 3.0)])
    tetrahedra = [[0, 1, 2, 4], [3, 1, 2, 7], [5, 1, 4, 7], [6, 2, 4, 7], [1, 2, 4, 7]]
    write_fields(folder / "mesh.vtu", corners, np.array(tetrahedra))
    solid = solid_of(read_results(folder))
    height = read_results(folder).curves_of("II")[0]["y_mm"][0]
    section = solid.section
    assert (section.low, section.high, section.width) == pytest.approx((-2.0 - height, 8.0 - height, 6.0))
    assert section.centre == pytest.approx(3.0 - height)
    assert section.spread == pytest.approx((100.0 / 12.0, 36.0 / 12.0))
    with pytest.raises(RodError, match="is not a law with its constants"):
        young_modulus({"law": "svk", "E": 1.2})


def test_an_arm_with_three_pressures_goes_to_mujoco_and_nowhere_else(tmp_path: Path) -> None:
    law: Any = replace(law_in_space(), mass=Mass.even(LENGTH_IN_SPACE, 12.0))
    folder = with_body(result_folder(tmp_path / "three", law))
    out = done("export", str(folder), "--to", "mujoco")
    assert "set_pressure takes those of a, b, c in kPa" in " ".join(out.split())
    assert (folder / "rod_mujoco_0_to_10kPa.xml").is_file()
    module = runpy.run_path(str(folder / "rod_mujoco_0_to_10kPa.py"))
    model, data = module["load"]((4.0, 3.0, 1.0))
    assert 1e3 * sum(model.body_mass) == pytest.approx(12.0)
    assert 1e3 * data.site("tip").xpos == pytest.approx(law.at((4.0, 3.0, 1.0)).solve_in_space(Load()).end, abs=0.01)
    in_plane = refused("export", str(folder), "--to", "pyelastica")
    assert "takes a law in a plane, and this one is in space" in in_plane
    at_one = refused("export", str(folder), "--to", "mujoco", "--pressure", "5 kPa", "--force")
    assert "the file has the arm's own law at every pressure" in at_one


def test_of_a_design_its_run_is_exported(tmp_path: Path) -> None:
    shutil.copytree(COARSE, tmp_path / "design" / "run")
    (tmp_path / "design" / "design.json").write_text("{}", encoding="utf-8")
    done("export", str(tmp_path / "design"), "--to", "json", "--out", str(tmp_path / "files"))
    done("solve", str(tmp_path / "design"), "--angle", "30 deg")


def test_the_weight_of_a_run_is_left_to_the_other_program(tmp_path: Path) -> None:
    """A law measured with gravity on: its file is that of the same law without."""
    heavy = copy_with(tmp_path / "arm", "law.json", lambda content: content | {"weight_N_per_mm": [0.0, -1e-4]})
    found = {}
    for folder, out in ((COARSE, "without"), (heavy, "with")):
        printed = done("export", str(folder), "--to", "json", "--out", str(tmp_path / out))
        assert ("let gravity act in the other program" in printed) == (out == "with")
        found[out] = error_in(printed)
    assert found["with"] > 3.0 * found["without"]  # judged with weight, against finite elements without it
    files = [next((tmp_path / out).glob("*.json")).read_text(encoding="utf-8") for out in ("without", "with")]
    assert files[0] == files[1]


def test_a_file_beside_its_rod() -> None:
    at = SimpleNamespace(rigidity=300.0, solve=lambda *_: 0.0, curve=lambda _: 0.0, s=[0.0, 112.0])
    robot: Any = SimpleNamespace(has=lambda _: False, known=(), length=112.0, solid=None, at=lambda _: at)
    told = judged(robot, coarse_run(), scaled_law())
    assert told.endswith(
        "Under small tip forces (EI/50l², EI/10l²) the file deviates from its rod by at most 0 % of the length."
    )


def test_the_modulus_of_an_exported_rod_is_that_of_its_law() -> None:
    material = {"law": "neo_hooke", "mu": 0.02, "kappa": 2.0, "density_tonne_mm3": 1e-9}
    assert young_modulus(material) == pytest.approx(9 * 2.0 * 0.02 / (3 * 2.0 + 0.02))
