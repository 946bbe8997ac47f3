"""Pairs of pressures: the runs that they stand for, and the law over both from the laws of single ratios."""

from collections.abc import Sequence
from pathlib import Path

import pytest

import pneurod
from pipeline.answers.rods.choice import choose_rod
from pipeline.answers.rods.end_loads import rod_at
from pipeline.answers.rods.pressures import Wish, pressures_for
from pipeline.config.document import Document, read_document
from pipeline.law.rows import PairSpec, read_pairs
from pipeline.results.files import folder_of, read_results, read_run
from pipeline.study.pairs.run import BETWEEN, PairRuns, joined, save_pairs
from pipeline.values.errors import InputError, RunFailed
from rod.arm_law.law import ArmLaw
from tests.pair_laws import ray

CONTENT = {
    "name": "two",
    "geometry": {"family": "bisected_circle", "length": "70 mm"},
    "material": {"law": "svk", "E": "1.2 MPa", "nu": 0.495},
}


def spec_of(*directions: float) -> PairSpec:
    rays = dict.fromkeys(directions, (30.0,))
    return PairSpec(Document(Path("two.yaml"), CONTENT, ()), "two", ("cavity", "cavity_lower"), rays)


def exact(direction: float, pressures: Sequence[float]) -> ArmLaw:
    assert list(pressures) == [10.0, 20.0, 30.0]
    return ray(direction)


def test_a_ratio_halfway_is_added_and_equal_pressures_are_one_of_them() -> None:
    law, notes = joined(spec_of(0.0, 2.0), {d: ray(d) for d in (0.0, 2.0)}, exact)
    assert law.directions == (0.0, 0.5, 1.0, 1.5, 2.0)
    assert law.error_between == pytest.approx(0.0, abs=1e-6)
    assert notes == ()


def test_where_the_law_misses_the_ratio_halfway_more_are_added() -> None:
    def other(direction: float, pressures: Sequence[float]) -> ArmLaw:
        return ray(direction, stiffer=1.2 if direction == 0.5 else 1.0)

    law, notes = joined(spec_of(0.0, 1.0), {d: ray(d) for d in (0.0, 1.0)}, other)
    assert {0.25, 0.75} <= set(law.directions)
    assert law.error_between is not None
    assert law.error_between > BETWEEN
    assert "less certain" in notes[0]


def test_ratios_that_are_not_borne_leave_their_neighbours_or_no_law() -> None:
    def failing(direction: float, pressures: Sequence[float]) -> ArmLaw:
        raise RunFailed("the cell buckles")

    law, notes = joined(spec_of(0.0, 1.0), {d: ray(d) for d in (0.0, 1.0)}, failing)
    assert law.error_between is None
    assert notes == ("Between 1_to_0 and 1_to_1: the cell buckles",)
    law, notes = joined(spec_of(0.0, 2.0), {d: ray(d) for d in (0.0, 2.0)}, failing)
    assert law is None
    assert notes[-1] == "The law over both pressures needs the run at equal pressures, which failed."
    law, notes = joined(spec_of(0.0, 1.0), {0.0: ray(0.0)}, exact)
    assert law is None
    assert "because 1_to_1 has no law" in notes[0]


def test_the_rod_is_read_from_the_folder(tmp_path: Path) -> None:
    spec = spec_of(0.0, 1.0)
    law, notes = joined(spec, {d: ray(d) for d in (0.0, 1.0)}, exact)
    made = PairRuns(tmp_path, spec, {}, law, notes)
    save_pairs(made)
    assert "1 to 0, 1 to 0.5, 1 to 1" in made.sentences[0]
    rods = choose_rod(read_run(tmp_path))
    rod = rod_at(rods, "[20 kPa, 8 kPa]")
    assert rod.solve().end == pytest.approx(law.at((20.0, 8.0)).solve().end)
    with pytest.raises(InputError, match="rod=five: a law of several pressures is that of rod law"):
        choose_rod(read_run(tmp_path), "five")
    with pytest.raises(InputError, match="has the pressures of cavity, cavity_lower; give all"):
        rod_at(rods, "20 kPa")
    with pytest.raises(InputError, match="has the pressures of cavity, cavity_lower; give their ratio"):
        pressures_for(rods, Wish(angle_deg=20.0))
    assert pneurod.read_results(tmp_path).rod((20.0, 8.0)).solve().end == pytest.approx(rod.solve().end)
    results = pneurod.read_results(tmp_path)
    assert "--pressure '[30 kPa, 0 kPa]'" in results.verdict.command
    found = results.along("1:0.4").pressure_for(angle=1.0).iloc[0]
    assert found.pressure_cavity_lower_kPa == pytest.approx(0.4 * found.pressure_kPa)
    assert [file.suffix for file in results.along("1:0.5").export("json")] == [".json"]
    with pytest.raises(InputError, match="takes a law at a measured ratio"):
        results.export("json")
    (tmp_path / "law.json").write_text('{"kind": "pairs"}', encoding="utf-8")
    with pytest.raises(InputError, match=r"law\.json: .* it is no law of an arm in format 5"):
        read_results(tmp_path)


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


def spec_in(file: Path, *settings: str) -> PairSpec:
    spec = read_pairs(read_document(file, settings))
    assert spec is not None
    return spec


def test_pairs_of_one_ratio_are_one_run(file: Path) -> None:
    spec = spec_in(file)
    assert spec.cavities == ("cavity", "cavity_lower")
    assert spec.rays == {0.0: (10.0,), 0.25: (10.0, 20.0), 2.0: (12.0,)}
    assert [folder_of(direction) for direction in spec.rays] == ["1_to_0", "1_to_0.25", "0_to_1"]


def test_the_run_of_a_ratio_has_fractions_of_the_larger_pressure(file: Path) -> None:
    config = spec_in(file, "mesh.size=5 mm").config(0.25, (10.0, 20.0))
    assert config.pressures_kPa == (10.0, 20.0)
    assert {name: c.fraction for name, c in config.effects.pressure.cavities.items()} == {
        "cavity": 1.0,
        "cavity_lower": 0.25,
    }
    assert config.law_by_cavity
    assert config.mesh.size_mm == 5.0


def test_one_pressure_is_no_pair(file: Path) -> None:
    assert read_pairs(read_document(file, ["pressures=[10 kPa, 20 kPa]"])) is None
