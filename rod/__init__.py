"""The actuator as one line: curvature, the five-parameter law, the rod in equilibrium."""

from .cells import cell_averaged
from .curvature import Smoothing, gaussian_process, shared_smoothing
from .curve import Curvature, Moment, moment_from_force
from .equilibrium import Rod, RodSolution
from .errors import Interval
from .fit import LoadedShape, RodFit, fit_rod, profile_over_break, without_stretch
from .identify import Identification, LineFit, identify
from .law import FiveParameters, RodError
from .synthetic import SyntheticArm

__all__ = [
    "Curvature",
    "FiveParameters",
    "Identification",
    "Interval",
    "LineFit",
    "LoadedShape",
    "Moment",
    "Rod",
    "RodError",
    "RodFit",
    "RodSolution",
    "Smoothing",
    "SyntheticArm",
    "cell_averaged",
    "fit_rod",
    "gaussian_process",
    "identify",
    "moment_from_force",
    "profile_over_break",
    "shared_smoothing",
    "without_stretch",
]
