"""The body in the report: its surface, and the compact data from which the browser draws it."""

import base64
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.results.unloaded import unloaded_states
from pipeline.show import body_view as module
from pipeline.show.body_view import Surfaces, along, body_view
from pipeline.show.drawing import write_fields
from pipeline.show.pictures import SURFACES, at_nodes, boundary, von_mises
from pipeline.values.formats import BODY
from pipeline.values.law import DeliveredLaw
from pipeline.values.run import Run
from rod.load import Load
from tests.bar import bar, write_surfaces
from tests.coarse import coarse_run
from tests.rod.arm_law.test_space_law import LENGTH
from tests.rod.arm_law.test_space_law import law as law_of_three_chambers


def decoded(text: Any, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=kind)


@pytest.mark.parametrize("nodes", [4, 10])
def test_the_boundary_is_closed_and_points_outward(nodes: int) -> None:
    points, tets = bar()
    faces, in_plane = boundary(points, tets[:, :nodes])
    a, b, c = (points[faces[:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(8.0)
    normals = np.cross(b - a, c - a)
    assert np.linalg.norm(normals, axis=1).sum() / 2 == pytest.approx(34.0)
    assert np.linalg.norm(normals[in_plane], axis=1).sum() / 2 == pytest.approx(8.0)
    if nodes == 10:
        for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
            assert np.allclose(points[faces[:, 3 + k]], (points[faces[:, i]] + points[faces[:, j]]) / 2)


def test_stress_and_means() -> None:
    assert von_mises(np.array([[3.0, 3.0, 3.0, 0, 0, 0], [2.0, 0, 0, 0, 0, 0], [0, 0, 0, 1.0, 0, 0]])) == pytest.approx(
        [0.0, 2.0, np.sqrt(3.0)]
    )
    nodes = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
    assert at_nodes([np.array([1.0, 3.0])], nodes)[0] == pytest.approx([1.0, 2.0, 2.0, 2.0, 3.0])


def test_the_browser_gets_the_positions_of_the_body(tmp_path: Path) -> None:
    arrays = write_surfaces(tmp_path)
    data: Any = body_view(Run(tmp_path))
    low, size = np.array(data["low_mm"]), np.array(data["high_mm"]) - data["low_mm"]
    assert [(state["experiment"], state["pressure_kPa"]) for state in data["states"]] == [
        ("I", 20.0), ("II", 10.0), ("II", 20.0),
    ]  # fmt: skip
    positions = low + decoded(data["states"][1]["positions"], "<u2").reshape(-1, 3) / 65535 * size
    assert np.abs(positions - arrays["points"] - arrays["displacement"][0]).max() < 1e-3
    stretch = decoded(data["states"][1]["stretch"], "u1") / 255 * 0.5 + 1.0
    assert np.abs(stretch - arrays["stretch"][0]).max() < 0.5 / 255
    triangles = decoded(data["triangles"], "<u2").reshape(-1, 3)
    assert len(triangles) == 4 * len(arrays["faces"])
    inside = np.abs(arrays["points"][triangles][:, :, 2]).max(axis=1) < 1e-9
    assert not inside[: data["outer"]].any()
    assert inside[data["outer"] :].all()


def test_too_many_data_are_reduced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_surfaces(tmp_path)
    full = Surfaces.read(tmp_path / SURFACES)
    coarse = full.without_middles()
    assert 0 < coarse.size < full.size
    monkeypatch.setattr(module, "LIMIT", full.size - 1)
    data: Any = body_view(Run(tmp_path))
    assert len(decoded(data["rest"], "<u2")) == 3 * len(coarse.points)
    assert len(data["states"]) == 3
    monkeypatch.setattr(module, "LIMIT", coarse.size - 1)
    assert [state["experiment"] for state in body_view(Run(tmp_path))["states"]] == ["II", "II"]
    monkeypatch.setattr(module, "LIMIT", 10)
    assert body_view(Run(tmp_path)) == {}


def test_sections_of_a_body_stand_on_its_bent_curve() -> None:
    """On a quarter of a circle in a plane that is turned about x; beyond its end the body goes on straight."""
    radius, s, turn = 60.0, np.linspace(0.0, 30.0 * np.pi, 721), 0.4
    angle, nothing = s / radius, np.zeros(len(s))
    up, across = np.array([0.0, np.cos(turn), np.sin(turn)]), np.array([0.0, -np.sin(turn), np.cos(turn)])
    curve = np.outer(radius * np.sin(angle), [1.0, 0.0, 0.0]) + np.outer(radius * (1.0 - np.cos(angle)), up)
    tangent = np.outer(np.cos(angle), [1.0, 0.0, 0.0]) + np.outer(np.sin(angle), up)
    normal = np.outer(np.cos(angle), up) - np.outer(np.sin(angle), [1.0, 0.0, 0.0])
    frames = np.stack([tangent, normal, np.outer(nothing + 1.0, across)], axis=2)
    points = np.array([[0.0, 2.0, 3.0], [15.0 * np.pi, 2.0, -1.0], [30.0 * np.pi + 5.0, 0.0, 1.0]])
    moved = along(points, s, curve, frames)
    middle = np.array([1.0, 0.0, 0.0]) * (radius - 2.0) * np.sqrt(0.5) + up * (radius - (radius - 2.0) * np.sqrt(0.5))
    assert moved[0] == pytest.approx(2.0 * up + 3.0 * across)
    assert moved[1] == pytest.approx(middle - across, abs=1e-4)
    assert moved[2] == pytest.approx([radius, *(up * (radius + 5.0) + across)[1:]], abs=1e-9)


@pytest.mark.parametrize("in_space", [False, True], ids=["plane", "space"])
def test_without_finite_elements_of_the_arm_its_body_stands_on_the_rod(tmp_path: Path, in_space: bool) -> None:
    points, tets = bar()
    run = coarse_run()
    assert run.law.plane is not None
    law = run.law.plane
    length = LENGTH if in_space else law.length
    scale = np.array([length / 8.0, 1.0, 1.0])
    write_fields(tmp_path / BODY, points * scale, tets)
    delivered = DeliveredLaw(law=law, unloaded=unloaded_states(law, (17.0, 37.0)))
    if in_space:
        delivered = DeliveredLaw(law=law_of_three_chambers())
    record = replace(run.record, mesh=replace(run.mesh, curve_height_mm=0.5))  # type: ignore[type-var]
    data: Any = body_view(Run(tmp_path, record=record, law=delivered))
    assert data["limits"] == {}
    states, rows = data["states"], ["0, 0, 10 kPa", "0, 10, 0 kPa", "10, 0, 0 kPa"]
    assert data["experiments"] == (rows if in_space else ["II"])
    x, y, z = (*law.at(37.0).solve().curve[-1], 0.0)
    if in_space:
        x, y, z = law_of_three_chambers().at((10.0, 0.0, 0.0)).solve_in_space(Load()).end
    low, size = np.array(data["low_mm"]), np.array(data["high_mm"]) - data["low_mm"]
    rest, bent = (
        decoded(text, "<u2").reshape(-1, 3) / 65535 * size + low for text in (data["rest"], states[-1]["positions"])
    )
    at_end = np.abs(rest - [length, 0.5, 0.5]).max(axis=1) < 0.51
    assert bent[at_end].mean(axis=0) == pytest.approx([x, y + 0.5, z], abs=1.0)
