"""Names of a package that are loaded when the first of them is used."""

from collections.abc import Callable
from types import ModuleType
from typing import Any


def named_in(load: Callable[[], ModuleType], package: str) -> Callable[[str], Any]:
    """The `__getattr__` of a package: names are those in `__all__` of the module that `load` imports."""

    def found(name: str) -> Any:
        """The name of that module; raises AttributeError where there is none."""
        if name == "__all__" or not name.startswith("_"):
            public = load()
            if name in (*public.__all__, "__all__"):
                return getattr(public, name)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    return found
