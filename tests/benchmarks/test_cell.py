"""The tables of docs/cell.md: nothing is right that was not compared, and kept results belong to what is measured."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks import cell, cell_mesh, cell_random
from benchmarks.cell import ARMS, CASES, Arm, Case, Comparison, Cost, Results, WholeArm
from benchmarks.cell_random import NOT_SOLVED, Row, page

GOOD = Comparison(10.0, "II", 0.001, None, 0.0)
MISSING = Comparison(20.0, "II", math.nan, None, math.nan, refusal=NOT_SOLVED)


def row(*comparisons: Comparison) -> Row:
    return Row("pneunet, svk, 20 kPa", {"law": 1.0}, -80.0, comparisons)


def test_a_design_is_right_only_where_all_of_its_loads_were_compared() -> None:
    assert row(GOOD).is_right
    assert row(GOOD).is_right_by_force
    for incomplete in (row(), row(GOOD, MISSING)):
        assert not incomplete.is_right
        assert not incomplete.is_right_by_force
    text = page(2026, [row(GOOD), row(GOOD, MISSING)])
    assert text.startswith("1 of 2 designs (seed 2026) are right in all loads; 1 of 2 are")
    assert "| 1 | pneunet, svk, 20 kPa | -80 | not solved | - | - | - | no |" in text
    assert f"- Design 1: II at 20 kPa: {NOT_SOLVED}." in text
    refused = replace(MISSING, refusal="the moment leaves the law")
    assert "| refused |" in page(2026, [row(refused, MISSING)])


@pytest.mark.parametrize("arguments", [["--whole", "--publish"], ["--first", "12", "--publish"]])
def test_only_all_designs_with_their_comparisons_are_published(
    arguments: Sequence[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["cell_random.py", str(tmp_path), "--seed", "2026", *arguments])
    with pytest.raises(SystemExit) as ended:
        cell_random.main()
    assert ended.value.code == 2
    assert "--publish" in capsys.readouterr().err


def test_a_kept_whole_arm_belongs_to_its_walls_and_its_load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    solved: list[tuple[Arm, Case]] = []
    state = WholeArm(np.array([0.0, 1.0]), np.zeros((2, 2)), np.array([0.0, 0.1]), 0.0, np.zeros((0, 2)))

    def solve(arm: Arm, case: Case, pressures: Sequence[float]) -> tuple[dict[float, WholeArm], Cost]:
        solved.append((arm, case))
        return {pressures[0]: state}, Cost(0.0, 0.0, 0)

    monkeypatch.setattr(cell, "solve_whole", solve)
    results, arm, case = Results(tmp_path), ARMS[1], CASES[6]
    for _ in range(2):
        states = results.whole(arm, case)
        assert list(states) == [20.0]
        assert np.array_equal(states[20.0].force, state.force)
    assert solved == [(arm, case)]
    thicker = replace(arm, design=replace(arm.design, wall=1.5))
    softer, pulled = replace(arm, material=replace(arm.material, E=1.0)), replace(case, force=(0.0, 0.04))
    others = [(thicker, case), (softer, case), (replace(arm, dhat=0.05), case), (arm, pulled)]
    for other in others:
        results.whole(*other)
    assert solved == [(arm, case), *others]
    monkeypatch.setattr(cell, "key_of", lambda *words: "of other sources")
    results.whole(arm, pulled)
    assert solved[len(others) + 1 :] == [(arm, pulled)]


def test_a_kept_mesh_belongs_to_its_series(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    meshes = iter(("first", "second"))
    monkeypatch.setattr(cell_mesh, "_solved", lambda case: next(meshes))
    series = cell_mesh.SERIES[0]
    assert cell_mesh.measured(series, 3.5, tmp_path) == "first"
    assert cell_mesh.measured(series, 3.5, tmp_path) == "first"
    assert cell_mesh.measured(replace(series, pressure=30.0), 3.5, tmp_path) == "second"


def test_a_table_names_the_sources_that_it_is_from(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    docs = tmp_path / "cell.md"
    docs.write_text("before\n\n<!-- cost -->\n\nold\n\n<!-- end of cost -->\n\nafter\n", encoding="utf-8")
    monkeypatch.setattr(cell, "DOCS", docs)
    monkeypatch.setattr(cell, "written_with", lambda: "Written with the sources of commit abc1234+.")
    for _ in range(2):
        cell.renew("cost", "| a table |\n")
    table = "| a table |\n\nWritten with the sources of commit abc1234+.\n"
    expected = f"before\n\n<!-- cost -->\n\n{table}\n<!-- end of cost -->\n\nafter\n"
    assert docs.read_text(encoding="utf-8") == expected
