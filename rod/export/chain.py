"""The rod as a chain of hinges with springs, for MuJoCo and SoMo. Files in m, kg, s and rad.

Between two pressures the torque of a spring, k (r - q) with stiffness k, neutral angle r and angle q, is interpolated
linearly in the pressure; from 0 to the lowest pressure k stays and r grows from zero.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from rod.export.arm import Arm
from rod.export.lumped import cut_into_joints


@dataclass(frozen=True)
class Springs:
    """Springs of the hinges in the middles of the elements, over the pressures of an arm (n,) and elements (m,)."""

    stiffness: Array  #: (n, m) N m/rad
    neutral: Array  #: (n, m) rad; the first hinge also carries the angle of the clamp

    @staticmethod
    def of(arm: Arm) -> "Springs":
        """The springs at every pressure."""
        cuts = [cut_into_joints(rod, np.linspace(0.0, rod.length, arm.elements + 1)) for rod in arm.rods]
        neutral = np.array([cut.rest_rotation for cut in cuts])
        neutral[:, 0] += [rod.theta0 for rod in arm.rods]
        return Springs(np.array([1e-3 / cut.compliance for cut in cuts]), neutral)


def write_mujoco(arm: Arm, path: Path) -> None:
    """An MJCF chain of hinges whose input is the pressure; the last body carries the site `tip`.

    `data.ctrl[:] = p` with p in kPa sets the pressure: every hinge has one actuator per interval of pressure, and each
    acts between the ends of its interval only (`ctrlrange`). The intervals are those of `Arm.tabulated`. There is a
    keyframe at every pressure of the arm itself. The first half element is part of the clamp. Joint damping makes the
    chain settle.
    """
    springs, h, (arm_mass, radius) = Springs.of(arm), 1e-3 * arm.piece, arm.dynamics
    inner = f'<site name="tip" pos="{0.5 * h:.9g} 0 0"/>'
    for k in range(arm.elements - 1, -1, -1):
        length = h if k < arm.elements - 1 else 0.5 * h
        mass = arm_mass * length / (1e-3 * arm.length)
        position, stiffness = 0.5 * h if k == 0 else h, springs.stiffness[0, k]
        inner = (
            f'<body name="piece{k}" pos="{position:.9g} 0 0">'
            f'<joint name="joint{k}" type="hinge" axis="0 0 1" stiffness="{stiffness:.9g}" springref="0" '
            f'damping="{0.03 * stiffness:.9g}"/>'
            f'<geom type="capsule" fromto="0 0 0 {length:.9g} 0 0" size="{radius:.9g}" mass="{mass:.9g}"/>'
            f"{inner}</body>\n"
        )
    path.write_text(
        '<mujoco model="pneurod">\n'
        f"<!-- numbers at {', '.join(f'{p:g} kPa' for p in arm.pressures)}: {arm.origin}; "
        "data.ctrl[:] = pressure in kPa -->\n"
        '<compiler angle="radian"/>\n'
        '<option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"><flag contact="disable"/></option>\n'
        f"<custom>\n{_numerics(arm)}</custom>\n"
        f'<worldbody>\n<body name="clamp">\n{inner}</body>\n</worldbody>\n'
        f"<actuator>\n{_actuators(arm.tabulated)}</actuator>\n"
        f"<keyframe>\n{_keyframes(arm, springs)}</keyframe>\n</mujoco>\n",
        encoding="utf-8",
    )


def _numerics(arm: Arm) -> str:
    values = {"pressures_kPa": list(arm.pressures), **arm.columns}
    return "".join(f'<numeric name="{name}" data="{_spaced(data)}"/>\n' for name, data in values.items())


def _actuators(arm: Arm) -> str:
    """Torque (g0 + g1 q)(p - p_low) of every hinge and interval, p limited to the interval."""
    springs = Springs.of(arm)
    torques = springs.stiffness * springs.neutral
    lines = []
    for index, high in enumerate(arm.pressures):
        low = arm.pressures[index - 1] if index else 0.0
        constant = (torques[index] - (torques[index - 1] if index else 0.0)) / (high - low)
        slope = -(springs.stiffness[index] - springs.stiffness[max(index - 1, 0)]) / (high - low)
        for k, (g0, g1) in enumerate(zip(constant, slope, strict=True)):
            lines.append(
                f'<general name="pressure{index}_{k}" joint="joint{k}" ctrllimited="true" ctrlrange="{low:g} {high:g}" '
                f'gaintype="affine" gainprm="{g0:.9g} {g1:.9g} 0" '
                f'biastype="affine" biasprm="{-g0 * low:.9g} {-g1 * low:.9g} 0"/>\n'
            )
    return "".join(lines)


def _keyframes(arm: Arm, springs: Springs) -> str:
    """The chain without load at every pressure."""
    count = len(arm.tabulated.pressures) * arm.elements
    lines = [
        f'<key name="{pressure:g}kPa" qpos="{_spaced(neutral)}" ctrl="{_spaced([pressure] * count)}"/>\n'
        for pressure, neutral in zip(arm.pressures, springs.neutral, strict=True)
    ]
    return "".join(lines)


def _spaced(values: Array | tuple[float, ...] | list[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def write_somo(arm: Arm, path: Path) -> None:
    """A SoMo manipulator definition (JSON, which is YAML) and the URDF beside it, at one pressure.

    One actuator, one revolute joint per element; planar_flag 2 lets every joint have its own spring and neutral
    position. The arm lies along z and bends about x. Lengths, forces and stiffnesses still have to be multiplied by
    SoMo's world scale.
    """
    springs = Springs.of(arm)
    definitions = [
        {
            "joint_type": "revolute",
            "axis": [1, 0, 0],
            "limits": [-math.pi, math.pi, 100, 3],
            "spring_stiffness": float(stiffness),
            "joint_neutral_position": float(neutral),
            "neutral_axis_offset": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            "joint_control_limit_force": 0.0,
        }
        for stiffness, neutral in zip(springs.stiffness[0], springs.neutral[0], strict=True)
    ]
    actuator = {
        "actuator_length": 1e-3 * arm.length,
        "n_segments": arm.elements,
        "planar_flag": 2,
        "link_definition": _somo_link(arm),
        "joint_definitions": definitions,
    }
    urdf = path.with_suffix(".urdf")
    content = {
        "manipulator_name": f"pneurod_{arm.label}",
        "urdf_filename": urdf.name,
        "n_act": 1,
        "actuator_definitions": [actuator],
        "base_definition": None,
        "tip_definitions": None,
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    urdf.write_text(_urdf(arm), encoding="utf-8")


def _somo_link(arm: Arm) -> dict[str, object]:
    """The box between two joints."""
    arm_mass, radius = arm.dynamics
    mass, width, length = arm_mass / arm.elements, 2.0 * radius, 1e-3 * arm.piece
    inertia = mass * (width**2 + length**2) / 12.0
    return {
        "shape_type": "box",
        "dimensions": [width, width, length],
        "mass": mass,
        "inertial_values": [inertia, 0, 0, inertia, 0, mass * width**2 / 6.0],
        "material_color": [0.2, 0.4, 0.7, 1.0],
        "material_name": "rod",
    }


_BASE = (
    '<link name="base_link"><inertial><mass value="0"/>'
    '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
)


def _urdf(arm: Arm) -> str:
    """Links and joints with the names SoMo gives them: half an element at both ends, hinges in the middles."""
    arm_mass, radius = arm.dynamics
    h, width = 1e-3 * arm.piece, 2.0 * radius
    lines = ['<?xml version="1.0"?>', f'<robot name="pneurod_{arm.label}">', _BASE]
    parent, position = "base_link", 0.0
    for k in range(arm.elements + 1):
        length = 0.5 * h if k in (0, arm.elements) else h
        mass = arm_mass * length / (1e-3 * arm.length)
        across, along = mass * (width**2 + length**2) / 12.0, mass * width**2 / 6.0
        origin = f'<origin xyz="0 0 {0.5 * length:.9g}" rpy="0 0 0"/>'
        box = f'<geometry><box size="{width:.9g} {width:.9g} {length:.9g}"/></geometry>'
        child, kind = f"act0Seg{k}", "revolute" if k else "fixed"
        lines += [
            f'<link name="{child}"><visual>{origin}{box}</visual><collision>{origin}{box}</collision><inertial>{origin}'
            f'<mass value="{mass:.9g}"/><inertia ixx="{across:.9g}" ixy="0" ixz="0" iyy="{across:.9g}" iyz="0" '
            f'izz="{along:.9g}"/></inertial></link>',
            f'<joint name="{parent}_to_{child}{"_ax0" if k else ""}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{child}"/><origin xyz="0 0 {position:.9g}" rpy="0 0 0"/><axis xyz="1 0 0"/>'
            '<limit lower="-3.14159265" upper="3.14159265" effort="100" velocity="3"/></joint>',
        ]
        parent, position = child, length
    return "\n".join([*lines, "</robot>", ""])
