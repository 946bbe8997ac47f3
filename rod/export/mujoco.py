"""The arm as a chain for MuJoCo: an MJCF file, and beside it a Python module that sets its pressure."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from rod.export.chain import Chain
from rod.export.program import write_program
from rod.export.robot import Robot

#: rad, an angle that no hinge has
FAR = 100.0


def write_mujoco(robot: Robot, path: Path) -> None:
    """The chain at its lowest pressure as MJCF, and the module of the same name.

    Each hinge has a spring, and a fixed tendon for each other slope of its law. The pieces collide with everything but
    the pieces of such arms: contype 2, conaffinity 1.
    """
    chain = robot.chains[0]
    damping = robot.damping_times[0]
    path.write_text(
        '<mujoco model="arm">\n'
        f"<!-- written by pneurod: {robot.description}, at {robot.pressures[0]:g} kPa; "
        f"{path.with_suffix('.py').name} sets another pressure. m, kg, s -->\n"
        '<compiler angle="radian"/>\n'
        f"<worldbody>\n{_bodies(robot, chain, damping)}</worldbody>\n"
        f"<tendon>\n{''.join(_tendons(chain))}</tendon>\n</mujoco>\n",
        encoding="utf-8",
    )
    section = robot.body.section
    low, high = section.low + _radius(robot), section.high - _radius(robot)
    of_geoms = 1e-3 * np.array([0.5 * (section.low + section.high), low, low, high, high])
    more = {"geom_heights": of_geoms.tolist(), "centre_height": 1e-3 * section.centre, "no_angle": FAR}
    name = "mujoco_space_arm" if robot.in_space else "mujoco_arm"
    write_program(name, {**robot.table, **more}, path.with_suffix(".py"))


def _bodies(robot: Robot, chain: Chain, damping: float) -> str:
    """The clamped piece with the moving ones inside it, each inside the one before."""
    solid, count = robot.body, len(chain.s)
    lengths = np.append(chain.legs[:, 0], chain.points[-1, 0])
    to_end = np.cumsum(lengths[::-1])[::-1]
    whole = chain.base[0] + to_end[0]
    slope = _slopes(chain)[:, chain.rest]
    inner = ""
    for k in range(count - 1, -1, -1):
        position = chain.base if k == 0 else chain.legs[k - 1]
        x, y = 1e-3 * position
        stiffness, low, high = slope[k], chain.angle[k, 0], chain.angle[k, -1]
        limits = f' limited="true" range="{low:.9g} {high:.9g}"' if chain.is_limited else ""
        px, py = 1e-3 * chain.points[k]
        inner = (
            f'<body name="piece{k}" pos="{x:.9g} {y:.9g} 0">\n{_out_of_plane(chain, k, damping)}'
            f'<joint name="joint{k}" type="hinge" axis="0 0 1" stiffness="{stiffness:.9g}" '
            f'springref="{chain.neutral[k]:.9g}" damping="{damping * stiffness:.9g}"{limits}/>\n'
            f"{_solid(robot, lengths[k], solid.mass * lengths[k] / whole, chain.lift)}"
            f"{_rails(robot, lengths[k], to_end[k], chain.lift)}"
            f'<site name="{"tip" if k == count - 1 else f"curve{k}"}" pos="{px:.9g} {py:.9g} 0"/>\n'
            f"{inner}</body>\n"
        )
    clamp = _solid(robot, chain.base[0], solid.mass * chain.base[0] / whole, 0.0)
    return f'<body name="clamp">\n{clamp}{inner}</body>\n'


def _out_of_plane(chain: Chain, k: int, damping: float) -> str:
    """The two joints that turn a piece out of the plane, before that within it; empty where they are not known."""
    if chain.space is None:
        return ""
    x, y = 1e-3 * chain.space.centre[k]
    cosine, sine = np.cos(chain.space.axis[k]), np.sin(chain.space.axis[k])
    hinges = (("twist", (cosine, sine), chain.space.twist[k]), ("sideways", (-sine, cosine), chain.space.bend[k]))
    return "".join(
        f'<joint name="{name}{k}" type="hinge" axis="{along:.9g} {across:.9g} 0" pos="{x:.9g} {y:.9g} 0" '
        f'stiffness="{1e-3 * stiffness:.9g}" damping="{1e-3 * damping * stiffness:.9g}"/>\n'
        for name, (along, across), stiffness in hinges
    )


def _solid(robot: Robot, length: float, mass: float, lift: float) -> str:
    """Mass (g), inertia and picture of a piece of a length whose hinge lies lift above the axis, both mm."""
    section = robot.body.section
    across, along = (section.spread[k] + length**2 / 12.0 for k in range(2))
    inertia = 1e-9 * mass * np.array([sum(section.spread), along, across])  # kg m2
    sizes = 0.5e-3 * np.array([length, section.high - section.low, section.width])
    middle, centre = 0.5 * (section.low + section.high) - lift, section.centre - lift
    return (
        f'<inertial pos="{0.5e-3 * length:.9g} {1e-3 * centre:.9g} 0" mass="{1e-3 * mass:.9g}" '
        f'diaginertia="{_spaced(inertia)}"/>\n'
        f'<geom type="box" pos="{0.5e-3 * length:.9g} {1e-3 * middle:.9g} 0" size="{_spaced(sizes)}" '
        'contype="0" conaffinity="0"/>\n'
    )


def _radius(robot: Robot) -> float:
    """mm, of the rails."""
    section = robot.body.section
    return 0.25 * min(section.high - section.low, section.width)


def _rails(robot: Robot, length: float, to_end: float, lift: float) -> str:
    """The surface of a piece of a length, at a distance from the end of the arm, in mm: capsules along its edges.

    They go on from piece to piece without edges, at which other bodies would be caught.
    """
    section, radius = robot.body.section, _radius(robot)
    end = min(length, to_end - radius)
    start = min(0.0, end - 0.01 * radius)
    lines = []
    for y in (section.low + radius - lift, section.high - radius - lift):
        for z in (radius - 0.5 * section.width, 0.5 * section.width - radius):
            ends = 1e-3 * np.array([start, y, z, end, y, z])
            lines.append(
                f'<geom type="capsule" fromto="{_spaced(ends)}" size="{1e-3 * radius:.9g}" group="3" '
                'contype="2" conaffinity="1"/>\n'
            )
    return "".join(lines)


def _tendons(chain: Chain) -> Iterator[str]:
    """For each state of a spring but the outermost: what the next slope away from the state without moment adds."""
    slopes = _slopes(chain)
    for k, angles in enumerate(chain.angle):
        for j in range(1, len(angles) - 1):
            is_above = j > chain.rest
            added = (slopes[k, j] - slopes[k, j - 1]) * (1.0 if is_above else -1.0)
            span = (-FAR, angles[j]) if is_above else (angles[j], FAR)
            yield (
                f'<fixed name="spring{k}_{j}" stiffness="{added:.9g}" springlength="{span[0]:.9g} {span[1]:.9g}">'
                f'<joint joint="joint{k}" coef="1"/></fixed>\n'
            )


def _slopes(chain: Chain) -> Array:
    """(m, n - 1) N m/rad, of the springs between their states."""
    return 1e-3 * np.diff(chain.moment) / np.diff(chain.angle)


def _spaced(values: Array) -> str:
    return " ".join(f"{value:.9g}" for value in values)
