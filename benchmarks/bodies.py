"""The bodies of the shipped configurations, whole and cut open: docs/pictures/*_body.png and *_open.png.

    python benchmarks/bodies.py [FOLDER]

The pictures are those that a run draws of its body at rest. All five take less than a minute.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE))

from benchmarks.arguments import parser_of  # noqa: E402
from pipeline.config.load import load_config  # noqa: E402
from pipeline.drawing.pictures import draw_body  # noqa: E402
from pipeline.simulation.scene import Scene  # noqa: E402

DOCS = HERE / "docs" / "pictures"
#: configurations that README.md shows
SHOWN = ("pneunet", "semicircular", "semicircular_single", "bisected_circle", "finger")


def draw(name: str, folder: Path) -> None:
    """Write both pictures of the body of a configuration, of which one half is meshed."""
    mesh = Scene.meshed(load_config(HERE / "configs" / f"{name}.yaml")).body.mesh
    draw_body(folder / f"{name}_body.png", mesh.points, mesh.tets)
    draw_body(folder / f"{name}_open.png", mesh.points, mesh.tets, cut_open=True)


def main() -> None:
    """All bodies, into docs/pictures or the given folder."""
    parser = parser_of(__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=DOCS, help="[default: docs/pictures]")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name in SHOWN:
        draw(name, folder)


if __name__ == "__main__":
    main()
