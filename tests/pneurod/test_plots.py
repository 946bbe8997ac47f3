"""What results offer beside their tables: plots, files for other programs, the mass of an arm with its law alone."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

import pneurod
from pipeline.api.results import Plots
from tests.coarse import COARSE


@pytest.fixture(scope="module")
def results() -> pneurod.Results:
    return pneurod.read_results(COARSE)


def test_the_angle_has_finite_elements_and_a_rod_with_its_error(results: pneurod.Results) -> None:
    figure = results.plot.angle()
    named = {trace.name for trace in figure.data}
    assert named == {"finite elements", "rod, the arm's own law"}
    solid, rod = (trace for trace in figure.data if trace.yaxis == "y")
    assert list(solid.x) == [0.0, 17.0, 37.0]
    assert solid.y[2] == pytest.approx(140.2, abs=0.1)
    assert min(rod.error_y.array) > 0.0
    assert rod.marker.color == "black"
    assert figure.layout.yaxis.title.text == "bending angle (°)"
    assert figure.layout.yaxis2.scaleanchor == "x2"


@pytest.mark.parametrize("name", ["shape", "force", "law", "moments"])
def test_every_plot_has_lines_with_units(results: pneurod.Results, name: str) -> None:
    figure = getattr(results.plot, name)()
    assert len(figure.data) > 3
    assert "(" in figure.layout.xaxis.title.text
    shown = [trace.name for trace in figure.data if trace.showlegend]
    assert len(shown) == len(set(shown)) > 1
    assert any("kPa" in entry for entry in shown) or name == "force"


def test_what_was_not_reached_is_named(results: pneurod.Results) -> None:
    nothing = Plots(replace(results.run, curves=(), law=None))
    with pytest.raises(pneurod.InputError, match="has no states of experiment II"):
        nothing.angle()
    with pytest.raises(pneurod.InputError, match="has no law of its own"):
        nothing.law()
    with pytest.raises(pneurod.InputError, match="'IV' is none; allowed: I, II, III"):
        results.plot.shape("IV")


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
    assert results.arm_law.mass is not None
    assert results.mass_g == pytest.approx(whole, rel=0.02)


def test_results_are_short_where_they_are_shown(results: pneurod.Results) -> None:
    assert str(results) == "\n".join(results.verdict.lines)
    assert repr(results).startswith("Results('")
    assert len(repr(results.arm_law)) < 120
    with pytest.warns(pneurod.RodWarning):
        rod = results.rod(20)
    assert len(repr(rod)) < 400
    shown = results._repr_html_()
    assert "bends by 72°, 140°" in shown
    assert "alpha2_N_mm2" in shown
    assert "--accuracy 1%" in shown
