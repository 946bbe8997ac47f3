"""The law by which the errors of the numbers fall with the mesh, from a few meshes and their error indicators.

An error of a number is a product of two errors in the energy norm, that of the state and that of its dual (R. Becker,
R. Rannacher, Acta Numerica 10 (2001), section 3), so it falls as the energy of the error does, which the indicator of
`fem.stress_error` follows: numbers of several meshes lie on a straight line over it. Measured on the bisected circle
with 13 000 to 227 000 degrees of freedom: the error of kappa_0 is 0.33 to 0.41 times the indicator on all six meshes,
while that falls from 0.14 to 0.03. Meshes that are not nested scatter around the line, F by a per cent of its
value, which three meshes show.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.accuracy.reference import HEADLINE

#: the number that its identification may leave less sure than the mesh does
RIGIDITY = "alpha2_N_mm2"
#: powers of the size between which the energy of the error falls: at a re-entrant edge stresses grow at most as
#: r^(-1/2), and in a smooth body the strain of quadratic elements has the order 2
SLOWEST, FASTEST = 1.0, 4.0
#: the least error over the indicator that is believed, as root mean square over kappa_0 and F; measured on the finest
#: meshes of the four arms of docs/accuracy.md: 0.25, 0.28, 0.32, 1.2
LEAST = 0.25

#: numbers (HEADLINE), alpha2_std_N_mm2 and stress_error of one mesh, a pilot's size_mm too
Solved = Mapping[str, Any]


@dataclass(frozen=True)
class MeshLaw:
    """Relative errors of kappa_0(l/2), alpha2 and F over the indicator, and the indicator over the size of the mesh."""

    size_mm: float  #: of the finer pilot
    indicator: float  #: on it
    order: float  #: power of the size with which the indicator falls
    share: Mapping[str, float]  #: error over the indicator

    @classmethod
    def of(cls, pilots: Sequence[Solved], run: Solved | None = None) -> "MeshLaw":
        """From two pilots, the coarser first, and from the run they were for, at the same pressure.

        The order is that of the pilots' indicators within the bounds that theory sets.
        """
        coarse, fine = pilots
        finer = coarse["size_mm"] / fine["size_mm"]
        order = math.log(coarse["stress_error"] / fine["stress_error"]) / math.log(finer)
        order = min(max(order, SLOWEST), FASTEST)
        indicators = [fine["stress_error"] * finer**order, fine["stress_error"]]
        if run is not None:
            indicators.append(run["stress_error"])
        share = _shares(indicators, [*pilots, *([] if run is None else [run])])
        return cls(fine["size_mm"], fine["stress_error"], order, share)

    def at(self, size_mm: float) -> dict[str, float]:
        """The errors on a mesh of another size, before it is solved."""
        return self.with_indicator(self.indicator * (size_mm / self.size_mm) ** self.order)

    def with_indicator(self, indicator: float) -> dict[str, float]:
        """The errors in a solved state with this indicator."""
        return {key: share * indicator for key, share in self.share.items()}

    def size_for(self, error: float) -> float:
        """The size (mm) at which the largest error is `error`."""
        return float(self.size_mm * (error / max(self.at(self.size_mm).values())) ** (1.0 / self.order))


def _shares(indicators: Sequence[float], meshes: Sequence[Solved]) -> dict[str, float]:
    """Errors over the indicator: slopes of straight lines through the numbers of two or three meshes over it, and the
    standard deviation of three from their line. Meshes weigh by the inverse of their indicator.

    Meshes may agree on a number by chance, so none gets less than the root mean square over kappa_0 and F, and that is
    no less than LEAST. A rigidity that differs by no more than two standard deviations of its identification says
    nothing about meshes.
    """
    weights, free = 1.0 / np.array(indicators), max(len(meshes) - 2, 1)
    found = {}
    for key in HEADLINE:
        values = np.array([mesh["numbers"][key] for mesh in meshes]) / meshes[-1]["numbers"][key]
        line = np.polyfit(indicators, values, 1, w=weights)
        off = weights * (values - np.polyval(line, indicators))
        found[key] = math.hypot(float(line[0]), float(np.linalg.norm(off)) / math.sqrt(free))
    others = [share for key, share in found.items() if key != RIGIDITY]
    usual = max(LEAST, math.sqrt(sum(one**2 for one in others) / len(others)))
    deviations = [mesh["alpha2_std_N_mm2"] / mesh["numbers"][RIGIDITY] for mesh in meshes]
    of_two = math.sqrt(2.0 * sum(one**2 for one in deviations) / len(deviations))
    if found[RIGIDITY] * float(np.ptp(indicators)) <= 2.0 * of_two:
        found[RIGIDITY] = usual
    return {key: max(share, usual) for key, share in found.items()}
