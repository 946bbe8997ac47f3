"""What the body does: hyperelastic finite elements under follower pressure and contact.

The names of `fem.public` are loaded when the first of them is used. So a configuration, which needs no more than
`fem.materials` and `fem.elements`, is read without numba, scipy and scikit-fem.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem.public import *  # noqa: F403  type checkers find the names where they are defined
else:

    def __getattr__(name: str) -> Any:
        """The name of `fem.public`; raises AttributeError where there is none."""
        if name == "__all__":
            return __dir__()
        if not name.startswith("_"):
            from fem.memory import paused

            with paused():
                import fem.public as public

            if name in vars(public):
                return getattr(public, name)
        raise AttributeError(f"module 'fem' has no attribute {name!r}")


def __dir__() -> list[str]:
    import fem.public as public

    return [name for name in vars(public) if not name.startswith("_")]
