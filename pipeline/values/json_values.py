"""What a result file in JSON, and a configuration in YAML, may be made of."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    #: a value that `Store.save_json` writes; arrays become lists, NaN and infinity become null
    Json: TypeAlias = (
        bool | int | float | str | np.generic | NDArray[Any] | Sequence["Json"] | Mapping[str, "Json"] | None
    )
    #: a value of a configuration as it is written: a text with its unit, a number, a word, several of them
    Written: TypeAlias = bool | int | float | str | Sequence["Written"] | Mapping[str, "Written"] | None
else:  # `--help` does not wait for numpy, and pydantic leaves such values as they are
    Json = Written = Any
#: an object of a result file, or one row of a table
JsonObject: TypeAlias = Mapping[str, Json]
#: an object that was read from a file in JSON; who uses it checks what it finds
ReadObject: TypeAlias = Mapping[str, Any]


def plain(value: Any) -> Any:
    """Numbers, arrays and columns of numpy and pandas as numbers and lists of Python."""
    to_list = getattr(value, "tolist", None)
    return to_list() if callable(to_list) else value
