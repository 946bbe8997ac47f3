"""True and stated errors of the limit to which a cell is corrected: python -m benchmarks.cell_limit OUT [--seed S].

For the coarse arms, or designs drawn at random, the limit from the meshes that the program compares stands beside that
from FINER finer ones. What is solved stays in the folder OUT, so that the program goes on where it was interrupted.
"""

import argparse
import json
import sys
from collections.abc import Iterator
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

from benchmarks.unseen.designs import drawn
from fem.cell.piece import PieceFailed
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.law.build import fine_mesh
from pipeline.law.mesh_limit import PLANE, scales_of
from pipeline.law.meshes import MESHES, find_limit
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.pressure import in_MPa

#: finer meshes for the true error
FINER = 2
ARMS = (
    ("semicircular_coarse", "svk"),
    ("semicircular_single_coarse", "svk"),
    ("bisected_circle_coarse", "svk"),
    ("pneunet_coarse", "svk"),
    ("pneunet_coarse", "hencky"),
)


def configs(seed: int | None, count: int) -> Iterator[Config]:
    """The coarse arms, or so many designs of a seed."""
    if seed is None:
        yield from (load_config(Path(f"configs/{name}.yaml"), [f"material.law={law}"]) for name, law in ARMS)
        return
    for design in drawn(seed, count):
        with TemporaryDirectory() as folder:
            file = Path(folder) / "drawn.yaml"
            file.write_text(yaml.safe_dump(json.loads(json.dumps(dict(design.document), default=float))))
            yield load_config(file, [])


def rows(config: Config, out: Path) -> Iterator[str]:
    """One row per pressure: the true errors and the stated ones of the three numbers, in %; out: folder of the cell."""
    arm = ArmPieces.of(Scene.meshed(config))
    pieces, length = arm.with_mesh(fine_mesh(arm)), config.design.length
    bends, name = {0.0: 0.0}, f"{config.name}, {config.material.law}"
    for pressure in config.pressures_kPa:
        try:
            cell = pieces.cell
            bends[pressure] = cell_without_moment(cell, in_MPa(pressure)).state.angle / cell.body.length
        except PieceFailed as failure:
            yield f"| {name}, {pressure:g} kPa | {failure} |"
    with open_store(out, config, fresh=False) as store:
        context = RunContext.alone(store, Silent())
        used, true = (find_limit(pieces, bends, inf, context, MESHES + more) for more in (0, FINER))
    for pressure, own in used.limits.items():
        if pressure:
            limit = true.limits[pressure]
            scales = scales_of(limit, length)
            rows = ((own[one].value - limit[one].value, own[one].std, scales[one]) for one in PLANE)
            cells = [f"{100.0 * error / c:+.2f} | {100.0 * std / c:.2f}" for error, std, c in rows]
            yield f"| {name}, {pressure:g} kPa | {' | '.join(cells)} | {len(true.meshes)} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="True and stated errors of the limit that a cell is corrected to.")
    parser.add_argument("out", type=Path, help="folder for what is solved")
    parser.add_argument("--seed", type=int, help="of designs drawn at random; default: the four coarse arms")
    parser.add_argument("--count", type=int, default=10, help="how many of them")
    given = parser.parse_args()
    heads = " | ".join(f"{name}: error | stated" for name in PLANE)
    sys.stdout.write(f"| cell | {heads} | meshes |\n")
    for one in configs(given.seed, given.count):
        for row in rows(one, given.out / f"{one.name}_{one.material.law}"):
            sys.stdout.write(f"{row}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
