"""The arm in the files of other programs: loaded, settled under a dead force, compared with the rod."""

import json
import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

from pipeline.results.laws import law_of_record
from rod import ArmLaw, FiveParameters, Rod, RodError
from rod.export.arm import Arm
from rod.export.chain import Chain, chain_of_five, chain_of_law, cut_into_joints, linear_chain_of_law
from rod.export.formats import export_robot
from rod.export.robot import Robot, Section, Solid
from rod.export.tables import arm_table, table, write_csv, write_json, write_law_csv, write_law_json
from rod.load import Load
from tests.coarse import COARSE
from tests.rod.arm_law.test_arm_law import law_of, straight_law
from tests.rod.arm_law.test_space_law import constant
from tests.rod.arm_law.test_space_law import law as law_in_space

FIVE = FiveParameters(150.0, 400.0, -0.8, 0.1, 14.0)
S = np.linspace(0.0, 112.0, 225)
RIPPLE = 1.0 + 0.3 * np.cos(2.0 * np.pi * S / 10.0)
ROD = Rod(112.0, 0.015 * RIPPLE, FIVE, theta0=0.1)
LOWER = Rod(112.0, 0.008 * RIPPLE, FiveParameters(160.0, 300.0, -0.4, 0.1, 12.0), theta0=0.06)
PRESSURES = (17.0, 37.0)
FORCE = (0.01, -0.05)
STD = {"alpha1": (9.0, 8.0), "alpha2": (1.0, 2.0), "m01": (0.3, 0.4), "m02": (0.01, 0.02), "d": (0.5, 0.6)}
SOLID = Solid(16.5, 1.2, 130.0, Section(-1.0, 16.0, 15.0, 4.0, (25.0, 18.0)), 0.1)
#: of the largest distance from the rod over the length
SMALL = 3e-3


def arm() -> Arm:
    return Arm(PRESSURES, (LOWER, ROD), deviations=STD)


@pytest.fixture(scope="module")
def law() -> ArmLaw:
    """That of the coarse arm of eleven chambers."""
    return law_of_record(json.loads((COARSE / "law.json").read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def robot(law: ArmLaw) -> Robot:
    return Robot.of_law(law, SOLID, law.pressures)


def imported(file: Path) -> Any:
    """The names of a Python file."""
    return SimpleNamespace(**runpy.run_path(str(file)))


def small_force(chain: Chain, part: float) -> tuple[float, float]:
    """A force across the end, N, over the rigidity over the square of the length."""
    return 0.0, part * chain.rigidity / chain.s[-1] ** 2


def off(points: np.ndarray, s: np.ndarray, rod: Any, force: tuple[float, float]) -> float:
    """Largest distance of points (m, 2) mm at s from a rod under a force, over the length."""
    return float(np.hypot(*(rod.solve(force=force).positions(s) - points).T).max() / s[-1])


@pytest.mark.parametrize("pressure", [17.0, 30.0, 37.0])
def test_a_chain_lies_on_the_rod_without_load_and_near_it_under_forces(law: ArmLaw, pressure: float) -> None:
    rod, chain = law.at(pressure), chain_of_law(law.at(pressure), 20)
    # the first element of the rod, up to the moment that decides on its clamp, is one element
    assert off(chain.curve(chain.neutral), chain.s, rod, (0.0, 0.0)) < 5e-6
    for part, allowed in ((-0.1, 2e-4), (0.02, 1e-4), (0.1, 2e-4), (0.5, 2e-3)):
        force = small_force(chain, part)
        assert off(chain.curve(chain.solve(force)), chain.s, rod, force) < allowed
    linear = linear_chain_of_law(rod, 60)
    for part in (0.0, 0.1):
        force = small_force(linear, part)
        assert off(linear.curve(linear.solve(force)), linear.s, rod, force) < 3e-3


@pytest.mark.parametrize("weight", [(0.0, -4e-4), (1e-3, 0.0), (-1e-4, 0.0)])
def test_a_chain_with_a_weight_lies_on_the_rod_with_it(law: ArmLaw, weight: tuple[float, float]) -> None:
    chain = chain_of_law(law.at(17.0), 20)
    heavy = replace(law, weight=weight).at(17.0)
    curve = chain.curve(chain.solve(weight=weight, height=law.mass.heights[-1] / law.mass.grams[-1]))
    assert np.abs(curve - chain.curve(chain.neutral)).max() > 1.0
    assert off(curve, chain.s, heavy, (0.0, 0.0)) < 5e-3


def test_shear_moves_a_chain_as_the_rod_under_a_force_across_its_end() -> None:
    """F l^3 / (3 EI) and F l / GA, where the one is a third of the other."""
    law = law_of(
        straight_law(0.0, GA=3.0 * 400.0 * 3.0 / 110.0**2), straight_law(10.0, GA=3.0 * 400.0 * 3.0 / 110.0**2)
    )
    chain, without = (chain_of_law(law.at(5.0), 40, has_shear=has) for has in (True, False))
    force = (0.0, 1e-4)
    ends = [c.curve(c.solve(force))[-1, 1] for c in (chain, without)]
    bent, sheared = 1e-4 * 110.0**3 / 1200.0, 1e-4 * 110.0 / chain.shear
    assert ends == pytest.approx([bent + sheared, bent], rel=2e-3)
    assert law.at(5.0).solve(force=force).end[1] == pytest.approx(ends[0], rel=2e-3)


def test_a_chain_turns_and_stretches_as_a_beam_off_whose_axis_the_neutral_line_lies() -> None:
    """A straight law with an eccentricity: under an axial force F at the end the beam bends by F e l / EI."""
    law = law_of(straight_law(0.0, eccentricity=1.5), straight_law(10.0, eccentricity=1.5))
    chain = chain_of_law(law.at(5.0), 40)
    assert chain.lift == pytest.approx(1.5)
    force = 1e-3
    turn = chain.solve((force, 0.0))
    rod = law.at(5.0).solve(force=(force, 0.0))
    assert turn.sum() == pytest.approx(rod.theta[-1], rel=1e-3)
    assert abs(turn.sum()) == pytest.approx(force * 1.5 * 110.0 / 400.0, rel=0.01)


def test_a_chain_that_would_leave_its_equilibrium_is_refused() -> None:
    """A straight column holds 0.9 times the force of Euler, and not 1.1 times that."""
    chain = chain_of_five(Rod(100.0, 0.0, FiveParameters(2000.0, 2000.0, 0.0, 0.0, 50.0)), 60, 1e6)
    euler = 2000.0 * (0.5 * np.pi / 100.0) ** 2
    assert chain.solve((-0.9 * euler, 0.0)) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(RodError, match="is unstable"):
        chain.solve((-1.1 * euler, 0.0))


def test_springs_rise_through_states_of_the_law_and_are_interpolated_between_pressures(robot: Robot) -> None:
    for chain in robot.chains:
        assert np.all(np.diff(chain.angle) > 0.0)
        assert np.all(np.diff(chain.moment) > 0.0)
        assert np.all(chain.moment[:, chain.rest] == 0.0)
    low, high = robot.pressures[-2:]
    middle = robot.at(0.5 * (low + high))
    assert middle.neutral == pytest.approx(0.5 * (robot.chains[-2].neutral + robot.chains[-1].neutral))
    with pytest.raises(RodError, match=r"goes from 0 to 37 kPa; 40 kPa is outside"):
        robot.at(40.0)


@pytest.fixture(scope="module")
def mujoco_file(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file, module = export_robot(robot, "mujoco", tmp_path_factory.mktemp("mujoco"))
    assert (file.name, module.name) == ("rod_mujoco_0_to_37kPa.xml", "rod_mujoco_0_to_37kPa.py")
    return module


def settled(mujoco: Any, model: Any, data: Any, force: tuple[float, float]) -> np.ndarray:
    """The material curve, (m, 2) mm, at rest under a force on the site `tip`."""
    model.dof_damping *= 5.0  # at rest sooner
    tip = model.site("tip")
    for step in range(8000):
        data.qfrc_applied[:] = 0.0
        point, body = data.site_xpos[tip.id].copy(), tip.bodyid[0]
        mujoco.mj_applyFT(model, data, np.array([*force, 0.0]), np.zeros(3), point, body, data.qfrc_applied)
        mujoco.mj_step(model, data)
        if step > 500 and np.abs(data.qvel).max() < 1e-6:
            break
    sites = [model.site(f"curve{k}").id for k in range(model.nq - 1)] + [tip.id]
    return 1e3 * data.site_xpos[sites, :2]


@pytest.mark.parametrize("pressure", [17.0, 30.0, 37.0])
@pytest.mark.parametrize("part", [0.0, 0.1, -0.1])
def test_mujoco_settles_on_the_rod(law: ArmLaw, robot: Robot, mujoco_file: Path, pressure: float, part: float) -> None:
    mujoco = pytest.importorskip("mujoco")
    program, chain = imported(mujoco_file), robot.at(pressure)
    model, data = program.load()
    assert (model.nu, model.opt.timestep) == (0, 0.002)
    program.set_pressure(model, data, pressure)
    force = small_force(chain, part)
    curve = settled(mujoco, model, data, force)
    assert off(curve, chain.s, law.at(pressure), force) < SMALL
    assert np.abs(curve - chain.curve(chain.solve(force))).max() < 0.1
    with pytest.raises(ValueError, match="40 kPa lies outside 0 to 37 kPa"):
        program.set_pressure(model, data, 40.0)


@pytest.mark.parametrize("pressures", [(0.0, 0.0, 0.0), (4.0, 3.0, 1.0), (0.0, 0.0, 10.0)])
@pytest.mark.parametrize("force", [(0.0, 0.0, 0.0), (0.0, 0.001, 0.0), (0.0, 0.0, 0.001)])
def test_mujoco_takes_all_pressures_of_an_arm_in_space(
    tmp_path: Path, pressures: tuple[float, ...], force: tuple[float, float, float]
) -> None:
    """Without a load the tip is that of the rod, and a small force moves it as far along itself.

    Shear is a turn of the first hinge, which is right for a straight arm, and a bent one is off by 1 %.
    """
    mujoco = pytest.importorskip("mujoco")
    law = law_in_space()
    turned = np.array([0.05, 0.02, -0.03, 1.0, -0.5, 0.3, *[0.0] * 3])  # by the clamp, with the place of the axis there
    law = replace(law, clamp=constant(turned.tolist(), 5), tip=constant([0.5, 0.2, -0.1, *[0.0] * 3], 3))
    program = imported(export_robot(Robot.of_space(law, SOLID), "mujoco", tmp_path)[1])
    model, data = program.load(pressures)
    model.opt.gravity[:] = 0.0
    rest, tip = 1e3 * data.site("tip").xpos, model.site("tip")
    free, moved = (np.array(law.at(pressures).solve_in_space(Load(f)).end) for f in ((0.0, 0.0, 0.0), force))
    assert rest == pytest.approx(free, abs=0.01)
    model.dof_damping *= 5.0
    for _ in range(3000 if any(force) else 0):
        data.qfrc_applied[:] = 0.0
        point = data.site_xpos[tip.id].copy()
        mujoco.mj_applyFT(model, data, np.array(force), np.zeros(3), point, tip.bodyid[0], data.qfrc_applied)
        mujoco.mj_step(model, data)
    along = np.array(force) * 1e3
    assert (1e3 * data.site("tip").xpos - rest) @ along == pytest.approx((moved - free) @ along, rel=0.02, abs=1e-9)
    with pytest.raises(ValueError, match="11 kPa"):
        program.set_pressure(model, data, (11.0, 0.0, 0.0))


def test_the_file_for_mujoco_is_the_module_at_its_lowest_pressure(mujoco_file: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    program = imported(mujoco_file)
    alone = mujoco.MjModel.from_xml_path(str(mujoco_file.with_suffix(".xml")))
    model, _ = program.load(0.0)
    names = ("jnt_stiffness", "qpos_spring", "jnt_range", "dof_damping", "tendon_stiffness", "tendon_lengthspring")
    for name in (*names, "body_pos", "body_ipos", "site_pos", "geom_pos"):
        assert getattr(alone, name) == pytest.approx(getattr(model, name), rel=1e-5, abs=1e-8), name


def test_mass_and_inertia_in_mujoco_are_those_of_the_body(mujoco_file: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    program = imported(mujoco_file)
    model, data = program.load(0.0)
    assert model.body_mass.sum() == pytest.approx(1e-3 * SOLID.mass)
    mujoco.mj_forward(model, data)
    centre = data.subtree_com[model.body("clamp").id]
    assert 1e3 * centre[:2] == pytest.approx([56.0, 4.0], abs=0.3)
    inertia = sum(
        model.body_inertia[k, 2] + model.body_mass[k] * np.sum((data.xipos[k] - centre)[:2] ** 2)
        for k in range(1, model.nbody)
    )
    assert inertia == pytest.approx(1e-9 * SOLID.mass * (25.0 + 112.0**2 / 12.0), rel=0.01)


def test_arms_attached_in_mujoco_do_not_collide_and_keep_their_pressures(mujoco_file: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    program = imported(mujoco_file)
    spec = mujoco.MjSpec()
    for name, x in (("left", 0.0), ("right", 0.005)):
        part = mujoco.MjSpec.from_file(str(mujoco_file.with_suffix(".xml")))
        spec.worldbody.add_frame(pos=[x, 0.0, 0.0]).attach_body(part.body("clamp"), f"{name}/", "")
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.01] * 3, pos=[0.1, 0.0, 0.0], name="box")
    model = spec.compile()
    data = mujoco.MjData(model)
    program.set_pressure(model, data, 17.0, "left/")
    program.set_pressure(model, data, 37.0, "right/")
    assert model.joint("left/joint9").stiffness != model.joint("right/joint9").stiffness
    mujoco.mj_forward(model, data)
    box = model.geom("box").id
    assert data.ncon > 0
    assert all(box in (contact.geom1, contact.geom2) for contact in data.contact)


def test_the_first_vibration_in_mujoco_has_the_loss_factor(mujoco_file: Path) -> None:
    """By its logarithmic decrement, pi times the loss factor."""
    mujoco = pytest.importorskip("mujoco")
    model, data = imported(mujoco_file).load(5.0)
    tip = model.site("tip").id
    rest = data.site_xpos[tip, 1]
    data.qpos += 1e-3 * np.linspace(1.0, 0.0, model.nq)
    height = []
    for _ in range(1200):
        mujoco.mj_step(model, data)
        height.append(data.site_xpos[tip, 1] - rest)
    before, now, after = np.array(height)[:-2], np.array(height)[1:-1], np.array(height)[2:]
    peaks = now[(now > before) & (now >= after) & (now > 0.0)]
    assert np.log(peaks[0] / peaks[2]) / 2.0 == pytest.approx(np.pi * SOLID.loss_factor, rel=0.1)


def test_five_parameters_in_mujoco(tmp_path: Path) -> None:
    """The file has the lines of a loaded rod, whatever acts on it, and is straight at 0 kPa."""
    mujoco = pytest.importorskip("mujoco")
    robot = Robot.of_five(arm(), SOLID, arm())
    program = imported(export_robot(robot, "mujoco", tmp_path)[1])
    model, data = program.load(37.0)
    assert model.ntendon == 0
    chain = chain_of_five(ROD, 60, 1.0)
    assert data.qpos == pytest.approx(chain.neutral, abs=1e-6)
    model, data = program.load()
    assert np.abs(data.qpos).max() == 0.0
    program.set_pressure(model, data, 37.0)
    curve = settled(mujoco, model, data, FORCE)
    assert off(curve, chain.s, ROD, FORCE) < SMALL


@pytest.mark.slow
@pytest.mark.parametrize("pressure", [17.0, 30.0])
def test_the_program_for_pyelastica_rests_on_the_rod(
    law: ArmLaw, robot: Robot, tmp_path: Path, pressure: float
) -> None:
    pytest.importorskip("elastica")
    bending = Robot.of_law(law, SOLID, law.pressures, has_shear=False)
    program, chain = imported(export_robot(bending, "pyelastica", tmp_path)[0]), robot.at(pressure)
    for part in (0.0, 0.1, -0.1):
        force = small_force(chain, part)
        rod = program.simulate(pressure, force)
        assert off(1e3 * program.curve(rod, pressure), chain.s, law.at(pressure), force) < SMALL


def test_the_program_for_pyelastica_ends_when_nothing_moves(law: ArmLaw, tmp_path: Path) -> None:
    """Of an arm with five chambers, which rests four times as soon as one with eleven."""
    pytest.importorskip("elastica")
    robot = Robot.of_law(replace(law, length=law.length - 6.0 * law.pitch), SOLID, law.pressures)
    program, told = imported(export_robot(robot, "pyelastica", tmp_path)[0]), list[float]()
    program.simulate(17.0, tell=lambda time, _: told.append(time))
    assert told == []
    force = small_force(robot.at(17.0), 0.1)
    rests = program.simulate(17.0, force, tell=lambda time, _: told.append(time))
    longer = program.simulate(17.0, force, 3.0 * told[-1])
    ends = [1e3 * program.curve(rod, 17.0)[-1] for rod in (rests, longer)]
    assert ends[0] == pytest.approx(ends[1], abs=10.0 * program.REST * robot.at(17.0).s[-1])
    assert told[-1] * program.first_vibration(17.0) < 10.0


def test_the_program_for_pyelastica_begins_in_equilibrium(robot: Robot, tmp_path: Path) -> None:
    pytest.importorskip("elastica")
    program = imported(export_robot(robot, "pyelastica", tmp_path)[0])
    for pressure in (17.0, 30.0):
        chain = robot.at(pressure)
        for part in (0.0, 0.1):
            force = small_force(chain, part)
            assert program.equilibrium(pressure, force) == pytest.approx(chain.solve(force), abs=1e-6)
            rod = program.build(pressure, force)
            curve = 1e3 * program.curve(rod, pressure)
            assert curve == pytest.approx(chain.curve(chain.solve(force)), abs=1e-4)
        assert program.time_step(rod, pressure) > 2e-5
    with pytest.raises(ValueError, match="outside 0 to 37 kPa"):
        program.build(50.0)


@pytest.mark.slow
def test_the_program_for_pyelastica_runs_and_draws(robot: Robot, tmp_path: Path) -> None:
    pytest.importorskip("elastica")
    (file,) = export_robot(robot, "pyelastica", tmp_path)
    picture = tmp_path / "arm.png"
    arguments = ["--pressure", "17", "37", "--seconds", "0.01", "--plot", str(picture)]
    done = subprocess.run([sys.executable, str(file), *arguments], capture_output=True, text=True, check=True)
    assert [line.partition(":")[0] for line in done.stdout.splitlines()] == ["17 kPa", "37 kPa", "picture"]
    assert picture.stat().st_size > 1000


def test_a_chain_of_joints_converges_with_the_square_of_the_piece():
    chains = [chain_of_five(ROD, n, 1.0) for n in (8, 16, 32)]
    errors = [off(chain.curve(chain.solve(FORCE))[-1:], chain.s[-1:], ROD, FORCE) for chain in chains]
    assert errors[0] > 10.0 * errors[2]
    assert errors[2] < 1e-3


def test_joints_add_up_to_the_rod_wherever_the_break_lies():
    for edges in (np.array([0.0, 14.0, 112.0]), np.array([0.0, 5.0, 40.0, 112.0])):
        cut = cut_into_joints(ROD, edges)
        assert cut.compliance.sum() == pytest.approx(14.0 / 150.0 + 98.0 / 400.0)
        rest = 0.015 * 112.0 + 14.0 * 0.8 / 150.0 - 98.0 * 0.1 / 400.0
        assert cut.rest_rotation.sum() == pytest.approx(rest, rel=1e-2)  # the last cell is not whole
    with pytest.raises(RodError, match="must be the end of the rod"):
        cut_into_joints(ROD, np.array([0.0, 50.0, 100.0]))
    with pytest.raises(RodError, match="lengths that rise from 0"):
        cut_into_joints(ROD, np.array([0.0, 50.0, 40.0]))


def test_tables_carry_the_five_parameters(tmp_path: Path) -> None:
    columns = table(ROD)
    assert columns["alpha_N_mm2"] * (0.0 - columns["kappa_rest_per_mm"]) == pytest.approx(
        FIVE.moment(columns["s_mm"], -columns["kappa_0_per_mm"])
    )
    file = tmp_path / "table"
    write_csv(arm(), file)
    lines = file.read_text().splitlines()
    whole = arm_table(arm())
    assert lines[0].split(",") == list(whole)
    assert {"pressure_kPa", "alpha_N_mm2_std", "m0_N_mm_std"} <= set(whole)
    rows = np.loadtxt(lines[1:], delimiter=",")
    assert np.array_equal(np.unique(rows[:, 0]), PRESSURES)
    upper = {name: column[rows[:, 0] == PRESSURES[1]] for name, column in zip(whole, rows.T, strict=True)}
    rest = np.interp(columns["s_mm"], upper["s_mm"], upper["kappa_rest_per_mm"])
    assert rest == pytest.approx(columns["kappa_rest_per_mm"], abs=1e-4)
    assert set(upper["theta0_rad"]) == {ROD.theta0}
    write_json(arm(), 20.0, file)
    content = json.loads(file.read_text())
    assert (content["alpha1_N_mm2"], content["d_mm"], content["mass_g"]) == ([160.0, 150.0], [12.0, 14.0], 20.0)
    assert content["alpha2_N_mm2_std"] == [1.0, 2.0]
    profile = np.column_stack([content["s_mm"], content["kappa_0_per_mm"][1]])
    back = Rod(112.0, profile, FIVE, theta0=content["theta0_rad"][1])
    assert back.solve(force=FORCE).y[-1] == pytest.approx(ROD.solve(force=FORCE).y[-1], abs=1e-5)


def test_tables_carry_the_law_and_json_the_whole_arm(law: ArmLaw, tmp_path: Path) -> None:
    robot = Robot.of_law(law, None, law.pressures)
    write_law_csv(law, (17.0, 37.0), tmp_path / "law.csv")
    rows = np.genfromtxt(tmp_path / "law.csv", delimiter=",", names=True)
    section = law.at(37.0).section
    last = rows[rows["pressure_kPa"] == 37.0]
    assert last["kappa_per_mm"] == pytest.approx(section.kappa)
    assert 1.0 / last["rigidity_N_mm2"] == pytest.approx(section.kappa_slope)
    write_law_json(law, robot, tmp_path / "law.json")
    content = json.loads((tmp_path / "law.json").read_text())
    assert content["kappa_per_mm"][-1] == pytest.approx(section.kappa)
    chain, ours = content["chain"], robot.at(37.0)
    angles = np.array(chain["angle_rad"][-1])[chain["kind"]]
    assert angles == pytest.approx(ours.angle, abs=1e-8)
    assert 1e3 * np.array(chain["base_m"][-1]) == pytest.approx(ours.base, abs=1e-6)
    assert (chain["pressures_kPa"][-1], chain["rest"], len(chain["kind"])) == (37.0, ours.rest, len(ours.s))
    with pytest.raises(RodError, match="needs the mass of the arm"):
        export_robot(robot, "mujoco", tmp_path)


def test_tables_turn_the_end_as_the_rod() -> None:
    """kappa_0 is linear between its own positions, which are no multiples of the spacing of a table."""
    s = np.arange(0.0, 112.1, 1.25)
    ripple = -0.02 * (1.0 + np.where(np.arange(len(s)) % 8 == 1, 3.0, -0.4))
    rod = Rod(112.0, np.column_stack([np.append(s, 112.0), np.append(ripple, ripple[-1])]), FIVE, theta0=-0.01)
    free, columns = rod.solve(), table(rod)
    turned = free.theta[-1] - free.theta[0]
    assert np.trapezoid(columns["kappa_0_per_mm"], columns["s_mm"]) == pytest.approx(turned, rel=1e-9)
    coarse = table(rod, np.linspace(0.0, 112.0, 225))
    assert abs(np.trapezoid(coarse["kappa_0_per_mm"], coarse["s_mm"]) / turned - 1.0) > 1e-3


def test_tables_have_both_sides_of_the_jump_at_d() -> None:
    """A code that interpolates between the rows has the jump at d, which is no multiple of the spacing of a table."""
    five = replace(FIVE, d=13.7)
    rod = Rod(112.0, -0.02, five)
    turned = -0.02 * 112.0 - five.m01 / five.alpha1 * 13.7 - five.m02 / five.alpha2 * (112.0 - 13.7)
    columns = table(rod)
    assert np.trapezoid(columns["kappa_rest_per_mm"], columns["s_mm"]) == pytest.approx(turned, rel=1e-7)
    without = table(rod, np.linspace(0.0, 112.0, 225))
    jump = abs(five.m01 / five.alpha1 - five.m02 / five.alpha2)
    assert abs(np.trapezoid(without["kappa_rest_per_mm"], without["s_mm"]) - turned) > 0.04 * jump
    compliance = np.trapezoid(1.0 / columns["alpha_N_mm2"], columns["s_mm"])
    assert compliance == pytest.approx(13.7 / five.alpha1 + (112.0 - 13.7) / five.alpha2, rel=1e-7)


def test_mujoco_opens_the_urdf_of_somo_with_the_springs_of_its_definition(law: ArmLaw, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = Robot.linear_of_law(law, SOLID, PRESSURES)
    files = export_robot(robot, "somo", tmp_path)
    assert [file.name for file in files] == [f"rod_somo_{p}kPa.{end}" for p in (17, 37) for end in ("yaml", "urdf")]
    content = json.loads(files[2].read_text())
    (actuator,) = content["actuator_definitions"]
    link, springs = actuator["link_definition"], actuator["joint_definitions"]
    assert link["dimensions"][2] * actuator["n_segments"] == pytest.approx(actuator["actuator_length"])
    assert link["mass"] * actuator["n_segments"] == pytest.approx(1e-3 * SOLID.mass)
    assert (len(springs), content["urdf_filename"]) == (actuator["n_segments"], files[3].name)
    spec = mujoco.MjSpec.from_file(str(files[3]))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = [spring["joint_neutral_position"] for spring in springs]
    mujoco.mj_kinematics(model, data)
    _, y, z = 1e3 * data.xpos[model.body("tip").id]
    assert [z, -y] == pytest.approx(law.at(37.0).solve().end, abs=0.3)


def test_sorosim_loads_with_its_strains(law: ArmLaw, tmp_path: Path) -> None:
    robot = Robot.linear_of_law(law, SOLID, PRESSURES)
    rod = loadmat(export_robot(robot, "sorosim", tmp_path)[0])["rod"][0, 0]
    assert float(rod["L"].item()) == pytest.approx(1e-3 * law.length)
    assert rod["pressures_kPa"].ravel() == pytest.approx(PRESSURES)
    X, xi = rod["X"].ravel(), rod["xi_star"]
    assert xi.shape == (6, X.size, 2)
    free = law.at(37.0).solve()
    turn = 1e-3 * law.length * np.trapezoid(xi[2, :, 1], X)
    assert turn == pytest.approx(free.theta[-1], rel=1e-3)
    inner = law.at(37.0).section
    assert 1e6 * rod["EI"][-1, 1] == pytest.approx(1.0 / np.interp(0.0, inner.moment, inner.kappa_slope))
    theta = 1e-3 * law.length * np.concatenate([[0.0], np.cumsum(np.diff(X) * (xi[2, 1:, 1] + xi[2, :-1, 1]) / 2)])
    steps = 1e-3 * law.length * np.diff(X) * xi[3, :-1, 1]
    middle = 0.5 * (theta[1:] + theta[:-1])
    x, y = rod["start"][:, 1] + [steps @ np.cos(middle), steps @ np.sin(middle)]
    along, across = rod["tip_beside"][:, 1]
    cosine, sine = np.cos(theta[-1]), np.sin(theta[-1])
    end = [x + along * cosine - across * sine, y + along * sine + across * cosine]
    assert 1e3 * np.array(end) == pytest.approx(free.end, abs=0.3)
