"""What the body does: hyperelastic finite elements under follower pressure and contact.

The names of `fem.public` are loaded when the first of them is used. So a configuration, which needs no more than
`fem.materials` and `fem.elements`, is read without numba, scipy and scikit-fem.
"""

from types import ModuleType
from typing import TYPE_CHECKING

from fem.memory import paused
from geometry.deferred import names_in

if TYPE_CHECKING:
    from fem.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def _public() -> ModuleType:
        with paused():
            import fem.public as public
        return public

    __getattr__, __dir__ = names_in(_public, __name__)
