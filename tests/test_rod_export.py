"""The five parameters in the files of other codes: loaded, settled under a dead force, compared with the rod."""

import importlib.util
import json

import numpy as np
import pytest
from scipy.io import loadmat

from rod import FiveParameters, Rod, RodError
from rod.export.formats import EXPORTS, Arm, export, table
from rod.export.lumped import joints

LAW = FiveParameters(150.0, 400.0, -0.8, 0.1, 14.0)
S = np.linspace(0.0, 112.0, 225)
ROD = Rod(112.0, 0.015 * (1.0 + 0.3 * np.cos(2.0 * np.pi * S / 10.0)), LAW, theta0=0.1)
FORCE = (0.01, -0.05)
SETTLED = ROD.solve(force=FORCE)


def off(points, s):
    """Largest distance (n, 2) mm from our rod over its length."""
    return np.hypot(*(SETTLED.positions(s) - points).T).max() / ROD.length


def test_mujoco_settles_to_our_shape(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    arm = Arm(ROD, mass=20.0, radius=7.0, elements=40)
    model = mujoco.MjModel.from_xml_path(str(export(arm, "mujoco", tmp_path)))
    data = mujoco.MjData(model)
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
    hinges = 1e3 * data.xanchor[:, :2]
    s = arm.piece * (np.arange(arm.elements) + 0.5)
    assert off(hinges, s) < 2e-3
    assert 1e3 * data.site_xpos[tip, :2] == pytest.approx([SETTLED.x[-1], SETTLED.y[-1]], abs=0.2)


def test_pyelastica_settles_to_our_shape(tmp_path):
    elastica = pytest.importorskip("elastica")
    arm = Arm(ROD, mass=20.0, radius=7.0, elements=24)
    path = export(arm, "pyelastica", tmp_path)
    spec = importlib.util.spec_from_file_location("exported_rod", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    rod = module.build()

    class Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):
        pass

    simulator, step = Simulator(), 4e-5
    simulator.append(rod)
    simulator.constrain(rod).using(elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    end = np.array([*FORCE, 0.0])
    simulator.add_forcing_to(rod).using(elastica.EndpointForces, np.zeros(3), end, ramp_up_time=0.1)
    simulator.dampen(rod).using(elastica.AnalyticalLinearDamper, uniform_damping_constant=20.0, time_step=step)
    simulator.finalize()
    stepper, time = elastica.PositionVerlet(), np.float64(0.0)
    while time < 1.3:
        time = stepper.step(simulator, time, step)
    s = np.linspace(0.0, 112.0, arm.elements + 1)
    assert off(1e3 * rod.position_collection[:2].T, s) < 1e-2


def test_a_chain_of_joints_converges_with_the_square_of_the_piece():
    """The chain's equilibrium under the moment of the rod, by rotating piece by piece."""
    errors = []
    for n in (8, 16, 32):
        cut = joints(ROD, np.linspace(0.0, 112.0, n + 1))
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
        cut = joints(ROD, edges)
        assert cut.compliance.sum() == pytest.approx(14.0 / 150.0 + 98.0 / 400.0)
        rest = 0.015 * 112.0 + 14.0 * 0.8 / 150.0 - 98.0 * 0.1 / 400.0
        assert cut.rest_rotation.sum() == pytest.approx(rest, rel=1e-2)  # the last cell is not whole
    with pytest.raises(RodError, match="must be the end of the rod"):
        joints(ROD, np.array([0.0, 50.0, 100.0]))
    with pytest.raises(RodError, match="lengths that rise from 0"):
        joints(ROD, np.array([0.0, 50.0, 40.0]))


def test_tables_carry_the_law(tmp_path):
    arm = Arm(ROD, mass=20.0, radius=7.0)
    columns = table(ROD)
    assert columns["alpha_N_mm2"] * (0.0 - columns["kappa_rest_per_mm"]) == pytest.approx(
        LAW.moment(columns["s_mm"], -columns["kappa_0_per_mm"])
    )
    lines = export(arm, "csv", tmp_path).read_text().splitlines()
    assert lines[0] == "s_mm,kappa_0_per_mm,alpha_N_mm2,m0_N_mm,kappa_rest_per_mm"
    assert np.loadtxt(lines[1:], delimiter=",")[:, 4] == pytest.approx(columns["kappa_rest_per_mm"])
    content = json.loads(export(arm, "json", tmp_path).read_text())
    assert (content["alpha1_N_mm2"], content["d_mm"], content["mass_g"]) == (150.0, 14.0, 20.0)
    back = Rod(112.0, np.column_stack([content["s_mm"], content["kappa_0_per_mm"]]), LAW, theta0=content["theta0_rad"])
    assert back.solve(force=FORCE).y[-1] == pytest.approx(SETTLED.y[-1], abs=1e-6)


def test_somo_has_one_spring_per_joint(tmp_path):
    content = json.loads(export(Arm(ROD, mass=20.0, radius=7.0, elements=30), "somo", tmp_path).read_text())
    (actuator,) = content["actuator_definitions"]
    link, springs = actuator["link_definition"], actuator["joint_definitions"]
    assert link["dimensions"][2] * actuator["n_segments"] == pytest.approx(actuator["actuator_length"])
    assert len(springs) == actuator["n_segments"] == 30
    assert sum(1.0 / s["spring_stiffness"] for s in springs) == pytest.approx(1e3 * (14.0 / 150.0 + 98.0 / 400.0))


def test_sorosim_loads_with_its_strains(tmp_path):
    rod = loadmat(export(Arm(ROD, mass=20.0, radius=7.0), "sorosim", tmp_path))["rod"][0, 0]
    assert float(rod["L"].item()) == pytest.approx(0.112)
    assert rod["xi_star"].shape == (6, rod["X"].size)
    assert np.all(rod["xi_star"][3] == 1.0)
    assert rod["EI"].ravel()[[0, -1]] == pytest.approx([150e-6, 400e-6])


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: Arm(ROD, mass=0.0, radius=7.0), r"mass must be positive, not 0\.0"),
        (lambda: Arm(ROD, mass=20.0, radius=7.0, elements=2), r"A chain of 2 elements is too coarse"),
        (lambda: export(Arm(ROD, mass=20.0, radius=7.0), "abaqus", None), r"'abaqus' is not among the formats"),
    ],
)
def test_wrong_exports_are_refused(call, sentence):
    with pytest.raises(RodError, match=sentence):
        call()
    assert len(EXPORTS) == 6
