"""The check that numbers of a model are finite: not NaN, not infinite."""

from collections.abc import Sequence

import numpy as np


def check_finite(name: str, value: float | Sequence[float], error: type[ValueError] = ValueError) -> None:
    """Raise `error` unless the value, or each of several, is a finite number; name: what it is, with its unit."""
    if not np.isfinite(value).all():
        raise error(f"{name} must be finite, not {value}")
