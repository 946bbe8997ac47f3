"""The command that measures the arm's own law: its files, what it keeps, what it refuses, and the rod that reads it."""

import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import pneurod
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from geometry import Reason
from pipeline.answers.rods.solid import solid_of
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.law import cells, meshes
from pipeline.law.build import MeasuredLaw, tell_first
from pipeline.law.cells import BETWEEN, is_not_reduced
from pipeline.law.mesh_limit import PLANE
from pipeline.law.meshes import find_limit
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.tasks import ArmTasks
from pipeline.law.study import LawReport, measure_law
from pipeline.law.unloaded import first_states
from pipeline.results.files import read_plane_law, read_results
from pipeline.results.unloaded import unloaded_states
from pipeline.simulate.scene import Scene
from pipeline.store.context import RunContext
from pipeline.store.parallel import Pending
from pipeline.store.progress import Progress, Silent
from pipeline.store.store import open_store
from pipeline.values.law import Unloaded
from tests.coarse import COARSE
from tests.commands import done, refused
from tests.solved import alone

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"
ARM = ["geometry.chambers=4", "pressures=[6 kPa, 9 kPa]", "mesh.size=6 mm", "accuracy=off"]


def arm(*settings: str, name: str = "pneunet_coarse") -> Config:
    return load_config(CONFIGS / f"{name}.yaml", settings)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, coarse_limit: None) -> LawReport[MeasuredLaw]:
    return measure_law(arm(*ARM), tmp_path_factory.mktemp("law"), 1, False, Silent())


def test_the_law_goes_through_rest_and_every_pressure_of_the_configuration(report: LawReport[MeasuredLaw]) -> None:
    law = report.measured.law
    assert report.measured.failures == ()
    assert {0.0, 6.0, 9.0} | set(report.measured.added_kPa) == set(law.pressures)
    assert (law.pitch, law.length, law.first_middle) == pytest.approx((10.0, 42.0, 6.0), abs=1e-9)
    kappa_0 = [cell.at(0.0)[0] for cell in law.cells]
    assert kappa_0[0] == pytest.approx(0.0, abs=1e-7)
    assert np.all(np.diff(kappa_0) < 0.0)  # negative, as in experiment II
    assert (report.measured.interpolation_error.between_pressures or 0.0) <= BETWEEN
    assert report.measured.interpolation_error.along_curves < 0.01


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ((1.9, 1.8, 1.7), True),
        ((9.0, 1.8, 1.7), False),  # halved until now
        ((1.9, 1.8, 0.9), False),
        ((1.8, 1.7), False),
        ((2.9, 2.8, 2.7), False),  # too far from what is allowed
        ((8.0, 1.9, 1.8, 1.7), True),
    ],
)
def test_intervals_of_the_pressure_are_not_divided_in_vain(errors: tuple[float, ...], expected: bool) -> None:
    assert is_not_reduced(errors, 1.0) is expected


def test_the_file_holds_the_law_with_its_errors_and_limits(report: LawReport[MeasuredLaw]) -> None:
    content = json.loads((report.directory / "law.json").read_text(encoding="utf-8"))
    assert {"format", "pitch_mm", "pressures_kPa", "curves", "clamp", "tip", "mesh_error", "limits"} <= set(content)
    keys = {"pressure_kPa", "kappa_per_mm", "moment_N_mm", "stretch", "rigidity_N_mm2", "contact", "min_J"}
    assert all(keys <= set(curve) for curve in content["curves"])
    error = content["mesh_error"]
    assert error["pressures_kPa"] == [6.0, 9.0]
    for name in ("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm"):
        values, stds = error[name], error[f"{name}_std"]
        assert all(0.0 < std < 0.2 * abs(value) for value, std in zip(values, stds, strict=True))
    assert content["accuracy"] is None
    assert (report.directory / "run.json").stat().st_size > 1000


def test_the_law_is_read_back_and_gives_the_same_rod(report: LawReport[MeasuredLaw]) -> None:
    results = pneurod.read_results(report.directory)
    assert isinstance(results.arm_law, pneurod.ArmLaw)
    assert results.run.record.config_hash == report.config.hash
    for pressure in (7.5, 9.0):
        ours, theirs = (law.at(pressure).solve(end_y=0.0) for law in (results.arm_law, report.measured.law))
        assert np.array_equal(ours.x, theirs.x)
        assert np.array_equal(ours.moment, theirs.moment)


def test_a_second_call_solves_nothing_and_writes_the_same_law(
    report: LawReport[MeasuredLaw], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(report.directory, tmp_path / "again")

    def refuse(*arguments: object, **options: object) -> None:
        raise AssertionError("a state is solved again")

    for name in ("solve", "solve_near"):
        monkeypatch.setattr(BendingPiece, name, refuse)
    measure_law(arm(*ARM), tmp_path / "again", 1, False, Silent())
    first, second = (folder / "law.json" for folder in (report.directory, tmp_path / "again"))
    assert first.read_bytes() == second.read_bytes()


def test_an_interrupted_measurement_continues_with_equal_numbers(
    report: LawReport[MeasuredLaw], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A cell, an end and a check that are missing are measured again, from the same states as the first time."""
    shutil.copytree(report.directory, tmp_path / "again")
    for pattern in ("cell_9kPa*", "clamp_*_9kPa*", "between_6*"):
        file = min((tmp_path / "again" / "law").rglob(pattern))
        file.unlink()
    again = measure_law(arm(*ARM), tmp_path / "again", 1, False, Silent())
    for ours, theirs in zip(again.measured.law.cells, report.measured.law.cells, strict=True):
        assert np.array_equal(ours.moment, theirs.moment)
        assert np.array_equal(ours.ripple, theirs.ripple)
    for clamp, other in zip(again.measured.law.clamps, report.measured.law.clamps, strict=True):
        assert np.array_equal(clamp.offset, other.offset)


def test_finer_meshes_are_tried_until_the_limit_is_certain_enough(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = arm(*ARM)
    pieces = ArmPieces(config, 0.04)
    with alone(tmp_path, config, fresh=False) as context:
        limit = find_limit(pieces, {0.0: 0.0, 9.0: -0.006}, 0.1, context)
        assert limit.is_reached
        sizes = [mesh.size_mm for mesh in limit.meshes]
        assert sizes == pytest.approx([6.0 / meshes.RATIO**k for k in range(len(sizes))])
        assert len(sizes) >= meshes.MESHES
        assert [remark.code for remark in limit.remarks] == ["cell_accuracy"]
        before_last = limit.meshes[-2].degrees_of_freedom
        monkeypatch.setattr(meshes, "MOST_UNKNOWNS", before_last * meshes.RATIO**2)
        limited = find_limit(pieces, {0.0: 0.0, 9.0: -0.006}, 1e-6, context)  # the same meshes, from the folder
        at_rest, highest = zip(*(mesh.kappa_0_per_mm for mesh in limit.meshes), strict=True)
        assert at_rest == (0.0, 0.0, 0.0, None)  # no finer mesh than it needs
        assert [mesh.kappa_0_per_mm[1] for mesh in limited.meshes] == list(highest)
        assert not limited.is_reached
        assert [remark.code for remark in limited.remarks] == ["cell_accuracy", "cell_accuracy_missed"]


@pytest.mark.slow
def test_the_delivered_law_is_that_of_the_limit(tmp_path: Path) -> None:
    config = arm("accuracy=20%", "pressures=[20 kPa]", name="semicircular_single_coarse")
    measured = measure_law(config, tmp_path, 1, False, Silent()).measured
    kappa_0, rigidity, moment = (measured.limit.limits[20.0][name].value for name in PLANE)
    cell, change = measured.law.cells[-1], -np.copysign(1.0 / config.design.length, kappa_0)
    assert cell.at(0.0)[0] == pytest.approx(kappa_0, rel=1e-6)
    assert cell.at(rigidity * change)[0] - kappa_0 == pytest.approx(change, rel=1e-2)
    assert cell.at(moment)[0] == pytest.approx(0.0, abs=0.02 * abs(kappa_0))
    assert measured.mesh_error.kappa_0_per_mm == pytest.approx((kappa_0,))
    assert len(json.loads((tmp_path / "law.json").read_text())["accuracy"]["meshes"]) >= meshes.MESHES


def test_a_pressure_that_a_finer_mesh_does_not_bear_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config, solved = arm(*ARM), meshes._Mapped.without_moment
    pieces = ArmPieces(config, 0.04)
    coarse = len(pieces.cell.space.points)

    def failing(known: meshes._Mapped, angle: float, close: float) -> tuple[PieceState, float]:
        if known.pressure == 0.009 and len(known.piece.space.points) > coarse:
            raise PieceFailed(Reason("tangent_indefinite"))
        return solved(known, angle, close)

    monkeypatch.setattr(meshes._Mapped, "without_moment", failing)
    with alone(tmp_path, config, fresh=False) as context:
        limit = find_limit(pieces, {0.0: 0.0, 6.0: -0.004, 9.0: -0.006}, 1.0, context)
    assert tuple(limit.limits) == (0.0, 6.0)
    [reason] = limit.reasons
    assert (reason.code, reason.values["pressure_kPa"]) == ("cell_no_limit", 9.0)
    assert reason.values["size_mm"] == pytest.approx(6.0 / meshes.RATIO)


def test_processes_measure_the_same_law(report: LawReport[MeasuredLaw], tmp_path: Path) -> None:
    shutil.copytree(report.directory, tmp_path / "again")
    for pattern in ("cell_6kPa*", "cell_9kPa*"):
        for file in (tmp_path / "again" / "law").rglob(pattern):
            file.unlink()
    again = measure_law(arm(*ARM), tmp_path / "again", 2, False, Silent()).measured.law
    for ours, theirs in zip(again.cells, report.measured.law.cells, strict=True):
        assert ours.moment == pytest.approx(theirs.moment, abs=1e-6)
        assert ours.kappa == pytest.approx(theirs.kappa, rel=1e-6, abs=1e-9)


def test_a_pressure_that_the_cell_does_not_bear_is_named_and_the_law_below_it_stays(
    report: LawReport[MeasuredLaw], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(report.directory, tmp_path / "again")
    [file] = (tmp_path / "again" / "law").rglob("cell_9kPa*")
    file.unlink()

    def fail(*arguments: object) -> None:
        raise PieceFailed(Reason("tangent_indefinite"))

    monkeypatch.setattr(cells, "sweep_cell", fail)
    again = measure_law(arm(*ARM), tmp_path / "again", 1, False, Silent())
    assert again.measured.law.pressures[-1] == 6.0
    [failure] = again.measured.failures
    assert failure.code == "law_incomplete"
    with pytest.raises(pneurod.RunFailed, match="the tangent is indefinite") as failed:
        again.raise_if_failed()
    assert "the law goes up to 6 kPa" in str(failed.value)


def test_the_section_law_is_exported_as_a_table(report: LawReport[MeasuredLaw], tmp_path: Path) -> None:
    shutil.copy(report.directory / "law.json", tmp_path)
    export = ("export", str(tmp_path), "--to")
    for target in ("csv", "json"):
        done(*export, target)
    (table,), (text,) = tmp_path.glob("law_*kPa.csv"), tmp_path.glob("law_*kPa.json")
    rows, content = np.genfromtxt(table, delimiter=",", names=True), json.loads(text.read_text(encoding="utf-8"))
    assert content["pressures_kPa"][-1] == 9.0
    last = rows[rows["pressure_kPa"] == 9.0]
    assert last["kappa_per_mm"] == pytest.approx(content["kappa_per_mm"][-1])
    done(*export, "csv", "--pressure", "8 kPa")
    assert (tmp_path / "law_8kPa.csv").is_file()
    assert "has a law and no body, which mujoco needs; give the folder of `pneurod run`" in refused(*export, "mujoco")


def test_the_folder_of_a_cell_is_solved_and_exported(report: LawReport, tmp_path: Path) -> None:
    """With the mass of its law, and the section of its mesh."""
    solid, law = solid_of(read_results(report.directory)), report.measured.law
    assert (solid.mass, solid.section.width) == pytest.approx((law.mass.grams[-1], 15.0))
    assert solid.section.centre == pytest.approx(law.mass.heights[-1] / law.mass.grams[-1], rel=1e-3)
    assert pneurod.solve(report, angle="10 deg").solutions
    for target in ("mujoco", "pyelastica", "somo", "sorosim"):
        assert pneurod.export(report, target, out=tmp_path).files


def test_the_tip_without_a_load_is_that_of_the_material_curve() -> None:
    """As finite elements of the whole arm have it; the end of the axis is 0.1 and 0.2 mm away."""
    measured = {row.pressure_kPa: row for row in read_results(COARSE).states if row.experiment == "II"}
    for state in unloaded_states(read_plane_law(COARSE / "law.json"), tuple(measured)):
        whole = measured[state.pressure_kPa]
        assert state.tip_mm == pytest.approx((whole.end_x_mm, whole.end_y_mm - 1.0), abs=0.08)


def test_the_first_numbers_are_those_of_the_law_on_the_same_mesh(
    report: LawReport[MeasuredLaw], tmp_path: Path
) -> None:
    config, told = arm(*ARM), Mock(spec=Progress)
    with open_store(tmp_path, config) as store:
        pieces, context = ArmPieces.of(Scene.meshed(config)), RunContext.alone(store, told)
        tell_first(pieces, context)
        first = first_states(ArmTasks(pieces, context), config.pressures_kPa)  # kept
    for one, other in zip(first, unloaded_states(report.measured.law, config.pressures_kPa), strict=True):
        for name in ("kappa_0_per_mm", "rigidity_N_mm2", "bending_deg", "tip_mm"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=2e-4)
    (sentence,) = told.remark.call_args.args
    assert "on a mesh of 6 mm" in sentence
    assert f"bends by {first[0].bending_deg:.0f}°, {first[1].bending_deg:.0f}° at 6, 9 kPa" in sentence


def test_first_numbers_leave_out_pressures_that_the_cell_does_not_bear() -> None:
    state = Unloaded(6.0, -0.004, 160.0, 20.0, (40.0, -7.0))

    class Failed:
        def result(self) -> Unloaded:
            raise PieceFailed(Reason("tangent_indefinite"))

    begun: list[Any] = [Pending.done(state), Failed()]
    tasks: Any = SimpleNamespace(submit=lambda _, number: begun[number])
    assert first_states(tasks, (0, 1)) == (state,)
