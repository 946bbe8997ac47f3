"""The files of a bench: what is measured of an arm as built, with noise, and what is true where it is predicted."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.virtual_arms.designs import VirtualArm
from benchmarks.virtual_arms.measured import Measurement, Row

#: standard deviations of the noise: of positions in mm, of angles in degrees
NOISE_MM, NOISE_DEG = 0.3, 1.0
COLUMNS = ("pressure_kPa", "force_x_N", "force_y_N", "held_y_mm", "tip_x_mm", "tip_y_mm", "end_angle_deg", "reaction_N")
#: what is predicted, in the order of the rows of the second file
WHAT = ("tip between", "tip beyond", "tip under a force", "force")


def write_measured(arm: VirtualArm, measurement: Measurement, path: Path, loaded: bool = False) -> None:
    """Write the rows that an arm is calibrated on: its free end, with noise; loaded: and that under the dead force."""
    rng = np.random.default_rng([arm.seed, arm.number, 3])
    lines = []
    rows = measurement.of("II", arm.measured_kPa)
    for row in (*rows, *(measurement.of("dead", [arm.loaded_kPa]) if loaded else ())):
        x, y = rng.normal(row.tip_mm, NOISE_MM)
        angle = rng.normal(row.angle_deg, NOISE_DEG)
        force = row.force_N if row.experiment == "dead" else ("", "")
        lines.append([row.pressure_kPa, *force, "", round(x, 2), round(y, 2), round(angle, 1), ""])
    _write(path, lines)


def write_true(arm: VirtualArm, measurement: Measurement, path: Path) -> None:
    """Write the rows that are predicted, without noise: `WHAT`, of those states that the arm as built has."""
    free = measurement.of("II", arm.predicted_kPa)
    rows = [*free, *measurement.of("dead", [arm.loaded_kPa]), *measurement.of("III", [arm.loaded_kPa])]
    _write(path, [_true(row) for row in rows])


def _true(row: Row) -> list[object]:
    if row.experiment == "III":
        return [row.pressure_kPa, "", "", row.tip_mm[1], "", "", "", row.force_N[1]]
    force = row.force_N if row.experiment == "dead" else ("", "")
    return [row.pressure_kPa, *force, "", *row.tip_mm, "", ""]


def _write(path: Path, lines: Sequence[Sequence[object]]) -> None:
    text = "\n".join(",".join(map(str, line)) for line in [COLUMNS, *lines])
    path.write_text(text + "\n", encoding="utf-8")
