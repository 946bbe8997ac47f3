"""The error of the mesh that law.json states, beside the error against a fine mesh of the same elements.

    OMP_NUM_THREADS=1 python benchmarks/cell_mesh_error.py

The four coarse configurations. Renews the table "mesh error" of docs/cell.md. Three minutes.
"""

import sys
from pathlib import Path
from time import process_time

# the rooms stand beside this folder
HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.arguments import parser_of  # noqa: E402
from benchmarks.cell import ARMS, renew, report, table_of  # noqa: E402
from pipeline.cell.mesh_error import COARSER, FINER, deviation, numbers_on  # noqa: E402
from pipeline.cell.pieces import ArmPieces  # noqa: E402
from pipeline.config.load import load_config  # noqa: E402
from pipeline.simulation.scene import Scene  # noqa: E402

#: mm, of the mesh that stands for the limit
FINE = 0.8
#: sizes over that of the law: the mesh of the law, and those from which its error is estimated
FACTORS = (1.0, FINER, COARSER)


def rows_of(name: str) -> list[list[str]]:
    """One row for each pressure."""
    config = load_config(HERE / "configs" / f"{name}_coarse.yaml")
    pieces, size = ArmPieces.of(Scene.meshed(config)), config.mesh.element_size_mm
    change, rows = 1.0 / pieces.design.length, []
    for pressure in config.pressures_kPa:
        kappa, meshes, spent = None, [], []
        for mesh in (*(factor * size for factor in FACTORS), FINE):
            begin = process_time()
            meshes.append(numbers_on(pieces.with_mesh_size(mesh).cell, pressure, kappa, change))
            spent.append(process_time() - begin)
            kappa = 0.5 * meshes[0][0]
        entries = []
        for own, finer, coarser, limit in zip(*meshes, strict=True):
            errors = (abs(own - limit), deviation(FINER, own, finer), deviation(COARSER, own, coarser))
            entries += [f"{100.0 * value / abs(limit):.1f}" for value in errors]
        rows.append([f"{name}, {pressure:g} kPa", *entries, *(f"{seconds:.1f}" for seconds in (spent[1], spent[3]))])
        report(" | ".join(rows[-1]))
    return rows


def main() -> None:
    """The table."""
    parser_of(__doc__).parse_args()
    rows = [row for arm in ARMS for row in rows_of(arm.name)]
    quantities = ("κ₀", "rigidity", "M at κ₀ / 2")
    columns = [f"{name}: {kind}" for name in quantities for kind in ("error", "stated", "from 1.5 times the size")]
    renew("mesh error", table_of(rows, ["arm", *columns, "s, half the size", f"s, {FINE:g} mm"]))


if __name__ == "__main__":
    main()
