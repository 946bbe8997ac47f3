"""What the report says about the five parameters: three estimators, the error of the mesh, the linear range."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.report.results import Results
from pipeline.saved_rod import pressurised_rod
from rod.pressurised_rod import STRETCHES

#: key in parameters.json, symbol, unit
NUMBERS = (
    ("alpha1_N_mm2", "α₁", "N mm²"),
    ("alpha2_N_mm2", "α₂", "N mm²"),
    ("m01_N_mm", "m₀₁", "N mm"),
    ("m02_N_mm", "m₀₂", "N mm"),
    ("d_mm", "d", "mm"),
)
_TITLES = {
    "cell_averaged": "cell averages",
    "gaussian_process": "Gaussian process",
    "rod_fit": "rod fit",
    "arm_law": "cell averages of the rod with the arm's own law",
}
_QUANTITIES = {"alpha1": "α₁", "alpha2": "α₂", "kappa_0": "κ₀(l/2)"}
#: relative departure from the straight line from which on it is reported
_REPORTED_DEPARTURE = 0.02


@dataclass(frozen=True)
class Cell:
    """A number of one estimator."""

    value: str  #: with its standard deviation
    interval: str  #: the 95 % interval; empty where there is none


def estimators(results: Results) -> list[tuple[str, str, list[Cell]]]:
    """Rows by pressure and estimator: p, name, the five parameters."""
    rows = []
    for index, pressure in enumerate(results.identified_pressures):
        predicted = results.parameters.get("predicted_by_arm_law")
        listed = {**(results.parameters.get("estimators") or {}), **({"arm_law": predicted} if predicted else {})}
        for name, columns in listed.items():
            cells = [_cell(columns, key, index) for key, _, _ in NUMBERS]
            rows.append((f"{pressure:g}", _TITLES.get(name, name), cells))
    return rows


def stretch_of_rod(results: Results) -> str:
    """Whether the arm stretches so much without load that its rod with five parameters should; empty if not told."""
    if not (results.parameters.get("eccentricity") or {}).get("rest_stretch"):
        return ""
    stretches = pressurised_rod(results.parameters, extensible=True).stretches
    limit, choice = ("more than", "takes") if stretches else ("at most", "does not take")
    return (
        f"Without load the curve is longer or shorter than at rest by {limit} {100 * STRETCHES:g} %, so that "
        f"pneurod rod {choice} this rod by itself."
    )


def mesh_error(results: Results) -> str:
    """Whether the standard deviations contain the error of the mesh, and how large that is."""
    error = results.parameters.get("mesh_error")
    if not error:
        coarser = (results.run.get("config", {}).get("mesh") or {}).get("coarser")
        why = results.parameters.get("mesh_error_reason") or (
            f"a mesh {coarser:g} times as coarse gave no parameters"
            if coarser
            else "mesh.coarser in the configuration adds it"
        )
        return f"The standard deviations do not contain the error of the mesh: {why}."
    sizes = " and ".join(f"{size:g}" for size in error["sizes_mm"])
    parts = []
    for key, symbol, unit in NUMBERS:
        stds = [std for std in error[f"{key}_std"] if std]
        if stds:
            parts.append(f"{max(stds):.2g} {unit} of {symbol}")
    seconds = (results.run.get("seconds") or {}).get("coarser mesh")
    cost = "" if seconds is None else f" (the coarser one took {seconds:.0f} s)"
    return (
        f"The standard deviations contain the error of the mesh, estimated from mesh sizes of {sizes} mm{cost}: "
        f"at most {', '.join(parts)}."
    )


def eccentricity(results: Results) -> list[tuple[str, list[str]]]:
    """Rows by pressure: p, the eccentricity, and the five parameters of the extensible rod."""
    columns = results.parameters.get("eccentricity")
    if not columns:
        return []
    rows = []
    for index, pressure in enumerate(results.identified_pressures):
        cells = [
            with_spread(columns[key][index], columns[f"{key}_std"][index], f"{columns[key][index]:.2f}")
            for key in ("eccentricity_mm", *(key for key, _, _ in NUMBERS))
        ]
        rows.append((f"{pressure:g}", cells))
    return rows


def observations(results: Results) -> str:
    """How many independent observations the default estimator has."""
    counts = results.parameters.get("observations") or []
    if not counts:
        return ""
    low, high = min(counts), max(counts)
    number = f"{low:.0f}" if round(low) == round(high) else f"{low:.0f} to {high:.0f}"
    return f"Errors of neighbouring points are correlated: each pressure gives {number} independent observations."


def linear_range(results: Results) -> list[str]:
    """The pressures over which α and κ₀ are linear in the pressure, and the departures elsewhere."""
    pressures = results.identified_pressures
    covered = results.parameters.get("linear_range_kPa")
    rows = results.parameters.get("straightness") or []
    if len(pressures) < 2 or not rows:
        return []
    if covered is None:
        sentences = ["There are no three neighbouring pressures at which α₁, α₂ and κ₀(l/2) all lie on straight lines."]
    else:
        sentences = [f"α₁, α₂ and κ₀(l/2) are linear in the pressure from {covered[0]:g} to {covered[1]:g} kPa."]
        if not results.parameters.get("linear_range_tested"):
            sentences.append("This is not tested: two pressures always lie on a straight line.")
    for row in rows:
        departures = [
            f"{100 * value:+.1f} % at {pressure:g} kPa"
            for pressure, value in zip(pressures, row["off_the_line"], strict=True)
            if value is not None
            and abs(value) > _REPORTED_DEPARTURE
            and (covered is None or not covered[0] <= pressure <= covered[1])
        ]
        if departures:
            quantity = _QUANTITIES.get(row["quantity"], row["quantity"])
            sentences.append(f"{quantity} departs from its straight line by {', '.join(departures)}.")
    return sentences


def with_spread(value: float | None, spread: float | None, bare: str = "-") -> str:
    """A number with its standard deviation, with as many digits as the deviation justifies."""
    if value is None or not np.isfinite(value):
        return "-"
    if spread is None or not np.isfinite(spread) or spread <= 0.0:
        return bare
    digits = _digits(spread)
    return f"{value:.{digits}f} ± {spread:.{digits}f}"


def _digits(spread: float) -> int:
    return max(0, 1 - int(np.floor(np.log10(spread))))


def _cell(columns: Mapping[str, Sequence[Any]], key: str, index: int) -> Cell:
    value, spread = columns[key][index], columns[f"{key}_std"][index]
    bounds = (columns.get(f"{key}_95") or {index: None})[index]
    if value is None:
        return Cell("-", "")
    if key == "d_mm" and (columns.get("d_is_at_most") or {index: False})[index]:
        return Cell(f"at most {value:.1f}", f"{bounds[1]:.1f} with 95 %" if bounds else "")
    digits = _digits(spread) if spread else 2
    interval = f"{bounds[0]:.{digits}f} … {bounds[1]:.{digits}f}" if bounds else ""
    return Cell(with_spread(value, spread, f"{value:.2f}"), interval)
