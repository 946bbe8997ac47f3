"""The arm at one pressure as a chain for SoMo and PyBullet: a manipulator definition and the URDF of its links."""

import json
import math
from pathlib import Path

from rod.export.robot import Robot


def write_somo(robot: Robot, path: Path) -> None:
    """A SoMo manipulator definition (JSON, which is YAML) and the URDF beside it, at one pressure, in m, kg, s.

    One actuator, one revolute joint per piece; planar_flag 2 lets every joint have its own spring and neutral position.
    The arm lies along z and bends about x. Lengths, forces and stiffnesses still have to be multiplied by SoMo's world
    scale.
    """
    (chain,) = robot.chains
    _, slopes = chain.springs(chain.neutral)
    definitions = [
        {
            "joint_type": "revolute",
            "axis": [1, 0, 0],
            "limits": [-math.pi, math.pi, 100, 3],
            "spring_stiffness": float(1e-3 * slope),
            "joint_neutral_position": float(neutral),
            "neutral_axis_offset": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            "joint_control_limit_force": 0.0,
        }
        for slope, neutral in zip(slopes, chain.neutral, strict=True)
    ]
    actuator = {
        "actuator_length": 1e-3 * _leg(robot) * len(definitions),
        "n_segments": len(definitions),
        "planar_flag": 2,
        "link_definition": _link(robot),
        "joint_definitions": definitions,
    }
    urdf = path.with_suffix(".urdf")
    content = {
        "manipulator_name": f"pneurod_{robot.label}",
        "urdf_filename": urdf.name,
        "n_act": 1,
        "actuator_definitions": [actuator],
        "base_definition": None,
        "tip_definitions": None,
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    urdf.write_text(_urdf(robot), encoding="utf-8")


def _leg(robot: Robot) -> float:
    """mm, between two hinges."""
    return float(robot.chains[0].legs[0, 0])


def _link(robot: Robot) -> dict[str, object]:
    """The box between two joints."""
    width, length = 2e-3 * robot.body.radius, 1e-3 * _leg(robot)
    mass = 1e-3 * robot.body.mass / len(robot.chains[0].s)
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


def _urdf(robot: Robot) -> str:
    """Links and joints with the names that SoMo gives them: half a piece at both ends, hinges in the middles.

    The frame is that of the clamped end of the material curve, beside which the first link begins; the link `tip` is
    the end of that curve.
    """
    (chain,) = robot.chains
    h, width, pieces = 1e-3 * _leg(robot), 2e-3 * robot.body.radius, len(robot.chains[0].s)
    lines = ['<?xml version="1.0"?>', f'<robot name="pneurod_{robot.label}">', _BASE]
    x, y = 1e-3 * chain.base
    parent, place = "base_link", f"0 {-y:.9g} {x - 0.5 * h:.9g}"
    for k in range(pieces + 1):
        length = 0.5 * h if k in (0, pieces) else h
        mass = 1e-3 * robot.body.mass * length / (h * pieces)
        across, along = mass * (width**2 + length**2) / 12.0, mass * width**2 / 6.0
        origin = f'<origin xyz="0 0 {0.5 * length:.9g}" rpy="0 0 0"/>'
        box = f'<geometry><box size="{width:.9g} {width:.9g} {length:.9g}"/></geometry>'
        child, kind = f"act0Seg{k}", "revolute" if k else "fixed"
        lines += [
            f'<link name="{child}"><visual>{origin}{box}</visual><collision>{origin}{box}</collision><inertial>{origin}'
            f'<mass value="{mass:.9g}"/><inertia ixx="{across:.9g}" ixy="0" ixz="0" iyy="{across:.9g}" iyz="0" '
            f'izz="{along:.9g}"/></inertial></link>',
            f'<joint name="{parent}_to_{child}{"_ax0" if k else ""}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{child}"/><origin xyz="{place}" rpy="0 0 0"/><axis xyz="1 0 0"/>'
            '<limit lower="-3.14159265" upper="3.14159265" effort="100" velocity="3"/></joint>',
        ]
        parent, place = child, f"0 0 {length:.9g}"
    x, y = 1e-3 * chain.points[-1]
    lines.append(
        f'<link name="tip"/><joint name="{parent}_to_tip" type="fixed"><parent link="{parent}"/><child link="tip"/>'
        f'<origin xyz="0 {-y:.9g} {x:.9g}" rpy="0 0 0"/></joint>'
    )
    return "\n".join([*lines, "</robot>", ""])
