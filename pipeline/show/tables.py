"""The tables of the report and of the terminal: five parameters, rods, loads, states, effects."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import fields
from typing import Any

from fem.elements import ELEMENTS
from pipeline.answers.rods.solid import young_modulus
from pipeline.results.rod_errors import mesh_errors, rod_errors
from pipeline.values.formatting import DIGITS, duration, number, percent
from pipeline.values.parameters import FiveColumns
from pipeline.values.run import Run, State
from pipeline.values.table import Table

#: key in parameters.json, symbol, unit: the five parameters
NUMBERS = (
    ("alpha1_N_mm2", "α₁", "N mm²"),
    ("alpha2_N_mm2", "α₂", "N mm²"),
    ("m01_N_mm", "m₀₁", "N mm"),
    ("m02_N_mm", "m₀₂", "N mm"),
    ("d_mm", "d", "mm"),
)
#: remark on a load whose moments five parameters were not identified with
OUTSIDE = "beyond its moments"
#: digits of a standard deviation
MOST_DIGITS = 3


def five_parameters(run: Run) -> Table:
    """The five parameters by pressure with their standard deviations and 95 % intervals; empty without them."""
    if not run.identified_kPa:
        return Table((), ())
    columns, single = run.parameters, run.parameters.single_line_suffices
    digits = {key: decimals_of(getattr(columns, key), getattr(columns, f"{key}_std")) for key, _, _ in NUMBERS}
    rows = tuple(
        (
            f"{pressure:g}",
            *(
                "one section" if key == "d_mm" and single[k] else _parameter(columns, key, k, digits[key])
                for key, _, _ in NUMBERS
            ),
        )
        for k, pressure in enumerate(run.identified_kPa)
    )
    included = "with" if run.parameters.mesh_error else "without"
    return Table(
        ("p (kPa)", *(f"{symbol} ({unit})" for _, symbol, unit in NUMBERS)),
        rows,
        "The paper's five parameters: α₁ and m₀₁ near the clamp (s < d), α₂ and m₀₂ beyond. ± is one standard "
        f"deviation, {included} the error of the mesh. The second line is the 95 % interval.",
    )


def _parameter(columns: FiveColumns, key: str, index: int, digits: int) -> str:
    value, spread = getattr(columns, key)[index], getattr(columns, f"{key}_std")[index]
    if value is None:
        return "-"
    if key == "d_mm":
        for bound, words in ((columns.d_is_at_most, "at most"), (columns.d_is_at_least, "at least")):
            if bound and bound[index]:
                return f"{words} {with_spread(value, None, digits)}"
    bounds = getattr(columns, f"{key}_95", None)
    below = interval(bounds[index], decimals_beside(spread, digits)) if bounds else ""
    return f"{with_spread(value, spread, digits)}\n{below}" if below else with_spread(value, spread, digits)


def rods(run: Run) -> Table:
    """The largest errors of every rod, against the finite elements and because of the mesh; empty without rods."""
    return Table.of(
        [(errors, mesh_errors(run, errors.rod)) for errors in rod_errors(run)],
        ("rod", lambda row: row[0].title),
        ("fitted loads", lambda row: str(row[0].loads_in_sample)),
        ("distance / length", lambda row: percent(row[0].distance_over_length_in_sample)),
        ("force error", lambda row: percent(row[0].force_error_in_sample)),
        ("other loads", lambda row: str(row[0].loads_out_of_sample)),
        ("distance / length", lambda row: percent(row[0].distance_over_length_out_of_sample)),
        ("force error", lambda row: percent(row[0].force_error_out_of_sample)),
        ("loads without solution", lambda row: str(row[0].loads_without_solution)),
        ("mesh error of κ₀", lambda row: percent(row[1].kappa_0)),
        ("mesh error of rigidity", lambda row: percent(row[1].rigidity)),
        ("mesh error of moment", lambda row: percent(row[1].force)),
    )


def loads(run: Run) -> Table:
    """Every load and pressure that a rod was not fitted to; empty where there is none."""
    rows = sorted(run.rod_errors, key=lambda row: (row.load, row.experiment, row.pressure_kPa))
    return Table.of(
        [row for row in rows if row.sample == "out"],
        ("load", lambda row: row.location),
        ("rod", lambda row: row.rod),
        ("distance / length", lambda row: percent(row.distance_over_length)),
        (
            "error of end angle (°)",
            lambda row: number(row.end_angle_error_rad and math.degrees(row.end_angle_error_rad)),
        ),
        ("error of force", lambda row: percent(row.force_error)),
        ("error of curvature", lambda row: percent(row.curvature_error)),
        ("remark", lambda row: row.reason or (OUTSIDE if row.warning else "")),
    )


def states(run: Run) -> Table:
    """Every experiment and pressure; empty where no experiment was begun."""
    titles = {column.name: column.metadata["title"] for column in fields(State) if "title" in column.metadata}
    rows = tuple(tuple(_cell(getattr(state, name)) for name in titles) for state in run.states)
    return Table(tuple(titles.values()), rows)


def effects(run: Run) -> Table:
    """Which effects were simulated, and why; empty where the run did not come so far."""
    return Table.of(
        run.effects,
        ("effect", lambda row: row.effect.replace("_", " ")),
        ("state", lambda row: row.state),
        ("reason", lambda row: row.reason),
        ("share of the solver's time", lambda row: percent(row.share_of_time)),
    )


def cost(run: Run) -> Table:
    """Wall time by stage of the run, then the parts of the solver's time; empty where it is not known."""
    stages = [(name, duration(value)) for name, value in run.record.seconds.items()]
    solver = [(f"solver: {name}", duration(value)) for name, value in run.record.solver_seconds.items()]
    return Table(("stage", "waiting time"), (*stages, *solver))


def design(run: Run) -> Table:
    """The design and its mesh: name and value with its unit; empty without a configuration."""
    geometry, mesh = run.config.get("geometry") or {}, run.mesh
    rows = [
        (name, str(value)) for name, value in geometry.items() if not isinstance(value, float) and value is not None
    ]
    lengths = [f"{name.replace('_', ' ')} {number(v)}" for name, v in geometry.items() if isinstance(v, float)]
    rows += [("dimensions (mm)", ", ".join(lengths))] if lengths else []
    materials = {"material": run.config.get("material") or {}, **(run.config.get("materials") or {})}
    for name, law in materials.items():
        values = [f"{key} {_cell(value)}" for key, value in law.items()]
        rows += [(name, ", ".join([*values, f"Young's modulus at rest {young_modulus(law):.3g} MPa"]))] if law else []
    if mesh:
        edges = f"edges {mesh.mean_edge_mm:.2g} mm on average, {mesh.longest_edge_mm:.2g} mm at most"
        rows.append(("mesh", f"{mesh.elements} {mesh.formulation} elements, {edges}"))
        rows.append((f"elements {mesh.formulation}", ELEMENTS[mesh.formulation].summary))
        rows += [(f"chosen {name}", reason) for name, reason in mesh.chosen.items()]
    return Table(("key", "value"), tuple(rows))


def in_time(run: Run) -> Table:
    """Vibrations, settling and creep at each pressure; empty where the material does not describe them."""
    remark = run.remark("in_time")
    rows: Any = remark.values["rows"] if remark else []
    names = [name for name in rows[0] if name != "pressure_kPa"] if rows else []
    columns = tuple(f"{row['pressure_kPa']:g} kPa" for row in rows)
    return Table(
        ("", *columns), tuple((name.replace("_", " "), *(number(row[name]) for row in rows)) for name in names)
    )


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_cell(item) for item in value)
    return number(value) if isinstance(value, float) else str(value)


def make_tables(run: Run) -> dict[str, Table]:
    """All tables of the report by the name that the template gives them; those without data are empty."""
    return {
        "five": five_parameters(run),
        "rods": rods(run),
        "loads": loads(run),
        "states": states(run),
        "effects": effects(run),
        "design": design(run),
        "cost": cost(run),
        "in_time": in_time(run),
    }


def fixed(value: float, decimals: int) -> str:
    """A number with this many decimals, fewer than none round tens and hundreds; a negative number that is rounded to
    zero has no sign."""
    text = f"{value if decimals >= 0 else round(value, decimals):.{max(decimals, 0)}f}"
    return text.removeprefix("-") if not text.strip("-0.") else text


def decimals_of(values: Iterable[float | None], spreads: Iterable[float | None]) -> int:
    """Decimals with which a quantity is written wherever it stands.

    The smallest standard deviation decides: one digit of it is kept, two where it begins with 1 or 2. No value has more
    than four digits. Without a standard deviation the largest value has four digits.
    """
    known = [abs(value) for value in values if value is not None and math.isfinite(value) and value]
    allowed = DIGITS - 1 - math.floor(math.log10(max(known))) if known else 2
    smallest = min((s for s in spreads if s is not None and math.isfinite(s) and s > 0.0), default=None)
    if smallest is None:
        return max(0, allowed)
    exponent = math.floor(math.log10(smallest))
    digits = 2 if smallest < 2.95 * 10.0**exponent else 1
    return max(0, min(allowed, digits - 1 - exponent))


def with_spread(value: float | None, spread: float | None, decimals: int) -> str:
    """A number with its standard deviation; a deviation that would be rounded to zero is rounded up, and of a large one
    three digits are written."""
    if value is None or not math.isfinite(value):
        return "-"
    if spread is None or not math.isfinite(spread) or spread <= 0.0:
        return fixed(value, decimals)
    decimals = decimals_beside(spread, decimals)
    return f"{fixed(value, decimals)} ± {fixed(max(spread, 10.0**-decimals), decimals)}"


def decimals_beside(spread: float | None, decimals: int) -> int:
    """Decimals of a number with this standard deviation, of which not more than MOST_DIGITS digits are written."""
    if spread is None or not math.isfinite(spread) or spread <= 10.0**-decimals:
        return decimals
    return min(decimals, MOST_DIGITS - 1 - math.floor(math.log10(spread)))


def interval(bounds: Sequence[float] | None, decimals: int) -> str:
    """The two ends of an interval; empty where there is none."""
    return "" if bounds is None else f"{fixed(bounds[0], decimals)} … {fixed(bounds[1], decimals)}"
