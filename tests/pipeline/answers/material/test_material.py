"""The command: one recommendation in words, its line for a configuration, files; tables of machines with known laws."""

import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import fem
from geometry.arrays import Array
from pipeline.answers.material.laws import Points
from pipeline.answers.material.loading import TensileTest
from pipeline.answers.material.page import fit_material, law_table
from pipeline.answers.material.sentences import doubts, doubts_of_given, yaml_line
from pipeline.answers.material.study import FitOptions, Material, fit_tests
from pipeline.answers.material.table import Specimen
from pipeline.config.load import load_config
from tests.commands import done, refused
from tests.pipeline.values.test_plots import panels_of
from tests.specimens import example

YEOH = fem.Yeoh(0.06, 0.004, 0.0, 100.0)


def written(folder: Path, strain: Array, stress: Array, header: str = "strain (1),stress (MPa)") -> str:
    rows = "\n".join(f"{e},{s}" for e, s in zip(strain, stress, strict=True))
    (folder / "pull.csv").write_text(f"{header}\n{rows}\n")
    return str(folder / "pull.csv")


def test_the_shipped_example_is_what_specimens_py_draws(configs: Path) -> None:
    assert (configs / "elastosil_m4601_yeoh.csv").read_text(encoding="utf-8") == example()


def test_the_command(configs: Path, tmp_path: Path) -> None:
    tests = str(configs / "elastosil_m4601_yeoh.csv")
    printed = done("material", tests, "--out", str(tmp_path), "--density", "1130 kg/m^3")
    lines = [line for line in printed.splitlines() if line]
    assert lines[0].startswith("Take yeoh: up to a stretch of 3 it can be used, and is on average 4")
    assert "the specimens differ by 2" in printed
    assert "Beyond a stretch of 1.65 the fitted laws disagree in biaxial tension, which these tests do not" in printed
    record = json.loads((tmp_path / "material.json").read_text(encoding="utf-8"))
    assert record["recommended"] == "yeoh"
    assert record["yaml"] in lines
    assert set(record["sentences"]) <= set(lines)
    named = {law["law"] for law in record["laws"]} | set(record["refused"])
    assert named == {"svk", "hencky", "neo_hooke", "mooney_rivlin", "yeoh", "ogden 1", "ogden 2"}
    for law in record["laws"]:
        assert (law["yaml"] is None) == (law["holds_between_stretches"] is None)
        assert law["ends_by"]
    assert printed.count("material: {law") == 1
    page = (tmp_path / "material.html").read_text(encoding="utf-8")
    assert len(page) < 2_600_000
    start, _, biaxial = panels_of(page)
    assert {trace["name"] for trace in biaxial["data"]} == {law["law"] for law in record["laws"]}
    assert "tests" in {trace["name"] for trace in start["data"]}
    assert start["layout"]["xaxis"]["range"] == [0.95, 1.5]
    assert not re.search(r'(src|href)="?https?:', page)
    rows = (tmp_path / "material_curves.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) > 100 * len(record["laws"])


def test_every_line_is_read_back_as_a_material(configs: Path, tmp_path: Path) -> None:
    arm = (configs / "pneunet_coarse.yaml").read_text(encoding="utf-8")
    begin, end = arm.index("\nmaterial:") + 1, arm.index("\npressures:")
    found = fit_material([configs / "elastosil_m4601_yeoh.csv"], FitOptions(density="1130 kg/m^3"), tmp_path)
    assert len(found.judged.usable) > 2
    for fit in found.judged.usable:
        path = tmp_path / f"{fit.name}.yaml"
        path.write_text(arm[:begin] + yaml_line(fit, "1130 kg/m^3") + "\n\n" + arm[end:], encoding="utf-8")
        material = load_config(path).material
        assert material.density_tonne_mm3 == pytest.approx(1.13e-9)
        assert fit.holds is not None
        assert material.holds_between == pytest.approx(fit.holds, abs=0.01)
        s = np.linspace(1.1, 1.5, 5)
        np.testing.assert_allclose(material.built().uniaxial(s).nominal, fit.law.uniaxial(s).nominal, rtol=1e-3)
    assert len(law_table(found.judged, FitOptions().need).rows) == 7


def test_the_stretches_of_a_run_are_met(tmp_path: Path) -> None:
    """Where an arm needs little, one constant suffices; a folder without states is refused."""
    from pipeline.results.files import save_value
    from pipeline.store.result_folder import ResultFolder
    from pipeline.values.run import State

    run = tmp_path / "run"
    states = (State(experiment="II", pressure_kPa=5.0, max_stretch=1.12, min_stretch=0.93),)
    save_value(ResultFolder(run), "experiments.json", states)
    strain = np.linspace(0.0, 2.5, 100)
    file = written(tmp_path, strain, YEOH.incompressible(1 + strain))
    command = ("material", file, "--out", str(tmp_path / "out"))
    assert "Take neo_hooke" in done(*command, "--for", str(run))
    assert "Take yeoh" in done(*command)
    save_value(ResultFolder(run), "experiments.json", ())
    assert f"{run}: holds no results; give the folder of a run" in refused(*command, "--for", str(run))


def test_two_kinds_of_test_and_compression_in_positive_numbers(tmp_path: Path) -> None:
    """Neo-Hooke's law comes from both kinds together, and from compression that is called so; else it is asked."""
    law, strain = fem.NeoHooke(0.15, 100.0), np.linspace(0.05, 1.5, 30)
    rows = [f"uniaxial,{e},{s}" for e, s in zip(strain, law.incompressible(1 + strain), strict=True)]
    rows += [f"equibiaxial,{e},{s}" for e, s in zip(strain, 0.15 * (1 + strain - (1 + strain) ** -5), strict=True)]
    (tmp_path / "two.csv").write_text("\n".join(["test,strain (1),stress (MPa)", *rows]))
    pressed = np.linspace(0.0, 0.4, 25)
    stress = -law.incompressible(1 - pressed)
    called = written(tmp_path, pressed, stress, "compressive strain (1),stress (MPa)")
    for file in (str(tmp_path / "two.csv"), called):
        printed = done("material", file, "--out", str(tmp_path / "out"))
        assert "Take neo_hooke" in printed
        assert "mu: 0.15 MPa" in printed
        assert ("equibiaxial over uniaxial" in printed) == (file != called)
    asked = refused("material", written(tmp_path, pressed, stress), "--out", str(tmp_path / "out"))
    assert "give compression negative numbers, or call tension 'tensile stress' in the title" in asked


def test_a_test_that_ends_early_says_so(tmp_path: Path) -> None:
    strain = np.linspace(0.0, 0.4, 60)
    file = written(tmp_path, strain, YEOH.incompressible(1 + strain))
    printed = done("material", file, "--out", str(tmp_path / "out"))
    assert "An arm may need 0.7 to 2, but the test ends at a stretch of 1.4." in printed
    assert "A test up to a stretch of 2.7 would tell more about two directions." in printed


def test_forces_and_extensions(tmp_path: Path) -> None:
    strain = np.linspace(0.0, 2.5, 100)
    file = written(tmp_path, 33 * strain, 16 * YEOH.incompressible(1 + strain), "Traversenweg (mm),Kraft (N)")
    printed = done("material", file, "--out", str(tmp_path / "out"), "--length", "33 mm", "--area", "0.16 cm^2")
    constants = re.search(r"c10: (\S+) MPa, c20: (\S+) MPa", printed)
    assert [float(constant) for constant in constants.groups()] == pytest.approx([0.06, 0.004], rel=0.02)


@pytest.mark.parametrize(
    ("factor", "percent", "pattern"),
    [
        (1.0, 1.0, ""),
        (1e3, 1.0, "Young's modulus is .* MPa, and rubbers have 0.01 to 100 MPa: is the stress in kPa, not MPa"),
        (1e-3, 1.0, "is the stress in MPa, not kPa"),
        (1e7, 1.0, "Young's modulus is .* and rubbers have 0.01 to 100 MPa$"),
        (1.0, 100.0, r"strains reach 1.5e\+04 %, .* is the strain in % where the title says 1"),
        (1.0, 0.01, "strains reach 1.[0-9]+ % only: check the unit of the strain"),
    ],
)
def test_what_is_most_likely_wrong_is_asked(factor: float, percent: float, pattern: str) -> None:
    s = np.linspace(1.0, 2.5, 61)
    test = TensileTest("pull", 1 + percent * (s - 1), factor * 0.3 * (s - s**-2))
    found = list(doubts((test,), Points.of((test,))))
    assert len(found) == bool(pattern)
    assert not pattern or re.search(pattern, found[0])


def test_strains_that_are_stretches_are_asked_about() -> None:
    s = np.linspace(1.0, 3.0, 21)
    test = TensileTest("pull", 1 + s, 0.2 * (s - s**-2))
    assert next(doubts((test,), Points.of((test,)))).endswith("if these are stretches, call the column 'stretch'")


def test_what_no_rubber_has_is_named() -> None:
    assert list(doubts_of_given(0.495, "1070 kg/m^3", 0.1)) == []
    of_nu, of_density, of_batch = doubts_of_given(0.3, "2000 kg/m^3", 0.3)
    assert of_nu == "a Poisson ratio of 0.3 is given, and rubbers have 0.45 to 0.5"
    assert of_density == "a density of 2000 kg/m^3 is given, and rubbers have 800 to 1400 kg/m^3"
    assert of_batch == "the specimens differ by 30 %; those of one batch by less than 20 %"


DATA = Path(__file__).resolve().parents[3] / "data"
#: nominal equibiaxial stress of the natural rubber at a stretch of 2, MPa
MEASURED = 0.82


@cache
def fitted(name: str) -> Material:
    return fit_tests([DATA / "tensile" / f"{name}.csv"], FitOptions())


def constants(name: str) -> list[float]:
    first = fitted(name).judged.laws[0]
    assert first.name == "yeoh"
    return [float(constant) for constant in first.constants]


def test_no_law_of_natural_rubber_is_offered_that_is_far_off_in_two_directions() -> None:
    """Uniaxial data to a stretch of 7 admit Ogden's laws that are 700 times too stiff in biaxial tension."""
    two = np.array([2.0])
    usable = [fit for fit in fitted("natural_rubber").judged.usable if fit.holds and fit.holds[1] >= 2.0]
    assert len(usable) >= 2
    for fit in usable:
        assert MEASURED / 1.5 < fit.law.incompressible(two, two)[0] < 1.5 * MEASURED


def test_slack_and_a_rounded_start_are_taken_away() -> None:
    assert constants("slack_start")[0] == pytest.approx(0.06, rel=0.01)
    assert constants("rounded_start") == pytest.approx([0.0895, 0.0085, -0.00025], rel=0.1)
    assert constants("rounded_start")[0] == pytest.approx(0.0895, rel=0.01)


@pytest.mark.parametrize("name", ["two_kinds_of_columns", "stretch_without_unit"])
def test_true_beside_engineering_columns_and_a_stretch_without_a_unit_are_read(name: str) -> None:
    assert constants(name)[:2] == pytest.approx([0.06, 0.004], rel=0.01)


@pytest.mark.parametrize("name", ["results_first.csv", "statistik.txt"])
def test_tables_of_results_above_the_curves_of_two_specimens_are_passed_over(name: str) -> None:
    """An English file with one specimen below the other, a German one with both beside each other; 2 % off the law."""
    material = fit_tests([DATA / "tensile" / name], FitOptions(Specimen(33.0, 16.0)))
    assert [(test.name, len(test.stress)) for test in material.tests] == [("1", 26), ("2", 26)]
    assert material.notes == ()
    assert material.points.spread == pytest.approx(0.04 / 2**0.5, rel=0.01)
    first = material.judged.laws[0]
    assert first.name == "yeoh"
    assert first.constants[:2] == pytest.approx([0.06, 0.004], rel=0.01)


def test_the_choice_of_the_paper() -> None:
    """What docs/materials.md says of E = E_H: nominal stress over that of the line E_L times strain at 1.2."""
    at, line = np.array([1.2]), 0.65 * 0.2
    assert fem.StVenantKirchhoff(1.2, 0.495).uniaxial(at).nominal[0] / line == pytest.approx(2.437, abs=1e-3)
    assert fem.Hencky(1.2, 0.495).uniaxial(at).nominal[0] / line == pytest.approx(1.402, abs=1e-3)


def test_the_stress_of_other_laws_beside_that_of_the_yeoh_law() -> None:
    """The table of docs/materials.md."""
    page = (Path(__file__).resolve().parents[4] / "docs" / "materials.md").read_text(encoding="utf-8")
    head, _, *rows = page.partition("| stretch |")[2].partition("\n\n")[0].splitlines()
    stretches = np.array([float(cell) for cell in head.strip("| ").split("|")])
    yeoh = fem.Yeoh(0.11, 0.02, 0.0, 100.0).incompressible(stretches)
    laws: dict[str, Callable[[float], fem.Material]] = {
        "svk, E": lambda E: fem.StVenantKirchhoff(E, 0.495),
        "hencky, E": lambda E: fem.Hencky(E, 0.495),
        "neo_hooke, μ": lambda mu: fem.NeoHooke(mu, mu * 2 * 1.495 / 0.03),
    }
    assert len(rows) == 5
    for row in rows:
        name, *cells = row.strip("| ").split("|")
        law, _, modulus = name.partition(" = ")
        ratios = laws[law](float(modulus.split()[0])).uniaxial(stretches).nominal / yeoh
        assert [float(cell) for cell in cells] == pytest.approx(ratios, abs=0.006)
