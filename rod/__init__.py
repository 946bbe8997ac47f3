"""The actuator as one line: curvature, the five-parameter law, the rod in equilibrium."""

from .alternatives import Candidate, Observation, compare_laws, simplest
from .cells import cell_averaged
from .closing import Closing, closing
from .curvature import Smoothing, gaussian_process, shared_smoothing
from .curve import Curvature, Moment, moment_from_force, without_stretch
from .equilibrium import Rod, RodSolution
from .errors import Interval
from .export import EXPORTS, Arm, export
from .extension import Extension, extension
from .extrapolation import Extrapolated, extrapolated
from .fit import LoadedShape, RodFit, fit_rod, profile_over_break, rest_curvature
from .identify import Identification, identify, shortest_break
from .law import FiveParameters, RodError
from .one_line import LineFit
from .pressures import LinearRange, PressurisedRod, Straightness, linear_range, next_pressure, straightness
from .sampled import SampledMoments
from .scaling import Reference, Scaled, scaled
from .synthetic import SyntheticArm

__all__ = [
    "EXPORTS",
    "Arm",
    "Candidate",
    "Closing",
    "Curvature",
    "Extension",
    "Extrapolated",
    "FiveParameters",
    "Identification",
    "Interval",
    "LineFit",
    "LinearRange",
    "LoadedShape",
    "Moment",
    "Observation",
    "PressurisedRod",
    "Reference",
    "Rod",
    "RodError",
    "RodFit",
    "RodSolution",
    "SampledMoments",
    "Scaled",
    "Smoothing",
    "Straightness",
    "SyntheticArm",
    "cell_averaged",
    "closing",
    "compare_laws",
    "export",
    "extension",
    "extrapolated",
    "fit_rod",
    "gaussian_process",
    "identify",
    "linear_range",
    "moment_from_force",
    "next_pressure",
    "profile_over_break",
    "rest_curvature",
    "scaled",
    "shared_smoothing",
    "shortest_break",
    "simplest",
    "straightness",
    "without_stretch",
]
