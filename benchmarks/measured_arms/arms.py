"""The measured arms: their configurations, and what was read of them as rows that `pneurod compare` takes.

Moseley, Florez, Sonar, Agarwal, Curtin, Paik, Advanced Engineering Materials 18 (2016), and the files of its repository
spa-design-tool (84d250a). docs/measured_arms.md says what is known of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd

from pipeline.answers.measured.rows import Measurements
from pipeline.answers.measured.table import read_measurements
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.law.build import build_law
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from rod.arm_law.law import ArmLaw

HERE = Path(__file__).parent
#: kPa at which angles are zero; mm, height of the bottom of the tip over the material curve
ZERO, BOTTOM = 10.0, -0.25
#: kPa at which the law of the cell is measured, close to each other where it is steep. The next curve, at 51 kPa, ends
#: far from straight, so that none is joined with it; the last row that a soft arm has is then at 37 kPa
PRESSURES = (11.0, 20.0, 28.0, 33.0, 36.0, 38.0, 39.5, 40.2, 41.0, 42.0, 43.0, 46.0)
TOP = 37.0


@dataclass(frozen=True)
class Arm:
    """One of the arms."""

    name: str  #: as in the files of its authors
    cells: str  #: name of the configuration whose law it has
    length: float  #: mm

    @property
    def slug(self) -> str:
        """For files."""
        return self.name.replace("-", "")


GIVEN, LONGER = Arm("c5-w7", "c5w7", 52.0), Arm("c7-w7", "c5w7", 70.0)


def config_of(arm: Arm, settings: Sequence[str] = ()) -> Config:
    """The configuration of an arm with the pressures of its law."""
    pressures = ", ".join(f"{pressure:g} kPa" for pressure in PRESSURES)
    return load_config(HERE / f"{arm.cells}.yaml", [f"pressures=[{pressures}]", *settings])


def law_of(arm: Arm, folder: Path) -> ArmLaw:
    """The law of an arm with its authors' silicone, as a draft has it; its curves are kept in a folder.

    Both arms with walls of 7 mm have the law of one cell.
    """
    config = config_of(arm, ["draft=true"])
    with open_store(folder / arm.cells, config) as store:
        pieces = ArmPieces.of(Scene.meshed(config))
        measured = build_law(pieces, config.pressures_kPa, RunContext.alone(store, Silent()), between=False)
    return replace(measured.law, length=arm.length)


def directions(
    arm: Arm, folder: Path, pressures: Sequence[float] = (), file: str = "bending_angle.csv"
) -> Measurements:
    """Rows of the direction of the tip; at some pressures, all by default."""
    rows = pd.read_csv(HERE / file)
    rows = rows[rows["pressure_kPa"] <= TOP]
    rows = rows[(rows["arm"] == arm.name) & (rows["pressure_kPa"].isin(pressures) | (not len(pressures)))]
    return asked(arm, folder, rows["pressure_kPa"].tolist(), rows["angle_deg"].tolist())


def asked(arm: Arm, folder: Path, pressures: Sequence[float], angles: Sequence[float]) -> Measurements:
    """Rows of the direction of the tip, degrees, at pressures in kPa."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{arm.slug}_direction.csv"
    lines = [f"{p:g},{angle:g},{ZERO:g},{BOTTOM:g}" for p, angle in zip(pressures, angles, strict=True)]
    path.write_text("\n".join(["pressure_kPa,-tip_direction_deg,zero_kPa,at_y_mm", *lines]) + "\n", encoding="utf-8")
    return read_measurements(path)


def second_test() -> dict[float, float]:
    """Degrees by kPa of the second test of the longer arm, whose zero is not stated."""
    rows = pd.read_csv(HERE / "bending_in_steps.csv")
    return dict(zip(rows["pressure_kPa"].astype(float), rows["angle_deg"].astype(float), strict=True))
