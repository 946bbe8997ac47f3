"""The states of sweeps as the paper uses them: the curves of experiments II and III at one pressure and their force."""

import csv
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry import Centreline
from rod import Curvature, Load, TestedCurves, cell_averaged


@dataclass(frozen=True)
class State:
    """One design at one pressure that was reached in II and in III."""

    folder: Path  #: of the point
    config: Mapping[str, Any]  #: as in run.json
    pressure: float  #: kPa
    pitch: float  #: mm
    curves: TestedCurves
    couple: float  #: N mm, of the support on the end

    @property
    def family(self) -> str:
        """The body family."""
        return str(self.config["geometry"]["family"])

    @property
    def law(self) -> str:
        """The material law."""
        return str(self.config["material"]["law"])

    @property
    def length(self) -> float:
        """mm."""
        return self.curves.free.length

    @property
    def load(self) -> Load:
        """On the end in III."""
        return Load(self.curves.force, self.couple)

    @property
    def kappa_0(self) -> Curvature:
        """Cell-averaged, of II."""
        return cell_averaged(self.curves.free, self.pitch)

    @property
    def kappa_0_middle(self) -> float:
        """kappa_0(l/2), 1/mm."""
        curvature = self.kappa_0
        return float(np.interp(curvature.length / 2, curvature.s, curvature.kappa))


def states_of(sweep: Path) -> list[State]:
    """The states of all points of a sweep, by point and pressure."""
    points = json.loads((sweep / "sweep.json").read_text(encoding="utf-8"))["points"]
    return [state for point in points if point["folder"] for state in _states(sweep / point["folder"])]


def unreached(sweep: Path) -> list[str]:
    """A sentence for each point that did not finish."""
    points = json.loads((sweep / "sweep.json").read_text(encoding="utf-8"))["points"]
    return [f"{point['values']}: {point['reason']}" for point in points if point["status"] != "finished"]


def _states(folder: Path) -> Iterator[State]:
    config = json.loads((folder / "states" / "configuration.json").read_text(encoding="utf-8"))["config"]
    rows = json.loads((folder / "experiments.json").read_text(encoding="utf-8"))
    forces = {(row["experiment"], row["pressure_kPa"]): row.get("reaction_N") for row in rows}
    curves: dict[tuple[str, float], list[list[float]]] = {}
    with (folder / "curves.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            key = (row["experiment"], float(row["pressure_kPa"]))
            columns = ("s_mm", "x_mm", "y_mm", "moment_N_mm")
            curves.setdefault(key, []).append([float(row[name]) for name in columns])
    for pressure in sorted({p for name, p in curves if name == "III"} & {p for name, p in curves if name == "II"}):
        free, loaded = (np.array(curves[name, pressure]).T for name in ("II", "III"))
        force = forces["III", pressure]
        tested = TestedCurves(Centreline(*free[:3]), Centreline(*loaded[:3]), (float(force[0]), float(force[1])))
        yield State(folder, config, pressure, _pitch(config["geometry"]), tested, float(loaded[3, -1]))


def _pitch(geometry: Mapping[str, Any]) -> float:
    """The pitch of the cells by the keys of the families, mm."""
    from geometry.families import FAMILIES

    design = FAMILIES[geometry["family"]](**{key: value for key, value in geometry.items() if key != "family"})
    return float(design.pitch)
