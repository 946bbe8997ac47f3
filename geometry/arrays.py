"""Types of the arrays that all rooms speak of."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]  #: numbers
Index = NDArray[np.int64]  #: numbers of nodes, elements or unknowns
Mask = NDArray[np.bool_]  #: true or false
