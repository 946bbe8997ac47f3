"""Pairs of pressures in a configuration: the runs that they stand for, and what is refused."""

from pathlib import Path

import pytest

from pipeline.config.document import read_document
from pipeline.law.rows import PairSpec, read_pairs
from pipeline.results.files import folder_of

DESIGN = """
name: two
geometry: {family: bisected_circle, length: 70 mm}
material: {law: svk, E: 1.2 MPa, nu: 0.495}
pressures: [[10 kPa, 0 kPa], [20 kPa, 5 kPa], [0.01 MPa, 2.5 kPa], [0 kPa, 12 kPa]]
"""


def design_in(folder: Path) -> Path:
    """A configuration with pairs of pressures."""
    path = folder / "two.yaml"
    path.write_text(DESIGN, encoding="utf-8")
    return path


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return design_in(tmp_path)


def spec_of(file: Path, *settings: str) -> PairSpec:
    spec = read_pairs(read_document(file, settings))
    assert spec is not None
    return spec


def test_pairs_of_one_ratio_are_one_run(file: Path) -> None:
    spec = spec_of(file)
    assert spec.cavities == ("cavity", "cavity_lower")
    assert spec.rays == {0.0: (10.0,), 0.25: (10.0, 20.0), 2.0: (12.0,)}
    assert [folder_of(direction) for direction in spec.rays] == ["1_to_0", "1_to_0.25", "0_to_1"]


def test_the_run_of_a_ratio_has_fractions_of_the_larger_pressure(file: Path) -> None:
    config = spec_of(file, "mesh.size=5 mm").config(0.25, (10.0, 20.0))
    assert config.pressures_kPa == (10.0, 20.0)
    assert {name: c.fraction for name, c in config.effects.pressure.cavities.items()} == {
        "cavity": 1.0,
        "cavity_lower": 0.25,
    }
    assert config.law_by_cavity
    assert config.mesh.size_mm == 5.0


def test_one_pressure_is_no_pair(file: Path) -> None:
    assert read_pairs(read_document(file, ["pressures=[10 kPa, 20 kPa]"])) is None
