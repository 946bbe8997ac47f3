"""Whether the content of a parameters.json, which may have been edited by hand, is that of a rod."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from pipeline.values.errors import quoted
from pipeline.values.formats import FORMAT
from rod.checked import Shape, check_positive, check_table, positive
from rod.errors import RodError
from rod.law import PARAMETER_COLUMNS

_LAW: dict[str, Shape] = dict.fromkeys(PARAMETER_COLUMNS.values(), ("n",))
_PROFILE: dict[str, Shape] = {"s_mm": ("m",), "theta0_rad": ("n",), "kappa_0_per_mm": ("n", "m")}
_STRETCH: dict[str, Shape] = {**_LAW, "eccentricity_mm": ("n",), "rest_stretch": ("n", "m")}
_AVERAGED: dict[str, Shape] = {"cell_s_mm": ("c",), "cell_averaged_per_mm": ("n", "c")}
_POSITIVE = ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm")


def check_format(content: Mapping[str, Any]) -> None:
    """Raise `RodError` for a format of the keys that this version does not know."""
    if (known := content.get("format", 1)) != FORMAT:
        raise RodError(f"format {quoted(known)} is not known; this version of pneurod reads {FORMAT}. Repeat the run.")


def check_parameters(content: Mapping[str, Any]) -> None:
    """Check what a rod is made of. Raises `RodError`, with the key, for numbers that cannot be those of a rod, and
    KeyError or TypeError for keys that are missing."""
    check_format(content)
    length, pressures = positive(content["length_mm"], "length_mm"), content["pressures_kPa"]
    check_table({"pressures_kPa": pressures}, {"pressures_kPa": ("n",)})
    if not pressures:
        raise RodError("pressures_kPa must have one number at least.")
    if pressures[0] < 0.0:
        raise RodError(f"pressures_kPa begin with {pressures[0]:g}; a rod has pressures from 0 on.")
    if content.get("mass_g") is not None:
        positive(content["mass_g"], "mass_g")
    if any(second <= first for first, second in pairwise(pressures)):
        raise RodError("pressures_kPa must rise.")
    sizes = {"n": len(pressures), "m": len(content["kappa_0"]["s_mm"])}
    if sizes["m"] < 2:
        raise RodError("s_mm of kappa_0 must be two numbers at least.")
    check_table(content, _LAW, sizes=sizes)
    check_positive(content, _POSITIVE)
    _check_deviations(content, sizes)
    positive(content["solid_volume_mm3"], "solid_volume_mm3")
    check_table(content["kappa_0"], _PROFILE, "kappa_0", sizes)
    if content["kappa_0"].get("cell_averaged_per_mm"):
        check_table(content["kappa_0"], _AVERAGED, "kappa_0", {"n": sizes["n"]})
    reach = float(content["kappa_0"]["s_mm"][-1])
    if abs(reach - length) > 1e-6 * length:
        raise RodError(f"s_mm of kappa_0 goes to {reach:g} mm, and length_mm is {length:g} mm.")
    _check_moment_range(content, "", sizes)
    if content.get("eccentricity"):
        check_table(content["eccentricity"], _STRETCH, "eccentricity", sizes)
        check_positive(content["eccentricity"], (*_POSITIVE, "rest_stretch"), "eccentricity")
        _check_moment_range(content["eccentricity"], "eccentricity", sizes)


def _check_moment_range(content: Mapping[str, Any], name: str, sizes: Mapping[str, int]) -> None:
    if content.get("moment_range_N_mm"):
        check_table(content, {"moment_range_N_mm": ("n", 2)}, name, sizes)


def _check_deviations(content: Mapping[str, Any], sizes: Mapping[str, int]) -> None:
    """Standard deviations may be null, or not be there."""
    for key in (f"{column}_std" for column in PARAMETER_COLUMNS.values()):
        column = content.get(key) or ()
        if column and None not in column:
            check_table(content, {key: ("n",)}, sizes=sizes)
        elif column and len(column) != sizes["n"]:
            raise RodError(f"{key} must be {sizes['n']} numbers, and has {len(column)}.")
