"""Bodies as other programs write them: read, meshed and bent, with a table of what becomes of each.

    make foreign
    python -m benchmarks.foreign [--results results/foreign] [--only finger.step]

Experiment II at 20 kPa on the mesh that the program chooses. All files but the last two hold the same finger, so that
its tip has to move as that of the first one. studies/own_bodies.md has the numbers of whole runs.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import fem
from benchmarks.markdown import table
from geometry import PneurodError
from pipeline.config.load import load_config
from pipeline.simulate.scene import Scene
from tests.foreign_bodies import Tried, write_tried

#: kPa
PRESSURE = 20.0
#: largest difference of the tip's displacement to that of the finger in a STEP file, over the latter: meshes of files
#: are coarse
DIFFERENT = 0.05
#: files that hold other bodies than the finger, and those whose many elements would take longer than all others
OTHERS, MESHED_ALONE = ("chambers.stl", "twin_bellows.stl"), ("twin_bellows.stl",)
HEAD = ("body", "elements", "smallest radius ratio", "u_y of the tip, mm", "air, mm³", "CPU s", "outcome")


@dataclass(frozen=True)
class Outcome:
    """What becomes of a file."""

    tried: Tried
    numbers: tuple[str, ...]  #: elements, smallest radius ratio, displacement of the tip, air
    deflection: float  #: mm, of the tip; 0 where none was computed
    seconds: float  #: processor time
    failure: str  #: a sentence; empty for a body that was bent

    @property
    def row(self) -> tuple[str, ...]:
        """Of the table."""
        return (self.tried.words, *self.numbers, f"{self.seconds:.0f}", self.words)

    @property
    def words(self) -> str:
        """What became of it."""
        return self.failure or ("meshed" if self.tried.file in MESHED_ALONE else "bent")


def outcome(tried: Tried, folder: Path) -> Outcome:
    """Mesh the body of a file and bend it."""
    start = process_time()
    try:
        numbers, deflection = bent(tried, folder)
    except (PneurodError, ArithmeticError) as failure:
        return Outcome(tried, ("",) * 4, 0.0, process_time() - start, str(failure))
    return Outcome(tried, numbers, deflection, process_time() - start, "")


def bent(tried: Tried, folder: Path) -> tuple[tuple[str, ...], float]:
    """Numbers of the table, and the displacement of the tip (mm). Raises what the program refuses the body with."""
    path = folder / f"{tried.file}.yaml"
    geometry = f"geometry: {{family: own, file: {tried.file}, {tried.keys}}}"
    material = "material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49}"
    path.write_text(f"name: tried\n{geometry}\n{material}\npressures: [{PRESSURE} kPa]\n", encoding="utf-8")
    config = load_config(path)
    scene = Scene.meshed(config)
    mesh, air = scene.body.mesh, sum(config.design.cavity_volumes.values())
    elements = f"{len(mesh.tets)}", f"{mesh.quality.minimum:.2g}"
    if tried.file in MESHED_ALONE:
        return (*elements, "", f"{air:.0f}"), 0.0
    experiment = fem.Experiment.of("II", scene.body, 0.0)
    model = experiment.model(scene.material, scene.effects(PRESSURE / 1000), config.mesh.formulation)
    step = fem.follow(model, [1.0]).steps[-1]
    deflection = float(experiment.end(step)[1]) - scene.body.curve_y
    return (*elements, f"{deflection:.3f}", f"{air:.0f}"), deflection


def main() -> int:
    """0 where every body is bent, and every finger as the first one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results/foreign"))
    parser.add_argument("--only", nargs="*", help="names of files")
    given = parser.parse_args()
    given.results.mkdir(parents=True, exist_ok=True)
    outcomes = []
    for tried in write_tried(given.results):
        if given.only is None or tried.file in given.only:
            outcomes.append(outcome(tried, given.results))
            sys.stderr.write(f"{tried.file}: {outcomes[-1].words}\n")
    sys.stdout.write(f"{table(HEAD, [one.row for one in outcomes])}\n")
    fingers = [one.deflection for one in outcomes if one.tried.file not in OTHERS]
    differ = any(abs(deflection - fingers[0]) > DIFFERENT * abs(fingers[0]) for deflection in fingers)
    return int(differ or any(one.failure for one in outcomes))


if __name__ == "__main__":
    sys.exit(main())
