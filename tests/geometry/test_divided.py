"""Elements around the material curve are made better without an attempt that has failed before."""

from pathlib import Path

import numpy as np
import pytest

from geometry import MeshFile
from geometry.files import divided
from tests.foreign_bodies import bar, meshed, write_mesh


def test_attempts_that_are_left_out_would_have_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = str(write_mesh(tmp_path / "bar.vtk", *meshed(bar, 4.0)))
    counts: list[int] = []

    def counting(change: divided.Change) -> divided.Change:
        def counted(mesh: divided.DividedMesh, line: divided.Line, vertex: int, around: divided.Index) -> bool:
            counts[-1] += 1
            return change(mesh, line, vertex, around)

        return counted

    class Forgetful(set[object]):
        """It never holds what was added."""

        def add(self, state: object) -> None:
            pass

    for name in ("_collapse", "_move"):
        monkeypatch.setattr(divided, name, counting(getattr(divided, name)))
    counts.append(0)
    mesh = MeshFile(path, 2.1).fixed_body.mesh
    initialised = divided._Attempts.__init__

    def forgetting(self: divided._Attempts, *given: object) -> None:
        initialised(self, *given)  # type: ignore[arg-type]
        self._failed = Forgetful()  # type: ignore[assignment]

    monkeypatch.setattr(divided._Attempts, "__init__", forgetting)
    counts.append(0)
    other = MeshFile(path, 2.1).fixed_body.mesh
    assert counts[0] < 0.8 * counts[1]
    np.testing.assert_array_equal(mesh.points, other.points)
    np.testing.assert_array_equal(mesh.tets, other.tets)
    assert mesh.faces.keys() == other.faces.keys()
    for face, triangles in mesh.faces.items():
        np.testing.assert_array_equal(triangles, other.faces[face])
