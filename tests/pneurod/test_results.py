"""What results offer beside their tables: files for other programs, and the mass of an arm with its own law alone."""

import shutil
from pathlib import Path

import pytest

import pneurod
from tests.coarse import COARSE


def test_a_rod_is_exported_from_python(tmp_path: Path) -> None:
    results = pneurod.read_results(COARSE)
    [path] = results.export("pyelastica", tmp_path)
    assert path.parent == tmp_path
    assert "def simulate(" in path.read_text(encoding="utf-8")
    with pytest.raises(pneurod.InputError, match=r"exists; give another out, or force=True to replace it$"):
        results.export("pyelastica", tmp_path)
    assert results.export("pyelastica", tmp_path, force=True) == (path,)
    with pytest.raises(pneurod.InputError, match=r"^to=gazebo: allowed are csv, json, mujoco, "):
        results.export("gazebo", tmp_path)


def test_the_mass_of_an_arm_with_its_own_law_alone_is_that_of_the_law(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    shutil.copytree(COARSE, folder)
    whole = pneurod.read_results(folder).mass_g
    (folder / "parameters.json").unlink()
    results = pneurod.read_results(folder)
    assert results.arm_law is not None
    assert results.arm_law.mass is not None
    assert results.mass_g == pytest.approx(whole, rel=0.02)
