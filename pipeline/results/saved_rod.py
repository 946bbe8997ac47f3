"""The rod of a parameters.json."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.config.units import PRESSURE
from pipeline.results.options import option_value
from pipeline.results.parameter_checks import check_parameters
from pipeline.results.without_parameters import refuse_without_parameters
from pipeline.values.errors import InputError, argument
from rod.curves.extension import Extension
from rod.errors import RodError
from rod.identification.moment_range import MomentRange
from rod.law import PARAMETER_COLUMNS, FiveParameters
from rod.load import pair
from rod.mechanics.equilibrium import Rod
from rod.pressurised_rod import PressurisedRod
from rod.same_pressure import known_at


@dataclass(frozen=True)
class SavedRod:
    """The identified rod of a parameters.json over its pressures, and the arm it belongs to."""

    rods: PressurisedRod
    mass_g: float | None  #: None where the configuration has no density
    deviations: Mapping[str, tuple[float, ...]]  #: standard deviations by PARAMETER_NAMES; empty: not in the file

    @staticmethod
    def read(path: Path, extensible: bool = False) -> "SavedRod":
        """The inextensible or the extensible rod of a file. Raises InputError."""
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            refuse_without_parameters(path, content)
            mass = None if content["mass_g"] is None else float(content["mass_g"])
            return SavedRod(pressurised_rod(content, extensible), mass, _deviations(content))
        except OSError as failure:
            reason = (
                f"cannot be read ({failure.strerror}); give the folder of a run, its parameters.json or its law.json"
            )
            raise InputError(f"{path}: {reason}") from None
        except RodError as failure:
            raise InputError(f"{path}: {failure}") from None
        except (AttributeError, KeyError, TypeError, ValueError) as failure:
            problem = f"is not the parameters.json of a finished run{_problem(failure)}"
            raise InputError(
                f"{path}: {problem}; give the folder of a run, its parameters.json or its law.json"
            ) from None

    def at(self, pressure: str) -> Rod:
        """The rod at a pressure written with its unit; its origin is the clamped end of the material curve.

        Raises InputError.
        """
        value = option_value("pressure", pressure, PRESSURE)
        try:
            return self.rods.at(value)
        except RodError as failure:
            raise InputError(f"{argument('pressure', pressure)}: {failure}") from None

    def deviations_at(self, pressure: float) -> Mapping[str, tuple[float, ...]]:
        """The standard deviations at an identified pressure (kPa) by PARAMETER_NAMES; elsewhere they are not known."""
        k = known_at(self.rods.pressures, pressure)
        return {} if k is None else {name: (values[k],) for name, values in self.deviations.items()}


def _problem(failure: Exception) -> str:
    """What an error of the reader says of the file, in words of a user."""
    if isinstance(failure, json.JSONDecodeError):
        return f", line {failure.lineno} is not JSON"
    if isinstance(failure, KeyError):
        return f", the key {failure} is missing"
    # Python's own sentences about types tell nothing of the file
    return f": {failure}" if type(failure) is ValueError else ""


def _deviations(content: Mapping[str, Any]) -> dict[str, tuple[float, ...]]:
    """The standard deviations of a parameters.json by PARAMETER_NAMES; empty where one is not there."""
    columns = {name: content.get(f"{column}_std", []) for name, column in PARAMETER_COLUMNS.items()}
    if any(not column or None in column for column in columns.values()):
        return {}
    return {name: tuple(float(value) for value in column) for name, column in columns.items()}


def pressurised_rod(content: Mapping[str, Any], extensible: bool = False) -> PressurisedRod:
    """The rod of the content of a parameters.json. Raises KeyError, TypeError or ValueError for one that has none."""
    check_parameters(content)
    profile = content["kappa_0"]
    of_rod = content["eccentricity"] if extensible else content
    columns = [of_rod[key] for key in PARAMETER_COLUMNS.values()]
    stretches = zip(of_rod["rest_stretch"], of_rod["eccentricity_mm"], strict=True) if extensible else ()
    return PressurisedRod(
        length=float(content["length_mm"]),
        pressures=np.array(content["pressures_kPa"], dtype=float),
        laws=tuple(FiveParameters(*row) for row in zip(*columns, strict=True)),
        s=np.array(profile["s_mm"], dtype=float),
        kappa_0=np.array(profile["kappa_0_per_mm"], dtype=float),
        theta0=np.array(profile["theta0_rad"], dtype=float),
        extensions=tuple(Extension(np.array(profile["s_mm"]), np.array(rest), e) for rest, e in stretches),
        moment_ranges=tuple(MomentRange(*ends) for ends in of_rod.get("moment_range_N_mm", ())),
        straight_without_pressure=bool(content.get("straight_without_pressure", True)),
        weight=pair(content.get("weight_N_per_mm", (0.0, 0.0)), "weight_N_per_mm"),
        weight_height=float(content.get("weight_height_mm", 0.0)),
    )
