"""The content of parameters.json as one frozen value: every column is a list over the pressures, units in its name.

Letters beside a type are the lengths of its lists: n pressures, m nodes of the material curve, c cells. Other lists may
be empty.
"""

import math
from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass, field, fields
from typing import Annotated, get_args

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema

from pipeline.values.json_values import ReadObject
from rod.checked import positive
from rod.identification.moment_range import MomentRange
from rod.law import PARAMETER_COLUMNS, FiveParameters
from rod.pressurised_rod import PressurisedRod
from rod.same_pressure import known_at

#: a number; NaN, in JSON null, where there is none
Number = Annotated[
    float,
    BeforeValidator(lambda value: math.nan if value is None else value),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "null"}]}),
]
Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0)]
Numbers = tuple[Finite, ...]
#: one number for every pressure; None where there is none
Column = Annotated[tuple[Finite | None, ...], "n"]
Switches = Annotated[tuple[bool | None, ...], "n"]
#: two ends of an interval for every pressure
Ends = Annotated[tuple[tuple[Finite, Finite] | None, ...], "n"]
#: columns without which there is no rod
_OF_ROD = (*PARAMETER_COLUMNS.values(), "theta0_rad", "kappa_0_per_mm")


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
class RestShape:
    """Curvature without load: at the nodes of the material curve, and averaged over cells."""

    s_mm: Numbers = ()
    theta0_rad: Annotated[Numbers, "n"] = ()
    kappa_0_per_mm: Annotated[tuple[Numbers, ...], "n", "m"] = ()
    cell_s_mm: Numbers = ()
    cell_averaged_per_mm: Annotated[tuple[Numbers, ...], "n", "c"] = ()
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
class RodParameters(FiveColumns):
    """Everything in parameters.json. Raises ValueError, with the key, for lists whose lengths differ."""

    format: int = 0
    design: ReadObject = field(default_factory=dict)  #: the section geometry of the configuration
    material: ReadObject | None = None  #: law, constants (MPa), density (tonne/mm3)
    materials: ReadObject | None = None  #: of the regions with another material
    solid_volume_mm3: Positive | None = None
    length_mm: Positive | None = None
    mass_g: Positive | None = None
    pressures_kPa: Numbers = ()
    straight_without_pressure: bool = True
    weight_N_per_mm: tuple[float, float] = (0.0, 0.0)  #: under which the arm has kappa_0
    weight_height_mm: float = 0.0
    estimator: str = "cell_averaged"
    d_given_mm: float | None = None
    linear_range_kPa: tuple[float, float] | None = None
    linear_range_tested: bool = False
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
    estimators: Mapping[str, TwoLines] = field(default_factory=dict)
    predicted_by_arm_law: TwoLines | None = None
    kappa_0: RestShape = RestShape()

    def __post_init__(self) -> None:
        sizes = {"n": len(self.pressures_kPa), "m": len(self.kappa_0.s_mm), "c": len(self.kappa_0.cell_s_mm)}
        for name, part in (("", self), ("kappa_0.", self.kappa_0)):
            for column in fields(part):
                held, (letter, *inner) = getattr(part, column.name), get_args(column.type)[1:] or ("",)
                if letter in sizes and (held or column.name in _OF_ROD):
                    _check_length(f"{name}{column.name}", held, sizes[letter])
                    for k, row in enumerate(held if inner else ()):
                        _check_length(f"{name}{column.name}.{k}", row, sizes[inner[0]])

    def rods(self) -> PressurisedRod:
        """The rod over the pressure. Raises `RodError` for numbers that cannot be those of a rod."""
        shape, columns = self.kappa_0, [getattr(self, column) for column in PARAMETER_COLUMNS.values()]
        return PressurisedRod(
            length=positive(self.length_mm, "length_mm"),
            pressures=np.array(self.pressures_kPa),
            laws=tuple(FiveParameters(*row) for row in zip(*columns, strict=True)),
            s=np.array(shape.s_mm),
            kappa_0=np.array(shape.kappa_0_per_mm),
            theta0=np.array(shape.theta0_rad),
            moment_ranges=tuple(MomentRange(*ends) for ends in self.moment_range_N_mm if ends),
            straight_without_pressure=self.straight_without_pressure,
            weight=self.weight_N_per_mm,
            weight_height=self.weight_height_mm,
        )

    def deviations_at(self, pressures: Sequence[float]) -> dict[str, tuple[float, ...]]:
        """The standard deviations at identified pressures (kPa) by PARAMETER_NAMES; empty where one is not known."""
        known = [known_at(self.pressures_kPa, pressure) for pressure in pressures]
        columns = {name: getattr(self, f"{column}_std") for name, column in PARAMETER_COLUMNS.items()}
        if None in known or any(not column or None in column for column in columns.values()):
            return {}
        return {name: tuple(column[k] for k in known) for name, column in columns.items()}


def _check_length(key: str, held: Sized, size: int) -> None:
    if len(held) != size:
        raise ValueError(f"{key}: must have a length of {size}, and has {len(held)}")
