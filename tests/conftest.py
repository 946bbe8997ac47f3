"""Fixtures that several test modules use."""

import os
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from fem.cell import piece
from geometry import Body, PneuNet
from pipeline.answers.rods import poses
from pipeline.law import build
from pipeline.law.meshes import find_limit
from pipeline.show import pictures
from pipeline.store.worker import THREADS
from tests.quotients import TIGHT
from tests.shared import SharedFolders

#: what makes the poses of an arm under the hand
POSES = poses._poses
#: of the libraries, as the tests begin
BEGAN_WITH = {name: os.environ.get(name) for name in THREADS}


@pytest.fixture(autouse=True)
def threads() -> Iterator[None]:
    """Numbers of threads that a test or its fixtures leave in the environment do not reach the next test: points of a
    sweep and Dask set them in this process, and numba refuses another number than it has begun with."""
    yield
    for name, value in BEGAN_WITH.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value


@pytest.fixture
def configs() -> Path:
    """The folder of the configurations that are shipped."""
    return Path(__file__).resolve().parent.parent / "configs"


@pytest.fixture(scope="module")
def coarse_limit() -> Iterator[None]:
    """The limit of a cell is that of two meshes, from that of the arm on: of four fine ones it takes ten times as long.

    `tests/pipeline/law/test_cell.py` and `test_meshes.py` have limits of all meshes.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "fine_mesh", lambda pieces: pieces.config.mesh)
        patch.setattr(build, "find_limit", partial(find_limit, fewest=2))
        yield


@pytest.fixture(scope="module")
def undrawn() -> Iterator[None]:
    """Pictures of runs are empty files; each takes half a second. `tests/pipeline/test_run.py` has drawn ones."""

    def left_empty(path: Path, *_: object, **__: object) -> None:
        path.parent.mkdir(exist_ok=True)
        path.touch()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, "window_for_pictures", nullcontext)
        for name in ("draw_body", "draw_deformed"):
            patch.setattr(pictures, name, left_empty)
        yield


@pytest.fixture(scope="module")
def few_proposals() -> Iterator[None]:
    """A calibration looks at few states to be measured next, each of which takes as many rods as a round of its fit."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pipeline.answers.measured.calibration.PRESSURES", (0.5, 1.0))
        yield


@pytest.fixture(scope="session", autouse=True)
def without_poses() -> Iterator[None]:
    """The arm under a slider and under the hand is in no page; its poses take six seconds for each."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(poses, "_poses", lambda *_: {})
        yield


@pytest.fixture(scope="module")
def with_poses() -> Iterator[None]:
    """But in those that a test looks at in a browser."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(poses, "_poses", POSES)
        yield


@pytest.fixture(scope="module")
def few_poses() -> Iterator[None]:
    """And few of them where the page is looked at, but nobody bends its arm."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(poses, "_poses", POSES)
        for name, value in (("MOST", 3), ("DIRECTIONS", 4), ("STEP", 1.5)):
            patch.setattr(poses, name, value)
        yield


@pytest.fixture
def solved_tightly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells are solved until their forces balance to `TIGHT`, so that differences of their states have digits."""
    monkeypatch.setattr(piece, "OPTIONS", replace(piece.OPTIONS, tolerance=TIGHT))


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SharedFolders]:
    """Folders that all processes of this run of the tests share."""
    own = tmp_path_factory.getbasetemp()
    folders = SharedFolders((own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "shared")
    yield folders
    assert not folders.changed(), "a test changed a folder that others read; it must take a copy"


@pytest.fixture(scope="session")
def short() -> Body:
    """Three chambers, 32 mm long."""
    return PneuNet(chambers=3).body(4.0)
