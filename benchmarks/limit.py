"""The limit pressure of a measured arm, by the law of its silicone: python -m benchmarks.limit.

One cell of the arm c5-w7 (tests/data/moseley_c5w7.yaml) is followed along the volume of its air on three meshes, with
the law of its authors and with three that `pneurod material` fits to their uniaxial test. The table of docs/cell.md.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pneurod
from benchmarks.markdown import ROOT, table, write_made
from fem.cell.inflation import extreme_pressures
from fem.cell.piece import BendingPiece
from pipeline.answers.material.sentences import yaml_line
from pipeline.config.load import load_config
from pipeline.law.mesh_limit import INFLATED
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.snap import RATIO
from pipeline.simulate.scene import Scene
from pipeline.values.pressure import in_kPa, in_MPa
from pipeline.values.richardson import extrapolate_all

ARM, TEST = ROOT / "tests/data/moseley_c5w7.yaml", ROOT / "tests/data/moseley/uniaxial.csv"
#: mm, sizes of the meshes; kPa, up to which a limit is looked for
SIZES, HIGHEST = (1.8 * RATIO**2, 1.8 * RATIO, 1.8), 45.0
#: laws by the name that `pneurod material` gives them, and pressures in kPa at which the curvature is told
LAWS = {"": 44.0, "yeoh": 36.0, "ogden 2": 28.0, "neo_hooke": 26.0}
QUANTITIES = ("limit, kPa", "κ₀, 1/m")


def materials() -> Iterator[tuple[str, list[str], float]]:
    """Name, settings and pressure of each law."""
    with TemporaryDirectory() as folder:
        fits = {fit.name: yaml_line(fit, None) for fit in pneurod.material([TEST], Path(folder)).judged.usable}
    for name, pressure in LAWS.items():
        yield name or "ogden 3, the authors'", [f"material={fits[name].partition(': ')[2]}"] if name else [], pressure


def on_mesh(cell: BendingPiece, pressure: float) -> dict[str, float]:
    """The numbers of a cell by QUANTITIES, without those that it does not have; the last at a pressure in kPa."""
    found, _ = extreme_pressures(cell, in_MPa(HIGHEST))
    at = 1e3 * cell_without_moment(cell, in_MPa(pressure)).state.angle / cell.body.length
    limit = {QUANTITIES[0]: in_kPa(found[0].pressure)} if found else {}
    return {**limit, QUANTITIES[1]: at}


def rows() -> Iterator[list[str]]:
    """One per law: its numbers with their deviations in the limit, and those of the finest mesh in brackets."""
    for name, settings, pressure in materials():
        pieces = ArmPieces.of(Scene.meshed(load_config(ARM, settings)))
        by_size = {size: on_mesh(pieces.with_mesh_size(size).cell, pressure) for size in SIZES}
        limits = extrapolate_all(by_size)
        cells = [
            f"{limits[one].limit:.2f}±{INFLATED * limits[one].limit_std:.2f} ({by_size[SIZES[-1]][one]:.2f})"
            if one in limits and one in by_size[SIZES[-1]] else "none" for one in QUANTITIES
        ]  # fmt: skip
        sys.stderr.write(f"{name} {settings}: {by_size}\n")
        yield [name, *cells[:-1], f"{pressure:g} kPa: {cells[-1]}"]


def main() -> None:
    """Write the table of docs/cell.md."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    write_made("python -m benchmarks.limit", table(["law", *QUANTITIES], list(rows())))


if __name__ == "__main__":
    main()
