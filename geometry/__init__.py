"""Geometry of the arms: dimensions, solids, meshes and the material curve.

The names of `geometry.public` are loaded when the first of them is used. So errors and reasons are
read without numpy.
"""

from types import ModuleType
from typing import TYPE_CHECKING

from geometry.deferred import names_in

if TYPE_CHECKING:
    from geometry.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def _public() -> ModuleType:
        import geometry.public as public

        return public

    __getattr__, __dir__ = names_in(_public, __name__)
