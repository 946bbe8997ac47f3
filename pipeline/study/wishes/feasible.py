"""Whether any design within the bounds keeps the limits that follow from its drawing alone."""

from contextlib import suppress
from itertools import islice, product

import numpy as np

from geometry import DesignError
from geometry.arrays import Array
from pipeline.study.wishes.step import exact_ratios, solved
from pipeline.study.wishes.wish import exact_limits
from pipeline.study.wishes.wish_file import WishFile
from pipeline.values.errors import InputError

#: corners of the bounds that are looked at
MOST_CORNERS = 64
#: excess over a limit, over it, that is rounding
ROUNDING = 1e-6


def check_feasible(file: WishFile) -> None:
    """Raise InputError where no design within the bounds has a mass and walls within their limits."""

    def excess(u: Array) -> float:
        return float(np.sum(np.maximum(exact_ratios(file, u) - 1.0, 0.0)))

    box, ends = np.log(file.wishes.bounds), list[tuple[float, int, Array]]()
    corners = islice(product(*box), MOST_CORNERS)
    for number, u in enumerate((np.log(file.wishes.start), *map(np.array, corners))):
        with suppress(InputError, DesignError):  # a corner may be no body
            ends.append((excess(u), number, u))
    least, _, best = min(ends)
    if least > ROUNDING:
        best = solved(excess, best, box)
    if excess(best) > ROUNDING:
        found = exact_limits(file.wishes, file.drawn(np.exp(best)))
        name = max(found, key=lambda key: found[key][0])
        has = f"{found[name][1]:.4g} {'g' if name == 'mass' else 'mm'}"
        raise InputError(
            f"{file.source}: limits.{name}: no design within the bounds of free keeps it; the nearest has {has}"
        )
