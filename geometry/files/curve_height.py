"""Heights at which the material curve of a body from a file may run, for the refusal of one that leaves it."""

from collections.abc import Callable
from itertools import islice
from math import floor, log10

#: heights that are looked at
HEIGHTS = 25
#: how many of them are tried, where that takes long, and named
TRIED, NAMED = 10, 5


def height_advice(
    low: float, high: float, fits: Callable[[float], bool], accepted: Callable[[float], bool] = lambda y: True
) -> str:
    """The second half of the sentence: some of the heights between low and high (mm) at which the curve `fits`, and is
    `accepted` by a check that may take long."""
    step = (high - low) / (HEIGHTS + 1)
    digits = max(0, 1 - floor(log10(step)))
    heights = (round(low + step * k, digits) for k in range(1, HEIGHTS + 1))  # as they are written
    fitting = [y for y in heights if fits(y)]
    spread = fitting[:: max(1, len(fitting) // (NAMED - 1))]
    order = [*spread, *(y for y in fitting if y not in spread)][:TRIED]
    named = sorted(islice(filter(accepted, order), NAMED))
    if not named:
        return (
            "at none of the heights that were tried does it run through the material from end to end; is an end "
            "rounded, or the arm not along x (axes)?"
        )
    listed = ", ".join(f"{y + 0.0:.9g}" for y in named)
    return f"give a height at which it runs through a wall from end to end, for example y = {listed} mm"
