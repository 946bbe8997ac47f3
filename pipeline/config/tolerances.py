"""How far a built arm differs from its drawing: a tolerance for each dimension, the material and the pressure.

Defaults of cast arms: ISO 3302-1:2014, class M2, dimensions within one part of the mould (the table is quoted, for
example, at www.walker-rubber.co.uk). Of printed arms: 0.1 mm, the typical accuracy that Xometry states for PolyJet and
FDM. 10 % of the stiffness, from batch to batch, and 2 % of the pressure are choices: values to be replaced.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

from geometry import Design
from pipeline.config.material import Material
from pipeline.config.section import Field, ReadContext, TypeAdapter, not_known, read_each
from pipeline.config.units import LENGTH, PRESSURE, STRESS, Dimension, convert
from pipeline.values.json_values import Json, Written

#: how an arm is made, which decides about the tolerances that are not given
PROCESSES = ("cast", "printed")
#: key of all moduli of the materials together
STIFFNESS = "material.stiffness"
#: largest dimension (mm) of each row of class M2, and its tolerance (mm); beyond the last one 0.5 %
M2 = (
    *((4.0, 0.10), (6.3, 0.15), (16.0, 0.20), (25.0, 0.25), (40.0, 0.35), (63.0, 0.40), (100.0, 0.50)),
    (160.0, 0.70),
)
BEYOND_M2, PRINTED_MM, OF_STIFFNESS, OF_PRESSURE = 0.005, 0.1, 0.10, 0.02


@dataclass(frozen=True)
class Tolerance:
    """The amount by which a value may differ."""

    amount: float  #: in mm, MPa or kPa, or a fraction of the value
    is_relative: bool
    is_default: Annotated[bool, Field(exclude=True)] = False  #: it was not given

    def of(self, value: float) -> float:
        """The tolerance of a value, in its unit."""
        return self.amount * abs(value) if self.is_relative else self.amount

    def text(self, unit: str) -> str:
        """The tolerance as it is written; unit: of the value."""
        return f"{100.0 * self.amount:g} %" if self.is_relative else f"{self.amount:g} {unit}"


@dataclass(frozen=True)
class Tolerances:
    """How an arm is made, and the tolerances that are given, by the key of the value."""

    process: str = PROCESSES[0]
    given: Mapping[str, Tolerance] = field(default_factory=dict)

    @staticmethod
    def from_record(record: Json) -> "Tolerances":
        """The tolerances of the record of a configuration; the defaults for None."""
        return Tolerances() if record is None else TypeAdapter(Tolerances).validate_python(record)

    def with_setting(self, key: str, written: str, units: Mapping[str, Dimension | None]) -> "Tolerances":
        """With another tolerance, or process; units: what each key measures. Raises ValueError."""
        read = _known(key, written, units)
        return replace(self, process=read) if isinstance(read, str) else replace(self, given={**self.given, key: read})

    def all(self, dimensions: Mapping[str, float]) -> dict[str, Tolerance]:
        """The tolerances that are given, and the defaults of all others.

        dimensions: mm, by key (geometry.wall). The stiffness has a default where no constant of a material is given.
        """
        every = {key: self._of_dimension(value) for key, value in dimensions.items()} | dict(self.given)
        if not any(key.startswith("material") for key in self.given):
            every[STIFFNESS] = Tolerance(OF_STIFFNESS, True, True)
        return {"pressure": Tolerance(OF_PRESSURE, True, True)} | every

    def _of_dimension(self, value: float) -> Tolerance:
        if self.process == "printed":
            return Tolerance(PRINTED_MM, False, True)
        row = next((tolerance for largest, tolerance in M2 if value <= largest), None)
        return Tolerance(BEYOND_M2, True, True) if row is None else Tolerance(row, False, True)


def read_tolerances(value: Any, beside: ReadContext) -> Tolerances:
    """The tolerances that a section describes."""
    design, material, materials = beside.known("design", "material", "materials")
    if not isinstance(value, Mapping):
        raise ValueError("must hold keys, for example {geometry.wall: 0.1 mm, material.stiffness: 10 %}")
    units = _units(design, {"material": material, **{f"materials.{name}": m for name, m in materials.items()}})
    if effects := beside.fields.get("effects"):
        units |= {key: measured for key, (_, measured) in effects.constants.items()}
    read = read_each(dict(_flat(value)), lambda key, written: _known(key, written, units))
    return Tolerances(
        next((entry for entry in read.values() if isinstance(entry, str)), PROCESSES[0]),
        {key: entry for key, entry in read.items() if isinstance(entry, Tolerance)},
    )


def _flat(value: Mapping[str, Written]) -> Iterator[tuple[str, Written]]:
    """Keys such as geometry.wall, also from sections within the section."""
    for key, entry in value.items():
        if isinstance(entry, Mapping):
            yield from ((f"{key}.{inner}", written) for inner, written in _flat(entry))
        else:
            yield str(key), entry


def _known(key: str, written: Any, units: Mapping[str, Dimension | None]) -> Tolerance | str:
    """The process, or the tolerance at a key; units: what each measures. Raises ValueError, also for an unknown key."""
    if key == "process" and written in PROCESSES:
        return str(written)
    if key == "process":
        raise ValueError(not_known(written, PROCESSES))
    if key not in units:
        raise ValueError(not_known(key, ("process", *units)))
    return _read(written, units[key])


def _units(design: Design, materials: Mapping[str, Material]) -> dict[str, Dimension | None]:
    """What each key measures; None for what has no unit."""
    units: dict[str, Dimension | None] = {"pressure": PRESSURE, STIFFNESS: None}
    units |= {f"geometry.{name}": LENGTH for name in design.dimensions}
    if design.is_from_file:
        units |= {f"geometry.scale_{axis}": None for axis in "xyz"}
    for section, material in materials.items():
        for name, kind in material.kinds.items():
            several = material.constants[name]
            names = [f"{name}.{k + 1}" for k in range(len(several))] if isinstance(several, tuple) else [name]
            units |= {f"{section}.{one}": STRESS if kind.unit else None for one in names}
    return units


def _read(written: Any, dimension: Dimension | None) -> Tolerance:
    """Raises ValueError."""
    is_relative = dimension is None or (isinstance(written, str) and written.rstrip().endswith("%"))
    example = "10 %" if dimension is None else f"0.1 {dimension.unit}' or '10 %"
    unit = "dimensionless" if dimension is None or is_relative else dimension.unit
    amount = convert(written, Dimension("a tolerance", unit, example))
    if not amount > 0.0:
        raise ValueError(f"{written!r} is not above zero; leave out what is exact")
    return Tolerance(amount, is_relative)
