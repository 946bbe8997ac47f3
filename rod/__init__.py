"""The actuator as a rod: curvature, the five-parameter law, identification, the rod in equilibrium.

The names of `rod.public` are loaded when the first of them is used. So `pneurod rod` imports what it needs from the
modules of this room, without scipy.
"""

from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rod.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def __getattr__(name: str) -> Any:
        """The name of `rod.public`; raises AttributeError where there is none."""
        if name == "__all__" or not name.startswith("_"):
            public = _public()
            if name in (*public.__all__, "__all__"):
                return getattr(public, name)
        raise AttributeError(f"module 'rod' has no attribute {name!r}")


def __dir__() -> list[str]:
    names: list[str] = _public().__all__
    return names


def _public() -> ModuleType:
    import rod.public as public

    return public
