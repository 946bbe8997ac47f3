"""Names of a package that are loaded when the first of them is used."""

from collections.abc import Callable
from types import ModuleType
from typing import Any


def names_in(load: Callable[[], ModuleType], package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The `__getattr__` and `__dir__` of a package, whose names are those of the module that `load` imports."""

    def names() -> list[str]:
        return [name for name in vars(load()) if not name.startswith("_")]

    def found(name: str) -> Any:
        """The name of that module; raises AttributeError where there is none."""
        if name == "__all__":
            return names()
        if not name.startswith("_") and name in names():
            return getattr(load(), name)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    return found, names
