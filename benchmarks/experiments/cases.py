"""A case: a folder with case.yaml, which says what was measured and where, and measured.csv with the numbers.

A case is a solid bar (`bar`), or an arm with the configuration that describes it as drawn (`arm`).
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from benchmarks.experiments.bar import Bar
from pipeline.answers.measured.rows import Measurements
from pipeline.answers.measured.table import read_measurements
from pipeline.config import kinds
from pipeline.config.config import Config
from pipeline.config.document import read_document
from pipeline.config.load import load_config
from pipeline.config.material import Material, read_material
from pipeline.config.section import Field, Kind, Section, read, section
from pipeline.values.errors import InputError

CASE, MEASURED = "case.yaml", "measured.csv"


@section(frozen=True)
class _Bar(Section):
    """A solid bar without a cavity, clamped at one end."""

    length_mm: kinds.PositiveLength
    height_mm: kinds.PositiveLength
    width_mm: kinds.PositiveLength
    material: Annotated[Material, Kind("a section", "{name: dragon_skin_10}", complete=read_material)]


_ROWS = kinds.list_of("lists of numbers of rows, from 1", "[[1, 2], [3, 4]]")


@section(frozen=True)
class _Case(Section):
    """The content of case.yaml."""

    name: kinds.Name
    source: kinds.Text
    licence: kinds.Text
    bar: _Bar | None = Field(default=None, examples=["{length: 100 mm, ...}"])
    arm: kinds.Text | None = Field(default=None, examples=["configs/pneunet.yaml"])
    #: numbers of the rows of each calibration; none: nothing is calibrated
    calibrate_on: Annotated[tuple[tuple[kinds.Count, ...], ...], _ROWS] = ()


@dataclass(frozen=True)
class Case:
    """What was measured on a real body, and the body as drawn."""

    name: str
    source: str
    licence: str
    body: Bar | Config
    measured: Measurements
    calibrate_on: tuple[tuple[int, ...], ...]  #: numbers of the rows of each calibration, from 1

    @property
    def length(self) -> float:
        """mm"""
        return self.body.length if isinstance(self.body, Bar) else self.body.design.length


def read_case(folder: Path) -> Case:
    """The case in a folder. Raises InputError with file, key or row, and what is allowed."""
    path = folder / CASE
    given = read(_Case, read_document(path))
    body = _body(given, path)
    measured = read_measurements(folder / MEASURED)
    count = len(measured.rows)
    if any(number > count for numbers in given.calibrate_on for number in numbers):
        raise InputError(f"{path}: calibrate_on: {MEASURED} has {count} rows; give numbers from 1 to {count}")
    return Case(given.name, given.source, given.licence, body, measured, given.calibrate_on)


def _body(given: _Case, path: Path) -> Bar | Config:
    if given.arm is not None and given.bar is None:
        return load_config(path.parent / given.arm)
    if given.bar is not None and given.arm is None:
        return _bar(given.bar, path)
    raise InputError(f"{path}: give either a bar or an arm")


def _bar(given: _Bar, path: Path) -> Bar:
    density = given.material.density_tonne_mm3
    if density is None:
        raise InputError(f"{path}: bar.material.density: is missing; for example 1070 kg/m^3")
    return Bar(given.length_mm, given.height_mm, given.width_mm, given.material.built(), density)


def cases_in(folder: Path) -> tuple[Case, ...]:
    """All cases below a folder, by name."""
    return tuple(read_case(path.parent) for path in sorted(folder.glob(f"*/{CASE}")))
