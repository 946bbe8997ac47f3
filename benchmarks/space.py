"""Arms bent out of their plane: the rod with the arm's own law against finite elements of the whole arm.

    make space
    python -m benchmarks.space [--results results/space] [--only NAME] [--random N]

Four coarse arms and designs drawn at random, each at two pressures: a force across the arm that moves its end by about
2 and 10 % of the length, and a couple that twists it by about 0.1 rad. Law and arm have the same mesh. Finite elements
are kept in the folder, and not solved again.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.exports import drawn_at_random
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
from rod import ArmLaw
from rod.arm_law.record import law_record

#: parts of the length by which forces across the arm move its end, and the angle (rad) by which a couple twists it
LIFTS, TWIST = (0.02, 0.1), 0.1
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


def rows_of(name: str, law: ArmLaw, states: Sequence[Mapping[str, Any]]) -> Iterator[list[str]]:
    """The rows of an arm: what a small force across its end does to rod and arm, per N."""
    for state in states:
        rod = law.at(state["pressure_kPa"])
        found, solid = rod.sideways(rod.solve()), state["by_force"]
        error = found.end_lift / solid["work"] - 1.0
        turned = np.linalg.norm(found.end_turn - solid["turn_rad"][:2]) / np.linalg.norm(solid["turn_rad"])
        words = f"{name}, {state['pressure_kPa']:g} kPa"
        yield [words, f"{found.end_lift:.1f}", f"{solid['work']:.1f}", f"{100 * error:.2f}", f"{100 * turned:.2f}"]


def main() -> int:
    """0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results/space"))
    parser.add_argument("--only", help="the name of one arm")
    parser.add_argument("--random", type=int, default=8, help="number of designs drawn at random")
    given = parser.parse_args()
    given.results.mkdir(parents=True, exist_ok=True)
    rows: list[list[str]] = []
    for name, config in designs(given.results, given.random).items():
        if given.only in (None, name):
            states = solved(config, given.results / f"{name}.json")
            rows += rows_of(name, law_of(config, given.results / f"law_{name}"), states)
    head = ["arm", "rod, mm/N", "arm, mm/N", "error, %", "error of the turn, %"]
    sys.stdout.write(f"{table(head, rows)}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
