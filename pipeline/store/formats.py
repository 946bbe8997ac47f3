"""The vocabulary of the result files: states of a row, the version of the keys, and the names of older versions."""

from typing import Any

#: the `status` of a row of experiments.json: the pressure was reached, or it was not
CONVERGED, NOT_CONVERGED = "converged", "not converged"
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
}


def with_present_keys(content: Any) -> Any:
    """The content of a JSON result file with every renamed key replaced, at any depth; present keys stay."""
    if isinstance(content, dict):
        return {RENAMED.get(key, key): with_present_keys(value) for key, value in content.items()}
    if isinstance(content, list):
        return [with_present_keys(value) for value in content]
    return content
