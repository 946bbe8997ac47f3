"""The states of sweeps as the paper uses them: the curves of experiments II and III at one pressure and their force."""

import csv
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.paper.free_lines import TestedCurves
from geometry import Centreline
from pipeline.results.files import read_plane_law
from rod import ArmLaw, Curvature, Load, cell_averaged

#: mm/s2, of the weight m g that makes moments dimensionless
STANDARD_GRAVITY = 9810.0


@dataclass(frozen=True)
class State:
    """One design at one pressure that was reached in II and in III."""

    folder: Path  #: of the point
    config: Mapping[str, Any]  #: as in run.json
    pressure: float  #: kPa
    pitch: float  #: mm
    curves: TestedCurves
    couple: float  #: N mm, of the support on the end
    unclamped: Centreline | None = None  #: of I, where it was solved

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
    return [state for folder in _folders(sweep) for state in _states(folder)]


@dataclass(frozen=True)
class EndState:
    """The end of the arm in III alone."""

    config: Mapping[str, Any]  #: as in run.json
    pressure: float  #: kPa
    position: tuple[float, float]  #: mm
    force: tuple[float, float]  #: N
    curve: Centreline

    @property
    def law(self) -> str:
        """The material law."""
        return str(self.config["material"]["law"])

    @property
    def held(self) -> tuple[float | None, float | None]:
        """Prescribed displacements of the end along x and y, mm."""
        return self.config["end"]["x_mm"], self.config["end"]["y_mm"]


def ends_of(sweep: Path) -> list[EndState]:
    """The end in III at every point and pressure of a sweep."""
    ends = []
    for folder in _folders(sweep):
        config = json.loads((folder / "states" / "configuration.json").read_text(encoding="utf-8"))["config"]
        curves = _curves(folder)
        for row in json.loads((folder / "experiments.json").read_text(encoding="utf-8")):
            if row["experiment"] == "III" and "reaction_N" in row:
                curve = Centreline(*np.array(curves["III", row["pressure_kPa"]]).T[:3])
                position, force = (row["end_x_mm"], row["end_y_mm"]), tuple(row["reaction_N"])
                ends.append(EndState(config, row["pressure_kPa"], position, (force[0], force[1]), curve))
    return ends


def laws_of(sweep: Path) -> dict[tuple[str, str], ArmLaw]:
    """The arms' own laws of a sweep by body family and material law."""
    laws = {}
    for folder in _folders(sweep):
        path = folder / "law.json"
        if path.is_file():
            config = json.loads((folder / "states" / "configuration.json").read_text(encoding="utf-8"))["config"]
            key = str(config["geometry"]["family"]), str(config["material"]["law"])
            laws[key] = read_plane_law(path)
    return laws


def _folders(sweep: Path) -> list[Path]:
    points = json.loads((sweep / "sweep.json").read_text(encoding="utf-8"))["points"]
    return [sweep / point["folder"] for point in points if point["folder"]]


def unreached(sweep: Path) -> list[str]:
    """A sentence for each point that did not finish."""
    points = json.loads((sweep / "sweep.json").read_text(encoding="utf-8"))["points"]
    return [f"{_words(point['values'])}: {point['reason']}" for point in points if point["status"] != "finished"]


def _words(values: Mapping[str, Any]) -> str:
    """The keys and values by which a point differs from the base of its sweep."""
    return ", ".join(f"{key} {value}" for key, value in values.items())


def _states(folder: Path) -> Iterator[State]:
    config = json.loads((folder / "states" / "configuration.json").read_text(encoding="utf-8"))["config"]
    rows = json.loads((folder / "experiments.json").read_text(encoding="utf-8"))
    forces = {(row["experiment"], row["pressure_kPa"]): row.get("reaction_N") for row in rows}
    curves = _curves(folder)
    for pressure in sorted({p for name, p in curves if name == "III"} & {p for name, p in curves if name == "II"}):
        free, loaded = (np.array(curves[name, pressure]).T for name in ("II", "III"))
        force = forces["III", pressure]
        tested = TestedCurves(Centreline(*free[:3]), Centreline(*loaded[:3]), (float(force[0]), float(force[1])))
        unclamped = curves.get(("I", pressure))
        apart = None if unclamped is None else Centreline(*np.array(unclamped).T[:3])
        yield State(folder, config, pressure, _pitch(config["geometry"]), tested, float(loaded[3, -1]), apart)


def _curves(folder: Path) -> dict[tuple[str, float], list[list[float]]]:
    """Rows of s, x, y (mm) and M (N mm) by experiment and pressure (kPa)."""
    curves: dict[tuple[str, float], list[list[float]]] = {}
    columns = ("s_mm", "x_mm", "y_mm", "moment_N_mm")
    with (folder / "curves.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            key = (row["experiment"], float(row["pressure_kPa"]))
            curves.setdefault(key, []).append([float(row[name]) for name in columns])
    return curves


def _pitch(geometry: Mapping[str, Any]) -> float:
    """The pitch of the cells by the keys of the families, mm."""
    from geometry.families import FAMILIES

    design = FAMILIES[geometry["family"]](**{key: value for key, value in geometry.items() if key != "family"})
    return float(design.pitch)


def weight_of(state: State) -> float:
    """m g of the arm, N."""
    from geometry.families import FAMILIES

    geometry = dict(state.config["geometry"])
    volume = FAMILIES[geometry.pop("family")](**geometry).solid_volume
    return float(volume * state.config["material"]["density_tonne_mm3"] * STANDARD_GRAVITY)
