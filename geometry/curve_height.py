"""Heights at which the material curve of a body from a file may run, for the refusal of one that leaves it."""

from collections.abc import Callable

import numpy as np

#: heights that are tried
HEIGHTS = 25


def height_advice(low: float, high: float, fits: Callable[[float], bool]) -> str:
    """The second half of the sentence: some of the heights between low and high (mm) at which the curve `fits`."""
    heights = [y for y in map(float, np.linspace(low, high, HEIGHTS + 2)[1:-1]) if fits(y)]
    if not heights:
        return "at no height does it run through the material from end to end; is the arm along x (axes)?"
    listed = ", ".join(f"{y:.3g}" for y in heights[:: max(1, len(heights) // 4)])
    return f"give a height at which it runs through a wall from end to end, for example y = {listed} mm"
