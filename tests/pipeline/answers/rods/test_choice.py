"""The rod of a run: the one that the verdict recommends, with its notes, in Python as on the command line."""

import json
import shutil
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pneurod
from pipeline.answers.rods.choice import choose_rod
from pipeline.results.files import read_run
from pipeline.results.rod_errors import rod_to_take
from pipeline.values.errors import InputError
from pipeline.values.run import Reported
from rod import LawRod
from tests.coarse import COARSE, coarse_run, copy_with
from tests.commands import done, refused

#: of the mesh, small enough for the verdict to recommend a rod
MESH_ERROR = 0.001


@pytest.mark.parametrize(("kind", "taken"), [(None, "law"), ("law", "law"), ("five", "five")])
def test_python_and_the_command_line_give_the_same_rod(kind: str | None, taken: str) -> None:
    with warnings.catch_warnings(record=True, action="always") as told:
        rod = pneurod.read_results(COARSE).rod("17 kPa", kind)
    assert isinstance(rod.law, LawRod) == (taken == "law")
    assert "of the force 11 % (rod and mesh added); allowed are 5 and 10 %" in rod.notes[0]
    assert [(w.category, str(w.message)) for w in told] == [(pneurod.RodWarning, note) for note in rod.notes]
    options = () if kind is None else ("--rod", kind)
    printed = done("rod", str(COARSE), "--pressure", "17 kPa", "--end-y", "-20 mm", *options)
    shape = rod.solve(end_y=-20.0)
    assert f"bends by             {shape.bending_deg:.2f}°" in printed
    assert shape.notes == rod.notes
    assert all(note in printed for note in shape.notes)
    assert "errors               error of the shape" in printed


def test_the_rod_of_a_good_run_has_no_notes_and_knows_its_errors() -> None:
    chosen = choose_rod(coarse_run(MESH_ERROR))
    assert (chosen.kind, chosen.pressures_kPa) == ("law", (0.0, 37.0))
    assert chosen.at(20.0).solve().notes == ()
    assert 0.0 < chosen.errors.shape < 0.01
    assert chosen.errors.largest_N == pytest.approx(0.1, abs=0.09)


def test_a_load_outside_the_identification_warns_and_is_noted() -> None:
    rod = choose_rod(coarse_run(MESH_ERROR), "five").at(17.0)
    assert rod.moment_range is not None
    with pytest.warns(pneurod.RodWarning, match="The moment leaves the .* of the identification"):
        shape = rod.solve(force=(0.0, -0.1))
    assert shape.notes[:-1] == rod.notes
    assert "The offsets m0 act under any load: the tip jumps by" in shape.notes[-1]


def test_an_arm_that_leaves_its_plane_has_no_rod() -> None:
    out = Reported("out_of_plane", {}, None, "The arm leaves its plane.")
    run = coarse_run(MESH_ERROR)
    for kind in (None, "law", "five"):
        with pytest.raises(InputError, match=r"The arm leaves its plane\.$"):
            choose_rod(replace(run, record=replace(run.record, remarks=(out,))), kind)


def test_commands_refuse_an_arm_that_leaves_its_plane_and_write_nothing(tmp_path: Path) -> None:
    remark = {"code": "out_of_plane", "values": {}, "where": None, "text": "The arm leaves its plane."}
    folder = copy_with(tmp_path / "arm", "run.json", lambda record: record | {"remarks": [remark]})
    before = sorted(folder.iterdir())
    for command in (("rod", str(folder), "--pressure", "17 kPa"), ("export", str(folder), "--to", "csv")):
        assert refused(*command) == f"{folder}: The arm leaves its plane."
    assert sorted(folder.iterdir()) == before


def test_the_error_of_a_law_alone_has_that_of_its_ends(tmp_path: Path) -> None:
    law, shapes = json.loads((COARSE / "law.json").read_text()), []
    for ends in (0.0, 0.02, None):
        law["interpolation_error"]["ends_over_length"] = ends
        (tmp_path / "law.json").write_text(json.dumps(law))
        taken = rod_to_take(read_run(tmp_path))
        assert ("because of its mesh and ends; no whole arm" in taken[1].text) == bool(ends)
        shapes.append(taken[1].shape)
    assert np.diff(shapes) == pytest.approx([0.02, -0.02])


def test_a_law_alone_is_taken(tmp_path: Path) -> None:
    """As `pneurod cell` leaves it: nothing was compared with finite elements."""
    shutil.copy(COARSE / "law.json", tmp_path)
    with pytest.warns(pneurod.RodWarning, match="of the force 11 % because of its mesh"):
        rod = pneurod.read_results(tmp_path).rod(17.0)
    assert isinstance(rod.law, LawRod)
    with pytest.raises(pneurod.InputError, match="holds no parameters of a rod"):
        pneurod.read_results(tmp_path).rod(17.0, kind="five")
