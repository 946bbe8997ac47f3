"""The five parameters in the files of other codes: loaded, settled under a dead force, compared with the rod."""

import json
import runpy
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from rod import FiveParameters, Rod, RodError
from rod.export.arm import Arm
from rod.export.chain import Springs
from rod.export.formats import EXPORTS, export_arm
from rod.export.lumped import cut_into_joints
from rod.export.tables import arm_table, table

LAW = FiveParameters(150.0, 400.0, -0.8, 0.1, 14.0)
S = np.linspace(0.0, 112.0, 225)
RIPPLE = 1.0 + 0.3 * np.cos(2.0 * np.pi * S / 10.0)
ROD = Rod(112.0, 0.015 * RIPPLE, LAW, theta0=0.1)
LOWER = Rod(112.0, 0.008 * RIPPLE, FiveParameters(160.0, 300.0, -0.4, 0.1, 12.0), theta0=0.06)
PRESSURES = (17.0, 37.0)
FORCE = (0.01, -0.05)
SETTLED = ROD.solve(force=FORCE)
STD = {"alpha1": (9.0, 8.0), "alpha2": (1.0, 2.0), "m01": (0.3, 0.4), "m02": (0.01, 0.02), "d": (0.5, 0.6)}
SMOOTH = tuple(np.column_stack([S[20:-20], np.full(185, kappa)]) for kappa in (0.008, 0.015))


def arm(elements: int = 40, mass: float = 20.0) -> Arm:
    return Arm(PRESSURES, (LOWER, ROD), mass, 7.0, elements=elements, deviations=STD, smooth=SMOOTH)


def off(points: np.ndarray, s: np.ndarray, settled=SETTLED) -> float:
    """Largest distance (n, 2) mm from our rod over its length."""
    return float(np.hypot(*(settled.positions(s) - points).T).max() / 112.0)


@pytest.mark.parametrize("pressure", [17.0, 27.0, 37.0])
def test_mujoco_settles_to_our_shape_at_the_pressure_of_its_controls(tmp_path: Path, pressure: float) -> None:
    mujoco = pytest.importorskip("mujoco")
    (file,) = export_arm(arm(), "mujoco", tmp_path)
    assert file.name == "rod_mujoco_17_to_37kPa.xml"
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    data.ctrl[:] = pressure
    tip = model.site("tip").id
    mujoco.mj_forward(model, data)
    for step in range(20000):
        data.qfrc_applied[:] = 0.0
        point = data.site_xpos[tip].copy()
        mujoco.mj_applyFT(
            model, data, np.array([*FORCE, 0.0]), np.zeros(3), point, model.site_bodyid[tip], data.qfrc_applied
        )
        mujoco.mj_step(model, data)
        if step > 200 and np.abs(data.qvel).max() < 1e-6:
            break
    settled = between(pressure).solve(force=FORCE)
    hinges = 1e3 * data.xanchor[:, :2]
    assert off(hinges, arm().piece * (np.arange(40) + 0.5), settled) < 2e-3
    assert 1e3 * data.site_xpos[tip, :2] == pytest.approx([settled.x[-1], settled.y[-1]], abs=0.2)


def between(pressure: float) -> Rod:
    """The rod whose moment is the mean of those of both rods where d is equal; at the ends these themselves."""
    t = (pressure - 17.0) / 20.0
    if t in (0.0, 1.0):
        return (LOWER, ROD)[round(t)]
    mean = {}
    for name in ("alpha1", "alpha2"):
        mean[name] = (1 - t) * getattr(LOWER.five, name) + t * getattr(ROD.five, name)
    s = np.linspace(0.0, 112.0, 2241)
    rows = [table(rod, s) for rod in (LOWER, ROD)]
    moments = [row["alpha_N_mm2"] * row["kappa_rest_per_mm"] for row in rows]
    alpha = (1 - t) * rows[0]["alpha_N_mm2"] + t * rows[1]["alpha_N_mm2"]
    rest = ((1 - t) * moments[0] + t * moments[1]) / alpha
    law = FiveParameters(mean["alpha1"], mean["alpha2"], 0.0, 0.0, 13.0)
    return Rod(112.0, np.column_stack([s, rest]), law, theta0=0.08)


def test_keyframes_of_mujoco_have_the_shape_without_load(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(export_arm(arm(), "mujoco", tmp_path)[0]))
    data = mujoco.MjData(model)
    for pressure in PRESSURES:
        mujoco.mj_resetDataKeyframe(model, data, model.key(f"{pressure:g}kPa").id)
        assert np.all(data.ctrl == pressure)
        mujoco.mj_forward(model, data)
        assert np.abs(data.qfrc_passive + data.qfrc_actuator).max() < 1e-7  # N m
    assert model.numeric("alpha2_N_mm2_std").data == pytest.approx(STD["alpha2"])


@pytest.mark.slow
def test_the_program_for_pyelastica_settles_to_our_shape(tmp_path: Path) -> None:
    pytest.importorskip("elastica")
    (file,) = export_arm(arm(elements=24), "pyelastica", tmp_path)
    program = runpy.run_path(str(file))
    rod = program["simulate"](37.0, FORCE)
    s = np.linspace(0.0, 112.0, 25)
    assert off(1e3 * rod.position_collection[:2].T, s) < 1e-2


def test_the_springs_of_the_program_for_pyelastica(tmp_path: Path) -> None:
    pytest.importorskip("elastica")
    (file,) = export_arm(arm(elements=24), "pyelastica", tmp_path)
    program = runpy.run_path(str(file))
    stiffness, curvature, theta0 = program["spring"](27.0)
    low, high = (program["spring"](pressure) for pressure in PRESSURES)
    assert stiffness == pytest.approx(0.5 * (low[0] + high[0]))
    assert stiffness * curvature == pytest.approx(0.5 * (low[0] * low[1] + high[0] * high[1]))
    assert (program["spring"](0.0)[1] == 0.0).all()
    assert theta0 == pytest.approx(0.08)
    assert program["spring"](37.0001)[2] == pytest.approx(0.1)  # 37 kPa written with six digits
    with pytest.raises(ValueError, match="outside 0 to 37 kPa"):
        program["build"](50.0)


@pytest.mark.slow
def test_the_program_for_pyelastica_runs_and_draws(tmp_path: Path) -> None:
    pytest.importorskip("elastica")
    (file,) = export_arm(arm(elements=8), "pyelastica", tmp_path)
    picture = tmp_path / "arm.png"
    arguments = ["--pressure", "17", "37", "--seconds", "0.01", "--plot", str(picture)]
    done = subprocess.run([sys.executable, str(file), *arguments], capture_output=True, text=True, check=True)
    assert [line.partition(":")[0] for line in done.stdout.splitlines()] == ["17 kPa", "37 kPa", "picture"]
    assert picture.stat().st_size > 1000


def test_a_chain_of_joints_converges_with_the_square_of_the_piece():
    """The chain's equilibrium under the moment of the rod, by rotating piece by piece."""
    errors = []
    for n in (8, 16, 32):
        cut = cut_into_joints(ROD, np.linspace(0.0, 112.0, n + 1))
        middles = 0.5 * (cut.edges[1:] + cut.edges[:-1])
        turns = cut.rest_rotation + cut.compliance * np.interp(middles, SETTLED.s, SETTLED.moment)
        angle = ROD.theta0 + np.concatenate([[0.0], np.cumsum(turns)])
        h = np.diff(np.concatenate([[0.0], middles, [112.0]]))
        tip = np.array([np.sum(h * np.cos(angle)), np.sum(h * np.sin(angle))])
        errors.append(np.hypot(*(tip - [SETTLED.x[-1], SETTLED.y[-1]])))
    assert errors[0] > 10.0 * errors[2]
    assert errors[2] < 0.1


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


def test_tables_carry_the_law(tmp_path: Path) -> None:
    columns = table(ROD)
    assert columns["alpha_N_mm2"] * (0.0 - columns["kappa_rest_per_mm"]) == pytest.approx(
        LAW.moment(columns["s_mm"], -columns["kappa_0_per_mm"])
    )
    (file,) = export_arm(arm(), "csv", tmp_path)
    lines = file.read_text().splitlines()
    whole = arm_table(arm())
    assert file.name == "rod_17_to_37kPa.csv"
    assert lines[0].split(",") == list(whole)
    assert {"pressure_kPa", "kappa_0_smooth_per_mm", "alpha_N_mm2_std", "m0_N_mm_std"} <= set(whole)
    rows = np.loadtxt(lines[1:], delimiter=",")
    assert np.array_equal(np.unique(rows[:, 0]), PRESSURES)
    upper = {name: column[rows[:, 0] == PRESSURES[1]] for name, column in zip(whole, rows.T, strict=True)}
    rest = np.interp(columns["s_mm"], upper["s_mm"], upper["kappa_rest_per_mm"])
    assert rest == pytest.approx(columns["kappa_rest_per_mm"], abs=1e-4)
    assert set(upper["theta0_rad"]) == {ROD.theta0}
    content = json.loads(export_arm(arm(), "json", tmp_path)[0].read_text())
    assert (content["alpha1_N_mm2"], content["d_mm"], content["mass_g"]) == ([160.0, 150.0], [12.0, 14.0], 20.0)
    assert content["alpha2_N_mm2_std"] == [1.0, 2.0]
    profile = np.column_stack([content["s_mm"], content["kappa_0_per_mm"][1]])
    back = Rod(112.0, profile, LAW, theta0=content["theta0_rad"][1])
    assert back.solve(force=FORCE).y[-1] == pytest.approx(SETTLED.y[-1], abs=1e-6)


def test_tables_turn_the_end_as_the_rod() -> None:
    """kappa_0 is linear between its own positions, which are no multiples of the spacing of a table."""
    s = np.arange(0.0, 112.1, 1.25)
    ripple = -0.02 * (1.0 + np.where(np.arange(len(s)) % 8 == 1, 3.0, -0.4))
    rod = Rod(112.0, np.column_stack([np.append(s, 112.0), np.append(ripple, ripple[-1])]), LAW, theta0=-0.01)
    free, columns = rod.solve(), table(rod)
    turned = free.theta[-1] - free.theta[0]
    assert np.trapezoid(columns["kappa_0_per_mm"], columns["s_mm"]) == pytest.approx(turned, rel=1e-9)
    coarse = table(rod, np.linspace(0.0, 112.0, 225))
    assert abs(np.trapezoid(coarse["kappa_0_per_mm"], coarse["s_mm"]) / turned - 1.0) > 1e-3
    smooth = np.column_stack([np.linspace(5.0, 107.0, 30), np.full(30, -0.02)])
    arms = Arm((17.0,), (rod,), None, None, smooth=(smooth,))
    both = arm_table(arms)
    assert np.trapezoid(both["kappa_0_smooth_per_mm"], both["s_mm"]) == pytest.approx(turned, rel=1e-9)


def test_tables_have_both_sides_of_the_jump_at_d() -> None:
    """A code that interpolates between the rows has the jump at d, which is no multiple of the spacing of a table."""
    law = replace(LAW, d=13.7)
    rod = Rod(112.0, -0.02, law)
    turned = -0.02 * 112.0 - law.m01 / law.alpha1 * 13.7 - law.m02 / law.alpha2 * (112.0 - 13.7)
    columns = table(rod)
    assert np.trapezoid(columns["kappa_rest_per_mm"], columns["s_mm"]) == pytest.approx(turned, rel=1e-7)
    without = table(rod, np.linspace(0.0, 112.0, 225))
    jump = abs(law.m01 / law.alpha1 - law.m02 / law.alpha2)
    assert abs(np.trapezoid(without["kappa_rest_per_mm"], without["s_mm"]) - turned) > 0.04 * jump
    compliance = np.trapezoid(1.0 / columns["alpha_N_mm2"], columns["s_mm"])
    assert compliance == pytest.approx(13.7 / law.alpha1 + (112.0 - 13.7) / law.alpha2, rel=1e-7)


def test_the_smooth_curve_has_no_ripple_and_the_rotation_of_the_end() -> None:
    for rod, smooth in zip((LOWER, ROD), arm().smoothed().rods, strict=True):
        free, plain = rod.solve(), smooth.solve()
        assert np.ptp(plain.kappa) < 0.05 * np.ptp(free.kappa)
        assert plain.theta[-1] == pytest.approx(free.theta[-1], abs=1e-4)
    with pytest.raises(RodError, match="no rest curvature averaged"):
        Arm((17.0,), (ROD,), 20.0, 7.0).smoothed()


def test_somo_has_one_spring_per_joint_and_a_urdf_of_the_same_chain(tmp_path: Path) -> None:
    files = export_arm(arm(elements=30), "somo", tmp_path)
    names = [file.name for file in files]
    assert names == [f"rod_somo_{p}kPa.{suffix}" for p in (17, 37) for suffix in ("yaml", "urdf")]
    content = json.loads(files[2].read_text())
    (actuator,) = content["actuator_definitions"]
    link, springs = actuator["link_definition"], actuator["joint_definitions"]
    assert link["dimensions"][2] * actuator["n_segments"] == pytest.approx(actuator["actuator_length"])
    assert len(springs) == actuator["n_segments"] == 30
    assert sum(1.0 / s["spring_stiffness"] for s in springs) == pytest.approx(1e3 * (14.0 / 150.0 + 98.0 / 400.0))
    robot = ET.fromstring(files[3].read_text())
    assert content["urdf_filename"] == files[3].name
    hinges = robot.findall("joint[@type='revolute']")
    heights = [float(origin.get("xyz", "").split()[2]) for origin in robot.findall("joint/origin")]
    boxes = [float(box.get("size", "").split()[2]) for box in robot.findall("link/visual/geometry/box")]
    masses = [float(mass.get("value", "")) for mass in robot.findall("link/inertial/mass")]
    assert len(hinges) == 30
    assert sum(boxes) == pytest.approx(0.112)
    assert np.diff(np.cumsum(heights)[1:]) == pytest.approx(0.112 / 30)
    assert sum(masses) == pytest.approx(0.020)


def test_springs_turn_the_end_as_the_rod(tmp_path: Path) -> None:
    springs = Springs.of(arm())
    for rod, neutral in zip((LOWER, ROD), springs.neutral, strict=True):
        columns = table(rod, np.linspace(0.0, 112.0, 22401))
        turned = rod.theta0 + np.trapezoid(columns["kappa_rest_per_mm"], columns["s_mm"])
        assert neutral.sum() == pytest.approx(turned, abs=1e-3)


def test_sorosim_loads_with_its_strains(tmp_path: Path) -> None:
    rod = loadmat(export_arm(arm(), "sorosim", tmp_path)[0])["rod"][0, 0]
    assert float(rod["L"].item()) == pytest.approx(0.112)
    assert rod["pressures_kPa"].ravel() == pytest.approx(PRESSURES)
    assert rod["xi_star"].shape == (6, rod["X"].size, 2)
    assert np.all(rod["xi_star"][3] == 1.0)
    assert rod["EI"][[0, -1]] == pytest.approx(np.array([[160e-6, 150e-6], [300e-6, 400e-6]]))


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: arm(mass=0.0), r"mass must be positive, not 0\.0"),
        (lambda: arm(elements=2), r"A chain of 2 elements is too coarse"),
        (lambda: Arm((37.0, 17.0), (ROD, ROD), 20.0, 7.0), r"must be above 0 and in ascending order"),
        (lambda: export_arm(arm(), "abaqus", Path()), r"'abaqus' is not among the formats"),
    ],
)
def test_wrong_exports_are_refused(call, sentence) -> None:
    with pytest.raises(RodError, match=sentence):
        call()
    assert len(EXPORTS) == 6
