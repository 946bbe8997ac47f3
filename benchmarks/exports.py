"""The exported rods of a run at rest in other programs, against the rod itself: the table of docs/how_to/robots.md.

    python benchmarks/exports.py results/pneunet_coarse [--programs mujoco pyelastica pybullet] [--force 0 0.02]

Every program gets the files of `pneurod export` and the same dead force on the end. The largest distance between its
points and those of the rod at the same arc length is printed over the length, at the identified pressures and, where
the pressure is an input of the file, between them. PyBullet is not among the packages of the project; it reads the
URDF that goes with the file for SoMo, and the springs of that file are applied as torques, as SoMo does.
"""

import importlib.util
import json
import runpy
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from benchmarks.arguments import parser_of
from geometry.arrays import Array
from pipeline.errors import InputError, RunFailed
from pipeline.rods.export import ExportOptions, exported
from pipeline.rods.saved import SavedRod
from rod import EXPORTS, RodSolution
from rod.export.arm import PARTS


def in_mujoco(files: list[Path], pressure: float, force: tuple[float, float]) -> np.ndarray:
    """Hinges and end (n, 2) in mm."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(files[0]))
    data = mujoco.MjData(model)
    known = model.numeric("pressures_kPa").data
    mujoco.mj_resetDataKeyframe(model, data, int(np.argmin(np.abs(known - pressure))))
    data.ctrl[:] = pressure
    tip = model.site("tip").id
    for step in range(40000):
        data.qfrc_applied[:] = 0.0
        end = np.array([*force, 0.0])
        mujoco.mj_applyFT(
            model, data, end, np.zeros(3), data.site_xpos[tip].copy(), model.site_bodyid[tip], data.qfrc_applied
        )
        mujoco.mj_step(model, data)
        if step > 200 and np.abs(data.qvel).max() < 1e-6:
            break
    return 1e3 * np.vstack([data.xanchor[:, :2], data.site_xpos[tip, :2]])


def in_pyelastica(files: list[Path], pressure: float, force: tuple[float, float]) -> np.ndarray:
    """Nodes (n, 2) in mm."""
    return 1e3 * runpy.run_path(str(files[0]))["simulate"](pressure, force).position_collection[:2].T


def in_pybullet(files: list[Path], pressure: float, force: tuple[float, float]) -> np.ndarray:
    """Hinges and end (n, 2) in mm: the joint angles at which springs and force are in balance, by Newton's method."""
    import pybullet as bullet

    definition = next(file for file in files if file.name == f"rod_somo_{pressure:g}kPa.yaml")
    joints = json.loads(definition.read_text())["actuator_definitions"][0]["joint_definitions"]
    stiffness, neutral = (
        np.array([joint[key] for joint in joints]) for key in ("spring_stiffness", "joint_neutral_position")
    )
    bullet.connect(bullet.DIRECT)
    robot = bullet.loadURDF(str(definition.with_suffix(".urdf")), useFixedBase=True)
    movable = [
        k for k in range(bullet.getNumJoints(robot)) if bullet.getJointInfo(robot, k)[2] == bullet.JOINT_REVOLUTE
    ]
    half = bullet.getVisualShapeData(robot)[-1][3][2]  # length of the last box, half an element
    # z of the file is x of the rod, and a positive angle about x turns z towards -y
    applied = np.array([0.0, -force[1], force[0]])

    def points(angles: np.ndarray) -> np.ndarray:
        for k, angle in zip(movable, angles, strict=True):
            bullet.resetJointState(robot, k, angle)
        states = [bullet.getLinkState(robot, k, computeForwardKinematics=True) for k in movable]
        hinges = np.array([state[4] for state in states])
        axis = np.array(bullet.getMatrixFromQuaternion(states[-1][5])).reshape(3, 3)[:, 2]
        return np.vstack([hinges, hinges[-1] + half * axis])

    angles = neutral.copy()
    for _ in range(40):
        at = points(angles)
        arms = at[-1] - at[:-1]
        torque = np.cross(arms, applied)[:, 0]
        residual = stiffness * (angles - neutral) - torque
        # turning hinge j moves the end, and all hinges beyond j, about hinge j
        turned = np.cross(np.array([1.0, 0.0, 0.0]), arms)
        later = np.maximum.outer(np.arange(len(arms)), np.arange(len(arms)))
        tangent = np.diag(stiffness) - np.cross(turned[later], applied)[..., 0]
        step = np.linalg.solve(tangent, residual)
        angles = angles - step * min(1.0, 0.2 / np.abs(step).max())
        if np.abs(residual).max() < 1e-12:
            break
    at = points(angles)
    bullet.disconnect()
    return 1e3 * np.column_stack([at[:, 2], -at[:, 1]])


#: where a pressure between two identified ones is tried, over the interval: in the middle of a part of `rod.export.arm`
BETWEEN = 1.5 / PARTS


def at_hinges(count: int) -> Array:
    """Arc lengths over the length of hinges in the middles of equal elements, and of the end (count,)."""
    return np.array([*((np.arange(count - 1) + 0.5) / (count - 1)), 1.0])


def at_nodes(count: int) -> Array:
    """Arc lengths over the length of nodes between equal elements (count,)."""
    return np.linspace(0.0, 1.0, count)


@dataclass(frozen=True)
class Program:
    """Another program that reads the files of an export."""

    package: str  #: that is imported
    target: str  #: the format, of `EXPORTS`
    solve: Callable[[list[Path], float, tuple[float, float]], Array]  #: points (n, 2) in mm at rest
    at: Callable[[int], Array]  #: the arc lengths of n points over the length


PROGRAMS = {
    "mujoco": Program("mujoco", "mujoco", in_mujoco, at_hinges),
    "pyelastica": Program("elastica", "pyelastica", in_pyelastica, at_nodes),
    "pybullet": Program("pybullet", "somo", in_pybullet, at_hinges),
}


def largest_distance(points: Array, at: Array, shape: RodSolution) -> float:
    """Largest distance of points (n, 2) in mm from those of a rod at the same arc lengths, over its length.

    at: arc lengths of the points over the length (n,).
    """
    length = float(shape.s[-1])
    return float(np.linalg.norm(points - shape.positions(at * length), axis=1).max()) / length


def main() -> None:
    """Print the table."""
    options = parser_of(__doc__)
    options.add_argument("folder", type=Path)
    options.add_argument("--programs", nargs="+", default=["mujoco", "pyelastica"], choices=list(PROGRAMS))
    options.add_argument("--force", nargs=2, type=float, default=(0.0, 0.02))
    given = options.parse_args()
    if lacking := [name for name in given.programs if importlib.util.find_spec(PROGRAMS[name].package) is None]:
        options.error(f"not installed: {', '.join(lacking)}")
    try:
        compare(given.folder, given.programs, tuple(given.force))
    except (InputError, RunFailed) as failure:
        sys.exit(str(failure))


def compare(folder: Path, programs: list[str], force: tuple[float, float]) -> None:
    """The lines of the table. Raises InputError and RunFailed."""
    write = sys.stdout.write
    saved = SavedRod.read(folder / "parameters.json", extensible=False)
    write("| program | pressure, kPa | largest distance over l, % | end, mm | end of the rod, mm |\n")
    write("|---|---:|---:|---|---|\n")
    with tempfile.TemporaryDirectory() as scratch:
        for name in programs:
            program = PROGRAMS[name]
            files = exported(folder, program.target, ExportOptions(out=Path(scratch)))
            known = saved.rods.pressures.tolist()
            between = (
                [] if EXPORTS[program.target].one_pressure else [a + BETWEEN * (b - a) for a, b in pairwise(known)]
            )
            for pressure in sorted([*known, *between]):
                shape = saved.rods.at(pressure).solve(force=force)
                theirs = program.solve(files, pressure, force)
                off = largest_distance(theirs, program.at(len(theirs)), shape)
                ends = ["({:.2f}, {:.2f})".format(*end) for end in (theirs[-1], shape.end)]
                write(f"| {name} | {pressure:g} | {100.0 * off:.3f} | {ends[0]} | {ends[1]} |\n")


if __name__ == "__main__":
    main()
