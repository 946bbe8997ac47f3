"""Types of the arrays that all rooms speak of, and arrays that cannot be changed."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]  #: numbers
Index = NDArray[np.int64]  #: numbers of nodes, elements or unknowns
Mask = NDArray[np.bool_]  #: true or false


def read_only(values: Any) -> NDArray[Any]:
    """A copy as an array that cannot be changed."""
    array = np.array(values)
    array.setflags(write=False)
    return array


def freeze(value: object, names: Iterable[str]) -> None:
    """Replace those of these fields of a frozen dataclass that are not None by arrays that cannot be changed."""
    for name in names:
        if getattr(value, name) is not None:
            object.__setattr__(value, name, read_only(getattr(value, name)))
