"""Exported arms that turn out of their plane: opened in their programs under a small force across it."""

import json
import runpy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

from pipeline.results.laws import law_of_record
from rod import ArmLaw
from rod.arm_law.curves import IN_SPACE
from rod.export.chain import chain_of_law
from rod.export.formats import export_robot
from rod.export.in_space import Part
from rod.export.robot import Robot
from rod.load import Load
from tests.coarse import COARSE
from tests.rod.arm_law.test_arm_law import law_of, straight_law
from tests.rod.test_export import SOLID

#: B_2 and GJ (N mm2), GA (N), twist axis (mm) and the difference of tilts
GIVEN = dict(zip(IN_SPACE, (1500.0, 350.0, 14.0, 1.5, 0.0), strict=True))
CLAMP = np.array([[4e-3, -5e-4], [-5e-4, 2e-3]])
#: N, across the plane; it moves the end by about half a millimetre
FORCE = 1e-3


def in_space(planar: ArmLaw, clamp: np.ndarray = CLAMP, **changes: float) -> ArmLaw:
    """A law with the same rigidities out of the plane everywhere, and the other numbers of a planar one."""
    values = GIVEN | changes
    cells = (replace(cell, **{k: np.full(len(cell.moment), v) for k, v in values.items()}) for cell in planar.cells)
    clamps = (replace(one, lateral_compliance=clamp) for one in planar.clamps)
    return replace(planar, cells=tuple(cells), clamps=tuple(clamps))


@pytest.fixture(scope="module")
def planar() -> ArmLaw:
    """That of the coarse arm of eleven chambers."""
    return law_of_record(json.loads((COARSE / "law.json").read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def spatial(planar: ArmLaw) -> ArmLaw:
    return in_space(planar)


def test_the_hinge_of_a_straight_part_has_its_compliances_and_lies_in_its_middle() -> None:
    part = Part(np.array([2.0, 3.0]), 0.0, 10.0, 0.0, 1.1, np.zeros(2))
    compliance, centre = part.turns(GIVEN, np.zeros((2, 2)))
    assert compliance == pytest.approx(np.diag([10.0 / 350.0, 10.0 / 1500.0]))
    assert centre == pytest.approx([2.0 + 0.5 * 11.0, 3.0 + 1.5])
    _, centre = part.turns(GIVEN, np.diag([0.0, 10.0 / 1500.0]))
    assert centre == pytest.approx([2.0 + 0.25 * 11.0, 4.5])


def test_the_planar_chain_is_the_same_with_rigidities_out_of_the_plane(planar: ArmLaw, spatial: ArmLaw) -> None:
    without, chain = (chain_of_law(one.at(27.0), 20) for one in (planar, spatial))
    assert without.space is None
    assert chain.space is not None
    for name in ("base", "legs", "points", "angle", "moment"):
        assert np.array_equal(getattr(without, name), getattr(chain, name)), name
    tables = [Robot.of_law(one, SOLID, one.pressures).table for one in (planar, spatial)]
    assert {name: tables[1][name] for name in tables[0]} == tables[0]
    more = set(tables[1]) - set(tables[0])
    assert more == {"sideways_axis_rad", "sideways_centre_m", "twist_N_m", "sideways_N_m", "sideways_shear_N"}


def test_an_arm_that_is_not_stable_out_of_its_plane_at_some_pressure_is_exported_in_it(planar: ArmLaw) -> None:
    spatial = in_space(planar)
    last = in_space(planar, torsional_rigidity=-300.0).cells[-1]
    table = Robot.of_law(replace(spatial, cells=(*spatial.cells[:-1], last)), SOLID, spatial.pressures).table
    assert table == Robot.of_law(planar, SOLID, planar.pressures).table


def pushed(module: Path, pressure: float, force: float) -> tuple[np.ndarray, np.ndarray]:
    """The end, (3,) mm, in MuJoCo at rest under a force along z on it, and how it turned about x and y, (2,) rad."""
    mujoco = pytest.importorskip("mujoco")
    program = runpy.run_path(str(module))
    model, data = program["load"](pressure)
    model.opt.gravity[:] = 0.0
    model.dof_damping *= 5.0  # at rest sooner
    tip = model.site("tip")
    mujoco.mj_forward(model, data)
    before = data.site_xmat[tip.id].reshape(3, 3).copy()
    for step in range(8000):
        data.qfrc_applied[:] = 0.0
        point = data.site_xpos[tip.id].copy()
        mujoco.mj_applyFT(
            model, data, np.array([0.0, 0.0, force]), np.zeros(3), point, tip.bodyid[0], data.qfrc_applied
        )
        mujoco.mj_step(model, data)
        if step > 500 and np.abs(data.qvel).max() < 1e-7:
            break
    return 1e3 * data.site_xpos[tip.id], turn_of(before, data.site_xmat[tip.id].reshape(3, 3))


def turn_of(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(2,) rad, about x and y, between frames (3, 3) little apart."""
    turn = second @ first.T
    return 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0]])


@pytest.mark.parametrize("pressure", [17.0, 30.0, 37.0])
def test_an_arm_in_mujoco_moves_out_of_its_plane_as_the_rod(spatial: ArmLaw, tmp_path: Path, pressure: float) -> None:
    _, module = export_robot(Robot.of_law(spatial, SOLID, spatial.pressures), "mujoco", tmp_path)
    rod = spatial.at(pressure)
    planar, found = (rod.solve_in_space(Load((0.0, 0.0, force))) for force in (0.0, FORCE))
    end, turn = pushed(module, pressure, FORCE)
    assert found.end[2] > 0.4
    assert end[2] == pytest.approx(found.end[2], rel=0.02)
    assert end[:2] == pytest.approx(found.end[:2], abs=0.2)  # between the pressures of the file
    expected = turn_of(planar.frames[-1], found.frames[-1])
    assert turn == pytest.approx(expected, abs=0.03 * float(np.linalg.norm(expected)))


def test_a_straight_arm_in_mujoco_bends_as_a_beam(tmp_path: Path) -> None:
    """F l^3 / (3 B), the turn of the clamp, and shear."""
    law = in_space(law_of(straight_law(0.0), straight_law(10.0)), np.diag([0.0, 1e-3]))
    _, module = export_robot(Robot.of_law(law, SOLID, law.pressures), "mujoco", tmp_path)
    end, _ = pushed(module, 5.0, 1e-3)
    twisted = 110.0 * GIVEN["twist_axis"] ** 2 / GIVEN["torsional_rigidity"]
    by_force = 110.0**3 / 3.0 / GIVEN["lateral_rigidity"] + 110.0**2 * 1e-3 + 110.0 / GIVEN["lateral_shear_rigidity"]
    assert end[2] == pytest.approx(1e-3 * (by_force + twisted), rel=5e-3)


def test_the_file_for_mujoco_is_the_module_out_of_the_plane_too(spatial: ArmLaw, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    file, module = export_robot(Robot.of_law(spatial, SOLID, spatial.pressures), "mujoco", tmp_path)
    alone, (model, _) = mujoco.MjModel.from_xml_path(str(file)), runpy.run_path(str(module))["load"](0.0)
    assert model.njnt == 3 * len(chain_of_law(spatial.at(0.0), 20).s)
    for name in ("jnt_stiffness", "jnt_axis", "jnt_pos", "dof_damping"):
        assert getattr(alone, name) == pytest.approx(getattr(model, name), rel=1e-5, abs=1e-8), name


def program_of(law: ArmLaw, folder: Path) -> Any:
    (file,) = export_robot(Robot.of_law(law, SOLID, law.pressures, has_shear=False), "pyelastica", folder)
    return runpy.run_path(str(file))


@pytest.mark.slow
def test_an_arm_in_pyelastica_moves_out_of_its_plane_as_the_rod(spatial: ArmLaw, tmp_path: Path) -> None:
    pytest.importorskip("elastica")
    program, rod = program_of(spatial, tmp_path), spatial.at(17.0)
    end = 1e3 * program["curve"](program["simulate"](17.0, (0.0, 0.0, FORCE)), 17.0)[-1]
    found = rod.solve_in_space(Load((0.0, 0.0, FORCE)))
    assert end == pytest.approx(found.end, abs=0.03 * found.end[2])


def test_the_program_for_pyelastica_refuses_a_third_component_that_it_does_not_know(
    planar: ArmLaw, spatial: ArmLaw, tmp_path: Path
) -> None:
    pytest.importorskip("elastica")
    with pytest.raises(ValueError, match="nothing is known of this arm out of its plane"):
        program_of(planar, tmp_path)["simulate"](17.0, (0.0, 0.0, 1e-3))
    program, chain = program_of(spatial, tmp_path), chain_of_law(spatial.at(17.0), 20, has_shear=False)
    arm = program["build"](17.0)
    curve = program["curve"](arm, 17.0)
    assert 1e3 * curve[:, :2] == pytest.approx(chain.curve(chain.neutral), abs=1e-4)
    assert np.abs(curve[:, 2]).max() == 0.0
    between = 1e3 * arm.rest_voronoi_lengths
    assert 1e9 * arm.bend_matrix[2, 2, 5] / between[5] == pytest.approx(1e3 * chain.space.twist[5], rel=1e-2)
    assert 1e9 * arm.bend_matrix[1, 1, 5] / between[5] == pytest.approx(1e3 * chain.space.bend[5], rel=1e-2)


def test_sorosim_has_the_rigidities_out_of_the_plane(planar: ArmLaw, spatial: ArmLaw, tmp_path: Path) -> None:
    content = []
    for one in (planar, spatial):
        robot = Robot.linear_of_law(one, SOLID, (17.0, 37.0))
        content.append(loadmat(export_robot(robot, "sorosim", tmp_path)[0])["rod"][0, 0])
    without, both = content
    assert np.array_equal(without["xi_star"], both["xi_star"])
    assert "GJ" not in without.dtype.names
    # within a piece the axes turn a little
    assert 1e6 * both["GJ"][-1] == pytest.approx(GIVEN["torsional_rigidity"], rel=1e-3)
    assert 1e6 * both["EI_y"][-1] == pytest.approx(GIVEN["lateral_rigidity"], rel=1e-3)
    assert np.all(both["GJ"][0] < both["GJ"][-1])
