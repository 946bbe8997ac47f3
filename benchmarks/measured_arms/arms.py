"""The measured arms: their configurations, what was read of them, and models that are tried.

Moseley, Florez, Sonar, Agarwal, Curtin, Paik, Advanced Engineering Materials 18 (2016), and the files of its repository
spa-design-tool (84d250a). docs/measured_arms.md says what is known of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from geometry.arrays import Array
from pipeline.config.config import Config
from pipeline.config.load import load_config

HERE = Path(__file__).parent
#: mm, length and breadth of a chamber
CHAMBER, BROAD = 2.0, 8.0
AUTHORS, UNIAXIAL, THIN = "authors", "uniaxial, yeoh", "fabric 0.1 mm"
#: settings of models that are tried. Laws are named by the tests that they were fitted to, as
#: `pneurod material uniaxial.csv planar.csv` finds them
MODELS = {
    AUTHORS: [],  # the law of the configuration
    UNIAXIAL: ["material={law: yeoh, c10: 0.009305 MPa, c20: 3.222e-05 MPa, c30: 1.621e-05 MPa, kappa: 1.855 MPa}"],
    "uniaxial, neo_hooke": ["material={law: neo_hooke, mu: 0.01877 MPa, kappa: 1.87 MPa}"],
    "planar, yeoh": [
        "material={law: yeoh, c10: 0.01397 MPa, c20: 0.0002574 MPa, c30: -1.772e-05 MPa, kappa: 2.785 MPa}"
    ],
    "both, mooney_rivlin": ["material={law: mooney_rivlin, c10: 0.007009 MPa, c01: 0.004995 MPa, kappa: 2.3 MPa}"],
    THIN: ["effects.strain_limiting_layer={thickness: 0.1 mm, E: 4100 MPa, nu: 0.49}"],
}


@dataclass(frozen=True)
class Arm:
    """One of the arms."""

    name: str  #: as in the files of its authors
    chambers: int
    wall: float  #: mm, thickness of all walls

    @property
    def pitch(self) -> float:
        """mm, from one chamber to the next."""
        return CHAMBER + self.wall

    @property
    def length(self) -> float:
        """mm"""
        return self.chambers * self.pitch + self.wall

    def config(self, pressures: Sequence[float], model: str = AUTHORS) -> Config:
        """Its configuration as a draft, for pressures in kPa and one of `MODELS`."""
        walls = [f"{name}={self.wall:g} mm" for name in ("partition", "end_wall", "side_wall", "roof")]
        sizes = f"width={BROAD + 2.0 * self.wall:g} mm", f"height={BROAD + 0.5 + self.wall:g} mm"
        geometry = [f"geometry.{one}" for one in (f"chambers={self.chambers}", *walls, *sizes)]
        steps = ", ".join(f"{pressure:g} kPa" for pressure in pressures)
        return load_config(HERE / "c5w7.yaml", [*geometry, f"pressures=[{steps}]", "draft=true", *MODELS[model]])


GIVEN, LONGER, BLIND = Arm("c5-w7", 5, 7.0), Arm("c7-w7", 7, 7.0), Arm("c5-w10", 5, 10.0)


def angles_of(arm: Arm) -> tuple[Array, Array]:
    """kPa and degrees, (n,) each, of the direction of the tip."""
    rows = pd.read_csv(HERE / "bending_angle.csv")
    rows = rows[rows["arm"] == arm.name]
    return rows["pressure_kPa"].to_numpy(float), rows["angle_deg"].to_numpy(float)


def second_test() -> dict[float, float]:
    """Degrees by kPa of the second test of the longer arm, whose zero is not stated."""
    rows = pd.read_csv(HERE / "bending_in_steps.csv")
    return dict(zip(rows["pressure_kPa"].astype(float), rows["angle_deg"].astype(float), strict=True))


def forces_of(arm: Arm) -> tuple[Array, Array]:
    """kPa and N, (n,) each, on the load cell at the tip, less what it shows after the hold."""
    rows = pd.read_csv(HERE / "blocked_force.csv")
    rows = rows[rows["arm"] == arm.name].dropna()
    rows["force"] = rows["force_N_mean_2_to_3_s"] - rows["zero_after_N"]
    means = rows.groupby("pressure_kPa")["force"].mean()
    return means.index.to_numpy(float), means.to_numpy(float)
