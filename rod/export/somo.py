"""The arm at one pressure as a chain for SoMo and PyBullet: a manipulator definition and the URDF of its links."""

import json
import math
from pathlib import Path

from rod.export.robot import Robot

_LINK = (
    '<link name="{name}"><visual>{origin}{box}</visual><collision>{origin}{box}</collision><inertial>{origin}'
    '<mass value="{mass:.9g}"/><inertia ixx="{across:.9g}" ixy="0" ixz="0" iyy="{across:.9g}" iyz="0" '
    'izz="{along:.9g}"/></inertial></link>'
)
_JOINT = (
    '<joint name="{parent}_to_{name}{axis}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
    '<origin xyz="{place}" rpy="0 0 0"/>{limits}</joint>'
)
_LIMITS = '<axis xyz="1 0 0"/><limit lower="-3.14159265" upper="3.14159265" effort="100" velocity="3"/>'
_BASE = (
    '<link name="base_link"><inertial><mass value="0"/>'
    '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
)


def write_somo(robot: Robot, path: Path) -> None:
    """A SoMo manipulator definition (JSON, which is YAML) and the URDF beside it, at one pressure, in m, kg, s.

    One actuator, one revolute joint per piece; planar_flag 2 lets every joint have its own spring and neutral position.
    The arm lies along z and bends about x. Lengths, forces and stiffnesses still have to be multiplied by SoMo's world
    scale.
    """
    (chain,) = robot.chains
    pieces, leg = len(chain.s), 1e-3 * float(chain.legs[0, 0])
    joints = [
        {
            "joint_type": "revolute",
            "axis": [1, 0, 0],
            "limits": [-math.pi, math.pi, 100, 3],
            "spring_stiffness": float(1e-3 * slope),
            "joint_neutral_position": float(neutral),
            "neutral_axis_offset": [0.0] * 6,
            "joint_control_limit_force": 0.0,
        }
        for slope, neutral in zip(chain.springs(chain.neutral)[1], chain.neutral, strict=True)
    ]
    actuator = {"actuator_length": leg * pieces, "n_segments": pieces, "planar_flag": 2}
    content = {
        "manipulator_name": f"pneurod_{robot.label}",
        "urdf_filename": path.with_suffix(".urdf").name,
        "n_act": 1,
        "actuator_definitions": [{**actuator, "link_definition": _link(robot, leg), "joint_definitions": joints}],
        "base_definition": None,
        "tip_definitions": None,
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    path.with_suffix(".urdf").write_text(_urdf(robot, leg), encoding="utf-8")


def _link(robot: Robot, leg: float) -> dict[str, object]:
    """The box between two joints at a distance in m."""
    width, (mass, across, along) = 2e-3 * robot.body.radius, _box(robot, leg)
    return {
        "shape_type": "box",
        "dimensions": [width, width, leg],
        "mass": mass,
        "inertial_values": [across, 0, 0, across, 0, along],
        "material_color": [0.2, 0.4, 0.7, 1.0],
        "material_name": "rod",
    }


def _box(robot: Robot, length: float) -> tuple[float, float, float]:
    """Mass, kg, and moments of inertia across and along, kg m2, of a link of a length in m."""
    chain, width = robot.chains[0], 2e-3 * robot.body.radius
    mass = 1e-3 * robot.body.mass * length / (1e-3 * float(chain.legs[0, 0]) * len(chain.s))
    return mass, mass * (width**2 + length**2) / 12.0, mass * width**2 / 6.0


def _urdf(robot: Robot, leg: float) -> str:
    """Links and joints with the names that SoMo gives them: half a piece at both ends, hinges in the middles.

    The frame is that of the clamped end of the material curve, beside which the first link begins; the link `tip` is
    the end of that curve. leg: m, between two hinges.
    """
    (chain,) = robot.chains
    pieces, width = len(chain.s), 2e-3 * robot.body.radius
    (x, y), (tip_x, tip_y) = 1e-3 * chain.base, 1e-3 * chain.points[-1]
    lines = ['<?xml version="1.0"?>', f'<robot name="pneurod_{robot.label}">', _BASE]
    parent, place = "base_link", f"0 {-y:.9g} {x - 0.5 * leg:.9g}"
    for k in range(pieces + 1):
        length, name = 0.5 * leg if k in (0, pieces) else leg, f"act0Seg{k}"
        mass, across, along = _box(robot, length)
        origin = f'<origin xyz="0 0 {0.5 * length:.9g}" rpy="0 0 0"/>'
        box = f'<geometry><box size="{width:.9g} {width:.9g} {length:.9g}"/></geometry>'
        lines.append(_LINK.format(name=name, origin=origin, box=box, mass=mass, across=across, along=along))
        axis, kind = ("_ax0", "revolute") if k else ("", "fixed")
        lines.append(_JOINT.format(parent=parent, name=name, axis=axis, kind=kind, place=place, limits=_LIMITS))
        parent, place = name, f"0 0 {length:.9g}"
    place = f"0 {-tip_y:.9g} {tip_x:.9g}"
    lines += [
        '<link name="tip"/>' + _JOINT.format(parent=parent, name="tip", axis="", kind="fixed", place=place, limits="")
    ]
    return "\n".join([*lines, "</robot>", ""])
