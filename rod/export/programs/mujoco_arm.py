"""A pneumatic arm in MuJoCo, written by pneurod: one input, the pressure in kPa.

    model, data = load()
    set_pressure(model, data, 27.0)
    mujoco.mj_step(model, data)

Where the arm is attached to another model (mujoco.MjSpec) with a prefix, give it to `set_pressure` as well.
"""

from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from rod.export.programs.table import TABLE, at

FILE = Path(__file__).with_suffix(".xml")


@lru_cache(maxsize=8)
def _numbers(model, prefix):
    """Numbers of joints, bodies and sites of the arm, and of its first tendon."""
    count = len(TABLE["kind"])
    joints = np.array([model.joint(f"{prefix}joint{k}").id for k in range(count)])
    bodies = np.array([model.body(f"{prefix}piece{k}").id for k in range(count)])
    sites = np.array([model.site(f"{prefix}curve{k}").id for k in range(count - 1)] + [model.site(f"{prefix}tip").id])
    geoms = model.body_geomadr[bodies][:, None] + np.arange(len(TABLE["geom_heights"]))
    has_tendons = len(TABLE["angle_rad"][0][0]) > 2
    return joints, bodies, sites, geoms, model.tendon(f"{prefix}spring0_1").id if has_tendons else 0


def load(pressure_kPa=TABLE["pressures_kPa"][0]):
    """The model at a pressure, and its data with the arm at rest in it."""
    model = mujoco.MjModel.from_xml_path(str(FILE))
    data = mujoco.MjData(model)
    set_pressure(model, data, pressure_kPa)
    data.qpos[:] = model.qpos_spring
    mujoco.mj_forward(model, data)
    return model, data


def set_pressure(model, data, pressure_kPa, prefix=""):
    """Give the arm a pressure in kPa, now: its springs change, and its joints move as time goes on.

    prefix: that with which the arm was attached. Raises ValueError for a pressure outside that of the file.
    """
    now = at(pressure_kPa)
    joints, bodies, sites, geoms, tendon = _numbers(model, prefix)
    kind, rest = TABLE["kind"], TABLE["rest"]
    angle, moment = now["angle_rad"][kind], now["moment_N_m"][kind]
    slope = np.diff(moment) / np.diff(angle)
    model.jnt_stiffness[joints] = slope[:, rest]
    model.qpos_spring[model.jnt_qposadr[joints]] = angle[:, rest]
    model.dof_damping[model.jnt_dofadr[joints]] = now["damping_time_s"] * slope[:, rest]
    if TABLE["is_limited"]:
        model.jnt_range[joints] = angle[:, [0, -1]]
    inner = np.arange(1, angle.shape[1] - 1)
    is_above = inner > rest
    tendons = slice(tendon, tendon + len(kind) * len(inner))
    model.tendon_stiffness[tendons] = (np.diff(slope) * np.where(is_above, 1.0, -1.0)).ravel()
    ends = np.where(is_above, -TABLE["no_angle"], angle[:, 1:-1]), np.where(is_above, angle[:, 1:-1], TABLE["no_angle"])
    model.tendon_lengthspring[tendons] = np.stack(ends, axis=2).reshape(-1, 2)
    if "twist_N_m" in now:
        _set_out_of_plane(model, now, prefix)
    model.body_pos[bodies, :2] = np.vstack([now["base_m"], now["legs_m"]])
    model.site_pos[sites, :2] = now["points_m"]
    model.body_ipos[bodies, 1] = TABLE["centre_height"] - now["lift_m"]
    model.geom_pos[geoms, 1] = np.array(TABLE["geom_heights"]) - now["lift_m"]
    # positions that were equal when the model was made need not be so any more
    model.site_sameframe[sites] = model.geom_sameframe[geoms] = model.body_sameframe[bodies] = 0


def _set_out_of_plane(model, now, prefix):
    """Axes and springs of the joints that turn the pieces out of the plane."""
    axis = now["sideways_axis_rad"]
    for name, turn, stiffness in (("twist", 0.0, now["twist_N_m"]), ("sideways", np.pi / 2, now["sideways_N_m"])):
        joints = np.array([model.joint(f"{prefix}{name}{k}").id for k in range(len(axis))])
        model.jnt_axis[joints, :2] = np.column_stack([np.cos(axis + turn), np.sin(axis + turn)])
        model.jnt_pos[joints, :2] = now["sideways_centre_m"]
        model.jnt_stiffness[joints] = stiffness
        model.dof_damping[model.jnt_dofadr[joints]] = now["damping_time_s"] * stiffness
