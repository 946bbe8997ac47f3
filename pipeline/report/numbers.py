"""What the report says about the five numbers: three estimators side by side, and where they are linear in p."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.report.results import Results

#: key in parameters.json, symbol, unit
NUMBERS = (
    ("alpha1_N_mm2", "α₁", "N mm²"),
    ("alpha2_N_mm2", "α₂", "N mm²"),
    ("m01_N_mm", "m₀₁", "N mm"),
    ("m02_N_mm", "m₀₂", "N mm"),
    ("d_mm", "d", "mm"),
)
_TITLES = {"cell_averaged": "cell averages", "gaussian_process": "Gaussian process", "rod_fit": "closest rod"}
_QUANTITIES = {"alpha1": "α₁", "alpha2": "α₂", "kappa_0": "κ₀(l/2)"}
#: a departure from a straight line that is named
_NAMED = 0.02


@dataclass(frozen=True)
class Cell:
    """A number of one estimator."""

    value: str  #: with its standard deviation
    interval: str  #: in which it lies with 95 %; empty where there is none


def estimators(results: Results) -> list[tuple[str, str, list[Cell]]]:
    """Rows by pressure and estimator: p, name, the five numbers."""
    found: Mapping[str, Any] = results.parameters.get("estimators") or {}
    rows = []
    for place, pressure in enumerate(results.parameters.get("pressures_kPa", ())):
        for name, columns in found.items():
            cells = [_cell(columns, key, place) for key, _, _ in NUMBERS]
            rows.append((f"{pressure:g}", _TITLES.get(name, name), cells))
    return rows


def mesh_error(results: Results) -> str:
    """Whether the deviations contain the error of the mesh, and how much of them it is."""
    found = results.parameters.get("mesh_error")
    asked = (results.run.get("config", {}).get("mesh") or {}).get("coarser")
    if not found:
        reason = results.parameters.get("mesh_error_reason") or f"a mesh {asked} times as coarse gave no numbers"
        why = reason if asked else "mesh.coarser in the configuration adds it"
        return f"The deviations do not contain the error of the mesh: {why}."
    sizes = " and ".join(f"{size:g}" for size in found["sizes_mm"])
    shares = []
    for key, symbol, unit in NUMBERS:
        stds = [std for std in found[f"{key}_std"] if std]
        if stds:
            shares.append(f"{max(stds):.2g} {unit} of {symbol}")
    seconds = (results.run.get("seconds") or {}).get("coarser mesh")
    cost = "" if seconds is None else f", which took {seconds:.0f} s"
    return f"They contain the error of the mesh, from sizes of {sizes} mm{cost}: at most {', '.join(shares)}."


def eccentricity(results: Results) -> list[tuple[str, list[str]]]:
    """Rows by pressure: p, the eccentricity, and the five numbers that go with it."""
    found: Mapping[str, Any] = results.parameters.get("eccentricity") or {}
    rows = []
    for place, pressure in enumerate(results.parameters.get("pressures_kPa", ()) if found else ()):
        cells = [
            with_spread(found[key][place], found[f"{key}_std"][place], f"{found[key][place]:.2f}")
            for key in ("eccentricity_mm", *(key for key, _, _ in NUMBERS))
        ]
        rows.append((f"{pressure:g}", cells))
    return rows


def observations(results: Results) -> str:
    """How many independent observations stand behind the numbers of the default."""
    counts = results.parameters.get("observations") or []
    if not counts:
        return ""
    low, high = min(counts), max(counts)
    said = f"{low:.0f}" if round(low) == round(high) else f"{low:.0f} to {high:.0f}"
    return f"Neighbouring points share their errors: each pressure gives {said} independent observations."


def regimes(results: Results) -> list[str]:
    """Between which pressures straight lines hold, and how far off they are elsewhere."""
    pressures = results.parameters.get("pressures_kPa") or []
    covered = results.parameters.get("linear_range_kPa")
    rows = results.parameters.get("straightness") or []
    if len(pressures) < 2 or not rows:
        return []
    if covered is None:
        said = ["There are no three neighbouring pressures at which α₁, α₂ and κ₀(l/2) all lie on straight lines."]
    else:
        said = [f"α₁, α₂ and κ₀(l/2) are linear in the pressure from {covered[0]:g} to {covered[1]:g} kPa."]
        if not results.parameters.get("linear_range_tested"):
            said.append("Through two pressures a line always goes: nothing was tested.")
    for row in rows:
        off = [
            f"{100 * value:+.1f} % at {pressure:g} kPa"
            for pressure, value in zip(pressures, row["off_the_line"], strict=True)
            if value is not None
            and abs(value) > _NAMED
            and (covered is None or not covered[0] <= pressure <= covered[1])
        ]
        if off:
            said.append(f"{_QUANTITIES.get(row['quantity'], row['quantity'])} is off that line by {', '.join(off)}.")
    return said


def with_spread(value: float | None, spread: float | None, bare: str = "-") -> str:
    """A number with its standard deviation, as many digits as the deviation carries."""
    if value is None or not np.isfinite(value):
        return "-"
    if spread is None or not np.isfinite(spread) or spread <= 0.0:
        return bare
    digits = _digits(spread)
    return f"{value:.{digits}f} ± {spread:.{digits}f}"


def _digits(spread: float) -> int:
    return max(0, 1 - int(np.floor(np.log10(spread))))


def _cell(columns: Mapping[str, Sequence[Any]], key: str, place: int) -> Cell:
    value, spread = columns[key][place], columns[f"{key}_std"][place]
    bounds = (columns.get(f"{key}_95") or {place: None})[place]
    if value is None:
        return Cell("-", "")
    if key == "d_mm" and (columns.get("d_is_at_most") or {place: False})[place]:
        upper = f", {bounds[1]:.1f} with 95 %" if bounds else ""
        return Cell(f"at most {value:.1f}", upper.removeprefix(", "))
    digits = _digits(spread) if spread else 2
    interval = f"{bounds[0]:.{digits}f} … {bounds[1]:.{digits}f}" if bounds else ""
    return Cell(with_spread(value, spread, f"{value:.2f}"), interval)
