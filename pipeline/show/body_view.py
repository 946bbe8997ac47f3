"""The deformed body as compact data for the view that turns in the browser."""

import base64
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.mesh_content import read_tetrahedra
from pipeline.show.pictures import SURFACES, boundary
from pipeline.values.formats import BODY
from pipeline.values.json_values import JsonObject
from pipeline.values.law import DeliveredLaw
from pipeline.values.run import Run
from rod.errors import RodError
from rod.load import Load
from rod.mechanics.equilibrium import Rod

#: bytes that the data of the view may have before they are written in base64, which takes a third more
LIMIT = 2_600_000
#: largest principal stretch, and von Mises stress
FIELDS = ("stretch", "von_mises_MPa")
#: parts of a row of pressures at which a body is swept
PARTS = (0.25, 0.5, 0.75, 1.0)
#: four triangles of a face with six nodes
_QUARTERS = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))


@dataclass(frozen=True)
class Surfaces:
    """The surface of the body in every state of a run."""

    half: bool  #: half of a body that is symmetric about z = 0
    points: Array  #: (n, 3), mm, at rest
    faces: Index  #: (f, 3), or (f, 6) with the middles of the edges
    in_plane: Mask  #: (f,), faces in the plane of symmetry
    experiments: tuple[str, ...]  #: of each state
    pressures_kPa: Array  #: (states,)
    displacement: Array  #: (states, n, 3), mm
    fields: Mapping[str, Array]  #: (states, n), means of the elements at a node by the names of `FIELDS`; or none

    @staticmethod
    def read(path: Path) -> "Surfaces":
        """The file that a run has written."""
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        experiments = tuple(map(str, arrays.pop("experiments")))
        fields = {name: arrays.pop(name) for name in FIELDS}
        return Surfaces(half=bool(arrays.pop("half")), experiments=experiments, fields=fields, **arrays)

    @property
    def size(self) -> int:
        """Bytes of the data of the view."""
        triangles = len(self.faces) * (4 if self.faces.shape[1] == 6 else 1)
        width = 2 if len(self.points) < 65536 else 4
        return 3 * width * triangles + len(self.points) * (6 + 8 * len(self.experiments))

    def triangles(self) -> tuple[Index, int]:
        """Triangles (t, 3), those in the plane of symmetry last, and the number of the others."""
        ordered = self.faces[np.argsort(self.in_plane, kind="stable")]
        if ordered.shape[1] == 6:
            ordered = ordered[:, _QUARTERS].reshape(-1, 3)
        return ordered, round(float((~self.in_plane).mean()) * len(ordered))

    def of_states(self, chosen: Mask) -> "Surfaces":
        """This view with some of the states."""
        return replace(
            self,
            experiments=tuple(name for name, keep in zip(self.experiments, chosen, strict=True) if keep),
            pressures_kPa=self.pressures_kPa[chosen],
            displacement=self.displacement[chosen],
            fields={name: values[chosen] for name, values in self.fields.items()},
        )

    def without_middles(self) -> "Surfaces":
        """This view with straight edges: a quarter of the triangles."""
        corners, numbers = np.unique(self.faces[:, :3], return_inverse=True)
        return replace(
            self,
            points=self.points[corners],
            faces=numbers.reshape(-1, 3),
            displacement=self.displacement[:, corners],
            fields={name: values[:, corners] for name, values in self.fields.items()},
        )


def body_view(run: Run) -> JsonObject:
    """The data of the view of the body of a run; empty where it has none or they are too large."""
    path = run.directory / SURFACES
    surfaces = Surfaces.read(path) if path.is_file() else _swept(run)
    fitting = next((one for one in _reduced(surfaces) if one.size <= LIMIT), None) if surfaces else None
    return {} if fitting is None else _data(fitting)


def _swept(run: Run) -> Surfaces | None:
    """The surface of the body at rest along the rod without a load; None without its mesh or law."""
    path, states = run.directory / BODY, list(_unloaded(run.law)) if run.law else []
    if not states or run.mesh is None or not path.is_file():
        return None
    points, tets = read_tetrahedra(path)
    faces, in_plane = boundary(points, tets)
    shown, numbers = np.unique(faces, return_inverse=True)
    points, height = points[shown], np.array([0.0, run.mesh.curve_height_mm, 0.0])
    moved = np.array([along(points - height, *curve) for _, _, *curve in states])
    return Surfaces(
        half=bool(points[:, 2].min() >= -1e-6 * np.ptp(points[:, 0])),
        points=points,
        faces=numbers.reshape(faces.shape),
        in_plane=in_plane,
        experiments=tuple(name for name, *_ in states),
        pressures_kPa=np.array([pressure for _, pressure, *_ in states]),
        displacement=moved + height - points,
        fields={},
    )


def _unloaded(law: DeliveredLaw) -> Iterator[tuple[str, float, Array, Array, Array]]:
    """The experiment or row, the largest pressure in kPa, and s (n,), curve (n, 3) and frames (n, 3, 3) of `along`."""
    for state in law.unloaded:
        shape = Rod(law.law.length, law=law.law.at(state.pressure_kPa)).solve()
        cosine, sine, nothing = np.cos(shape.theta), np.sin(shape.theta), np.zeros(len(shape.s))
        rows = [[cosine, -sine, nothing], [sine, cosine, nothing], [nothing, nothing, nothing + 1.0]]
        curve = np.column_stack([shape.curve, nothing])
        yield "II", state.pressure_kPa, shape.s, curve, np.moveaxis(np.array(rows), 2, 0)
    for row, part in product(law.law.rows if not law.law.has_plane else (), PARTS):
        with suppress(RodError):
            bent = law.law.at(tuple(part * p for p in row)).solve_in_space(Load())
            name = f"{', '.join(f'{pressure:g}' for pressure in row)} kPa"
            yield name, part * max(row), bent.s, bent.axis, bent.frames


def along(points: Array, s: Array, curve: Array, frames: Array) -> Array:
    """Points (m, 3) of a body whose curve is the x axis, where sections follow a bent curve, (m, 3) mm.

    s (n,) along the curve (n, 3), with the normal of the section and two directions in it as columns of frames
    (n, 3, 3). Beyond the ends the body goes on straight.
    """
    at = np.clip(points[:, 0], s[0], s[-1])
    place, turn = (
        np.column_stack([np.interp(at, s, column) for column in values.reshape(len(s), -1).T])
        for values in (curve, frames)
    )
    inside = np.column_stack([points[:, 0] - at, points[:, 1:]])
    return place + np.einsum("mij,mj->mi", turn.reshape(-1, 3, 3), inside)


def _reduced(surfaces: Surfaces) -> Iterator[Surfaces]:
    """The surfaces in less and less detail: all, straight edges, without I, and then the highest pressure alone."""
    yield surfaces
    coarse = surfaces.without_middles()
    yield coarse
    loaded = np.array([name != "I" for name in surfaces.experiments])
    yield coarse.of_states(loaded)
    yield coarse.of_states(loaded & (surfaces.pressures_kPa == surfaces.pressures_kPa.max()))


def _data(surfaces: Surfaces) -> JsonObject:
    positions = np.concatenate([surfaces.points[None], surfaces.points + surfaces.displacement])
    low, high = positions.min(axis=(0, 1)), positions.max(axis=(0, 1))
    if surfaces.half:
        low[2] = min(low[2], -high[2])
    grid = np.round((positions - low) / (high - low) * 65535.0).astype("<u2")
    triangles, outer = surfaces.triangles()
    fields = surfaces.fields
    limits = {
        name: (0.0 if name == "von_mises_MPa" else float(values.min()), float(values.max()))
        for name, values in fields.items()
    }
    at = zip(surfaces.experiments, map(float, surfaces.pressures_kPa), strict=True)
    states: list[JsonObject] = [
        {
            "experiment": experiment,
            "pressure_kPa": pressure,
            "positions": _text(grid[k + 1]),
            **{name: _text(_bytes(values[k], limits[name])) for name, values in fields.items()},
        }
        for (experiment, pressure), k in sorted((state, k) for k, state in enumerate(at))
    ]
    return {
        "half": surfaces.half,
        "low_mm": low.tolist(),
        "high_mm": high.tolist(),
        "rest": _text(grid[0]),
        "triangles": _text(triangles.astype("<u2" if len(surfaces.points) < 65536 else "<u4")),
        "wide": len(surfaces.points) >= 65536,
        "outer": outer,
        "limits": limits,
        "states": states,
        "experiments": sorted(set(surfaces.experiments)),
    }


def _bytes(values: Array, limits: tuple[float, float]) -> Array:
    width = (limits[1] - limits[0]) or 1.0
    return np.round((values - limits[0]) / width * 255.0).astype(np.uint8)


def _text(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
