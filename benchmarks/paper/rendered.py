"""Figs 3 and 14: bodies at 37 kPa, drawn from the states of the sweeps."""

import io
import json
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.image
import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.data import ARMS, Data
from benchmarks.paper.drawing import ARM_NAMES, NotThere
from fem import Discretisation
from geometry.arrays import Array
from pipeline.config.load import load_config
from pipeline.show.drawing import Colour, draw_deformed
from pipeline.simulate.scene import Scene

#: kPa
PRESSURE = 37.0
TESTS = {
    "I": "(a) Test I: free",
    "II": "(b) Test II: clamped at one end",
    "III": "(c) Test III: clamped, and the height of the other end held",
}


def tests(data: Data) -> Figure:
    """Fig. 3: the pneu-net in I, II and III."""
    pictures = {title: _picture(data.sweeps["pneunet"], ARMS[0], name) for name, title in TESTS.items()}
    return _stacked(f"Fig. 3: the pneu-net at {PRESSURE:g} kPa, svk, coloured by displacement", pictures, 1)


def bodies(data: Data) -> Figure:
    """Fig. 14: the four arms in III."""
    pictures = {
        ARM_NAMES[arm]: _picture(data.sweeps["pneunet" if arm == ARMS[0] else "arms"], arm, "III") for arm in ARMS
    }
    return _stacked(f"Fig. 14: four arms in Test III at {PRESSURE:g} kPa, svk, coloured by displacement", pictures, 2)


def _picture(sweep: Path, arm: str, experiment: str) -> Array:
    """A picture (h, w, 4) of a state of a sweep with the St. Venant-Kirchhoff law. Raises `NotThere`."""
    missing = NotThere(f"experiment {experiment} of {arm} with svk at {PRESSURE:g} kPa")
    record = json.loads((sweep / "sweep.json").read_text(encoding="utf-8"))
    for point in record["points"]:
        values = {**record["set"], **point["values"]}
        config = load_config(Path(record["base"]), [f"{key}={json.dumps(value)}" for key, value in values.items()])
        if config.family == arm and config.material.law == "svk":
            state = sweep / point["folder"] / "states" / f"{experiment}_{PRESSURE:g}kPa.npz"
            if not state.is_file():
                raise missing
            body = Scene.meshed(config).body
            space = Discretisation.of(body.mesh, config.mesh.formulation)
            with np.load(state, allow_pickle=False) as stored:
                displacement = np.array(stored["displacement"]).reshape(-1, 3)
            size = Colour(np.linalg.norm(displacement, axis=1), "displacement (mm)")
            with TemporaryDirectory() as folder:
                file = Path(folder) / "picture.png"
                draw_deformed(file, space.points, space.nodes, displacement, size, mirrored=body.half)
                return np.asarray(matplotlib.image.imread(io.BytesIO(file.read_bytes())))
    raise missing


def _stacked(title: str, pictures: dict[str, Array], columns: int) -> Figure:
    rows = -(-len(pictures) // columns)
    figure = Figure(figsize=(6.0 * columns, 0.5 + 3.4 * rows), layout="constrained", dpi=150)
    figure.suptitle(title, fontsize=11)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel, (name, picture) in zip(panels, pictures.items(), strict=True):
        panel.imshow(picture)
        panel.set_title(name, fontsize=9)
        panel.axis("off")
    return figure
