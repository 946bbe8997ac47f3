"""What several test modules need."""

from pathlib import Path

import pytest


@pytest.fixture
def configs() -> Path:
    """The folder of the configurations that are shipped."""
    return Path(__file__).resolve().parent.parent / "configs"
