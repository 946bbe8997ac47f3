"""The arm's own law in a whole run on a short arm: files, rows of the validation, the first lines of the report."""

import json
from collections.abc import Iterator
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import pytest

from geometry import Reason
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.law import cells
from pipeline.law.of_run import LawOfRun, deliver_law_of_run, law_on_mesh_of_arm
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.results.files import read_results
from pipeline.results.laws import law_of_record
from pipeline.results.verdict import verdict_of
from pipeline.run import run
from pipeline.simulate.outcome import Failure, Outcome, Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import find_highest_pressure
from pipeline.store.context import RunContext
from pipeline.store.parallel import Pending
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.errors import InputError
from rod import Rod
from tests.pipeline.simulate.test_outcome import outcome, record
from tests.shared import SharedFolders
from tests.solved import alone

SHORT = """
name: five
geometry: {family: pneunet, chambers: 5}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [6 kPa, 12 kPa]
accuracy: off
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
"""


@pytest.fixture(scope="module", autouse=True)
def few_pressures(coarse_limit: None, undrawn: None) -> Iterator[None]:
    """Between two pressures the law may be ten times as wrong as usual, so that fewer are solved there."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cells, "BETWEEN", 10.0 * cells.BETWEEN)
        yield


def config(folder: Path, *settings: str) -> Config:
    path = folder / "five.yaml"
    path.write_text(SHORT, encoding="utf-8")
    return load_config(path, settings)


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory, shared: SharedFolders, few_pressures: None) -> Path:
    five = config(tmp_path_factory.mktemp("config"))
    return shared.folder("five", lambda out: run(five, out, 1, False, Silent()).results.raise_if_failed())


def read(results: Path, name: str):
    return json.loads((results / name).read_text(encoding="utf-8"))


def test_the_law_meets_the_finite_elements_under_loads_that_nothing_was_fitted_to(results: Path) -> None:
    rows = read(results, "validation.json")
    states = [(row["experiment"], row["pressure_kPa"], row["load"]) for row in rows]
    assert states == [
        *(("II", 6.0, ""), ("III", 6.0, ""), ("II", 12.0, ""), ("III", 12.0, "")),
        *(("dead", 9.0, f"dead force 0, {force} N") for force in (-0.0068, 0.0014)),
        ("III", 9.0, "end at +5.2 mm"),
    ]
    for row in rows:
        assert (row["rod"], row["sample"], row["reason"]) == ("arm_law", "out", "")
        assert row["distance_over_length"] < 0.003
        assert abs(row["end_angle_error_rad"]) < 0.01
        assert row["experiment"] != "III" or abs(row["force_error"]) < 0.02  # measured: 0.012


def test_the_law_of_a_run_is_a_file_that_gives_a_rod(results: Path) -> None:
    law = law_of_record(read(results, "law.json"))
    assert law.pressures[0] == 0.0
    shape = Rod(law.length, law=law.at(9.0)).solve(force=(0.0, 0.01))
    assert shape.x[-1] > 40.0
    effects = {row["effect"]: row for row in read(results, "effects.json")}
    assert effects["arm_law"]["state"] == "on"
    assert "from 0 to 12 kPa" in effects["arm_law"]["reason"]


@pytest.mark.slow
def test_the_law_predicts_the_five_parameters(tmp_path: Path) -> None:
    both = config(tmp_path, "pressures=[12 kPa]", "validation=off", "geometry.chambers=8")
    run(both, tmp_path / "both", 1, False, Silent()).results.raise_if_failed()
    content = read(tmp_path / "both", "parameters.json")
    predicted, identified = content["predicted_by_arm_law"], content["estimators"]["cell_averaged"]
    assert predicted["reason"] == [""]
    assert predicted["alpha2_N_mm2"][0] == pytest.approx(identified["alpha2_N_mm2"][0], rel=0.05)
    assert {row["rod"] for row in read(tmp_path / "both", "validation.json")} == {"five", "arm_law"}


def test_a_run_with_the_law_alone_solves_no_whole_arm(tmp_path: Path, results: Path) -> None:
    run(config(tmp_path, "law=cell"), tmp_path / "out", 1, False, Silent()).results.raise_if_failed()
    for name in ("parameters", "experiments", "validation", "law_on_mesh_of_arm"):
        assert not (tmp_path / "out" / f"{name}.json").exists()
    assert "Moment of a cell over its curvature" in (tmp_path / "out/report.html").read_text(encoding="utf-8")
    alone, both = read_results(tmp_path / "out"), read_results(results)
    verdict = verdict_of(alone)
    assert (verdict.rod, verdict.errors) == ("arm_law", ())
    assert verdict.bending == verdict_of(both).bending
    assert alone.law.pressures_kPa[-1] == 12.0


def test_others_begin_after_the_first_numbers_and_before_the_cells(tmp_path: Path) -> None:
    class Begun(Exception):
        pass

    progress, given = Mock(), config(tmp_path, "validation=off")
    with open_store(tmp_path / "out", given) as store, pytest.raises(Begun):
        deliver_law_of_run(Scene.meshed(given), RunContext.alone(store, progress), Mock(side_effect=Begun))
    assert "first numbers" in progress.remark.call_args.args[0]
    progress.experiment.assert_not_called()


def test_an_arm_without_a_law_keeps_its_five_parameters_and_says_why(tmp_path: Path) -> None:
    weight = "effects.gravity={acceleration: [0 m/s^2, 0 m/s^2, 9.81 m/s^2]}"
    for choice in ("both", "five"):
        heavy = config(tmp_path, weight, f"law={choice}")
        with alone(tmp_path / choice, heavy) as context:
            law = deliver_law_of_run(Scene.meshed(heavy), context)
        assert law.law is None
        assert law.effect.state == "off"
        assert ("switched off" if choice == "five" else "weight") in law.effect.reason
        assert law.failures == ()
    with pytest.raises(InputError, match=r"law: cell is not possible: the weight bends the arm out of its plane"):
        config(tmp_path, weight, "law=cell")


def test_a_body_of_which_no_piece_is_made_fails_with_the_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(self: ArmPieces) -> None:
        raise NoArmLaw("no wall faces the plane between two cells.")

    design = config(tmp_path, "law=cell", "validation=off")
    monkeypatch.setattr(ArmPieces, "repetition", property(refused))
    with alone(tmp_path / "refused", design) as context:
        law = deliver_law_of_run(Scene.meshed(design), context)
    assert law.law is None
    assert law.failures == (Reason("no_arm_law", {"why": "no wall faces the plane between two cells"}),)


def test_a_law_that_goes_beyond_the_end_of_the_whole_arm_is_named() -> None:
    failure = Failure(150.0, (), 0, 0, limit_kPa=44.93, reached_kPa=44.87)
    measured: Any = SimpleNamespace(law=SimpleNamespace(pressures=(0.0, 64.64)))
    law = LawOfRun(measured, ())
    assert law.remarks(Outcomes({"III": outcome("III", record(17.0))})) == ()
    (remark,) = law.remarks(Outcomes({"III": outcome("III", record(17.0), failure=failure)}))
    assert remark == Reason("law_beyond_end", {"highest_kPa": 64.64, "experiment": "III", "end_kPa": 44.93})


def test_pressures_that_the_cell_does_not_bear_end_the_law_below_them(tmp_path: Path) -> None:
    """All of them, or the highest one."""
    for pressures, highest in (("[1 MPa, 2 MPa]", None), ("[6 kPa, 2 MPa]", 6.0)):
        large = config(tmp_path, f"pressures={pressures}", "law=cell", "validation=off")
        with alone(tmp_path / str(highest), large) as context:
            made = deliver_law_of_run(Scene.meshed(large), context)
        assert (made.law and made.law.pressures[-1]) == highest
        assert "no equilibrium of the half cell at" in str(made.failures[0].values["why"])
        assert made.failures[0].code == ("no_arm_law" if highest is None else "law_incomplete")


def test_a_cell_that_bears_no_pressure_of_the_configuration_is_measured_below_the_limit_of_the_arm(
    tmp_path: Path,
) -> None:
    large = config(tmp_path, "pressures=[1 MPa, 2 MPa]", "validation=off")
    with alone(tmp_path / "out", large) as context:
        made = law_on_mesh_of_arm(Scene.meshed(large), context, lambda: 8.0).result()
    assert (made.law.pressures[0], made.law.pressures[-1]) == (0.0, 8.0)
    assert [reason.code for reason in made.reasons][:2] == ["law_measured", "law_incomplete"]
    assert 8.0 in made.measured.added_kPa


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which a law finds the curves of an earlier one of the same configuration."""
    return tmp_path_factory.mktemp("measured")


@pytest.mark.parametrize(
    ("reached", "below_limit", "end", "highest"),
    [
        pytest.param((6.0, 12.0), (), 0.0, 12.0, marks=pytest.mark.slow),
        ((6.0,), (), 11.0, 6.0),
        ((6.0,), (2.0, 9.0), 11.0, 9.0),
        ((), (2.0, 4.0), 5.0, 4.0),
        ((), (), 5.0, 4.0),
        pytest.param((), (), 0.0, 12.0, marks=pytest.mark.slow),
    ],
)
def test_the_law_goes_no_higher_than_the_whole_arm(
    measured: Path, reached: tuple[float, ...], below_limit: tuple[float, ...], end: float, highest: float
) -> None:
    """Up to the highest pressure at which II has a state, those below its limit included."""
    design = config(measured, "validation=off")
    scene, simulated = Scene.meshed(design), ended(design, reached, below_limit, end)
    with alone(measured / "out", design) as context:
        made = law_on_mesh_of_arm(scene, context, lambda: find_highest_pressure(scene, *simulated)).result()
    assert made.law.pressures[-1] == highest
    assert all(pressure in made.law.pressures for pressure in (6.0, 12.0) if pressure <= highest)
    assert (Reason("law_up_to", {"pressure_kPa": highest}) in made.reasons) == (highest < 12.0)
    assert made.failures == ()
    assert (highest in made.measured.added_kPa) == (highest not in (6.0, 12.0))


def ended(
    design: Config, reached: tuple[float, ...], below_limit: tuple[float, ...], end: float
) -> tuple[Pending[Outcome], Pending[tuple[Outcomes, str]]]:
    """Experiment II with states at these pressures, and with those that were added below its limit."""
    failure = Failure(12.0, (), 0, 0, limit_kPa=end) if len(reached) < 2 else None
    second, complete = (
        outcome("II", *map(record, pressures), failure=failure) for pressures in (reached, (*reached, *below_limit))
    )
    return Pending.done(second), Pending.done((Outcomes({"II": complete}), ""))


def test_the_law_goes_up_to_the_loads_of_the_validation_below_the_end_of_the_arm(tmp_path: Path) -> None:
    design = config(tmp_path, "validation={pressures: [6 kPa, 8 kPa, 10 kPa], end_y: [5 mm]}")
    scene = Scene.meshed(design)
    assert find_highest_pressure(scene, *ended(design, (6.0,), (), 9.0)) == 8.0
    assert find_highest_pressure(scene, None, Pending.done((Outcomes({}), ""))) == inf


@pytest.mark.parametrize("jobs", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_a_run_tells_its_law_how_high_it_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jobs: int) -> None:
    def up_to_six(scene: Scene, second: Pending[Outcome], complete: Pending[tuple[Outcomes, str]]) -> float:
        assert second.result().failure is None
        assert [record.pressure_kPa for record in complete.result()[0]["II"].records] == [6.0, 12.0]
        return 6.0

    monkeypatch.setattr("pipeline.stages.find_highest_pressure", up_to_six)
    design = config(tmp_path, "accuracy=20 %", "validation=off", "experiments=[II, III]")
    delivered = run(design, tmp_path / "out", jobs, False, Silent()).arm.law
    assert delivered.pressures[-1] == 12.0
    assert read(tmp_path / "out", "law_on_mesh_of_arm.json")["pressures_kPa"][-1] == 6.0
