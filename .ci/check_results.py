"""Look whether the result files of the coarse arm are there and sound; the exit status says it."""

import csv
import json
import math
import sys
from pathlib import Path
from typing import Any

FILES = (
    *("parameters.json", "experiments.json", "validation.json", "effects.json", "run.json"),
    *("curves.csv", "mesh.vtu", "I.pvd", "II.pvd", "III.pvd", "report.html"),
)
PRESSURES = [17.0, 37.0]


def unsound(directory: Path) -> list[str]:
    """What is wrong in `directory`, one sentence each."""
    missing = [name for name in FILES if not (directory / name).is_file() or not (directory / name).stat().st_size]
    if missing:
        return [f"{name} is missing or empty" for name in missing]
    parameters = json.loads((directory / "parameters.json").read_text(encoding="utf-8"))
    experiments = json.loads((directory / "experiments.json").read_text(encoding="utf-8"))
    numbers = [*wrong_parameters(parameters), *wrong_experiments(experiments), *wrong_curves(directory / "curves.csv")]
    return [*numbers, *wrong_report((directory / "report.html").read_text(encoding="utf-8"))]


def wrong_report(page: str) -> list[str]:
    complaints = [] if len(page.encode()) < 6_000_000 else [f"report.html has {len(page.encode())} bytes"]
    for part in ('id="verdict"', 'id="body-data"', 'class="plot"', "bends by"):
        if part not in page:
            complaints.append(f"report.html has no {part}")
    return complaints


def wrong_parameters(parameters: dict[str, Any]) -> list[str]:
    complaints = []
    if parameters["pressures_kPa"] != PRESSURES:
        complaints.append(f"pressures are {parameters['pressures_kPa']}")
    for name in ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm"):
        values = parameters[name]
        if len(values) != len(PRESSURES) or not all(value > 0.0 for value in values):
            complaints.append(f"{name} must be positive at every pressure: {values}")
        if not all(spread >= 0.0 for spread in parameters[f"{name}_std"]):
            complaints.append(f"{name}_std must not be negative: {parameters[f'{name}_std']}")
    if not all(0.0 < d < parameters["length_mm"] for d in parameters["d_mm"]):
        complaints.append(f"d must lie on the curve: {parameters['d_mm']}")
    predicted = parameters["predicted_by_arm_law"].get("alpha2_N_mm2", [])
    pairs = list(zip(predicted, parameters["alpha2_N_mm2"], strict=False))
    if len(pairs) != len(PRESSURES) or not all(a is not None and abs(a - b) < 0.1 * b for a, b in pairs):
        complaints.append(f"alpha2_N_mm2 from the law of a cell differs by a tenth or more: {predicted}")
    return complaints


def wrong_experiments(rows: list[dict[str, Any]]) -> list[str]:
    # a converged row may carry a reason too: what limits the trust in it
    complaints = [
        f"{row['experiment']} at {row['pressure_kPa']} kPa: {row['status']}, {row['reason']}"
        for row in rows
        if row["status"] != "converged"
    ]
    experiments = sorted((row["experiment"], row["pressure_kPa"]) for row in rows)
    if experiments != [(experiment, pressure) for experiment in ("I", "II", "III") for pressure in PRESSURES]:
        complaints.append(f"experiments are {experiments}")
    complaints += [f"J = {row['min_J']} in {row['experiment']}" for row in rows if not 0.0 < row["min_J"] < 1.5]
    bent = {row["pressure_kPa"]: row["end_y_mm"] for row in rows if row["experiment"] == "II"}
    if not bent[37.0] < bent[17.0] < 0.0:
        complaints.append(f"II must curl away from the chambers, and more at 37 kPa: {bent}")
    return complaints


def wrong_curves(path: Path) -> list[str]:
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    if len(rows) < 6 * 20:
        return [f"{path.name} has {len(rows)} rows"]
    cells = (float(row[name]) for row in rows for name in ("s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm"))
    return [] if all(map(math.isfinite, cells)) else [f"{path.name} holds numbers that are not finite"]


if __name__ == "__main__":
    complaints = unsound(Path(sys.argv[1]))
    sys.exit("\n".join(complaints) or 0)
