"""The actuator as a rod: curvature, the five-parameter law, identification, the rod in equilibrium.

The names of `rod.public` are loaded when the first of them is used. So `pneurod rod` imports what it needs from the
modules of this room, without scipy.
"""

from types import ModuleType
from typing import TYPE_CHECKING

from geometry.deferred import names_in

if TYPE_CHECKING:
    from rod.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def _public() -> ModuleType:
        import rod.public as public

        return public

    __getattr__, __dir__ = names_in(_public, __name__)
