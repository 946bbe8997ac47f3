"""Fixtures that several test modules use."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from geometry import Body, PneuNet


@pytest.fixture(autouse=True)
def environment() -> Iterator[None]:
    """Whatever a test sets in the environment holds for that test alone: a point of a sweep sets its threads."""
    before = dict(os.environ)
    yield
    if dict(os.environ) != before:
        os.environ.clear()
        os.environ.update(before)


@pytest.fixture
def configs() -> Path:
    """The folder of the configurations that are shipped."""
    return Path(__file__).resolve().parent.parent / "configs"


@pytest.fixture(scope="session")
def short() -> Body:
    """Three chambers, 32 mm long."""
    return PneuNet(chambers=3).body(4.0)
