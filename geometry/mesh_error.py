"""What is wrong with a mesh, and where, in a sentence."""

from collections.abc import Iterable


class MeshError(ValueError):
    """A mesh that cannot be used, with the reason in one sentence."""


def position_text(point: Iterable[float]) -> str:
    """A point (3,) in mm to a tenth of a millimetre, with the unit, for sentences."""
    return "(" + ", ".join(f"{x:.1f}" for x in point) + ") mm"
