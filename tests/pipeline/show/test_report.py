"""The report is made from the results alone, opens offline, is short, and shows what a failed run reached."""

import html
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.results.rod_errors import rod_and_mesh, rod_errors
from pipeline.results.verdict import verdict_of
from pipeline.show import figures, tables
from pipeline.show.saved import render_page
from pipeline.values.law import DeliveredLaw
from pipeline.values.parameters import RodParameters
from pipeline.values.run import Reported, Run
from rod.load import Load
from tests.coarse import coarse_run
from tests.rod.arm_law.test_space_law import law as law_of_three_chambers


@pytest.fixture(scope="module")
def run() -> Run:
    return coarse_run(0.02)


@pytest.fixture(scope="module")
def page(run: Run) -> str:
    return render_page(run)


def words_of(page: str) -> list[str]:
    without = re.sub(r"<(script|style)\b.*?</\1>", " ", page, flags=re.DOTALL)
    return html.unescape(re.sub(r"<[^>]+>", " ", without)).split()


def traces(panels: figures.Panels) -> list[dict[str, Any]]:
    """The traces of the first panel, with the bands left out."""
    return [trace for line in panels[0].lines for trace in line.traces() if "name" in trace]


def test_the_page_begins_with_the_verdict(page: str, run: Run) -> None:
    shown = " ".join(words_of(page))
    for line in verdict_of(run).lines:
        assert " ".join(line.split()) in shown
    assert shown.index("bends by") < shown.index("five parameters")
    assert page.index('id="verdict"') < page.index("Bending angle over pressure") < page.index("<details>")


def test_the_page_is_short_and_asks_nobody_for_anything(page: str) -> None:
    assert len(words_of(page)) < 2500
    own = re.sub(r'<script type="text/plain" id="plotly-packed">.*?</script>', "", page, flags=re.DOTALL)
    assert not re.findall(r'(?:src|href)="(?!data:|#)', own)
    assert len(page.encode()) < 6_000_000


@pytest.mark.parametrize("missing", ["states", "curves", "rod_errors", "parameters", "law", "record", "effects"])
def test_what_a_failed_run_lacks_is_left_out(run: Run, missing: str) -> None:
    empty: Any = getattr(Run(run.directory), missing)
    part = replace(run, **{missing: empty})
    failures = (Reported("stopped", {}, None, "experiment II stopped before 45 kPa."),)
    page = render_page(replace(part, record=replace(part.record, failures=failures)))
    assert "experiment II stopped before 45 kPa" in page


def test_bending_angle_has_the_rod_to_take_beside_the_finite_elements(run: Run) -> None:
    solid, rod = traces(figures.bending(run))
    assert solid["x"] == [0.0, 17.0, 37.0]
    assert solid["y"] == pytest.approx([0.0, 73.7, 140.2], abs=0.1)
    assert rod["name"] == "rod, the arm's own law"
    assert rod["y"] == pytest.approx([72.5, 139.9], abs=0.1)
    spread = rod["error_y"]["array"]
    verdict = rod_and_mesh(run, rod_errors(run)[0])
    chord = np.hypot(*run.curve("II", 37.0).tip_mm)  # type: ignore[union-attr]
    assert spread[1] == pytest.approx(np.degrees(2 * verdict.shape * run.length_mm / chord), rel=0.01)
    path = figures.bending(run)[1].lines
    assert (path[0].x[0], path[0].y[0]) == (run.length_mm, 0.0)
    assert path[1].spread[0] == pytest.approx(verdict.shape * run.length_mm)  # type: ignore[index]
    _, five = traces(figures.bending(replace(run, law=None, rod_errors=run.errors_of("five"))))
    assert five["y"] == pytest.approx([run.parameters.rods().at(p).solve().bending_deg for p in (17.0, 37.0)], abs=0.1)


def test_the_rod_is_averaged_like_the_dots_it_is_compared_with(run: Run) -> None:
    """A line of α₁ drawn through averages over a cell would run below them near the clamp."""
    shown = traces(figures.moments(run))
    dots = next(trace for trace in shown if trace["name"] == "finite elements, 37 kPa")
    line = next(trace for trace in shown if trace["name"] == "rod, five parameters, 37 kPa")
    assert line["y"] == dots["y"]
    x, y = (np.array(values, dtype=float) for values in (dots["x"], line["x"]))
    near_clamp = np.array(dots["y"], dtype=float) > 10.0
    assert near_clamp.any()
    assert np.abs(y - x)[near_clamp].max() < 0.15 * np.nanmax(x)


def test_an_arm_with_several_pressures_shows_where_its_tip_can_be() -> None:
    """Rings from row to row, the largest pressure as the colour; each tip is that of the rod at its pressures."""
    law = law_of_three_chambers()
    [panel] = figures.reach(Run(Path("three"), law=DeliveredLaw(law=law)))
    assert [line.frame for line in panel.lines] == ["2.5 kPa", "5 kPa", "7.5 kPa", "9 kPa", "10 kPa"]
    assert len({line.colour for line in panel.lines}) == 5
    outer = panel.lines[-1]
    assert outer.z is not None
    tips = np.column_stack([outer.x, outer.y, outer.z])
    assert tips[0] == pytest.approx(tips[-1])  # closed
    assert outer.texts[3] == "5, 5, 0 kPa"
    assert tips[3] == pytest.approx(law.at((5.0, 5.0, 0.0)).solve_in_space(Load()).end)
    around = DeliveredLaw(law=law).towards()
    assert around[4] == pytest.approx(law.at((10.0, 0.0, 0.0)).solve_in_space(Load()).bending_deg)  # against y
    assert len(set(np.round(around, 3))) == 8
    assert DeliveredLaw(law=replace(law, pressures=np.outer([1.0, 2.0, 3.0], [2.0, 1.0, 0.0]))).towards() == ()
    page = render_page(Run(Path("three"), law=DeliveredLaw(law=law, directions_deg=around, notes=("Twist is small.",))))
    assert f"Towards y, and then every 45° towards z, it bends by up to {around[0]:.0f}°" in page
    assert "Where the tip can be" in page
    assert "Twist is small." in page
    assert figures.reach(coarse_run()) == ()


def test_figures_without_data_are_empty(run: Run) -> None:
    nothing = replace(
        run, states=(), curves=(), rod_errors=(), parameters=RodParameters(), law=None, validation_curves=()
    )
    drawn = (figures.bending, figures.moments, figures.rigidities, figures.end_forces, figures.arm_law)
    assert [figure(nothing) for figure in (*drawn, figures.validation_shapes)] == [()] * 6
    assert figures.of_experiment(nothing, "II") == ()
    made = (tables.five_parameters, tables.rods, tables.loads, tables.states)
    assert not any(table(nothing) for table in made)


def test_the_five_parameters_have_errors_and_intervals(run: Run) -> None:
    table = tables.five_parameters(run)
    assert table.heads == ("p (kPa)", "α₁ (N mm²)", "α₂ (N mm²)", "m₀₁ (N mm)", "m₀₂ (N mm)", "d (mm)")
    assert table.rows[1][2] == "448.2 ± 0.8\n447.1 … 449.9"
    assert "without the error of the mesh" in table.caption
    single = replace(run, parameters=replace(run.parameters, single_line_suffices=(True, True)))
    one = tables.five_parameters(single)
    assert one.rows[0][-1] == "one section"


def test_a_material_stands_with_its_modulus_at_rest(run: Run) -> None:
    """Of the constants of Ogden's law, which other programs read in another form, it shows which one is meant."""
    ogden = {"law": "ogden", "mu": [0.08], "alpha": [5.5], "kappa": 21.9}
    for material, modulus in ((run.config["material"], "1.2 MPa"), (ogden, "0.658 MPa")):
        table = tables.design(replace(run, record=replace(run.record, config={"material": material})))
        [shown] = [value for name, value in table.rows if name == "material"]
        assert shown.endswith(f"Young's modulus at rest {modulus}")


def test_every_rod_and_load_has_a_row(run: Run) -> None:
    rods, loads = tables.rods(run), tables.loads(run)
    assert rods.rows[0][0] == "the arm's own law"
    assert len(loads.rows) == sum(row.sample == "out" for row in run.rod_errors)
    assert {len(row) for row in rods.rows} == {len(rods.heads)}
    assert {len(row) for row in loads.rows} == {len(loads.heads)}


def test_pictures_are_in_the_page(tmp_path: Path, run: Run) -> None:
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "II_37kPa.png").write_bytes(b"picture")
    assert "data:image/png;base64,cGljdHVyZQ==" in render_page(replace(run, directory=tmp_path))


def test_every_section_is_there_once(page: str) -> None:
    titles = re.findall(r"<h2>(.*?)</h2>", page)
    assert len(titles) == len(set(titles)) == 8
    assert page.count("<details>") == page.count("</details>") == 9  # and the configuration
