"""The names that users and the other rooms write as `rod.NAME`."""

from rod.arm_law.law import ArmLaw, LawRod
from rod.arm_law.record import law_from_record, law_record
from rod.curves.cell_average import cell_averaged, shortest_pitch
from rod.curves.closure import Closure, end_displacement_closure
from rod.curves.curve import Curvature, Moment, moment_between, moment_from_load, without_stretch
from rod.curves.extension import Extension, extension, moment_about_neutral_axis
from rod.curves.gaussian_process import Smoothing, gaussian_process, shared_smoothing
from rod.curves.uncertainty import Bootstrap, Interval
from rod.errors import RodError
from rod.export.arm import Arm
from rod.export.formats import EXPORTS, export_arm
from rod.identification.alternatives import Candidate, Observation, compare_laws, simplest
from rod.identification.estimate import ParameterEstimate
from rod.identification.moment_range import MomentRange
from rod.identification.observed import too_few_pitches
from rod.identification.paper import FreeLines, TestedCurves, paper_cells, paper_process, single_rigidity_control
from rod.identification.shape_fit import LoadedShape, RodFit, fit_rod, rest_curvature
from rod.identification.single_line import LineFit
from rod.identification.two_lines import Identification, identify, is_clear, longest_break, shortest_break
from rod.law import PARAMETER_COLUMNS, PARAMETER_NAMES, FiveParameters, TwoSlopes
from rod.load import Load
from rod.mechanics.equilibrium import Rod
from rod.pressures import LinearRange, Quantity, Straightness, linear_range, next_pressure, straightness
from rod.pressurised_rod import OutsidePressures, PressurisedRod
from rod.scaling import ReferenceArm, ScaledArm, scaled_arm
from rod.solution import RodSolution
from rod.warm_up import compile_kernels

__all__ = [
    "EXPORTS",
    "PARAMETER_COLUMNS",
    "PARAMETER_NAMES",
    "Arm",
    "ArmLaw",
    "Bootstrap",
    "Candidate",
    "Closure",
    "Curvature",
    "Extension",
    "FiveParameters",
    "FreeLines",
    "Identification",
    "Interval",
    "LawRod",
    "LineFit",
    "LinearRange",
    "Load",
    "LoadedShape",
    "Moment",
    "MomentRange",
    "Observation",
    "OutsidePressures",
    "ParameterEstimate",
    "PressurisedRod",
    "Quantity",
    "ReferenceArm",
    "Rod",
    "RodError",
    "RodFit",
    "RodSolution",
    "ScaledArm",
    "Smoothing",
    "Straightness",
    "TestedCurves",
    "TwoSlopes",
    "cell_averaged",
    "compare_laws",
    "compile_kernels",
    "end_displacement_closure",
    "export_arm",
    "extension",
    "fit_rod",
    "gaussian_process",
    "identify",
    "is_clear",
    "law_from_record",
    "law_record",
    "linear_range",
    "longest_break",
    "moment_about_neutral_axis",
    "moment_between",
    "moment_from_load",
    "next_pressure",
    "paper_cells",
    "paper_process",
    "rest_curvature",
    "scaled_arm",
    "shared_smoothing",
    "shortest_break",
    "shortest_pitch",
    "simplest",
    "single_rigidity_control",
    "straightness",
    "too_few_pitches",
    "without_stretch",
]
