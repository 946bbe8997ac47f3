"""The mesh of a body as the files of a run have it."""

from pathlib import Path

import numpy as np
import pyvista

from geometry.arrays import Array, Index


def read_tetrahedra(path: Path) -> tuple[Array, Index]:
    """Points (n, 3) in mm and the corners (m, 4) of the tetrahedra of a .vtu file of a run."""
    grid = pyvista.read(path)
    cells = grid.cells_dict
    tets = cells[pyvista.CellType.TETRA if pyvista.CellType.TETRA in cells else pyvista.CellType.QUADRATIC_TETRA]
    return np.asarray(grid.points, float), np.asarray(tets[:, :4])
