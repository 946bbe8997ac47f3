"""Laws in closed form of the measured bodies, and their measured motions as rows of `pneurod calibrate`."""

import csv
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from benchmarks.experiments.bar import GRAVITY, Bar
from benchmarks.experiments.cases import read_case
from benchmarks.in_time.measured import FITTED, Line
from pipeline.answers.measured.calibration import calibrated
from pipeline.answers.measured.predicted import LawRods, Numbers
from pipeline.answers.measured.rows import VIBRATION, Measurements
from pipeline.answers.measured.table import read_measurements
from rod import ArmLaw
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.weight import Mass

HERE = Path(__file__).parent
#: of a rectangular section in shear; mm, of the markers above the middle of the face of the bar
SHEAR, ABOVE = 0.85, 21.0
#: mm, of the segment between its clamp and its tip; N mm2, so that its law has a rigidity, which does not matter
SEGMENT, RIGIDITY = 120.0, 1e4
#: s, of holds that are looked at
HELD = 0.6, 2.8
#: kPa, of the holds that are foretold
HOLDS = 25.0, 30.0, 35.0, 40.0, 45.0
#: s, when the curve was read; kPa, up to which its law goes
CURVE, BEYOND = (1.0, 1.5), 65.0


def closed_law(length: float, kappa: dict[float, float], rigidities: tuple[float, float, float], mass: Mass) -> ArmLaw:
    """The law of a rod with one rigidity and a curvature in 1/mm at each pressure in kPa.

    rigidities: against bending in N mm2, stretch and shear in N.
    """
    pitch, n = 0.1 * length, 9
    bending, axial, shear = rigidities
    moment, ones, still, pair = np.linspace(-0.04, 0.04, n) * bending, np.ones(n), np.zeros((n, 2)), np.zeros((2, 2))
    by_pressure = -bending * np.gradient(list(kappa.values()), list(kappa))
    at = np.array([0.0, pitch])
    cells, clamps, tips = [], [], []
    for (p, free), slope in zip(kappa.items(), by_pressure, strict=True):
        cells.append(CellCurve(
            p, moment, free + moment / bending, bending * ones, slope * ones, ones, 0.0 * ones, 0.0 * ones,
            axial * ones, shear * ones, np.zeros(n, bool), ones, np.array([0.0, 0.25, 0.5]) * pitch,
            np.zeros((n, 3, 2)),
        ))  # fmt: skip
        clamps.append(ClampCurve(p, moment, 0.0 * ones, 0.0 * ones, 0.0 * ones, still, still, at, np.zeros((n, 2, 2))))
        turns = np.zeros(4), np.zeros((4, 2)), np.zeros((4, 2, 2))
        tips.append(TipCurve(p, at - pitch, pair, np.zeros(2), *turns, pair, pair))
    return ArmLaw(pitch, 0.5 * pitch, length, tuple(cells), tuple(clamps), tuple(tips), mass)


def bar_law(bar: Bar) -> ArmLaw:
    """Of a bar with a rectangular section, without pressure."""
    young, area = bar.law.young_modulus, bar.width * bar.height
    rigidities = young * area * bar.height**2 / 12.0, young * area, SHEAR * bar.law.shear_modulus * area
    return closed_law(
        bar.length, {0.0: 0.0, 1.0: 0.0}, rigidities, Mass.even(bar.length, 1e6 * bar.density * bar.length * area)
    )


def segment_law() -> ArmLaw:
    """Of the segment as an arc, by its tip over the pressure, which holds give; beyond their last it goes on evenly."""
    table, known = (pd.read_csv(HERE / f"sopra_{name}.csv", comment="#") for name in ("hold", "segment"))
    last = table["pressure_kPa"].max()
    at_last = table[(table["pressure_kPa"] == last) & table["t_s"].between(*CURVE)]["tip_distance_mm"].mean()
    pressures = [0.0, *known["pressure_kPa"], last]
    turns = [0.0, *(brentq(_farther, 1e-6, 3.0, tip) for tip in [*known["tip_distance_mm"], at_last])]
    beyond = turns[-1] + (BEYOND - last) * (turns[-1] - turns[-2]) / (last - pressures[-2])
    kappa = {p: -turn / SEGMENT for p, turn in zip([*pressures, BEYOND], [*turns, beyond], strict=True)}
    return closed_law(SEGMENT, kappa, (RIGIDITY, 1e9, 1e9), Mass.even(SEGMENT, 100.0))


def _farther(turn: float, tip: float) -> float:
    """mm, by which the tip of an arc with a turn in rad is farther from that of a straight one than a number."""
    return SEGMENT * float(np.hypot(1.0 - np.sin(turn) / turn, (1.0 - np.cos(turn)) / turn)) - tip


def calibrated_lines(folder: Path) -> Iterator[Line]:
    """Rows of the table: the bar calibrated to all its motions, and holds of the segment by that at `FITTED`.

    folder: of the files that are calibrated to.
    """
    case = read_case(HERE.parent / "experiments" / "eth_beam")
    assert isinstance(case.body, Bar)
    found = calibrated(bar_law(case.body), {}, rows_of_bar(folder / "bar.csv"))
    for load, names in product(dict.fromkeys(row.load for row in found.predictions), VIBRATION):
        at = [row for row in found.predictions if (row.load, row.quantity) == (load, names)]
        if at:
            known, own = float(np.mean([row.measured for row in at])), at[0].predicted
            goal = "3 %" if names == VIBRATION[0] else "20 %"
            shown = f"{100.0 * (own / known - 1.0):+.1f} %"
            yield f"bar, calibrated, {load}", names, f"{known:.3g}", f"{own:.3g}", shown, goal
    found = calibrated(segment_law(), {}, rows_of_hold(folder / "hold.csv", FITTED))
    for pressure in HOLDS:
        numbers = Numbers.of(rows_of_hold(folder / "hold.csv", pressure))
        by_rod = numbers.predicted(LawRods(found.law, found.rubber), found.setup)
        known, own = (float(tips[-1] / tips[0] - 1.0) for tips in (numbers.values, by_rod))
        words = f"segment, calibrated at {FITTED:g} kPa, {pressure:g} kPa", "creep"
        yield *words, f"{100 * known:.1f} %", f"{100 * own:.1f} %", f"{100 * (own / known - 1.0):+.0f} %", "20 %"


def rows_of_bar(file: Path) -> Measurements:
    """All takes; masses stand for the forces on the end."""
    rows = []
    for _, row in pd.read_csv(HERE / "eth_beam_release.csv", comment="#").iterrows():
        up = row["u_up_mm"]
        turn = np.arcsin((row["u_along_mm"] + 0.5 * up**2 / 100.0) / ABOVE)  # the middle comes nearer as it falls
        middle, grams = up + ABOVE * (1.0 - np.cos(turn)), 1e6 * row["edge_force_N"] / GRAVITY
        rows.append((row["t_s"], 0.0, f"{middle:.3f}", f"{grams:.3f}", "lying", row["repeat"]))
    return _written(file, ("t_s", "pressure_kPa", "tip_y_mm", "tip_mass_g", "orientation", "repeat"), rows)


def rows_of_hold(file: Path, pressure: float) -> Measurements:
    """A hold of the segment, means of 0.1 s: its vibrations are not looked at, because its mass is not known."""
    holds = pd.read_csv(HERE / "sopra_hold.csv", comment="#")
    kept = holds[(holds["pressure_kPa"] == pressure) & holds["t_s"].between(*HELD)]
    means = kept.groupby((10.0 * kept["t_s"] + 1e-6).astype(int)).mean()
    return _written(file, tuple(means.columns), means.to_numpy().tolist())


def _written(file: Path, titles: Sequence[str], rows: Sequence[Sequence[object]]) -> Measurements:
    with file.open("w", encoding="utf-8", newline="") as lines:
        csv.writer(lines).writerows([titles, *rows])
    return read_measurements(file)
