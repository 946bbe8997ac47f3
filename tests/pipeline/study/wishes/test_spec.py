"""The file of a wish: what is read, and what is refused with its key."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.study.wishes.step import check_feasible
from pipeline.study.wishes.wish import rounded
from pipeline.values.errors import InputError
from tests.pipeline.study.wishes.test_measured import SMALL, small


def test_a_file_is_complete_values(tmp_path: Path) -> None:
    file = small(tmp_path)
    wishes = file.wishes
    assert wishes.dimensions == ("geometry.wall", "geometry.base")
    assert wishes.start.tolist() == [1.0, 2.0, 22.5]  # of the base, and the middle of a pressure
    assert wishes.pressures_kPa(wishes.start) == (20.0, 22.5)
    assert [len(part) for part in wishes.parts(np.arange(6.0))] == [1, 2, 1, 1, 1]
    kappa_0, tip = wishes.wishes[:2]
    assert (kappa_0.target, kappa_0.within) == ((-6e-4,), pytest.approx(1.2e-5))
    found = np.concatenate([wishes.targets[:1], [40.0, -4.0], wishes.targets[3:]])
    assert wishes.misses(found) == pytest.approx([0.0, 2.0, 0.0, 0.0, 0.0])
    assert tip.text(tip.target) == "(40, -2) mm"
    config = file.config(rounded(np.array([1.23456789, 2.0, 25.0])))
    assert config.design.dimensions["wall"] == 1.23457
    assert config.pressures_kPa == (20.0, 25.0)
    assert config.end.y_mm == 0.0
    assert config.name == "small"
    loaded = small(tmp_path, SMALL.replace("0.1 deg}", "0.1 deg, under: {force: [0 N, -0.1 N]}}")).wishes.wishes[2]
    assert loaded.under.force == (0.0, -0.1)
    assert loaded.name == "angle at grip under force [0 N, -0.1 N]"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("geometry.wall:", "geometry.wal:", r"free.geometry.wal: .*did you mean 'geometry.wall'"),
        ("geometry.wall:", "geometry.chambers:", r"free.geometry.chambers: needs a family with chambers, another free"),
        ("free:", "free:\n  geometry.chambers: {from: 4.5, to: 8}", r"free.geometry.chambers: .* whole numbers"),
        ("{from: 0.7 mm, to: 1.6 mm}", "1 mm", r"free.geometry.wall: must hold keys; .*from, to"),
        ("{from: 0.7 mm, to: 1.6 mm}", "{from: 0.7 mm}", r"free.geometry.wall.to: is missing"),
        ("{from: 0.7 mm, to: 1.6 mm}", "{from: 0.7, to: 1.6 mm}", r"free.geometry.wall.from: .*has no unit"),
        ("{from: 0.7 mm, to: 1.6 mm}", "{from: 1.6 mm, to: 0.7 mm}", r"free.geometry.wall: goes from 1.6 to 0.7 mm"),
        ("{from: 0.7 mm, to: 1.6 mm}", "{from: 1.1 mm, to: 1.6 mm}", r"free.geometry.wall: .* outside its bounds"),
        ("kappa_0: -0.6 1/m", "kappa_0: -0.6", r"wishes\[1\].kappa_0: .*has no unit"),
        ("kappa_0: -0.6 1/m", "kapa_0: -0.6 1/m", r"wishes\[1\].kapa_0: unknown key; did you mean 'kappa_0'"),
        ("kappa_0: -0.6 1/m", "kappa_0: -0.6 1/m, angle: 4 deg", r"wishes\[1\]: names 2 quantities"),
        ("at: grip, within: 1 mm", "at: grp, within: 1 mm", r"wishes\[2\].at: 'grp' is not known; did you mean 'grip'"),
        ("at: grip, within: 1 mm", "at: grip, within: 1 %", r"wishes\[2\].within: .*no tolerance here"),
        ("at: grip, within: 1 mm", "at: grip", r"wishes\[2\].within: is missing"),
        ("tip: [40 mm, -2 mm]", "tip: 40 mm", r"wishes\[2\].tip: must be a list, for example"),
        (", at_height: 0 mm", "", r"wishes\[5\].at_height: belongs to a force"),
        ("within: 0.1 deg", "within: 0.1 deg, under: {pull: 1 N}", r"wishes\[3\].under: .*no load; allowed are force"),
        ("within: 0.1 deg", "within: 0.1 deg, under: {force: 1 mm}", r"wishes\[3\].under: .*N"),
        ("within: 0.1 deg", "within: 0.1 deg, under: {tip_mass: 1 g}", r"wishes\[3\].under: .*needs orientation"),
        ("at: 20 kPa, within: 2 %}", "at: 20 kPa, within: 2 %, under: {force: 1 N}}", r"under: kappa_0 is that of"),
        ("mass: 30 g", "mass: 30", r"limits.mass: .*has no unit"),
        ("mass: 30 g", "weight: 30 g", r"limits.weight: unknown key"),
        ("largest_stretch: 1.3", "largest_stretch: 0.9", r"limits.largest_stretch: .* above 1"),
        ("limits:", "minimize: masses\nlimits:", r"minimize: .*did you mean 'mass'"),
        ("limits:", "objective: mass\nlimits:", r"objective: unknown key"),
        ("semicircular_coarse.yaml", "nowhere.yaml", r"base: .*no such file"),
        ("mesh.size: 6 mm", "mesh.siz: 6 mm", r"set.mesh.siz: unknown key"),
    ],
)
def test_a_file_that_cannot_be_meant_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in SMALL
    with pytest.raises(InputError, match=words):
        small(tmp_path, SMALL.replace(old, new))


def test_wishes_that_no_arm_has_together_are_refused(tmp_path: Path) -> None:
    other = "  - {kappa_0: -0.8 1/m, at: 20 kPa, within: 2 %}\nlimits:"
    with pytest.raises(InputError, match=r"wishes\[6\]: .*contradicts wishes\[1\]"):
        small(tmp_path, SMALL.replace("limits:", other))
    small(tmp_path, SMALL.replace("limits:", other.replace("-0.8", "-0.62")))


def test_limits_that_no_design_keeps_are_refused(tmp_path: Path) -> None:
    check_feasible(small(tmp_path))
    for old, new, words in (
        ("mass: 30 g", "mass: 1 g", r"limits.mass: no design"),
        ("smallest_wall: 0.5 mm", "smallest_wall: 1.7 mm", r"limits.smallest_wall: .*has 1.6 mm"),
    ):
        with pytest.raises(InputError, match=words):
            check_feasible(small(tmp_path, SMALL.replace(old, new)))
