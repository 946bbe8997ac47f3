"""Difference quotients of solved states, and the tolerances that the digits of these states allow.

A state is solved to a part d of its values. Two neighbouring states share most of their digits, and their difference
over the width w is uncertain by 2 d |f| / w. A smaller width takes digits away, a larger one adds the curvature of f.
A test states d; a comparison that needs more digits than there are fails on every processor, not on some.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from geometry.arrays import Array

#: of Newton's method in the fixture `solved_tightly`, and the part of themselves to which moments and lengths of its
#: states are known: they are linear in the forces that are left, which levers and small moments enlarge
TIGHT, KNOWN = 1e-11, 1e-10
#: part to which the end of a rod with a law is known: its Newton's method ends with a last correction of 1e-8, which
#: is right to a tenth at least
SOLVED = 1e-9


@dataclass(frozen=True)
class Quotient:
    """Of two values or arrays, and what the digits of both leave uncertain."""

    value: Array
    noise: float

    def within(self, rel: float = 0.0, abs: float = 0.0) -> Any:
        """Compare as `pytest.approx` does; a tolerance below the noise is refused."""
        tolerance = np.maximum(rel * np.abs(self.value), abs)
        assert np.all(tolerance > self.noise), f"{tolerance} asks for more digits than states have: {self.noise:.2g}"
        return pytest.approx(self.value, rel=rel, abs=abs)


def quotient(more: Any, less: Any, width: float, known: float = KNOWN) -> Quotient:
    """The difference of two values or arrays over the width between them; known: part to which the largest is."""
    values = np.array([less, more])
    return Quotient((values[1] - values[0]) / width, 2.0 * known * float(np.abs(values).max()) / abs(width))
