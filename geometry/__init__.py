"""Geometry of the arms: dimensions, solids, meshes and the material curve.

The names of `geometry.public` are loaded when the first of them is used. So errors and reasons are
read without numpy.
"""

from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geometry.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def __getattr__(name: str) -> Any:
        """The name of `geometry.public`; raises AttributeError where there is none."""
        if name == "__all__" or not name.startswith("_"):
            public = _public()
            if name in (*public.__all__, "__all__"):
                return getattr(public, name)
        raise AttributeError(f"module 'geometry' has no attribute {name!r}")


def __dir__() -> list[str]:
    names: list[str] = _public().__all__
    return names


def _public() -> ModuleType:
    import geometry.public as public

    return public
