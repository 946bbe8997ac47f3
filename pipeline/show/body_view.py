"""The deformed body as compact data for the view that turns in the browser."""

import base64
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array, Index, Mask
from pipeline.values.formats import SURFACES

#: bytes that the data of the view may have before they are written in base64, which takes a third more
LIMIT = 2_600_000
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
    stretch: Array  #: (states, n), largest principal stretch, mean of the elements at the node
    von_mises_MPa: Array  #: (states, n), likewise

    @staticmethod
    def read(path: Path) -> "Surfaces":
        """The file that a run has written."""
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        experiments = tuple(map(str, arrays.pop("experiments")))
        return Surfaces(half=bool(arrays.pop("half")), experiments=experiments, **arrays)

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
        """The same with some of the states."""
        return replace(
            self,
            experiments=tuple(name for name, keep in zip(self.experiments, chosen, strict=True) if keep),
            pressures_kPa=self.pressures_kPa[chosen],
            displacement=self.displacement[chosen],
            stretch=self.stretch[chosen],
            von_mises_MPa=self.von_mises_MPa[chosen],
        )

    def without_middles(self) -> "Surfaces":
        """The same with straight edges: a quarter of the triangles."""
        corners, numbers = np.unique(self.faces[:, :3], return_inverse=True)
        return replace(
            self,
            points=self.points[corners],
            faces=numbers.reshape(-1, 3),
            displacement=self.displacement[:, corners],
            stretch=self.stretch[:, corners],
            von_mises_MPa=self.von_mises_MPa[:, corners],
        )


def body_view(directory: Path) -> dict[str, Any]:
    """The data of the view of the body in a result folder; empty where the run has none or they are too large."""
    path = directory / SURFACES
    if not path.is_file():
        return {}
    fitting = next((surfaces for surfaces in _reduced(Surfaces.read(path)) if surfaces.size <= LIMIT), None)
    return {} if fitting is None else _data(fitting)


def experiments_of(view: Mapping[str, Any]) -> list[str]:
    """The experiments that the view shows."""
    return sorted({state["experiment"] for state in view.get("states", ())})


def _reduced(surfaces: Surfaces) -> Iterator[Surfaces]:
    """The surfaces in less and less detail: all, straight edges, without I, and then the highest pressure alone."""
    yield surfaces
    coarse = surfaces.without_middles()
    yield coarse
    loaded = np.array([name != "I" for name in surfaces.experiments])
    yield coarse.of_states(loaded)
    yield coarse.of_states(loaded & (surfaces.pressures_kPa == surfaces.pressures_kPa.max()))


def _data(surfaces: Surfaces) -> dict[str, Any]:
    positions = np.concatenate([surfaces.points[None], surfaces.points + surfaces.displacement])
    low, high = positions.min(axis=(0, 1)), positions.max(axis=(0, 1))
    if surfaces.half:
        low[2] = min(low[2], -high[2])
    grid = np.round((positions - low) / (high - low) * 65535.0).astype("<u2")
    triangles, outer = surfaces.triangles()
    fields = {"stretch": surfaces.stretch, "von_mises_MPa": surfaces.von_mises_MPa}
    limits = {
        "stretch": (float(surfaces.stretch.min()), float(surfaces.stretch.max())),
        "von_mises_MPa": (0.0, float(surfaces.von_mises_MPa.max())),
    }
    states = [
        {
            "experiment": experiment,
            "pressure_kPa": float(surfaces.pressures_kPa[k]),
            "positions": _text(grid[k + 1]),
            **{name: _text(_bytes(values[k], limits[name])) for name, values in fields.items()},
        }
        for k, experiment in enumerate(surfaces.experiments)
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
        "states": sorted(states, key=lambda state: (str(state["experiment"]), state["pressure_kPa"])),
    }


def _bytes(values: Array, limits: tuple[float, float]) -> Array:
    width = (limits[1] - limits[0]) or 1.0
    return np.round((values - limits[0]) / width * 255.0).astype(np.uint8)


def _text(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
