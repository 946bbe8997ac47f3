"""A design from its wish to its files, on a small cell."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pneurod
from fem.cell.piece import BendingPiece
from pipeline.config.load import load_config
from pipeline.store.progress import Silent
from pipeline.study.wishes.design import find_best
from pipeline.study.wishes.measured import delivered
from pipeline.study.wishes.report import DesignReport, WishResult
from pipeline.study.wishes.wish import WishFile
from pipeline.values.errors import RunFailed
from tests.commands import done, refused
from tests.pipeline.study.wishes.test_measured import CONFIGS, small
from tests.pipeline.values.test_plots import panels_of
from tests.solved import alone

#: wall and base of the arm that is looked for, mm, and about its stiffness, N/mm
KNOWN, GUESS = np.array([1.0, 2.0]), 0.027
WISH = f"""
name: tiny
base: {CONFIGS}/semicircular_coarse.yaml
set: {{geometry.chambers: 4, mesh.size: 8 mm, accuracy: off}}
free:
  geometry.wall: {{from: 0.7 mm, to: 1.6 mm, start: 1.3 mm}}
  geometry.base: {{from: 1.2 mm, to: 3 mm, start: 2.6 mm}}
wishes:
  - {{kappa_0: KAPPA 1/mm, at: 30 kPa, within: 2 %}}
  - {{stiffness: STIFFNESS N/mm, at: 30 kPa, within: 2 %}}
limits: {{mass: 30 g}}
"""


def wish_of_known_arm(folder: Path) -> Path:
    """A file that wishes the numbers of the arm KNOWN, as its law has them; about its stiffness decides the force."""
    numbers = -1e-3, GUESS

    def text() -> str:
        return WISH.replace("KAPPA", f"{numbers[0]:.6g}").replace("STIFFNESS", f"{numbers[1]:.6g}")

    file = small(folder, text())
    with alone(folder / "known", file) as context:
        numbers = delivered(file, KNOWN, context)[0]
    assert numbers[1] == pytest.approx(GUESS, rel=0.05)
    return small(folder, text()).source


def test_a_known_arm_is_found_again_and_nothing_is_measured_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wish, out = wish_of_known_arm(tmp_path), tmp_path / "out"
    command = ["design", str(wish), "--out", str(out), "--no-run", "--jobs", "1", "-q"]
    assert "geometry.wall" in done(*command)
    found = json.loads((out / "design.json").read_text())
    assert found["given_up"] == []
    assert all(row["miss"] <= 1.0 for row in found["wishes"])
    assert [found["found"][f"geometry.{name}"] for name in ("wall", "base")] == pytest.approx(KNOWN, rel=0.05)
    design = load_config(out / "design.yaml").design
    assert design.dimensions["wall"] == found["found"]["geometry.wall"]
    rows = list(csv.DictReader((out / "history.csv").read_text().splitlines()))
    assert [rows[0]["law"], rows[-1]["law"]] == ["coarse", "delivered"]
    assert float(rows[0]["largest_miss"]) > 10.0
    arm, misses, _ = panels_of((out / "design.html").read_text(encoding="utf-8"))
    assert [(trace["name"], trace["line"]["dash"]) for trace in arm["data"]] == [
        ("start, 30 kPa", "dot"), ("found, 30 kPa", "solid"),
    ]  # fmt: skip
    assert arm["data"][0]["y"][-1] != pytest.approx(arm["data"][1]["y"][-1], rel=0.01)
    assert misses["layout"]["yaxis"]["type"] == "log"

    def refuse(*_: object) -> None:
        raise AssertionError("solved again")

    monkeypatch.setattr(BendingPiece, "_solve_directly", refuse)
    report = pneurod.design(wish, out=out, run=False, jobs=1)
    assert report.found == found["found"]
    assert report.run is None

    before = (out / "design.yaml").read_bytes()
    wish.write_text(wish.read_text().replace("30 g", "20 g"))
    assert "holds the results of a run with another configuration" in refused(*command)
    assert (out / "design.yaml").read_bytes() == before

    missed = replace(report, wishes=(replace(report.wishes[0], miss=3.0), report.wishes[1]))
    with pytest.raises(
        RunFailed, match=r"wish.yaml: 1 of 3 wishes .* missed: wishes\[1\], kappa_0 at 30 kPa, is .* instead of "
    ):
        missed.raise_if_missed()
    report.raise_if_missed()


def test_a_wrong_file_ends_with_its_key(tmp_path: Path) -> None:
    wish = tmp_path / "wish.yaml"
    wish.write_text(WISH.replace("KAPPA 1/mm", "-1").replace("STIFFNESS", "1"), encoding="utf-8")
    assert "wishes[1].kappa_0" in refused("design", str(wish), "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_the_number_of_chambers_is_tried_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """That of the base first, then its neighbours, until nothing is missed; a number that has no law is passed over."""
    text = WISH.replace("KAPPA", "-1e-3").replace("STIFFNESS", f"{GUESS}")
    file = small(tmp_path, text.replace("free:", "free:\n  geometry.chambers: {from: 3, to: 6}"))
    assert file.counts[:1] == (4,)
    assert sorted(file.counts) == [3, 4, 5, 6]
    assert file.with_chambers(6).start.design.dimensions == file.start.design.dimensions
    tried: list[tuple[int, Path, bool]] = []

    def find(one: WishFile, out: Path, *_: object, with_run: bool) -> DesignReport:
        count = one.start.design.chambers
        tried.append((count, out, with_run))
        if count == 3:
            raise RunFailed("no design was found")
        miss = {4: 5.0, 5: 2.0, 6: 3.0 - met}[count]
        wish = WishResult(1, one.wishes.wishes[0], 30.0, (), (-2e-3,), miss)
        return DesignReport(one.source, out, "tiny", {}, {}, (wish,), (), None, (), None, ())

    monkeypatch.setattr("pipeline.study.wishes.design.find_design", find)
    met = 0.0
    report = find_best(file, tmp_path / "out", 1, False, Silent(), with_run=True)
    assert [count for count, _, _ in tried] == [4, 3, 5, 6, 5]
    assert report.directory == tmp_path / "out" / "5_chambers"
    assert [with_run for _, _, with_run in tried] == [False] * 4 + [True]
    met, tried[:] = 2.5, []
    report = find_best(file, tmp_path / "out", 1, False, Silent(), with_run=False)
    assert report.directory.name == "6_chambers"
    assert not report.given_up
