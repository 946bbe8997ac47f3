"""The sketches of the bodies name every dimension of a configuration."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from benchmarks.sketches import DOCS, SKETCHES, draw
from geometry import FAMILIES

#: what has no place in a sketch: a number, and lists that stand for equal dimensions
NO_DIMENSIONS = {"chambers", "chamber_lengths", "chamber_heights", "gaps"}


def words(file: Path) -> set[str]:
    return set(re.findall(r">([a-z_]+)</text>", file.read_text(encoding="utf-8")))


@pytest.mark.parametrize("family", SKETCHES)
def test_every_dimension_is_shown(family: str, tmp_path: Path) -> None:
    draw(family, tmp_path / "sketch.svg")
    dimensions = {field.name for field in fields(FAMILIES[family])} - NO_DIMENSIONS
    assert words(tmp_path / "sketch.svg") >= dimensions
    assert words(DOCS / f"sketch_{family}.svg") == words(tmp_path / "sketch.svg")
