"""The vocabulary of the result files: states of a row, the version of the keys, and the names of older versions."""

from collections.abc import Mapping, Sequence
from typing import Any

#: the `status` of a row of experiments.json: the pressure was reached, or it was not
CONVERGED, NOT_CONVERGED = "converged", "not converged"
#: the rods in rows of validation.json: five parameters, five parameters with an eccentricity, the law from one cell
FIVE, EXTENSIBLE, ARM_LAW = "five", "five_extensible", "arm_law"
#: the rods in the tables of curves, in the order of their columns, and how the names of these begin
CURVE_PREFIXES = {FIVE: "rod", ARM_LAW: ARM_LAW, EXTENSIBLE: EXTENSIBLE}
#: the columns of curves.csv; validation_curves.csv has `load` before them
CURVE_COLUMNS = (
    *("experiment", "pressure_kPa", "s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "kappa_std_per_mm"),
    "moment_N_mm",
    *(f"{prefix}_{name}" for prefix in CURVE_PREFIXES.values() for name in ("x_mm", "y_mm", "kappa_per_mm")),
)
#: the file with the surface of the body in every state
SURFACES = "pictures/surfaces.npz"
#: number of the present set of keys, written as `format` to the files; files without it are of format 1
FORMAT = 2
#: keys of format 1 -> keys of format 2 (parameters, validation, effects_table, run, accuracy and material .json)
RENAMED = {
    "sixth_number": "eccentricity",
    "one_line_suffices": "single_line_suffices",
    "one_line_alpha_N_mm2": "single_line_alpha_N_mm2",
    "one_line_alpha_N_mm2_std": "single_line_alpha_N_mm2_std",
    "one_line_m0_N_mm": "single_line_m0_N_mm",
    "r2_one_line": "r2_single_line",
    "sampled_moment_N_mm": "moment_range_N_mm",
    "distance_over_length_with_sixth_number": "distance_over_length_with_eccentricity",
    "force_error_with_sixth_number": "force_error_with_eccentricity",
    "believed": "estimated",
    "believed_error": "estimated_error",
    "believed_of_contact": "estimated_of_contact",
    "asked": "requested",
    "choice": "series",
    "coarser_mm": "second_mm",
}


def with_present_keys(content: Any) -> Any:
    """The content of a JSON result file with every renamed key replaced, at any depth; present keys stay."""
    if isinstance(content, dict):
        return {RENAMED.get(key, key): with_present_keys(value) for key, value in content.items()}
    if isinstance(content, list):
        return [with_present_keys(value) for value in content]
    return content


def of_extensible(content: Mapping[str, Any]) -> Mapping[str, Any]:
    """What a parameters.json has of the rod that stretches, by present keys; empty without it.

    Earlier files have one range of moments for both rods.
    """
    columns = content.get("eccentricity") or {}
    shared = {key: content[key] for key in ("moment_range_N_mm",) if columns and key in content}
    return {**shared, **columns}


def validation_rows(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The rows of a validation.json with one rod each.

    Files of versions before the arm's own law have one row per load and pressure, which holds the inextensible rod and,
    with keys of their own, the extensible one.
    """
    present: list[dict[str, Any]] = []
    for row in rows:
        if "rod" in row:
            present.append(dict(row))
            continue
        ending = "_with_eccentricity"
        of_extensible = {key.removesuffix(ending): value for key, value in row.items() if key.endswith(ending)}
        common = {key: row[key] for key in ("experiment", "pressure_kPa", "load", "sample") if key in row}
        present.append({key: value for key, value in row.items() if not key.endswith(ending)} | {"rod": "five"})
        if any(value not in (None, "") for value in of_extensible.values()):
            present.append(common | {"rod": "five_extensible"} | of_extensible)
    return present
