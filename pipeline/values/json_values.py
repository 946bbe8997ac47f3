"""What a result file in JSON may be made of: the types of everything that is handed to `Store.save_json`."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    #: a value that `Store.save_json` writes; arrays become lists, NaN and infinity become null
    Json: TypeAlias = (
        bool | int | float | str | np.generic | NDArray[Any] | Sequence["Json"] | Mapping[str, "Json"] | None
    )
else:  # `--help` does not wait for numpy
    Json = Any
#: an object of a result file, or one row of a table
JsonObject: TypeAlias = Mapping[str, Json]


def plain(value: Any) -> Any:
    """Numbers, arrays and columns of numpy and pandas as numbers and lists of Python."""
    to_list = getattr(value, "tolist", None)
    return to_list() if callable(to_list) else value
