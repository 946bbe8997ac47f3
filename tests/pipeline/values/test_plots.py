"""Plots of HTML pages: what is written, and what a browser shows of it."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import sync_playwright

from pipeline.values.page import Section
from pipeline.values.page import page as page_of
from pipeline.values.plots import GREY, Line, Panel, figure, packed_plotly
from pipeline.values.table import Table

X = np.linspace(0.0, 10.0, 5)


def panels_of(text: str) -> list[dict[str, Any]]:
    """What each panel of a figure draws."""
    return [json.loads(drawn) for drawn in re.findall(r'<script type="application/json">(.*?)</script>', text)]


def test_a_line_keeps_its_numbers_and_is_interrupted_where_they_are_not_finite() -> None:
    line = Line(X, np.array([1.0, np.nan, 1.23456789, np.inf, 5.0]), "a")
    [panel] = panels_of(figure([Panel("title", "x (mm)", "y (N)", (line,))]))
    [trace] = panel["data"]
    assert trace["x"] == [0.0, 2.5, 5.0, 7.5, 10.0]
    assert trace["y"] == [1.0, None, 1.23457, None, 5.0]
    assert trace["mode"] == "lines"
    assert panel["layout"]["xaxis"]["title"]["text"] == "x (mm)"


def test_a_spread_is_a_band_around_a_line_and_error_bars_of_points() -> None:
    half = np.full(5, 0.5)
    band = Line(X, X, "a", spread=half)
    points = Line(X, X, "b", dash="", marker="circle", spread=half)
    [panel] = panels_of(figure([Panel("", "", "", (band, points))]))
    around, line, bars = panel["data"]
    assert around["y"] == [0.5, 3.0, 5.5, 8.0, 10.5, 9.5, 7.0, 4.5, 2.0, -0.5]
    assert "error_y" not in line
    assert bars["error_y"]["array"] == [0.5] * 5
    assert bars["mode"] == "markers"


def test_axes_are_logarithmic_or_to_scale() -> None:
    line, flat = Line(X + 1, X + 1, "a"), Line(X, X / 100, "a")
    log, scaled, wide = panels_of(
        figure([
            Panel("", "x", "y", (line,), log_x=True, log_y=True, y_range=(0.1, 100.0)),
            Panel("", "x", "y", (line,), lengths=True),
            Panel("", "x", "y", (flat,), lengths=True),
        ])
    )  # fmt: skip
    assert log["layout"]["xaxis"]["type"] == "log"
    assert log["layout"]["yaxis"]["range"] == [-1.0, 2.0]
    assert scaled["layout"]["yaxis"]["scaleanchor"] == "x"
    assert "scaleanchor" not in wide["layout"]["yaxis"]


def test_a_panel_in_space_has_three_axes_to_scale() -> None:
    line = Line(X, X, "a", z=np.array([1.0, 2.0, np.nan, 4.0, 5.0]))
    [panel] = panels_of(figure([Panel("tip", "x (mm)", "y (mm)", (line,), z="z (mm)")]))
    [trace], scene = panel["data"], panel["layout"]["scene"]
    assert (trace["type"], trace["z"]) == ("scatter3d", [1.0, 2.0, None, 4.0, 5.0])
    assert [scene[f"{axis}axis"]["title"]["text"] for axis in "xyz"] == ["x (mm)", "y (mm)", "z (mm)"]
    assert scene["aspectratio"] == {"x": 1.0, "y": 1.0, "z": 0.4}


def test_text_in_names_cannot_leave_its_place() -> None:
    text = figure([Panel("<b>&", "x", "y", (Line(X, X, "</script><i>"), Line(X, X, "b")))])
    assert "</script><i>" not in text
    assert "<b>" not in text
    assert panels_of(text)[0]["data"][0]["name"] == "</script><i>"


def test_a_page_holds_the_library_once_and_no_address() -> None:
    page = page_of("two", *[Section(panels=[Panel("", "x", "y", (Line(X, X, "a"),))])] * 2)
    assert page.count('id="plotly-packed"') == 1
    assert not re.search(r'(src|href)="?https?:', page)
    assert len(packed_plotly()) < 2.2e6


@pytest.mark.parametrize("width", [1280, 400])
def test_a_browser_draws_the_panels_and_its_buttons_show_and_hide_lines(tmp_path: Path, width: int) -> None:
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("no Chromium on this machine (Debian package chromium)")
    lines = [
        Line(X, X * number, f"{name} {number}", GREY, entry=name, frame=f"{number} kPa")
        for number in (1, 2)
        for name in ("solid", "rod")
    ]
    shown = [Panel("one", "x", "y", tuple(lines)), Panel("two", "x", "y", tuple(lines))]
    wide = Table(("a long title",) * 30, (("12.345",) * 30,))
    text = page_of("page", Section(panels=shown), Section("more", panels=shown, table=wide))
    path = tmp_path / "page.html"
    path.write_text(text.replace('<h2 class="heading">more</h2>', "<details><summary>more</summary>"), encoding="utf-8")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": width, "height": 800})
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(path.as_uri())
        page.wait_for_function("document.querySelectorAll('.plot[data-ready]').length === 2")
        count = "document.querySelectorAll('.plot-area .scatterlayer .trace').length"
        assert page.evaluate(count) == 8
        page.click("button[data-frame='2 kPa'] >> nth=0")
        assert page.evaluate(count) == 4
        page.click("button[data-entry='rod'] >> nth=0")
        assert page.evaluate(count) == 2
        page.click("summary")
        page.wait_for_function("document.querySelectorAll('.plot[data-ready]').length === 4")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        wide = "document.querySelector('.wide')"
        assert page.evaluate(f"{wide}.scrollWidth > {wide}.clientWidth")
        assert page.evaluate(f"getComputedStyle({wide}).backgroundImage").count("linear-gradient") == 4
        assert errors == []
        browser.close()
