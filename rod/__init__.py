"""The actuator as one line: curvature, the five-parameter law, the rod in equilibrium."""

from .equilibrium import Rod, RodSolution
from .law import FiveParameters, RodError

__all__ = ["FiveParameters", "Rod", "RodError", "RodSolution"]
