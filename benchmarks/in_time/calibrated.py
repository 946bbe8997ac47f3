"""Laws in closed form of the measured bodies, and their measured motions as rows of `pneurod calibrate`."""

import csv
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from benchmarks.experiments.bar import GRAVITY, Bar
from pipeline.answers.measured.rows import Measurements
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
        clamps.append(ClampCurve(p, moment, *3 * [0.0 * ones], still, still, at, np.zeros((n, 2, 2))))
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


def rows_of_bar(file: Path, forces: tuple[float, ...]) -> Measurements:
    """The takes under some forces on the end, in N, which masses stand for."""
    takes = pd.read_csv(HERE / "eth_beam_release.csv", comment="#")
    rows = []
    for _, row in takes[takes["edge_force_N"].isin(forces)].iterrows():
        up = row["u_up_mm"]
        turn = np.arcsin((row["u_along_mm"] + 0.5 * up**2 / 100.0) / ABOVE)  # the middle comes nearer as it falls
        middle = up + ABOVE * (1.0 - np.cos(turn))
        rows.append(
            (row["t_s"], 0.0, f"{middle:.3f}", f"{1e6 * row['edge_force_N'] / GRAVITY:.3f}", "lying", row["repeat"])
        )
    return _written(file, ("t_s", "pressure_kPa", "tip_y_mm", "tip_mass_g", "orientation", "repeat"), rows)


def rows_of_holds(file: Path, pressures: tuple[float, ...]) -> Measurements:
    """Some holds of the segment, means of 0.1 s: its vibrations are not looked at, because its mass is not known."""
    holds = pd.read_csv(HERE / "sopra_hold.csv", comment="#")
    kept = holds[holds["pressure_kPa"].isin(pressures) & holds["t_s"].between(*HELD)]
    means = kept.groupby(["pressure_kPa", (10.0 * kept["t_s"] + 1e-6).astype(int)]).mean(numeric_only=True)
    rows = [(p, *mean) for (p, _), mean in zip(means.index, means[["t_s", "tip_distance_mm"]].to_numpy(), strict=True)]
    return _written(file, ("pressure_kPa", "t_s", "tip_distance_mm"), rows)


def _written(file: Path, titles, rows) -> Measurements:
    with file.open("w", encoding="utf-8", newline="") as lines:
        csv.writer(lines).writerows([titles, *rows])
    return read_measurements(file)
