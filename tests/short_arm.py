"""A short arm with five parameters on a coarse mesh, and its run, which tests of runs and of Python users read."""

from pathlib import Path

import pneurod
from tests.shared import SharedFolders

SHORT = """
name: short
geometry: {family: pneunet, chambers: 7}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [8 kPa, 16 kPa]
law: five
validation: off
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
"""


def write_short(folder: Path) -> Path:
    """Its configuration."""
    path = folder / "short.yaml"
    path.write_text(SHORT, encoding="utf-8")
    return path


def short_run(shared: SharedFolders, config: Path) -> Path:
    """The folder of its run."""
    return shared.folder("short", lambda out: pneurod.characterize(config, out, jobs=1))
