"""An arm with three chambers: the rod with its law in space against finite elements of the whole arm.

    make space
    python -m benchmarks.three_chambers [--results results/three_chambers]

The law is that of `benchmarks/short_three_chambers/arm.yaml`, between its rows of pressures. The whole arm has the same
mesh and pressures that are none of these rows: half and all of 18, 9 and 1.8 kPa. At the highest ones forces along y, z
and x act on its end.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.markdown import table, write_made
from benchmarks.whole_arm import NodalForces, at_full_pressure, reached
from fem import Experiment, Model
from fem.solution import Step
from fem.supports import nodes_at
from geometry.arrays import Array
from pipeline.config.document import read_document
from pipeline.config.load import load_config
from pipeline.law.rows import read_rows
from pipeline.law.study import measure_any_law
from pipeline.simulate.scene import Scene
from pipeline.store.progress import Silent
from pipeline.values.pressure import in_MPa
from rod.arm_law.space_law import SpaceLaw
from rod.load import Load

CONFIG = Path("benchmarks/short_three_chambers/arm.yaml")
#: of the pressure, by cavity, in the whole arm, and its pressures in kPa
FRACTIONS, PRESSURES = {"first": 1.0, "second": 0.5, "third": 0.1}, (9.0, 18.0)
#: N, forces on the end, and the part of each that acts first
FORCES, PART = ((0.0, 0.012, 0.0), (0.0, 0.0, 0.012), (0.012, 0.0, 0.0)), 0.2


def solved() -> Iterator[dict[str, Any]]:
    """Finite elements of the whole arm: pressure, force, and the material curve (mm) and air (mm3) of each state."""
    cavities = ", ".join(f"{name}: {part}" for name, part in FRACTIONS.items())
    pressures = ", ".join(f"{pressure} kPa" for pressure in PRESSURES)
    config = load_config(CONFIG, [f"pressures=[{pressures}]", f"effects.pressure.cavities={{{cavities}}}"])
    scene = Scene.meshed(config)
    experiment, effects = Experiment.of("II", scene.body, None), scene.effects(in_MPa(PRESSURES[-1]))

    def model(*added: NodalForces) -> Model:
        supports, acting = list(experiment.supports), [*effects, *added]
        return Model(scene.body.mesh, scene.material, supports, acting, config.mesh.formulation)

    free = model()
    curve, edge = (nodes_at(line, free.space) for line in (experiment.curve, experiment.edge))

    def told(step: Step) -> dict[str, Any]:
        air = [step.cavity_volume(name) for name in scene.body.cavities]
        return {"curve_mm": step.positions[curve].tolist(), "air_mm3": air}

    steps = reached(free, [pressure / PRESSURES[-1] for pressure in PRESSURES], ())
    for pressure, step in zip(PRESSURES, steps, strict=True):
        yield {"pressure_kPa": pressure, "force_N": [0.0] * 3, **told(step)}
    last = steps[-1]
    start = replace(last, factor=0.0, rate=None, active=(*last.active, True), contacts=(*last.contacts, None))
    effects = [at_full_pressure(effect, 1.0) for effect in effects]
    for force in FORCES:
        nodal = np.zeros_like(last.positions)
        np.add.at(nodal, edge, experiment.edge.nodal_weights(free.space)[:, None] * np.array(force))
        for step in reached(model(NodalForces(nodal)), [0.0, PART, 1.0], [start])[1:]:
            acting = (step.factor * np.array(force)).tolist()
            yield {"pressure_kPa": PRESSURES[-1], "force_N": acting, **told(step)}


def rod_of(law: SpaceLaw, state: Mapping[str, Any]) -> tuple[Array, Array]:
    """(n, 3) mm and (3,) mm3: the curve of the rod under the same loads, and its air."""
    rod = law.at([state["pressure_kPa"] * part for part in FRACTIONS.values()])
    fx, fy, fz = state["force_N"]
    shape = rod.solve_in_space(Load((fx, fy, fz)))
    return shape.curve, rod.volumes(shape)


def main() -> int:
    """0 where the end of the rod is within 0.2 % of the length."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results/three_chambers"))
    given = parser.parse_args()
    spec = read_rows(read_document(CONFIG))
    assert spec is not None
    law = measure_any_law(spec, given.results / "law", 2, False, Silent()).measured.law
    assert isinstance(law, SpaceLaw)
    file = given.results / "whole_arm.json"
    if not file.exists():
        file.write_text(json.dumps(list(solved())) + "\n", encoding="utf-8")
    states = json.loads(file.read_text(encoding="utf-8"))
    rods = [rod_of(law, state) for state in states]
    curves = [(rod[0], np.array(state["curve_mm"])) for rod, state in zip(rods, states, strict=True)]
    free = curves[len(PRESSURES) - 1]
    rows = []
    for state, (_, air), (own, solid) in zip(states, rods, curves, strict=True):
        missed, moved = own[-1] - solid[-1], solid[-1] - free[1][-1]
        away = float(np.linalg.norm(missed - (free[0][-1] - free[1][-1])))
        error = f"{100 * away / np.linalg.norm(moved):.2f}" if any(state["force_N"]) else ""
        force = ", ".join(f"{part:g}" for part in state["force_N"])
        end = ", ".join(f"{part:.2f}" for part in solid[-1])
        size = 100 * float(np.linalg.norm(missed)) / law.length
        missing = ", ".join(f"{100 * part:.2f}" for part in air / state["air_mm3"] - 1.0)
        rows.append([f"{state['pressure_kPa']:g}", force, end, f"{size:.3f}", error, missing])
    heads = ["pressure, kPa", "force, N", "end, mm", "rod: error of the end, % of l", "of what the force moves, %"]
    heads.append("of the air, %")
    write_made("python -m benchmarks.three_chambers", table(heads, rows))
    sys.stdout.write(f"{table(heads, rows)}\n")
    draw(curves, given.results / "three_chambers.png")
    return int(max(float(row[3]) for row in rows) > 0.2)


def draw(curves: list[tuple[Array, Array]], file: Path) -> None:
    """Rods as lines and finite elements as points, from the side and from above."""
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    for axes, row in zip(figure.subplots(1, 2), (1, 2), strict=True):
        for colour, (own, solid) in enumerate(curves):
            axes.plot(solid[::-3, 0], solid[::-3, row], "o", ms=3, mfc="none", color=f"C{colour}")
            axes.plot(own[:, 0], own[:, row], lw=1, color=f"C{colour}")
        axes.set(xlabel="x, mm", ylabel=f"{'xyz'[row]}, mm (enlarged)")
    figure.savefig(file, dpi=110)


if __name__ == "__main__":
    sys.exit(main())
