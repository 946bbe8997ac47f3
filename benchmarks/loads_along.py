"""A dead force in the middle of coarse arms: the rod with the arm's own law against finite elements of the arm.

    python -m benchmarks.loads_along [--results results/loads_along]

The force is spread evenly over nodes at the material curve near the middle of the arm. The rod has it on their mean.
Law and arm have the same mesh.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.markdown import table
from benchmarks.space import law_of
from benchmarks.whole_arm import NodalForces, PlanarState, reached
from geometry import Centreline
from geometry.arrays import Array
from pipeline.config.load import load_config
from pipeline.simulate.scene import Scene
from rod import PointLoad, Rod

#: arms with their pressures, kPa
ARMS = {"pneunet": 17.0, "semicircular": 20.0}
#: N, across and along the arm at rest
FORCES = ((0.0, 0.01), (0.0, -0.01), (0.01, 0.0))
#: mm from the middle of the material curve, within which the loaded nodes lie
NEAR = 1.5
#: largest error over the length
ALLOWED = 0.002


def loaded_nodes(planar: PlanarState) -> Array:
    """(n,) the weights of nodes near the middle of the material curve."""
    points, body = planar.step.space.points, planar.scene.body
    near = np.hypot(points[:, 0] - 0.5 * body.length, points[:, 1] - planar.experiment.curve.vertices[0, 1]) <= NEAR
    return np.asarray(near / near.sum())


def bent(planar: PlanarState, weights: Array, force: tuple[float, float]) -> Centreline:
    """The material curve of finite elements under a force on nodes."""
    nodal = weights[:, None] * [*force, 0.0] / planar.experiment.symmetry_factor
    step = planar.step
    active, contacts = (*step.active, True), (*step.contacts, None)
    start = replace(step, factor=0.0, rate=None, active=active, contacts=contacts)
    formulation = planar.scene.config.mesh.formulation
    model = planar.experiment.model(planar.scene.material, (*planar.effects, NodalForces(nodal)), formulation)
    return planar.experiment.centreline(reached(model, [0.0, 1.0], [start])[-1])


def distances(rod: Rod, load: list[PointLoad], curve: Centreline) -> Array:
    """(n,) between the material curves of rod and finite elements, over the length."""
    own = rod.solve(along=load).positions(curve.s)
    x, y = curve.x - curve.x[0], curve.y - curve.y[0]
    return np.asarray(np.hypot(own[:, 0] - x, own[:, 1] - y) / rod.length)


def rows_of(name: str, pressure: float, folder: Path) -> Iterator[tuple[str, str, float, float, float]]:
    """Arm, force (N), how far the end moves, and the errors of the end and of the shape, over the length."""
    changes = [f"pressures=[{pressure:g} kPa]", "accuracy=off"]
    config = load_config(Path(f"configs/{name}_coarse.yaml"), changes)
    law = law_of(config, folder / f"law_{name}")
    rod = Rod(law.length, law=law.at(pressure))
    (planar,) = PlanarState.all_of(Scene.meshed(config), [pressure])
    weights, points = loaded_nodes(planar), planar.step.space.points
    s, height = (float(value) for value in weights @ points[:, :2])
    free = planar.experiment.centreline(planar.step)
    error = distances(rod, [], free)
    yield name, "0, 0", 0.0, float(error[-1]), float(error.max())
    for force in FORCES:
        curve = bent(planar, weights, force)
        beside = (0.0, height - float(planar.experiment.curve.vertices[0, 1]))
        error = distances(rod, [PointLoad(s, force, beside=beside)], curve)
        moved = float(np.hypot(curve.x[-1] - free.x[-1], curve.y[-1] - free.y[-1])) / rod.length
        yield name, f"{force[0]:g}, {force[1]:g}", moved, float(error[-1]), float(error.max())


def main() -> int:
    """0 where the shape is right to 0.2 % of the length."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results/loads_along"))
    given = parser.parse_args()
    rows = [row for name, pressure in ARMS.items() for row in rows_of(name, pressure, given.results)]
    lines = [[name, force, *(f"{100 * value:.2f}" for value in values)] for name, force, *values in rows]
    head = ["arm", "force, N", "end moves, % of l", "error of the end, % of l", "error of the shape, % of l"]
    sys.stdout.write(f"{table(head, lines)}\n")
    return int(max(row[-1] for row in rows) > ALLOWED)


if __name__ == "__main__":
    sys.exit(main())
