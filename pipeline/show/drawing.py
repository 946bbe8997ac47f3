"""Pictures and fields of the body by pyvista. Works without a display.

Elements are tetrahedra with 4 or 10 nodes. The mid-edge nodes of the latter stand on the edges (0,1), (1,2), (0,2),
(0,3), (1,3), (2,3), in this order, which is that of VTK_QUADRATIC_TETRA and of scikit-fem's ElementTetP2.
"""

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyvista

from geometry.arrays import Array, Index
from pipeline.store.atomic_file import write_atomic

_WIDTH, _TALLEST = 1400, 900  # pixels of the body in a picture
_BAR = 190  # pixels of the scale under it
_SILICONE = "#d9dde3"
_REGIONS = ("#7fa6c9", "#d3a97b", "#93ba8b", "#b79bc8")  # of regions with a material of their own, in turn
_INK = "#1f2933"
_OUTLINE = "#9aa5b1"


@dataclass(frozen=True)
class Colour:
    """What the colours of a picture mean."""

    values: Array  #: per node (n,) or per element (m,)
    title: str  #: with its unit: largest principal stretch, displacement (mm)
    limits: tuple[float, float] | None = None  #: ends of the scale; those of the values when None


def write_fields(path: Path, points: Array, tets: Index, fields: Mapping[str, Array] | None = None) -> None:
    """Write a .vtu file of the body at rest with fields on it.

    points (n, 3) in mm; tets (m, 4) or (m, 10); a field has n rows (at nodes) or m rows (per element) and any number
    of components. A field named `displacement` lets ParaView warp the body.
    """
    grid = _grid(points, tets)
    for name, values in (fields or {}).items():
        _attach(grid, name, np.asarray(values))
    # VTK does not report a full disk, so it writes into memory
    writer = pyvista.XMLUnstructuredGridWriter(str(path), grid).writer
    writer.SetWriteToOutputString(True)
    writer.Write()
    write_atomic(path, writer.GetOutputString().encode())


def draw_body(
    path: Path,
    points: Array,
    tets: Index,
    *,
    mirrored: bool = True,
    cut_open: bool = False,
    regions: Array | None = None,
    window: Any | None = None,
) -> None:
    """Draw the body at rest into a PNG, with the clamp on the left: a half model mirrored at z = 0, or cut open there.

    Cut open, the half beyond z = 0 is seen from inside: that of a half model, z >= 0, reflected to z <= 0.
    regions: number of the region of each tetrahedron (m,), 0 where it has none; each region has a colour of its own.
    window: of `window_for_pictures`; one of its own where None.
    """
    grid = _grid(points, tets)
    _attach(grid, "region", np.zeros(len(tets)) if regions is None else regions)
    body = _skin(grid)
    if cut_open:
        body = _reflected(body)
    elif mirrored:
        body = _mirrored(body)
    with _emptied(window) as plotter:
        for number in np.unique(body.cell_data["region"]).astype(int):
            part = body.extract_cells(body.cell_data["region"] == number).extract_surface(algorithm="dataset_surface")
            colour = _REGIONS[(number - 1) % len(_REGIONS)] if number else _SILICONE
            plotter.add_mesh(
                part, color=colour, smooth_shading=True, split_sharp_edges=True, ambient=0.35, diffuse=0.75
            )
        _add_edges(plotter, body)
        _aim_camera(plotter, body.points)
        _save(plotter, path)


def draw_deformed(
    path: Path,
    points: Array,
    tets: Index,
    displacement: Array,
    colour: Colour,
    *,
    mirrored: bool = True,
    window: Any | None = None,
) -> None:
    """Draw the deformed body into a PNG, with the outline of the body at rest.

    points and displacement (n, 3) in mm, tets (m, 4) or (m, 10). `mirrored` mirrors a half model at z = 0. window: of
    `window_for_pictures`; one of its own where None.
    """
    grid = _grid(points + displacement, tets)
    _attach(grid, colour.title, np.asarray(colour.values, dtype=float))
    body, rest = _skin(grid), _skin(_grid(points, tets))
    if mirrored:
        body, rest = _mirrored(body), _mirrored(rest)
    rest = rest.connectivity("closest", closest_point=rest.points[rest.points[:, 0].argmax()])  # not the cavities
    with _emptied(window) as plotter:
        actor = plotter.add_mesh(
            body,
            scalars=colour.title,
            clim=colour.limits or (float(np.min(colour.values)), float(np.max(colour.values))),
            cmap="viridis",
            ambient=0.45,
            diffuse=0.65,
            show_scalar_bar=False,
        )
        _add_edges(plotter, body)
        _add_edges(plotter, rest, angle=35, color=_OUTLINE, line_width=2)
        _aim_camera(plotter, np.vstack([body.points, rest.points]), below=_BAR)
        _add_bar(plotter, colour.title, actor.mapper)
        _save(plotter, path)


def _grid(points: Array, tets: Index) -> Any:
    nodes = tets.shape[1]
    kind = {4: pyvista.CellType.TETRA, 10: pyvista.CellType.QUADRATIC_TETRA}[nodes]
    return pyvista.UnstructuredGrid({kind: np.ascontiguousarray(tets, dtype=np.int64)}, np.array(points, dtype=float))


def _attach(grid: Any, name: str, values: Array) -> None:
    """Put a field on nodes or elements, whichever it has as many rows as."""
    if len(values) == grid.n_points:
        grid.point_data[name] = values
    elif len(values) == grid.n_cells:
        grid.cell_data[name] = values
    else:
        raise ValueError(
            f"the field '{name}' has {len(values)} rows; the body has {grid.n_points} nodes and {grid.n_cells} elements"
        )


def _skin(grid: Any) -> Any:
    """The boundary triangles; faces of quadratic elements give four each."""
    return grid.extract_surface(nonlinear_subdivision=1, algorithm="dataset_surface")


def _mirrored(half: Any) -> Any:
    """The skin of both halves, without the faces in the plane z = 0 where they meet."""
    z = half.points[half.regular_faces, 2]
    inside = np.abs(z).max(axis=1) < 1e-6 * np.ptp(half.points[:, 0])
    shell = half.extract_cells(~inside).extract_surface(algorithm="dataset_surface")
    return shell.merge(_reflected(shell)).clean(tolerance=1e-7)


def _reflected(skin: Any) -> Any:
    """The skin on the other side of z = 0, its faces seen from outside as before."""
    return skin.reflect((0.0, 0.0, 1.0)).flip_faces()


def _add_edges(plotter: Any, body: Any, angle: float = 40, **how: Any) -> None:
    """Lines where faces meet at more than an angle in degrees; a body whose edges are all rounded has none."""
    edges = body.extract_feature_edges(angle, boundary_edges=False, non_manifold_edges=False)
    if edges.n_points:
        plotter.add_mesh(edges, **(how or {"color": _INK, "line_width": 1.5, "opacity": 0.6}))


def _add_bar(plotter: Any, title: str, mapper: Any) -> None:
    plotter.add_scalar_bar(
        f"{title}\n",  # the line break keeps the title off the labels
        mapper=mapper,
        color=_INK,
        n_labels=4,
        fmt="%.3g",
        title_font_size=44,
        label_font_size=40,
        width=0.5,
        height=0.9 * _BAR / plotter.window_size[1],
        position_x=0.25,
        position_y=0.01,
    )


@contextmanager
def window_for_pictures() -> Iterator[Any]:
    """A window that several pictures share, one after the other and in one thread: without a graphics card a new one
    with its shaders takes a third of the time of a picture."""
    pyvista.vtk_verbosity("off")  # otherwise VTK reports on stderr that there is no X server
    plotter = pyvista.Plotter(off_screen=True, lighting="light kit")
    try:
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        yield plotter
    finally:
        plotter.close()


@contextmanager
def _emptied(window: Any | None) -> Iterator[Any]:
    """The window without what it has shown before, or a new one where None."""
    with nullcontext(window) if window is not None else window_for_pictures() as plotter:
        plotter.suppress_rendering = True  # it would otherwise draw again with everything that is added to it
        for title in tuple(plotter.scalar_bars.keys()):
            plotter.remove_scalar_bar(title, render=False)
        plotter.clear_actors()
        yield plotter


def _aim_camera(plotter: Any, points: Array, below: int = 0) -> None:
    """Look against z, a little from above and from the free end, and fit the window to the points.

    The clamp, x = 0, is on the left. `below` pixels stay free under the body.
    """
    towards = np.array([0.28, 0.22, 1.0])
    towards /= np.linalg.norm(towards)
    right = np.cross([0.0, 1.0, 0.0], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    projected = points @ np.column_stack([right, up])
    low, high = projected.min(axis=0), projected.max(axis=0)
    width, height = 1.06 * (high - low)
    pixel = max(width / _WIDTH, height / _TALLEST)
    plotter.window_size = [_WIDTH, int(height / pixel) + below]
    centre = (low + high) / 2 - [0.0, below * pixel / 2]
    focus = centre[0] * right + centre[1] * up
    plotter.camera_position = [focus + 10 * width * towards, focus, up]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = pixel * plotter.window_size[1] / 2
    plotter.reset_camera_clipping_range()


def _save(plotter: Any, path: Path) -> None:
    plotter.suppress_rendering = False
    plotter.render()
    picture = io.BytesIO()
    plotter.screenshot(picture)
    write_atomic(path, picture.getvalue())
