"""The actuator as a rod: curvature, the five-parameter law, identification, the rod in equilibrium.

The names of `rod.public` are loaded when the first of them is used. So `pneurod rod` imports what it needs from the
modules of this room, without scipy.
"""

from types import ModuleType
from typing import TYPE_CHECKING

from geometry.deferred import named_in

if TYPE_CHECKING:
    from rod.public import *  # noqa: F403  type checkers find the names where they are defined


def __dir__() -> list[str]:
    names: list[str] = _public().__all__
    return names


def _public() -> ModuleType:
    import rod.public as public

    return public


if not TYPE_CHECKING:
    __getattr__ = named_in(_public, __name__)
