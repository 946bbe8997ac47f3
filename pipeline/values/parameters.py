"""The content of parameters.json as one frozen value: every column is a list over the pressures, units in its name."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

#: one number for every pressure; None where there is none
Column = tuple[float | None, ...]
Numbers = tuple[float, ...]
Switches = tuple[bool | None, ...]
#: two ends of an interval for every pressure
Ends = tuple[tuple[float, float] | None, ...]


@dataclass(frozen=True)
class FiveColumns:
    """The five parameters: values, standard deviations, and 95 % intervals."""

    alpha1_N_mm2: Column = ()
    alpha1_N_mm2_std: Column = ()
    alpha1_N_mm2_95: Ends = ()
    alpha2_N_mm2: Column = ()
    alpha2_N_mm2_std: Column = ()
    alpha2_N_mm2_95: Ends = ()
    m01_N_mm: Column = ()
    m01_N_mm_std: Column = ()
    m01_N_mm_95: Ends = ()
    m02_N_mm: Column = ()
    m02_N_mm_std: Column = ()
    m02_N_mm_95: Ends = ()
    d_mm: Column = ()
    d_mm_std: Column = ()
    d_mm_95: Ends = ()
    d_is_at_most: Switches = ()  #: whether d is the lower end of the range in which it was sought
    d_is_at_least: Switches = ()


@dataclass(frozen=True)
class TwoLines(FiveColumns):
    """Parameters of two lines at every pressure, also where a single line suffices."""

    reason: tuple[str, ...] = ()  #: why there are none; empty where there are
    single_line_suffices: Switches = ()
    single_line_alpha_N_mm2: Column = ()
    observations: Column = ()  #: how many independent ones


@dataclass(frozen=True)
class StretchingRod(FiveColumns):
    """Parameters of the rod whose curve stretches with its curvature."""

    eccentricity_mm: Column = ()  #: distance of the neutral axis from the material curve
    eccentricity_mm_std: Column = ()
    moment_range_N_mm: Ends = ()
    rest_stretch: tuple[Numbers, ...] = ()  #: at the nodes of the material curve, without load


@dataclass(frozen=True)
class RestShape:
    """Curvature without load: at the nodes of the material curve, and averaged over cells."""

    s_mm: Numbers = ()
    theta0_rad: Numbers = ()
    kappa_0_per_mm: tuple[Numbers, ...] = ()
    cell_s_mm: Numbers = ()
    cell_averaged_per_mm: tuple[Numbers, ...] = ()
    middle_per_mm: Numbers = ()


@dataclass(frozen=True)
class MeshErrorOfFive:
    """What the mesh contributes: standard deviations of the parameters, and relative errors of three quantities."""

    sizes_mm: Numbers
    mixed_at_kPa: float | None = None
    alpha1_N_mm2_std: Column = ()
    alpha2_N_mm2_std: Column = ()
    m01_N_mm_std: Column = ()
    m02_N_mm_std: Column = ()
    d_mm_std: Column = ()
    kappa_0_relative: Column = ()
    alpha2_relative: Column = ()
    force_relative: Column = ()


@dataclass(frozen=True)
class Straightness:
    """A quantity over the pressure beside its straight line."""

    quantity: str
    slope_per_kPa: float
    at_0_kPa: float
    values: Numbers
    off_the_line: Column  #: relative


@dataclass(frozen=True)
class Dimensionless:
    """M/(m g l) over (kappa - kappa_0) l at one pressure."""

    pressure_kPa: float
    s_over_length: Numbers
    delta_kappa_times_length: Numbers
    moment_over_m_g_length: Numbers


@dataclass(frozen=True)
class BreakProfile:
    """Residual of the change of curvature over the position d of the break, at one pressure."""

    pressure_kPa: float
    d_mm: Numbers
    rms_per_mm: Numbers


@dataclass(frozen=True)
class RodParameters(FiveColumns):
    """Everything in parameters.json."""

    format: int = 0
    design: Mapping[str, Any] = field(default_factory=dict)  #: the section geometry of the configuration
    material: Mapping[str, Any] | None = None  #: law, constants (MPa), density (tonne/mm3)
    materials: Mapping[str, Any] | None = None  #: of the regions with another material
    solid_volume_mm3: float | None = None
    length_mm: float | None = None
    mass_g: float | None = None
    pressures_kPa: Numbers = ()
    straight_without_pressure: bool = True
    weight_N_per_mm: tuple[float, float] = (0.0, 0.0)  #: under which the arm has kappa_0
    weight_height_mm: float = 0.0
    estimator: str = "cell_averaged"
    d_given_mm: float | None = None
    linear_range_kPa: tuple[float, float] | None = None
    linear_range_tested: bool = False
    straightness: tuple[Straightness, ...] = ()
    beta1_N_mm2_per_kPa: float | None = None
    beta1_N_mm2_per_kPa_std: float | None = None
    beta2_N_mm2_per_kPa: float | None = None
    beta2_N_mm2_per_kPa_std: float | None = None
    single_line_alpha_N_mm2: Column = ()
    single_line_alpha_N_mm2_std: Column = ()
    single_line_m0_N_mm: Column = ()
    single_line_suffices: Switches = ()
    evidence_for_two_lines: Column = ()
    evidence_of_choice: Column = ()
    two_lines_on_coarser_mesh: Switches = ()
    r2_two_lines: Column = ()
    r2_single_line: Column = ()
    observations: Column = ()
    mesh_error: MeshErrorOfFive | None = None
    mesh_error_reason: str = ""
    moment_range_N_mm: Ends = ()
    eccentricity: StretchingRod | None = None
    estimators: Mapping[str, TwoLines] = field(default_factory=dict)
    predicted_by_arm_law: TwoLines | None = None
    kappa_0: RestShape = RestShape()
    dimensionless: tuple[Dimensionless, ...] = ()
    dimensionless_numbers: Mapping[str, Any] | None = None
    profile_over_d: tuple[BreakProfile, ...] = ()
