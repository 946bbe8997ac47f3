"""Pictures are not empty, and the fields are quadratic tetrahedra that ParaView and meshio can read."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import pyvista

from pipeline.show import drawing as pictures
from pipeline.show.drawing import (
    Colour,
    _grid,
    _mirrored,
    _skin,
    draw_body,
    draw_deformed,
    window_for_pictures,
    write_fields,
)
from pipeline.show.pictures import write_series
from tests.bar import bar, bent

HERE = Path(__file__).parent.parent.parent


def seen(path: Path) -> np.ndarray:
    picture = pyvista.read(path)
    width, height, _ = picture.dimensions
    return np.asarray(picture.active_scalars).reshape(height, width, -1)[..., :3]


def assert_shows_something(path: Path) -> None:
    pixels = seen(path)
    assert pixels.shape[0] > 100
    assert pixels.shape[1] == 1400
    white = (pixels == 255).all(axis=2).mean()
    assert 0.1 < white < 0.95
    assert pixels.std() > 20


@pytest.mark.parametrize("cut_open", [False, True])
def test_a_region_has_a_colour_of_its_own(tmp_path: Path, cut_open: bool) -> None:
    points, tets = bar()
    behind = points[tets, 0].mean(axis=1) > 4
    draw_body(tmp_path / "one.png", points, tets, cut_open=cut_open)
    draw_body(tmp_path / "two.png", points, tets, cut_open=cut_open, regions=behind)
    blue = [(np.ptp(seen(tmp_path / name).astype(int), axis=2) > 40).mean() for name in ("one.png", "two.png")]
    grey = [(seen(tmp_path / name) < 250).all(axis=2).mean() for name in ("one.png", "two.png")]
    assert blue[0] == 0
    assert 0.2 * grey[1] < blue[1] < 0.8 * grey[1]
    assert grey[1] == pytest.approx(grey[0], rel=0.01)


@pytest.mark.parametrize("cut_open", [False, True])
def test_the_clamp_is_on_the_left(tmp_path: Path, cut_open: bool) -> None:
    points, tets = bar()
    at_clamp = points[tets, 0].mean(axis=1) < 2
    draw_body(tmp_path / "body.png", points, tets, cut_open=cut_open, regions=at_clamp)
    coloured = np.ptp(seen(tmp_path / "body.png").astype(int), axis=2) > 40
    assert coloured.mean() > 0.05
    assert np.nonzero(coloured)[1].max() < 700


def test_pictures_in_one_window_are_those_in_windows_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The window changes its size, and scales and bodies of the picture before are gone, after an error too."""
    points, tets = bar()
    scale, other = Colour(points[:, 0], "x (mm)", (0.0, 5.0)), Colour(points[:, 1], "height (mm)")

    def draw(kind: str, window: Any | None) -> None:
        draw_body(tmp_path / f"{kind}_body.png", points, tets, window=window)
        draw_deformed(tmp_path / f"{kind}_bent.png", points, tets, bent(points), scale, window=window)
        with monkeypatch.context() as patch:
            patch.setattr(pictures, "_add_bar", failing)
            with pytest.raises(RuntimeError):
                draw_deformed(tmp_path / "failed.png", points, tets, 2.0 * bent(points), other, window=window)
        draw_deformed(tmp_path / f"{kind}_other.png", points, tets, bent(points), other, window=window)
        draw_body(tmp_path / f"{kind}_open.png", points, tets, cut_open=True, window=window)

    def failing(*_: object) -> None:
        raise RuntimeError

    draw("alone", None)
    with window_for_pictures() as window:
        draw("shared", window)
    for name in ("body", "bent", "other", "open"):
        assert np.array_equal(*(seen(tmp_path / f"{kind}_{name}.png") for kind in ("alone", "shared"))), name
    assert not np.array_equal(seen(tmp_path / "alone_bent.png"), seen(tmp_path / "alone_other.png"))
    assert (seen(tmp_path / "alone_bent.png")[-190:] < 250).any()  # the scale


def test_two_threads_may_draw(tmp_path: Path) -> None:
    """As those of a Dask worker, one after the other; a window of another thread would end the process."""
    program = tmp_path / "program.py"
    program.write_text(
        "import sys\n"
        "from concurrent.futures import ThreadPoolExecutor\n"
        "from pathlib import Path\n"
        "from threading import Barrier\n"
        "from bar import bar\n"
        "from pipeline.show.drawing import draw_body\n"
        "both = Barrier(2)\n"
        "def wait(): both.wait()\n"
        "def draw(number): draw_body(Path(sys.argv[1]) / f'{number}.png', *bar())\n"
        "with ThreadPoolExecutor(2) as pool:\n"
        "    [pending.result() for pending in [pool.submit(wait), pool.submit(wait)]]  # two threads live\n"
        "    for number in range(4): pool.submit(draw, number).result()\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (HERE, HERE.parent)))}
    subprocess.run([sys.executable, str(program), str(tmp_path)], env=environment, check=True, timeout=300)
    assert len(list(tmp_path.glob("*.png"))) == 4


def test_a_body_without_sharp_edges(tmp_path: Path) -> None:
    sphere = pyvista.Sphere(radius=5.0, center=(5.0, 0.0, 0.0))
    surface = np.asarray(sphere.regular_faces)
    points = np.vstack([np.asarray(sphere.points, dtype=float), [[5.0, 0.0, 0.0]]])
    tets = np.column_stack([np.full(len(surface), len(points) - 1), surface])
    draw_body(tmp_path / "body.png", points, tets, mirrored=False)
    colour = Colour(points[:, 0], "x (mm)")
    draw_deformed(tmp_path / "deformed.png", points, tets, 0.1 * points, colour, mirrored=False)
    assert_shows_something(tmp_path / "body.png")
    assert_shows_something(tmp_path / "deformed.png")


def test_a_full_body_is_not_mirrored(tmp_path: Path) -> None:
    """Mirroring it would double every face, and no edge would be left to draw."""
    points, tets = bar()
    draw_body(tmp_path / "body.png", points - [0.0, 0.0, 0.5], tets, mirrored=False)
    assert_shows_something(tmp_path / "body.png")


def test_the_deformed_body_coloured_at_nodes_or_elements(tmp_path: Path) -> None:
    points, tets = bar()
    displacement = bent(points)
    for name, values in (("nodes", np.linalg.norm(displacement, axis=1)), ("elements", np.linspace(1, 2, len(tets)))):
        path = tmp_path / f"{name}.png"
        draw_deformed(path, points, tets, displacement, Colour(values, "displacement (mm)"))
        assert_shows_something(path)
        colours = np.unique(seen(path).reshape(-1, 3) // 32, axis=0)
        assert len(colours) > 20
    linear = tmp_path / "linear.png"
    draw_deformed(linear, points, tets[:, :4], displacement, Colour(values, "stretch", (1.0, 1.5)), mirrored=False)
    assert_shows_something(linear)


def test_the_mirrored_body_is_closed() -> None:
    half = _skin(_grid(*bar()))
    whole = _mirrored(half)
    assert half.volume == pytest.approx(8.0)
    assert whole.volume == pytest.approx(16.0)
    assert whole.n_open_edges == 0


def test_fields_and_series_can_be_read(tmp_path: Path) -> None:
    points, tets = bar()
    fields = {"displacement": bent(points), "J": np.ones(len(tets)), "cauchy_stress_MPa": np.zeros((len(tets), 6))}
    (tmp_path / "fields").mkdir()
    write_fields(tmp_path / "fields" / "II_17kPa.vtu", points, tets, fields)
    grid = pyvista.read(tmp_path / "fields" / "II_17kPa.vtu")
    assert set(grid.celltypes) == {pyvista.CellType.QUADRATIC_TETRA}
    assert grid.compute_cell_sizes()["Volume"].sum() == pytest.approx(8.0)
    np.testing.assert_array_equal(grid.cells_dict[pyvista.CellType.QUADRATIC_TETRA], tets)
    np.testing.assert_allclose(grid.point_data["displacement"], fields["displacement"])
    assert grid.cell_data["cauchy_stress_MPa"].shape == (len(tets), 6)
    write_series(tmp_path / "II.pvd", [(17.0, "fields/II_17kPa.vtu")])
    entry = ElementTree.parse(tmp_path / "II.pvd").getroot().find("Collection/DataSet")
    assert entry.attrib["timestep"] == "17"
    assert pyvista.get_reader(tmp_path / "II.pvd").time_values == [17.0]


def test_a_field_of_the_wrong_length_is_rejected(tmp_path: Path) -> None:
    points, tets = bar()
    with pytest.raises(
        ValueError, match=f"the field 'J' has 3 rows; the body has {len(points)} nodes and {len(tets)} elements"
    ):
        write_fields(tmp_path / "a.vtu", points, tets, {"J": np.ones(3)})
