"""What the programs for MuJoCo and PyElastica have in common: the table of an arm at a pressure."""

import pprint
from collections.abc import Mapping
from typing import Any

from rod.same_pressure import SAME

AT = f'''
def at(pressure_kPa):
    """The numbers of TABLE at a pressure in kPa, by straight lines. Raises ValueError outside its pressures."""
    known = TABLE["pressures_kPa"]
    slack = {SAME} * known[-1]
    if not known[0] - slack <= pressure_kPa <= known[-1] + slack:
        raise ValueError(f"{{pressure_kPa:g}} kPa lies outside {{known[0]:g}} to {{known[-1]:g}} kPa")
    j = min(max(1, int(np.searchsorted(known, pressure_kPa))), len(known) - 1)
    i = max(j - 1, 0)
    t = min(max((pressure_kPa - known[i]) / (known[j] - known[i]), 0.0), 1.0) if j > i else 0.0
    return {{name: (1.0 - t) * values[i] + t * values[j] for name, values in OVER_PRESSURES.items()}}


ENDINGS = ("_m", "_N", "_s", "_rad")
OVER_PRESSURES = {{name: np.array(v) for name, v in TABLE.items() if name.endswith(ENDINGS) and name != "s_m"}}
'''


def as_python(table: Mapping[str, Any]) -> str:
    """A table as a literal of Python."""
    return pprint.pformat(dict(table), width=10**6, compact=True, sort_dicts=False)
