"""A pneumatic arm with several pressures in MuJoCo, written by pneurod.

    model, data = load()
    set_pressure(model, data, [27.0, 5.0, 0.0])
    mujoco.mj_step(model, data)

Pressures are in kPa, in the order of TABLE["cavities"]; the law holds between the rows of TABLE["rows_kPa"] and 0 kPa.
Where the arm is attached to another model (mujoco.MjSpec) with a prefix, give it to `set_pressure` as well.
"""

from pathlib import Path

import mujoco
import numpy as np

from rod.export.programs.table import TABLE

FILE = Path(__file__).with_suffix(".xml")


def load(pressures_kPa=None):
    """The model at pressures, none by default, and its data with the arm at rest in it."""
    model = mujoco.MjModel.from_xml_path(str(FILE))
    data = mujoco.MjData(model)
    set_pressure(model, data, [0.0] * len(TABLE["cavities"]) if pressures_kPa is None else pressures_kPa)
    data.qpos[:] = model.qpos_spring
    mujoco.mj_forward(model, data)
    return model, data


def _value(name, x, *orders):
    """Polynomials of the law (c,) at x (v,) in mm, N and kPa, differentiated so often by the first variables."""
    powers, scale, coefficients = map(np.array, TABLE[name])
    terms = np.prod((x / scale)[len(orders) :] ** powers[:, len(orders) :], axis=1)
    for column, order in enumerate(orders):
        power = powers[:, column]
        terms = terms * np.prod([(power - i) / scale[column] for i in range(order)], axis=0)
        terms = terms * (x / scale)[column] ** np.maximum(power - order, 0)
    return terms @ coefficients


def set_pressure(model, data, pressures_kPa, prefix=""):
    """Give the arm its pressures in kPa, now. Raises ValueError for one below 0 kPa or above the largest of the law."""
    if min(pressures_kPa) < 0.0 or max(pressures_kPa) > np.max(TABLE["rows_kPa"]) * (1.0 + TABLE["same_pressure"]):
        raise ValueError(f"{max(pressures_kPa, key=abs):g} kPa lies outside 0 to {np.max(TABLE['rows_kPa']):g} kPa")
    p = np.asarray(pressures_kPa, float) @ np.array(TABLE["onto"])
    x, length = np.array([0.0, 0.0, *p]), TABLE["length_mm"]
    turns, by_y, by_z = (_value("clamp", x, *orders) for orders in ((), (1, 0), (0, 1)))
    for _ in range(25):  # the curvatures about y and z without a moment
        moment = np.concatenate([_value("potential", x, 1, 0), _value("potential", x, 0, 1)])
        second = [_value("potential", x, *orders)[0] for orders in ((2, 0), (1, 1), (0, 2))]
        B = np.array([second[:2], second[1:]])
        x[:2] -= np.linalg.solve(B, moment)
    piece, soft = length / TABLE["pieces"], _value("compliance", p)
    leg, angles = 1e-3 * piece * _value("stretch", x)[0], piece * np.array([0.0, *x[:2]])
    # the first hinge turns as the clamped end does, and moves the end of the arm as shear does
    more = np.array([0.0, by_y[1] + soft[5] / length, by_z[2] + soft[3] / length])
    for k in range(TABLE["pieces"]):
        compliance = piece * np.array([soft[0], *np.diag(np.linalg.inv(B))]) + (k == 0) * more
        joints = [model.joint(f"{prefix}{name}{k}").id for name in ("twist", "sideways", "joint")]
        model.jnt_stiffness[joints] = 1e-3 / compliance
        model.qpos_spring[model.jnt_qposadr[joints]] = angles
        model.dof_damping[model.jnt_dofadr[joints]] = TABLE["damping_time"] * 1e-3 / compliance
        model.body_pos[model.body(f"{prefix}piece{k}").id] = [leg, 0.0, 0.0]
    first, angle = model.body(f"{prefix}piece0").id, np.linalg.norm(turns[:3])
    mujoco.mju_axisAngle2Quat(model.body_quat[first], turns[:3] / max(angle, 1e-12), angle)
    forward = np.zeros(3)
    mujoco.mju_rotVecQuat(forward, np.array([0.5 * leg, 0.0, 0.0]), model.body_quat[first])
    model.body_pos[first] = 1e-3 * turns[3:6] + forward
    model.site_pos[model.site(f"{prefix}tip").id] = 1e-3 * _value("tip", p)[:3] + [0.5 * leg, 0.0, 0.0]
    # positions that were equal when the model was made need not be so any more
    model.site_sameframe[:] = model.body_sameframe[:] = 0
