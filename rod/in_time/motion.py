"""The motion of an arm."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple, final

import numpy as np

from geometry.arrays import Array, freeze


class Instant(NamedTuple):
    """Where an arm in motion is, with N nodes and n = N - 1 elements."""

    time: float  #: s
    shape: Array  #: (N, 2) or, in space, (N, 3) mm, places of the nodes
    tip: Array  #: (2,) or (3,) mm, the end of the material curve
    angle: float  #: degrees, turn of the end section in the plane
    curvature: Array  #: (n,) 1/mm of the elements, in space (n, 3): twist, lateral, and in the plane
    pressure: Array  #: (c,) kPa
    volume: Array  #: (c,) mm3 of air; (0,) where the law has none
    beyond: float  #: 1/mm, by how much a cell bends beyond the curvatures of the law


@final
@dataclass(frozen=True, eq=False)  # arrays
class Motion:
    """An arm in time, at n times from 0 on. Positions are those of `Rod.solve`; arrays are read-only."""

    times_s: Array  #: (n,) s
    pressures_kPa: Array  #: (n, c)
    volumes_mm3: Array  #: (n, c) air in each cavity; (n, 0) where the law has none
    tips: Array  #: (n, 2) or, in space, (n, 3) mm, the end of the material curve
    end_angles_deg: Array  #: (n,) turn of the end section in the plane
    reactions: Array  #: (n, k) N and N mm, of all that supports hold
    beyond_per_mm: Array  #: (n,) 1/mm, by how much a cell bends beyond the curvatures of the law
    s: Array  #: (N,) mm, rest arc lengths of the nodes
    axis: Array  #: (n, N, 2) or (n, N, 3) mm, places of the nodes
    reason: str  #: why it ends before the time that was asked for, one sentence; empty where it does not
    notes: tuple[str, ...] = ()  #: what limits the trust in it, a sentence each

    def __post_init__(self) -> None:
        freeze(self, (one.name for one in fields(self) if one.name not in ("reason", "notes")))

    def shapes(self, times_s: Sequence[float]) -> Array:
        """(m, N, 2 or 3) mm: the axis at times (m,) in s, between two steps by straight lines."""
        at = np.clip(np.asarray(times_s, float), 0.0, self.times_s[-1])
        k = np.interp(at, self.times_s, np.arange(len(self.times_s)))
        i = np.minimum(k.astype(int), max(len(self.times_s) - 2, 0))
        after, part = np.minimum(i + 1, len(self.times_s) - 1), (k - i)[:, None, None]
        return np.asarray((1.0 - part) * self.axis[i] + part * self.axis[after])
