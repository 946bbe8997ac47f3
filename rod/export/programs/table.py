"""The numbers of an arm at a pressure: the beginning of every program that is written."""

import numpy as np

#: the arm over the pressures in m, N, rad and s
TABLE = {}
OVER_PRESSURES = {
    name: np.array(values)
    for name, values in TABLE.items()
    if name.endswith(("_m", "_N", "_s", "_rad")) and name != "s_m"
}


def at(pressure_kPa):
    """The numbers of TABLE at a pressure in kPa, by straight lines. Raises ValueError outside its pressures."""
    known = TABLE["pressures_kPa"]
    slack = TABLE["same_pressure"] * known[-1]
    if not known[0] - slack <= pressure_kPa <= known[-1] + slack:
        raise ValueError(f"{pressure_kPa:g} kPa lies outside {known[0]:g} to {known[-1]:g} kPa")
    j = min(max(1, int(np.searchsorted(known, pressure_kPa))), len(known) - 1)
    i = max(j - 1, 0)
    t = min(max((pressure_kPa - known[i]) / (known[j] - known[i]), 0.0), 1.0) if j > i else 0.0
    return {name: (1.0 - t) * values[i] + t * values[j] for name, values in OVER_PRESSURES.items()}
