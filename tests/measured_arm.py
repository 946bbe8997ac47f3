"""An arm with a law in closed form, its result folder, and measurements of one that was built otherwise."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from pipeline.answers.measured.predicted import LawRods, Numbers, Setup
from pipeline.answers.measured.rows import Measurements, Row, State
from pipeline.results.laws import law_record
from pipeline.show.drawing import write_fields
from pipeline.values.formats import FORMAT
from pipeline.values.record import MeshRecord
from rod import ArmLaw
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from rod.weight import Mass

LENGTH, PITCH, EI = 110.0, 10.0, 400.0
#: curvature without moment per pressure, 1/(mm kPa), and its change by a wall that is thicker by 1 mm, over it
BENDING, THICKER = -5e-4, -0.8


def arm_law(highest: float = 40.0) -> ArmLaw:
    """Curvatures in proportion to the pressure, one rigidity, and derivatives by a wall of 1 mm."""
    pressures = np.linspace(0.0, highest, 5)
    parts = [parts_of(float(pressure), BENDING * float(pressure), BENDING) for pressure in pressures]
    cells, clamps, tips = zip(*parts, strict=True)
    rates = LawRate(
        1.0, "mm", 0.0, 0.0, 0.0,
        tuple(CellRate(-EI * THICKER * BENDING * p * np.ones(9), np.zeros(9), np.zeros((9, 2, 2)), np.array(0.0))
              for p in pressures),
        tuple(ClampRate(np.zeros(9), np.zeros((9, 2))) for _ in pressures),
    )  # fmt: skip
    return ArmLaw(PITCH, 5.0, LENGTH, cells, clamps, tips, Mass.even(LENGTH, 20.0), rates={"geometry.wall": rates})


def parts_of(pressure: float, kappa_0: float, slope: float) -> tuple[CellCurve, ClampCurve, TipCurve]:
    """A cell with M = EI (kappa - kappa_0), and ends that are cells too; slope: of kappa_0 by the pressure."""
    moment, ones = np.linspace(-40.0, 40.0, 9), np.ones(9)
    cell = CellCurve(
        pressure, moment, kappa_0 + moment / EI, EI * ones, -EI * slope * ones, ones, 0 * ones, 0 * ones,
        1e9 * ones, 1e9 * ones, np.zeros(9, bool), ones, np.array([0.0, 2.5, 5.0]), np.zeros((9, 3, 2)),
    )  # fmt: skip
    still, pair = np.zeros((9, 2)), np.zeros((2, 2))
    at = np.array([0.0, 10.0])
    clamp = ClampCurve(pressure, moment, 0 * ones, 0 * ones, 0 * ones, still, still, at, np.zeros((9, 2, 2)))
    turns = np.zeros(4), np.zeros((4, 2)), np.zeros((4, 2, 2))
    return cell, clamp, TipCurve(pressure, at - 10.0, pair, np.zeros(2), *turns, pair, pair)


def result_folder(folder: Path, law: ArmLaw | None = None) -> Path:
    """What `pneurod cell` leaves of it, without pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    config = {"name": "closed_form", "geometry": {"wall": 1.0}, "pressures_kPa": [20.0], "end": {"y_mm": 0.0}}
    (folder / "law.json").write_text(json.dumps(law_record(law or arm_law())), encoding="utf-8")
    (folder / "run.json").write_text(json.dumps({"format": FORMAT, "config": config}), encoding="utf-8")
    return folder


def with_body(folder: Path) -> Path:
    """The same folder with the mesh of a box of 110 x 10 x 12 mm, half of it, and a material."""
    corners = np.array([[x, y, z] for x in (0.0, LENGTH) for y in (0.0, 10.0) for z in (0.0, 6.0)])
    tetrahedra = np.array([[0, 1, 2, 4], [3, 1, 2, 7], [5, 1, 4, 7], [6, 2, 4, 7], [1, 2, 4, 7]])
    write_fields(folder / "mesh.vtu", corners, tetrahedra)
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    run["config"]["material"] = {"law": "neo_hooke", "mu": 0.15, "kappa": 15.0}
    run["mesh"] = asdict(MeshRecord(4.0, False, "p2p0", "walls", 10.0, 1.0, {}, 5, 9.0, 110.0, 0.1, 1.0))
    (folder / "run.json").write_text(json.dumps(run), encoding="utf-8")
    return folder


def measured(file: Path, law: ArmLaw, states: list[State], scatter: float = 0.0, setup: Setup | None = None) -> Path:
    """A file of the tip in some states of a built arm, and of the reaction where it is held; scatter: mm."""
    rows = ["pressure_kPa;tip_x_mm;tip_y_mm;force_y_N;held_y_mm;reaction_N"]
    random, rig = np.random.default_rng(1), setup or Setup()
    names = [("tip_x", "tip_y") if state.held_y_mm is None else ("reaction",) for state in states]
    empty = tuple(
        Row(k, state, dict.fromkeys(of, 0.0)) for k, (state, of) in enumerate(zip(states, names, strict=True))
    )
    read = Numbers.of(Measurements("", empty)).predicted(LawRods(law), rig).tolist()
    for state in states:
        cells = [f"{state.pressure_kPa:g}", "", "", f"{state.force_N[1]:g}", "", ""]
        if state.held_y_mm is None:
            cells[1:3] = [f"{read.pop(0) + scatter * random.normal():.4f}" for _ in range(2)]
        else:
            cells[3:] = ["", f"{state.held_y_mm:g}", f"{read.pop(0):.6f}"]
        rows.append(";".join(cells).replace(".", ","))
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return file
