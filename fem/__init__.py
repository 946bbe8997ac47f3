"""What the body does: hyperelastic finite elements under follower pressure and contact.

The names of `fem.public` are loaded when the first of them is used. So a configuration, which needs no more than
`fem.materials` and `fem.elements`, is read without numba, scipy and scikit-fem.
"""

from types import ModuleType
from typing import TYPE_CHECKING, Any

from fem.memory import paused

if TYPE_CHECKING:
    from fem.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def __getattr__(name: str) -> Any:
        """The name of `fem.public`; raises AttributeError where there is none."""
        if name == "__all__":
            return __dir__()
        if not name.startswith("_") and name in vars(public := _public()):
            return getattr(public, name)
        raise AttributeError(f"module 'fem' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [name for name in vars(_public()) if not name.startswith("_")]


def _public() -> ModuleType:
    with paused():
        import fem.public as public
    return public
