"""The part of law.json that the verdict and the report read, as frozen values."""

from dataclasses import dataclass

from pipeline.values.parameters import Column, Numbers
from rod.same_pressure import is_same


@dataclass(frozen=True)
class LawMeshError:
    """Standard deviations of the arm's own law due to its mesh, by pressure (the key mesh_error of law.json)."""

    size_mm: float | None = None
    second_mm: float | None = None
    pressures_kPa: Numbers = ()
    kappa_0_per_mm: Column = ()
    rigidity_N_mm2: Column = ()
    moment_N_mm: Column = ()
    kappa_0_per_mm_std: Column = ()
    rigidity_N_mm2_std: Column = ()
    moment_N_mm_std: Column = ()
    lateral_rigidity_N_mm2: Column = ()
    lateral_rigidity_N_mm2_std: Column = ()
    torsional_rigidity_N_mm2: Column = ()
    torsional_rigidity_N_mm2_std: Column = ()
    reason: str = ""


@dataclass(frozen=True)
class LawCurve:
    """Moment over curvature of one cell at one pressure, arrays of one length."""

    pressure_kPa: float
    kappa_per_mm: Numbers = ()
    moment_N_mm: Numbers = ()
    rigidity_N_mm2: Numbers = ()
    contact: tuple[bool, ...] = ()  #: whether walls touch


@dataclass(frozen=True)
class LawCurves:
    """The curves of one end of the arm."""

    curves: tuple[LawCurve, ...] = ()


@dataclass(frozen=True)
class Unloaded:
    """The clamped arm without a load at one pressure, by its own law."""

    pressure_kPa: float
    kappa_0_per_mm: float  #: curvature of the cell
    rigidity_N_mm2: float  #: dM/dkappa of the cell there
    bending_deg: float  #: angle of the circular arc through both ends
    tip_mm: tuple[float, float]  #: relative to the clamped end


@dataclass(frozen=True)
class Law:
    """The arm's own law as the report needs it; `rod.ArmLaw` is the whole of law.json."""

    length_mm: float
    pitch_mm: float
    pressures_kPa: Numbers
    curves: tuple[LawCurve, ...]
    clamp: LawCurves = LawCurves()
    mesh_error: LawMeshError | None = None
    unloaded: tuple[Unloaded, ...] = ()  #: at the pressures of the configuration

    def curve(self, pressure_kPa: float) -> LawCurve | None:
        """The curve at a pressure; None where there is none."""
        return next((curve for curve in self.curves if is_same(curve.pressure_kPa, pressure_kPa)), None)
