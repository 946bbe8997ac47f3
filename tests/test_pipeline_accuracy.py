"""The ladder of accuracy: its rungs, the logic of errors on numbers made up, and a tiny ladder that is solved."""

import json
from pathlib import Path
from typing import Any

import pytest

from pipeline.accuracy import ladder as rungs
from pipeline.accuracy import study as accuracy
from pipeline.accuracy.figure import html_page, svg_picture
from pipeline.accuracy.ladder import CONTACT, LOCKING, POINTS, TOLERANCE, Rung, ladder, mesh_choice
from pipeline.accuracy.record import accuracy_record
from pipeline.accuracy.reference import Reference, errors, headline, limit, pareto_front, shifted
from pipeline.accuracy.study import climb
from pipeline.accuracy.table import COLUMNS_OF_RUNGS, markdown, reference_sentences
from pipeline.config.config import Config, load_config
from pipeline.errors import RunFailed
from pipeline.progress import Silent

TOUCHING = 0.04
EXACT = {"kappa_0_per_mm": -0.016, "alpha1_N_mm2": 50.0, "alpha2_N_mm2": 400.0, "d_mm": 12.0, "force_N": 0.03}


@pytest.fixture
def config(configs: Path) -> Config:
    return load_config(configs / "pneunet_coarse.yaml")


def test_the_ladder_has_its_lines(config: Config) -> None:
    found = ladder(config, TOUCHING)
    by_choice = {choice: [rung for rung in found if rung.choice == choice] for choice in {r.choice for r in found}}
    lines = {"p2p0", "mixed", "p2", "p2p0, graded to walls", "mixed, graded to walls"}
    assert set(by_choice) == lines | {"p1", TOLERANCE, CONTACT}
    assert min(len(by_choice[choice]) for choice in lines - {"p2"}) >= 5
    assert [rung.value for rung in by_choice["p1"]] == [4.0, 2.0, 1.0]
    assert min(rung.config.mesh.size_mm for rung in found if rung.is_mesh and rung.choice != "p1") == 1.3
    assert [r.value for r in by_choice["mixed, graded to walls"]] == [6.0, 5.0, 4.0, 3.0, 2.0, 1.6, 1.3]
    assert len({rung.folder for rung in found}) == len(found)
    assert [rung.value for rung in by_choice[CONTACT]] == [0.16, 0.08, 0.02]
    assert [rung.config.contact_dhat_mm for rung in by_choice[CONTACT]] == [0.16, 0.08, 0.02]
    assert all(rung.config.mesh == config.mesh for rung in by_choice[TOLERANCE] + by_choice[CONTACT])
    assert sum(rung.config == config for rung in found) == 1
    assert [rung.choice for rung in found if len(rung.strides) > 1] == [mesh_choice(config)]
    assert not [rung for rung in ladder(config, None) if rung.choice == CONTACT]


def test_pareto_front() -> None:
    points = [(1.0, 9.0), (2.0, 4.0), (2.0, 5.0), (3.0, 4.0), (4.0, 1.0), (5.0, 2.0)]
    assert pareto_front(points) == [0, 1, 4]
    assert pareto_front([]) == []
    assert pareto_front([(1.0, 1.0), (1.0, 1.0)]) == [0]


def test_the_limit_is_that_of_infinitely_many_degrees_of_freedom() -> None:
    sizes = [20_000, 40_000, 80_000, 160_000]
    steady = [(n, 10.0 + 50.0 * n ** (-2 / 3)) for n in sizes]
    found = limit([steady])
    assert found is not None
    assert found.value == pytest.approx(10.0, abs=2 * found.std)
    assert found.std < 0.2 * (steady[-1][1] - 10.0) + 0.02
    other = [(n, value + 0.3) for n, value in steady]
    both = limit([steady, other])
    assert both is not None
    assert both.std > found.std
    assert both.std >= 0.15 * 0.99
    assert limit([steady[:1]]) is None
    assert limit([]) is None


def test_the_reference_has_no_contact_distance_left() -> None:
    distances = [(mm, 7.0 + 2.0 * mm) for mm in (0.2, 0.1, 0.05, 0.025)]
    found = shifted(Reference(7.4, 0.01), distances, 0.2)
    assert found.value == pytest.approx(7.0, abs=0.02)
    assert found.std >= 0.01


def test_errors_are_relative_and_that_of_the_end_is_over_the_length() -> None:
    exact = {key: Reference(value, 0.0) for key, value in EXACT.items()}
    exact["end_mm"] = [Reference(100.0, 0.0), Reference(-60.0, 0.0)]  # type: ignore[assignment]
    numbers = {**EXACT, "alpha2_N_mm2": 408.0, "d_mm": None, "end_mm": [103.0, -64.0]}
    found = errors(numbers, exact, 100.0)
    assert found["alpha2_N_mm2"] == pytest.approx(0.02)
    assert found["end_mm"] == pytest.approx(0.05)
    assert found["kappa_0_per_mm"] == 0.0
    assert found["d_mm"] is None
    assert headline([found, {**found, "force_N": -0.03}]) == pytest.approx(0.03)
    assert headline([{**found, "force_N": None}]) is None


def made_up(rung: Rung) -> dict[str, Any]:
    """What a rung would have found, were its error 1000 / n, twice that of what locks, and 50 % per mm of contact
    distance."""
    size, formulation = rung.config.mesh.size_mm, rung.config.mesh.formulation
    n = 500_000 / size**2 * (1.3 if rung.config.mesh.grading == "walls" else 1.0)
    n = round(n / 6 if formulation == "p1" else n)
    share = 1000.0 / n * (2.0 if formulation in LOCKING else 1.0)
    share += 0.5 * (rung.config.contact_dhat_mm or TOUCHING)
    numbers = [
        {
            "pressure_kPa": pressure,
            "stride": stride,
            "points": 180 // stride,
            **{key: value * (1.0 + share) for key, value in EXACT.items()},
            "end_mm": [100.0, -60.0 * (1.0 + share)],
        }
        for pressure in rung.config.pressures_kPa
        for stride in rung.strides
    ]
    stages = dict.fromkeys(("mesh", "set_up", "assembly", "factorization", "contact", "fit"), n / 1e4)
    cost = {"wall_seconds": n / 1e3, "cpu_seconds": n / 1e3, "seconds": stages, "peak_memory_MB": n / 100.0}
    return {"failure": "", **cost, "degrees_of_freedom": n, "factorizations": 60, "numbers": numbers, "key": "none"}


@pytest.fixture
def record(config: Config) -> dict[str, Any]:
    found = [(rung, made_up(rung)) for rung in ladder(config, TOUCHING)]
    return accuracy_record(config, found, TOUCHING)


def test_a_ladder_made_up_gives_its_errors_back(record: dict[str, Any]) -> None:
    for found in record["reference"]:
        for key, value in EXACT.items():
            assert found[key]["value"] == pytest.approx(value, rel=5e-3)
            assert found[key]["value"] == pytest.approx(value, abs=2 * found[key]["std"])
    rows = record["rungs"]
    [base] = [row for row in rows if (row["choice"], row["value"]) == ("p2p0", 4.0)]
    assert base["headline"] == pytest.approx(1000.0 / base["degrees_of_freedom"] + 0.5 * TOUCHING, abs=5e-3)
    closest = {row["value"]: row["headline"] for row in rows if row["choice"] == CONTACT}
    assert closest[0.16] - closest[0.02] == pytest.approx(0.5 * 0.14, rel=0.05)
    assert 0.0 < record["reference_error"] < 0.03
    assert not any(row["on_front"] for row in rows if row["choice"] == "p2")
    assert any(row["on_front"] for row in rows)
    thinned = [row for row in rows if row["choice"] == POINTS]
    assert [row["value"] for row in thinned] == [90, 60, 45]


def test_a_mesh_that_sees_one_slope_says_nothing_of_two(config: Config) -> None:
    """On the coarsest meshes one line suffices: its rigidity is not the second one of the finer meshes."""
    coarse = [(rung, made_up(rung)) for rung in ladder(config, TOUCHING)]
    for rung, found in coarse:
        for numbers in found["numbers"] if rung.is_mesh and rung.value == 6.0 else []:
            numbers.update(alpha1_N_mm2=250.0, alpha2_N_mm2=250.0, d_mm=None)
    for found in accuracy_record(config, coarse, TOUCHING)["reference"]:
        for key in ("alpha1_N_mm2", "alpha2_N_mm2"):
            assert found[key]["value"] == pytest.approx(EXACT[key], rel=1e-3)
            assert found[key]["std"] < 0.011 * EXACT[key]  # what the contact distance leaves; with them 0.4


@pytest.mark.parametrize(
    "single", ["mixed at 3 and 2.4 mm", "the finest of both lines", "contact at 0.02 mm"], ids=lambda text: text
)
def test_the_reference_is_of_the_law_that_most_meshes_see(config: Config, single: str) -> None:
    rungs = [(rung, made_up(rung)) for rung in ladder(config, TOUCHING)]
    finest = {"mixed": (2.4,), "mixed, graded to walls": (1.3,)}
    which = {
        "mixed at 3 and 2.4 mm": lambda rung: rung.choice == "mixed" and rung.value in (3.0, 2.4),
        "the finest of both lines": lambda rung: rung.value in finest.get(rung.choice, ()),
        "contact at 0.02 mm": lambda rung: rung.choice == CONTACT and rung.value == 0.02,
    }[single]
    changed = [numbers for rung, found in rungs if which(rung) for numbers in found["numbers"]]
    assert changed
    for numbers in changed:
        numbers.update(alpha1_N_mm2=250.0, alpha2_N_mm2=250.0, d_mm=None)
    for found in accuracy_record(config, rungs, TOUCHING)["reference"]:
        for key in ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm"):
            assert found[key]["value"] == pytest.approx(EXACT[key], rel=5e-3)


def test_rungs_that_failed_are_told_and_have_no_error(config: Config) -> None:
    found = [(rung, made_up(rung)) for rung in ladder(config, TOUCHING)]
    found[0] = (found[0][0], {"failure": "the body could not be meshed", "numbers": []})
    row = accuracy_record(config, found, TOUCHING)["rungs"][0]
    assert (row["headline"], row["on_front"], row["errors"]) == (None, False, [])
    assert row["failure"] == "the body could not be meshed"
    with pytest.raises(RunFailed, match="17 kPa, 37 kPa"):
        accuracy_record(config, [(rung, {"failure": "no", "numbers": []}) for rung, _ in found], TOUCHING)


def test_table_and_pictures(record: dict[str, Any]) -> None:
    lines = markdown(record).splitlines()
    assert len(lines) == 2 + len(record["rungs"])
    assert {line.count("|") for line in lines} == {len(COLUMNS_OF_RUNGS) + 1}
    assert sum("**" in line for line in lines) == sum(row["on_front"] for row in record["rungs"])
    assert len(reference_sentences(record)) == 2
    assert "κ₀(l/2) = -0.016 " in reference_sentences(record)[0]
    page, picture = html_page(record), svg_picture(record)
    assert "nothing is better" in page
    assert picture.startswith("<?xml")
    assert svg_picture(record) == picture


def test_a_tiny_ladder_is_climbed_and_resumed(configs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rungs, "SIZES", {"off": (1.0, 0.75)})
    monkeypatch.setattr(rungs, "LOCKING", {"p1": (0.5,)})
    monkeypatch.setattr(rungs, "FORMULATIONS", ("mixed", "p1"))
    monkeypatch.setattr(rungs, "TOLERANCES", ())
    monkeypatch.setattr(rungs, "DISTANCES", ())
    overrides = ["geometry.chambers=8", "mesh={size: 8 mm, formulation: mixed}", "pressures=[5 kPa]"]
    config = load_config(configs / "pneunet_coarse.yaml", [*overrides, "effects.self_contact=off"])
    record = climb(config, tmp_path, 1, False, Silent())
    assert json.loads((tmp_path / "accuracy.json").read_text())["rungs"] == json.loads(json.dumps(record["rungs"]))
    assert (tmp_path / "accuracy.svg").is_file()
    assert (tmp_path / "accuracy.html").is_file()
    coarse, fine, linear = record["rungs"]
    assert coarse["degrees_of_freedom"] < fine["degrees_of_freedom"]
    assert coarse["headline"] > fine["headline"] > 0.0
    assert 2 * linear["degrees_of_freedom"] < coarse["degrees_of_freedom"]
    names = ("mixed_8", "p1_4")
    found = [json.loads((tmp_path / f"rungs/{name}.json").read_text())["numbers"][0] for name in names]
    assert found[1]["alpha1_N_mm2"] > 2 * found[0]["alpha1_N_mm2"]  # it locks; measured: 525 and 192
    for row in (coarse, fine, linear):
        assert row["failure"] == ""
        assert 100.0 < row["peak_memory_MB"] < 4000.0
        assert 0.0 < row["seconds"]["factorization"] < row["wall_seconds"]
        assert row["cpu_seconds"] > 0.0

    def never(missing: Any, jobs: int, keep: Any) -> None:
        assert missing == []

    monkeypatch.setattr(accuracy, "measured_apart", never)
    assert climb(config, tmp_path, 1, False, Silent())["rungs"] == record["rungs"]
