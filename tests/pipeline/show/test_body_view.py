"""The body in the report: its surface, and the compact data from which the browser draws it."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.show import body_view as module
from pipeline.show.body_view import Surfaces, body_view
from pipeline.show.pictures import at_nodes, boundary, von_mises
from pipeline.values.formats import SURFACES
from tests.bar import bar, write_surfaces


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
    data: Any = body_view(tmp_path)
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
    data: Any = body_view(tmp_path)
    assert len(decoded(data["rest"], "<u2")) == 3 * len(coarse.points)
    assert len(data["states"]) == 3
    monkeypatch.setattr(module, "LIMIT", coarse.size - 1)
    assert [state["experiment"] for state in body_view(tmp_path)["states"]] == ["II", "II"]
    monkeypatch.setattr(module, "LIMIT", 10)
    assert body_view(tmp_path) == {}


def test_a_run_without_surfaces_has_no_view(tmp_path: Path) -> None:
    assert body_view(tmp_path) == {}
