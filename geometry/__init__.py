"""Geometry of the arms: dimensions, solids, meshes and the material curve.

The names of `geometry.public` are loaded when the first of them is used. So errors and reasons are
read without numpy.
"""

from types import ModuleType
from typing import TYPE_CHECKING

from geometry.deferred import named_in

if TYPE_CHECKING:
    from geometry.public import *  # noqa: F403  type checkers find the names where they are defined


def __dir__() -> list[str]:
    names: list[str] = _public().__all__
    return names


def _public() -> ModuleType:
    import geometry.public as public

    return public


if not TYPE_CHECKING:
    __getattr__ = named_in(_public, __name__)
