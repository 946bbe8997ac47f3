"""Arms bent out of their plane: the rod with the arm's own law against finite elements of the whole arm.

    make space
    python -m benchmarks.space [--results results/space] [--only NAME] [--random N]

Four coarse arms and designs drawn at random, each at two pressures: a force across the arm that moves its end by about
2 and 10 % of the length, and a couple that twists it by about 0.1 rad. Law and arm have the same mesh. Finite elements
are kept in the folder, and not solved again.
"""

import argparse
import json
import runpy
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.exports import drawn_at_random, rest
from benchmarks.markdown import table
from benchmarks.whole_arm import PlanarState, couple, force_across
from pipeline.cell.build import build_law
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.saved import SavedLaw
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.context import RunContext
from pipeline.progress import Silent
from pipeline.simulation.scene import Scene
from pipeline.store.store import open_store
from rod import ArmLaw, Solid
from rod.arm_law.law import LawRod
from rod.arm_law.record import law_record
from rod.export.formats import PROGRAMS, export_robot
from rod.export.robot import Robot, Section
from rod.spatial import SpatialLoad

#: parts of the length by which forces across the arm move its end, and the angle (rad) by which a couple twists it
LIFTS, TWIST = (0.02, 0.1), 0.1
#: N, forces up to this are those of a couple
ROUND = 1e-12
#: programs in which exported arms are opened
OPENED = ("mujoco", "pyelastica")
ARMS = ("pneunet", "bisected_circle", "semicircular", "semicircular_single")


def designs(folder: Path, random: int) -> dict[str, Config]:
    """The arms by their names."""
    given: dict[str, tuple[str, dict[str, Any]]] = {name: (f"configs/{name}_coarse.yaml", {}) for name in ARMS}
    given |= drawn_at_random(folder, range(random))
    same_mesh = {"accuracy": "off", "law_in_space": "true"}
    return {
        name: load_config(Path(path), [f"{key}={value}" for key, value in {**changes, **same_mesh}.items()])
        for name, (path, changes) in given.items()
    }


def solved(config: Config, file: Path) -> list[dict[str, Any]]:
    """Finite elements of an arm: its state in the plane at each pressure that it bears, and those out of it."""
    if file.exists():
        return list(json.loads(file.read_text(encoding="utf-8")))
    states = []
    for planar in PlanarState.all_of(Scene.meshed(config), config.pressures_kPa):
        states.append(across(planar))
        file.write_text(json.dumps(states) + "\n", encoding="utf-8")
    return states


def across(planar: PlanarState) -> dict[str, Any]:
    """What stands in the file for a pressure."""
    half, length, x = planar.experiment, planar.scene.body.length, planar.step.positions
    tangent = planar.frame[:, 0]
    force = planar.slight(force_across(half, planar.step.space))
    torque = planar.slight(couple(half, planar.step.space, x, tangent))
    record = {"pressure_kPa": planar.pressure_kPa, "length_mm": length, "frame": planar.frame.tolist()}
    record |= {"by_force": force, "by_torque": torque, "unstable": planar.across.negative_pivots}
    push = LIFTS[-1] * length / force["lift"]
    parts = [lift / LIFTS[-1] for lift in LIFTS]
    whole, now = planar.whole, planar.space.points + planar.mirrored(planar.space)
    record["forces"] = [bent.record() for bent in planar.bent(push * force_across(whole, planar.space), parts)]
    turn = TWIST / float(tangent @ torque["turn_rad"])
    bent = planar.bent(turn * couple(whole, planar.space, now, tangent), [1.0])
    record["couples"] = [one.record() for one in bent]
    return record


def law_of(config: Config, folder: Path) -> ArmLaw:
    """The arm's own law on the mesh of the arm, out of its plane too."""
    file = folder / "law.json"
    if not file.exists():
        with open_store(folder, config, fresh=False) as store:
            pieces = ArmPieces.of(Scene.meshed(config))
            measured = build_law(pieces, config.pressures_kPa, RunContext.alone(store, Silent()), between=False)
            store.save_json(file.name, law_record(measured.law))
    return SavedLaw.read(file).law


def exported(law: ArmLaw, pressure: float, folder: Path, force: float) -> dict[str, float]:
    """Displacement along z (mm) of the end under a force (N) there, of the arm in the files of other programs."""
    assert law.mass is not None
    radius = 0.05 * law.length  # where the arm rests does not depend on its section
    section = Section(-radius, radius, 2.0 * radius, 0.0, (0.25 * radius**2, 0.25 * radius**2))
    solid = Solid(float(law.mass.grams[-1]), 1.0, np.pi * radius**2, section, 0.1)
    lifts = {}
    for name in OPENED:
        robot = Robot.of_law(law, solid, [pressure], has_shear=not PROGRAMS[name].has_shear)
        program = runpy.run_path(str(export_robot(robot, name, folder)[-1]))
        if name == "mujoco":
            model, data = program["load"](pressure)
            model.opt.gravity[:] = 0.0
            rest(model, data, (force, 0.0), np.array([0.0, 0.0, 1.0]), np.zeros(3))
            lifts[name] = 1e3 * float(data.site("tip").xpos[2])
        else:
            arm = program["simulate"](pressure, (0.0, 0.0, force))
            lifts[name] = 1e3 * float(program["curve"](arm, pressure)[-1, 2])
    return lifts


def compared(rod: LawRod, solid: Mapping[str, Any]) -> dict[str, float]:
    """Displacement (mm) and turn (rad) of a solid by a load, and how far the rod is from them, over them."""
    fx, fy, fz = (float(part) if abs(part) > ROUND else 0.0 for part in solid["force_N"])
    mx, my, mz = (0.0 if fz else float(part) for part in solid["moment_about_end_N_mm"])
    planar, found = (rod.solve_in_space(load) for load in (SpatialLoad(), SpatialLoad((fx, fy, fz), (mx, my, mz))))
    moved = np.array(found.end) - planar.end
    turned = Rotation.from_matrix(found.frames[-1] @ planar.frames[-1].T).as_rotvec()
    row: dict[str, float] = {}
    for name, own in (("moved_mm", moved), ("turn_rad", turned)):
        size = float(np.linalg.norm(solid[name]))
        row |= {name: size, f"{name}_error": float(np.linalg.norm(own - solid[name])) / size}
    return row


def errors_of(name: str, law: ArmLaw, states: Sequence[Mapping[str, Any]], folder: Path) -> Iterator[dict[str, Any]]:
    """For each pressure and load of an arm how far the rod is from it; for the smallest force those of exports too."""
    for state in states:
        pressure = state["pressure_kPa"]
        rod = law.at(pressure)
        for load in ("forces", "couples"):
            for k, solid in enumerate(state[load]):
                row = {"arm": name, "pressure_kPa": pressure, "load": load[:-1], **compared(rod, solid)}
                if load == "forces" and k == 0:
                    lifts = exported(law, pressure, folder, solid["force_N"][2])
                    row |= {program: lift / solid["moved_mm"][2] - 1.0 for program, lift in lifts.items()}
                yield row


def in_words(row: Mapping[str, Any]) -> list[str]:
    """A row of the table."""
    percent = (
        f"{100 * row[name]:.2f}" if name in row else "" for name in ("moved_mm_error", "turn_rad_error", *OPENED)
    )
    words = f"{row['arm']}, {row['pressure_kPa']:g} kPa, {row['load']}"
    return [words, f"{row['moved_mm']:.2f}", f"{row['turn_rad']:.3f}", *percent]


def main() -> int:
    """0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results/space"))
    parser.add_argument("--only", help="the name of one arm")
    parser.add_argument("--random", type=int, default=8, help="number of designs drawn at random")
    given = parser.parse_args()
    given.results.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    for name, config in designs(given.results, given.random).items():
        if given.only in (None, name):
            states = solved(config, given.results / f"{name}.json")
            folder = given.results / f"law_{name}"
            rows += errors_of(name, law_of(config, folder), states, folder)
            (given.results / "space.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    head = ["arm, load", "moved, mm", "turned, rad", "error, %", "of the turn, %", *OPENED]
    sys.stdout.write(f"{table(head, [in_words(row) for row in rows])}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
