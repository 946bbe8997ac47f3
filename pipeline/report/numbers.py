"""What the report says about the five parameters: two lines beside a single one, eccentricity, the linear range."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.report.formatting import decimals_beside, decimals_of, interval, percent, with_spread
from pipeline.report.results import Results
from pipeline.rods.saved import pressurised_rod
from rod.pressurised_rod import STRETCHES

#: key in parameters.json, symbol, unit: the five parameters
NUMBERS = (
    ("alpha1_N_mm2", "α₁", "N mm²"),
    ("alpha2_N_mm2", "α₂", "N mm²"),
    ("m01_N_mm", "m₀₁", "N mm"),
    ("m02_N_mm", "m₀₂", "N mm"),
    ("d_mm", "d", "mm"),
)
_TITLES = {
    "cell_averaged": "cell averages",
    "arm_law": "cell averages of the rod with the arm's own law",
}
_QUANTITIES = {"alpha1": "α₁", "alpha2": "α₂", "kappa_0": "κ₀(l/2)"}
#: relative departure from the straight line from which on it is reported
_REPORTED_DEPARTURE = 0.02


@dataclass(frozen=True)
class Cell:
    """A parameter in a table."""

    value: str  #: with its standard deviation
    interval: str  #: the 95 % interval; empty where there is none


#: d of a single line
NO_BREAK = Cell("-", "single line")


def decimals(results: Results) -> dict[str, int]:
    """The decimals of each of the five parameters at every pressure and by every estimator; beside a large standard
    deviation fewer are written."""
    columns = results.parameters
    return {key: decimals_of(columns.get(key) or (), columns.get(f"{key}_std") or ()) for key, _, _ in NUMBERS}


def five_parameters(results: Results) -> list[tuple[str, list[Cell]]]:
    """Rows by pressure: p, the five parameters of the rod with their intervals."""
    return _rows(results, results.parameters)


def _rows(results: Results, columns: Mapping[str, Any]) -> list[tuple[str, list[Cell]]]:
    """Rows by pressure: p, and the five parameters of a rod with their intervals."""
    digits = decimals(results)
    single = results.parameters.get("single_line_suffices") or [False] * len(results.identified_pressures)
    return [
        (
            f"{pressure:g}",
            [
                NO_BREAK if key == "d_mm" and single[index] else _cell(columns, key, index, digits[key])
                for key, _, _ in NUMBERS
            ],
        )
        for index, pressure in enumerate(results.identified_pressures)
    ]


def estimators(results: Results) -> list[tuple[str, str, list[Cell]]]:
    """Rows by pressure and estimator: p, name, the five parameters."""
    rows = []
    digits = decimals(results)
    for index, pressure in enumerate(results.identified_pressures):
        predicted = results.parameters.get("predicted_by_arm_law")
        listed = {**(results.parameters.get("estimators") or {}), **({"arm_law": predicted} if predicted else {})}
        for name, columns in listed.items():
            cells = [_cell(columns, key, index, digits[key]) for key, _, _ in NUMBERS]
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


def eccentricity(results: Results) -> list[tuple[str, list[Cell]]]:
    """Rows by pressure: p, the five parameters of the rod that stretches with their intervals, and its eccentricity."""
    columns = results.parameters.get("eccentricity")
    if not columns:
        return []
    digits = decimals_of(columns["eccentricity_mm"], columns["eccentricity_mm_std"])
    return [
        (pressure, [*cells, _cell(columns, "eccentricity_mm", index, digits)])
        for index, (pressure, cells) in enumerate(_rows(results, columns))
    ]


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
        if results.parameters.get("linear_range_tested"):
            sentences = [f"α₁, α₂ and κ₀(l/2) are linear in the pressure from {covered[0]:g} to {covered[1]:g} kPa."]
        else:
            sentences = [
                "Whether α₁, α₂ and κ₀(l/2) are linear in the pressure was not tested: two pressures always lie on a "
                "straight line."
            ]
    for row in rows:
        departures = [
            f"{'+' if value > 0.0 else ''}{percent(value)} at {pressure:g} kPa"
            for pressure, value in zip(pressures, row["off_the_line"], strict=True)
            if value is not None
            and abs(value) > _REPORTED_DEPARTURE
            and (covered is None or not covered[0] <= pressure <= covered[1])
        ]
        if departures:
            quantity = _QUANTITIES.get(row["quantity"], row["quantity"])
            sentences.append(f"{quantity} departs from its straight line by {', '.join(departures)}.")
    return sentences


def slopes(results: Results) -> list[str]:
    """The slopes of the two rigidities over the pressure, one equation each; empty where there are none."""
    sentences = []
    for which, symbol in ((1, "β₁"), (2, "β₂")):
        value, spread = (results.parameters.get(f"beta{which}_N_mm2_per_kPa{ending}") for ending in ("", "_std"))
        if value is not None:
            sentences.append(f"{symbol} = {with_spread(value, spread, decimals_of([value], [spread]))} N mm²/kPa")
    return sentences


def _cell(columns: Mapping[str, Any], key: str, index: int, digits: int) -> Cell:
    value, spread = columns[key][index], (columns.get(f"{key}_std") or {index: None})[index]
    bounds = (columns.get(f"{key}_95") or {index: None})[index]
    if value is None:
        return Cell("-", "")
    if key == "d_mm" and (columns.get("d_is_at_most") or {index: False})[index]:
        upper = interval(bounds, digits).rpartition(" ")[2]
        return Cell(f"at most {with_spread(value, None, digits)}", f"< {upper} (95 %)" if upper else "")
    if key == "d_mm" and (columns.get("d_is_at_least") or {index: False})[index]:
        lower = interval(bounds, digits).partition(" ")[0]
        return Cell(f"at least {with_spread(value, None, digits)}", f"> {lower} (95 %)" if lower else "")
    return Cell(with_spread(value, spread, digits), interval(bounds, decimals_beside(spread, digits)))
