"""The actuator as one line: curvature, the five-parameter law, the rod in equilibrium."""

from .cells import cell_averaged
from .curvature import Smoothing, gaussian_process, shared_smoothing
from .curve import Curvature, Moment, moment_from_force
from .equilibrium import Rod, RodSolution
from .identify import Identification, Interval, LineFit, identify
from .law import FiveParameters, RodError
from .synthetic import SyntheticArm

__all__ = [
    "Curvature",
    "FiveParameters",
    "Identification",
    "Interval",
    "LineFit",
    "Moment",
    "Rod",
    "RodError",
    "RodSolution",
    "Smoothing",
    "SyntheticArm",
    "cell_averaged",
    "gaussian_process",
    "identify",
    "moment_from_force",
    "shared_smoothing",
]
