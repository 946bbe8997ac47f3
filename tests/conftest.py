"""Fixtures that several test modules use."""

from pathlib import Path

import pytest

from geometry import Body, PneuNet


@pytest.fixture
def configs() -> Path:
    """The folder of the configurations that are shipped."""
    return Path(__file__).resolve().parent.parent / "configs"


@pytest.fixture(scope="session")
def short() -> Body:
    """Three chambers, 32 mm long."""
    return PneuNet(chambers=3).body(4.0)
