"""A draft: the arm's own law on one mesh, what says that it is one, and what it lacks."""

import json
import pickle
from dataclasses import replace
from pathlib import Path

import pytest

import pneurod
from pipeline.config.document import Document, read_document
from pipeline.config.load import checked
from pipeline.law.ends import CLAMP_NEAR
from pipeline.law.rows import read_pairs
from pipeline.results.files import LAW, read_results, replace_draft
from pipeline.results.verdict import verdict_of
from pipeline.store.result_folder import ResultFolder
from pipeline.study.sweep.points import Point
from pipeline.study.sweep.spec import points_of, read_sweep
from pipeline.values.errors import InputError
from pipeline.values.law import DRAFT
from tests.coarse import copy_with
from tests.shared import SharedFolders

ARM = """
name: small
geometry: {family: semicircular, chambers: 4}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [15 kPa, 30 kPa]
mesh: {size: 6 mm, grading: off, formulation: p2p0}
"""


def arm(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(ARM)
    return path


@pytest.fixture
def draft(shared: SharedFolders, tmp_path: Path, undrawn: None) -> Path:
    return shared.folder("draft", lambda out: pneurod.characterize(arm(tmp_path), out, draft=True, jobs=1))


def test_a_draft_is_one_law_without_what_takes_time(draft: Path) -> None:
    run = read_results(draft)
    assert run.law.pressures_kPa == (0.0, 15.0, 30.0)
    assert run.law.plane.rates == {}
    assert len(run.law.unloaded) == 2
    assert [path.name for path in (draft / "law").iterdir()] == ["p2p0_off_6mm"]
    assert not (draft / "experiments.json").exists()


def test_every_answer_says_that_it_is_a_draft(draft: Path) -> None:
    verdict = verdict_of(read_results(draft))
    assert verdict.draft
    assert verdict.lines[0].startswith("small (draft), ")
    assert any(DRAFT in line for line in verdict.lines)
    page = (draft / "report.html").read_text()
    assert DRAFT in page
    assert "A run without --draft does that" in page
    with pytest.warns(pneurod.RodWarning, match=DRAFT):
        pneurod.read_results(draft).rod(20.0)
    assert pneurod.solve(draft, angle="2 deg").solutions[0].error_kPa is None


def test_workers_measure_it() -> None:
    assert pickle.loads(pickle.dumps(CLAMP_NEAR)).file == "clamp_near"


def test_a_draft_has_no_budget(draft: Path) -> None:
    with pytest.raises(InputError, match="a budget needs derivatives, which a draft does not have"):
        pneurod.budget(draft)


def test_a_draft_belongs_to_the_configuration_of_its_full_run(tmp_path: Path) -> None:
    full = read_document(arm(tmp_path))
    one = checked(full.with_values([("draft", True)], str))
    assert one.draft
    assert one.hash == checked(full).hash


def test_a_full_law_takes_the_place_of_a_draft_alone(tmp_path: Path) -> None:
    folder = ResultFolder(copy_with(tmp_path / "run", LAW, lambda law: law | {"draft": True}))
    replace_draft(folder, draft=True)
    assert (folder.directory / LAW).exists()
    replace_draft(folder, draft=False)
    assert not (folder.directory / LAW).exists()
    full = ResultFolder(copy_with(tmp_path / "full", LAW, lambda law: law))
    replace_draft(full, draft=False)
    with pytest.raises(InputError, match="holds a law that is no draft"):
        replace_draft(full, draft=True)


def test_pairs_of_pressures_have_no_draft(tmp_path: Path) -> None:
    content = {**read_document(arm(tmp_path)).content, "pressures": [["10 kPa", "5 kPa"]], "draft": True}
    with pytest.raises(InputError, match=r"draft: is for one pressure in all cavities, not for pairs"):
        read_pairs(Document(Path("two.yaml"), content, ()))


def test_a_sweep_of_drafts_does_the_full_points_anew(tmp_path: Path) -> None:
    arm(tmp_path)
    file = tmp_path / "sweep.yaml"
    file.write_text(json.dumps({"name": "s", "base": "small.yaml", "axes": [{"geometry.wall": ["1 mm", "1.2 mm"]}]}))
    sweep = read_sweep(file)
    drafts, full = (points_of(one, tmp_path) for one in (sweep.as_draft(), sweep))
    for one, other in zip(drafts, full, strict=True):
        assert isinstance(one, Point)
        assert isinstance(other, Point)
        assert one.config.draft
        assert one.name == other.name
        assert one.kept.key != replace(other, run=one.run).kept.key
