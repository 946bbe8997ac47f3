"""The arm of a page under sliders and under the hand, in a real browser, beside the rod itself."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page

import pneurod
from pipeline.answers.measured.calibrate import calibrate_files
from pipeline.answers.measured.rows import State
from tests.coarse import COARSE
from tests.measured_arm import arm_law, measured, result_folder
from tests.pipeline.show.test_browser import browser  # noqa: F401  a fixture

pytestmark = pytest.mark.usefixtures("with_poses")


@pytest.fixture(scope="module")
def results() -> pneurod.Results:
    return pneurod.read_results(COARSE)


@pytest.fixture(scope="module")
def written(results: pneurod.Results, tmp_path_factory: pytest.TempPathFactory, with_poses: None) -> Path:
    path = tmp_path_factory.mktemp("hand") / "hand.html"
    path.write_text(str(results.hand), encoding="utf-8")
    return path


@pytest.fixture(params=[1280, 400])
def page(browser: Browser, written: Path, request: pytest.FixtureRequest) -> Iterator[Page]:  # noqa: F811
    errors: list[str] = []
    page = browser.new_page(viewport={"width": request.param, "height": 900}, has_touch=request.param == 400)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(written.as_uri())
    yield page
    assert errors == []
    page.close()


def slide(hand: Locator, pressure: float) -> None:
    hand.locator("input").evaluate("(e, p) => { e.value = p; e.dispatchEvent(new Event('input')); }", pressure)


def drag(page: Page, x: float, y: float) -> None:
    """The tip, by parts of the width of the picture."""
    box, picture = page.locator(".tip circle").last.bounding_box(), page.locator(".hand svg").bounding_box()
    at = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.move(*at)
    page.mouse.down()
    page.mouse.move(at[0] + x * picture["height"], at[1] + y * picture["height"], steps=3)
    page.mouse.up()


def test_slider_and_hand_bend_the_arm_as_the_rod_does(page: Page, results: pneurod.Results) -> None:
    hand = page.locator(".hand")
    pushed = ((7.5, (-0.08, 0.05)), (16.5, (-0.1, 0.02)), (30.0, (-0.1, -0.1)), (23.0, (0.0, 0.12)))
    for pressure, way in ((12.0, (0.0, 0.0)), (12.0, (0.1, 0.1)), (28.0, (0.15, -0.1)), (35.0, (0.1, 0.0)), *pushed):
        hand.locator("button").evaluate("button => button.click()")
        slide(hand, pressure)
        if any(way):
            drag(page, *way)
        (reached, *force), tip = (json.loads(str(hand.get_attribute(f"data-{name}"))) for name in ("state", "tip"))
        assert any(force) == any(way)
        assert reached == pytest.approx(pressure)
        with pytest.warns(pneurod.RodWarning):
            rod = results.rod(reached)
        shape = rod.solve(tuple(force))
        assert math.dist(shape.end, tip) < 0.005 * results.length_mm
        told = hand.locator(".told").inner_text()
        assert float(told.split("bends by ")[1].split("°")[0]) == pytest.approx(shape.bending_deg, abs=1.0)
        assert f"({tip[0]:.1f}, {tip[1]:.1f}) ± 2.0 mm" in told


def test_beyond_the_law_the_arm_stops_and_the_page_says_so(page: Page, results: pneurod.Results) -> None:
    hand = page.locator(".hand")
    slide(hand, 20.0)
    assert hand.locator(".ends").is_hidden()
    drag(page, 0.0, 1.5)
    assert hand.locator(".ends").is_visible()
    pressure, *force = json.loads(str(hand.get_attribute("data-state")))
    with pytest.warns(pneurod.RodWarning):
        rod = results.rod(pressure)
    rod.solve((0.9 * force[0], 0.9 * force[1]))
    with pytest.raises(pneurod.RodError):
        rod.solve((1.3 * force[0], 1.3 * force[1]))
    slide(hand, 0.5)  # where the law bears less
    assert hand.locator(".ends").is_visible()
    hand.locator("button").click()
    assert json.loads(str(hand.get_attribute("data-state"))) == [0.5, 0.0, 0.0]
    assert hand.locator(".ends").is_hidden()


def test_arrow_keys_pull_at_the_tip(page: Page) -> None:
    hand = page.locator(".hand")
    before = json.loads(str(hand.get_attribute("data-tip")))
    hand.locator(".tip").press("ArrowRight")
    assert json.loads(str(hand.get_attribute("data-tip")))[0] > before[0]


def test_the_picture_of_a_calibration_shows_what_was_measured(
    tmp_path: Path, few_proposals: None, few_poses: None
) -> None:
    states = [State(10.0), State(20.0), State(20.0, force_N=(0.0, 0.001))]
    file = measured(tmp_path / "arm.csv", arm_law(), states)
    report = calibrate_files(result_folder(tmp_path / "arm"), file)
    page = (report.directory / "calibration.html").read_text(encoding="utf-8")
    arm = json.loads(page.split('<script type="application/json">')[1].split("</script>")[0])
    tips = {row.pressure_kPa: [] for row in report.found.predictions}
    for row in report.found.predictions:
        if not row.load and row.quantity.startswith("tip"):
            tips[row.pressure_kPa].append(row.measured)
    assert [[point["x"], point["y"]] for point in arm["points"]] == [pytest.approx(tips[p], abs=0.5) for p in (10, 20)]
    assert len(page) < 3_500_000
