"""The names that users and the other rooms write as `rod.NAME`."""

from rod.along import LineLoad, PointLoad, Reaction, Support
from rod.arm.stability import Stability
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.curves.cell_average import cell_averaged, shortest_pitch
from rod.curves.closure import Closure, end_displacement_closure
from rod.curves.curve import Curvature, Moment, moment_between, moment_from_load, without_stretch
from rod.curves.rest_shape import rest_curvature
from rod.curves.uncertainty import Bootstrap, Interval
from rod.errors import RodError, RodWarning
from rod.export.arm import Arm
from rod.export.formats import EXPORTS, export_robot
from rod.export.robot import Robot, Solid
from rod.identification.moment_range import MomentRange
from rod.identification.observed import too_few_pitches
from rod.identification.single_line import LineFit
from rod.identification.two_lines import Identification, identify, is_clear, longest_break, shortest_break
from rod.in_time.air import Air
from rod.in_time.body import Body
from rod.in_time.frequencies import Mode, frequencies
from rod.in_time.motion import Motion
from rod.in_time.move import MovingArm, Start, Steps, move
from rod.in_time.relaxation import Relaxation
from rod.law import PARAMETER_COLUMNS, PARAMETER_NAMES, FiveParameters, TwoSlopes
from rod.load import Load, Loading
from rod.mechanics.equilibrium import Rod
from rod.pressures import LinearRange, Quantity, Straightness, linear_range, straightness
from rod.pressurised_rod import PressurisedRod
from rod.solution import RodSolution, SpatialSolution
from rod.warm_up import compile_kernels

__all__ = [
    "EXPORTS",
    "PARAMETER_COLUMNS",
    "PARAMETER_NAMES",
    "Air",
    "Arm",
    "ArmLaw",
    "Body",
    "Bootstrap",
    "Closure",
    "Curvature",
    "FiveParameters",
    "Identification",
    "Interval",
    "LawRod",
    "LineFit",
    "LineLoad",
    "LinearRange",
    "Load",
    "Loading",
    "Mode",
    "Moment",
    "MomentRange",
    "Motion",
    "MovingArm",
    "PointLoad",
    "PressurisedRod",
    "Quantity",
    "Reaction",
    "Relaxation",
    "Robot",
    "Rod",
    "RodError",
    "RodSolution",
    "RodWarning",
    "Solid",
    "SpatialSolution",
    "Stability",
    "Start",
    "Steps",
    "Straightness",
    "Support",
    "TwoSlopes",
    "cell_averaged",
    "compile_kernels",
    "end_displacement_closure",
    "export_robot",
    "frequencies",
    "identify",
    "is_clear",
    "linear_range",
    "longest_break",
    "moment_between",
    "moment_from_load",
    "move",
    "rest_curvature",
    "shortest_break",
    "shortest_pitch",
    "straightness",
    "too_few_pitches",
    "without_stretch",
]
