"""Whether any design within the bounds keeps the limits that follow from its drawing alone."""

from collections.abc import Iterator

import numpy as np
from scipy.optimize import minimize

from geometry import DesignError
from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.wishes.step import exact_ratios
from pipeline.wishes.wish import exact_limits
from pipeline.wishes.wish_file import WishFile

#: corners of the bounds that are looked at
MOST_CORNERS = 64
#: excess over a limit, over it, that is rounding
ROUNDING = 1e-6


def check_feasible(file: WishFile) -> None:
    """Raise InputError where no design within the bounds has a mass and walls within their limits."""
    ends = list(_excesses(file))
    if not ends or min(excess for excess, _ in ends) <= ROUNDING:
        return
    start = np.log(min(ends, key=lambda end: end[0])[1])
    box = np.log(file.wishes.bounds)
    try:
        best = np.exp(minimize(lambda u: _excess(file, u), start, method="SLSQP", bounds=box).x)
    except (InputError, DesignError):  # a point between is no body
        best = np.exp(start)
    if _excess(file, np.log(best)) <= ROUNDING:
        return
    found = exact_limits(file.wishes, file.drawn(best))
    name = max(found, key=lambda key: found[key][0])
    units = {"mass": "g", "smallest_wall": "mm"}
    raise InputError(
        f"{file.source}: limits.{name}: no design within the bounds of free keeps it; "
        f"the nearest has {found[name][1]:.4g} {units[name]}"
    )


def _excesses(file: WishFile) -> Iterator[tuple[float, Array]]:
    """Of the start and the corners that are bodies."""
    bounds = file.wishes.bounds
    numbers = range(min(2 ** len(bounds), MOST_CORNERS))
    corners = [np.array([pair[(number >> k) & 1] for k, pair in enumerate(bounds)]) for number in numbers]
    for point in (file.wishes.start, *corners):
        try:
            yield _excess(file, np.log(point)), point
        except (InputError, DesignError):
            continue


def _excess(file: WishFile, u: Array) -> float:
    return float(np.sum(np.maximum(exact_ratios(file, u) - 1.0, 0.0)))
