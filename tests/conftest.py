"""Fixtures that several test modules use."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from geometry import Body, PneuNet
from pipeline.processes import THREADS

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
    """Limits of meshes of a cell begin at the mesh of the arm instead of a fine one, in a fifth of the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pipeline.cell.limit.fine_mesh", lambda pieces: pieces.config.mesh)
        yield


@pytest.fixture(scope="session")
def short() -> Body:
    """Three chambers, 32 mm long."""
    return PneuNet(chambers=3).body(4.0)
