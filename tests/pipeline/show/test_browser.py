"""The report in a real browser: headless Chromium of the system, driven by Playwright; no browser is downloaded.

Screenshots are kept in results/screenshots, to be looked at.
"""

import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from pipeline.results.files import read_results
from pipeline.show.drawing import draw_body
from pipeline.show.saved import render_page
from tests.bar import write_surfaces
from tests.coarse import COARSE

SCREENSHOTS = Path(__file__).resolve().parents[3] / "results" / "screenshots"
#: WebGL without a graphics card
ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
#: part of the pixels of the canvas that the body covers
COVERED = """canvas => {
  const gl = canvas.getContext("webgl2"), pixels = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels.filter((value, k) => k % 4 === 3 && value > 0).length / (canvas.width * canvas.height);
}"""
#: where the highest pixel of the body is, from 0 at its left end to 1 at its right end
HIGHEST = """canvas => {
  const gl = canvas.getContext("webgl2"), pixels = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let [left, right, at] = [Infinity, 0, 0];
  for (let k = 0; k < canvas.width * canvas.height; k++) {
    if (!pixels[4 * k + 3]) continue;
    at = k % canvas.width; // rows come from the lowest to the highest
    [left, right] = [Math.min(left, at), Math.max(right, at)];
  }
  return (at - left) / (right - left);
}"""
#: elements that stand out of the page to the right and are in no box that scrolls
TOO_WIDE = """() => {
  const width = document.documentElement.clientWidth;
  const boxed = (element) => {
    for (let box = element.parentElement; box && box !== document.body; box = box.parentElement) {
      if (["auto", "scroll"].includes(getComputedStyle(box).overflowX)) return true;
    }
    return false;
  };
  const out = [...document.querySelectorAll("body *")].filter((element) => {
    return element.getBoundingClientRect().right > width + 1 && !boxed(element);
  });
  return [document.documentElement.scrollWidth > width, ...out.map((element) => element.outerHTML.slice(0, 100))];
}"""


@dataclass
class Opened:
    """A page, and what the browser has said and asked for since it was opened."""

    page: Page
    messages: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if program is None:
        if os.environ.get("PNEUROD_CI"):
            pytest.fail("no Chromium; .ci/run installs the Debian package chromium")
        pytest.skip("no Chromium on this machine (Debian package chromium)")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, few_poses: None) -> Path:
    """The report on stored results of the coarse arm, with a bar for the body."""
    results = shutil.copytree(COARSE, tmp_path_factory.mktemp("results") / "arm")
    arrays = write_surfaces(results)
    for name in ("body", "body_open", "II_37kPa"):
        draw_body(results / "pictures" / f"{name}.png", *arrays["body"])
    (results / "report.html").write_text(render_page(read_results(results)), encoding="utf-8")
    return results / "report.html"


@pytest.fixture
def opened(browser: Browser, report: Path, request: pytest.FixtureRequest) -> Iterator[Opened]:
    """The report in a window of a width, light or dark."""
    width, scheme = getattr(request, "param", (1280, "light"))
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
    window = Opened(page)
    page.on("console", lambda message: window.messages.append(message.text))
    page.on("pageerror", lambda error: window.messages.append(str(error)))
    page.on("request", lambda request: window.requests.append(request.url))
    page.goto(report.as_uri())
    page.wait_for_selector("#body-view[data-ready]", state="attached")
    yield window
    assert window.messages == []
    assert [url for url in window.requests if not url.startswith("data:")] == [report.as_uri()]
    page.close()


@pytest.mark.parametrize(
    "opened", [(width, scheme) for width in (1280, 400) for scheme in ("light", "dark")], indirect=True
)
def test_nothing_is_wider_than_the_page(opened: Opened) -> None:
    page = opened.page
    open_sections(page)
    assert page.evaluate(TOO_WIDE) == [False]
    background = page.evaluate("getComputedStyle(document.body).backgroundColor")
    dark = page.evaluate("matchMedia('(prefers-color-scheme: dark)').matches")
    assert (sum(map(int, background[4:-1].split(","))) < 200) == dark
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    for anchor in ("verdict", "parameters", "body-view"):
        page.locator(f"#{anchor}").evaluate("element => element.scrollIntoView()")
        page.screenshot(path=SCREENSHOTS / f"{anchor}_{page.viewport_size['width']}_{'dark' if dark else 'light'}.png")


def test_the_buttons_of_a_figure_choose_a_pressure_and_hide_lines(opened: Opened) -> None:
    opened.page.locator("details", has_text="The five parameters").first.evaluate("element => { element.open = true; }")
    plots = opened.page.locator(".plots", has_text="Moment over change of curvature")
    plots.locator(".plot[data-ready]").wait_for()
    visible = "plot => plot.querySelector('.plot-area').data.filter(({visible}) => visible !== false).length"
    plot = plots.locator(".plot")
    everything = plot.evaluate(visible)
    plots.get_by_role("button", name="17 kPa").click()
    assert plot.evaluate(visible) == everything / 2
    plots.get_by_role("button", name="finite elements").click()
    assert plot.evaluate(visible) == everything / 4


def open_sections(page: Page) -> None:
    for details in page.locator("details").all():
        details.evaluate("element => { element.open = true; }")


def test_the_body_turns_and_follows_its_controls(opened: Opened) -> None:
    page = opened.page
    open_sections(page)
    view, canvas = page.locator("#body-view"), page.locator("#body-view canvas")
    canvas.scroll_into_view_if_needed()

    def picture() -> str:
        return str(canvas.evaluate("canvas => canvas.toDataURL()"))

    assert 0.02 < canvas.evaluate(COVERED) < 0.9
    assert view.locator("output").inner_text() == "20 kPa"
    pictures = [picture()]
    box = canvas.bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] + 60, middle[1] + 10)
    page.mouse.up()
    pictures.append(picture())
    for value, text in (("0", "0 kPa, at rest"), ("1", "10 kPa")):
        view.locator("input[name=pressure]").fill(value)
        assert view.locator("output").inner_text() == text
        pictures.append(picture())
    scales = []
    for field_name in ("displacement", "stretch", "von_mises_MPa"):
        view.locator("select[name=field]").select_option(field_name)
        scales.append((view.locator(".low").inner_text(), view.locator(".high").inner_text()))
        pictures.append(picture())
    assert scales[1:] == [("1", "1.5"), ("0", "2")]
    view.locator("input[name=open]").check()
    pictures.append(picture())
    view.locator("button[name=closer]").click()
    pictures.append(picture())
    canvas.focus()
    page.keyboard.press("ArrowUp")
    pictures.append(picture())
    view.locator("button[name=reset]").click()
    view.locator("select[name=experiment]").select_option("I")
    pictures.append(picture())
    assert len(set(pictures)) == len(pictures) - 1  # the displacement was chosen when it was chosen already
    assert canvas.evaluate(COVERED) > 0.02


def test_the_clamp_is_on_the_left_whole_and_cut_open(opened: Opened) -> None:
    """In II the bar bends down from its clamp."""
    open_sections(opened.page)
    view, canvas = opened.page.locator("#body-view"), opened.page.locator("#body-view canvas")
    canvas.scroll_into_view_if_needed()
    whole = str(canvas.evaluate("canvas => canvas.toDataURL()"))
    assert canvas.evaluate(HIGHEST) < 0.3
    view.locator("input[name=open]").check()
    assert canvas.evaluate(HIGHEST) < 0.3
    assert str(canvas.evaluate("canvas => canvas.toDataURL()")) != whole
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    view.screenshot(path=SCREENSHOTS / "cut_open.png")
