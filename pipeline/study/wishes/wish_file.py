"""What the file of a wish says, with the configurations that follow from it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from json import dumps
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.config.section import read
from pipeline.study.wishes.wish import GEOMETRY, Wishes
from pipeline.values.json_values import JsonObject

#: significant digits of dimensions and pressures
DIGITS = 6


@dataclass(frozen=True)
class WishFile:
    """What a file says, with the configurations that follow from it."""

    source: Path
    name: str
    base: Document  #: with the values of `set`
    wishes: Wishes

    def record(self) -> JsonObject:
        """Everything that decides the result."""
        base = sha256(dumps(self.base.content, sort_keys=True, default=str).encode()).hexdigest()
        return {"name": self.name, "base_hash": base, "wishes": repr(self.wishes)}

    @property
    def hash(self) -> str:
        """sha256 of the record."""
        return sha256(dumps(self.record(), sort_keys=True).encode()).hexdigest()

    def document(self, point: Array) -> Document:
        """The base with the dimensions and pressures of a point (n,), and how the end is held."""
        values = self.wishes.values(point)
        found: dict[str, Any] = {"name": self.name}
        found |= {key: f"{values[key]:.{DIGITS}g} mm" for key in self.wishes.dimensions}
        found["pressures"] = [f"{pressure:.{DIGITS}g} kPa" for pressure in self.wishes.pressures_kPa(point)]
        forces = [wish for wish in self.wishes.wishes if wish.quantity == "force"]
        heights = [f"{height:g} mm" for height in dict.fromkeys(wish.height_mm for wish in forces)]
        if heights:
            found["end"] = {"y": heights[0]}
        if heights[1:]:
            found["validation"] = {"end_y": heights[1:]}
        return self.base.with_values(list(found.items()), lambda key: f"{self.source}: {key}")

    def config(self, point: Array) -> Config:
        """The design of a point (n,). Raises InputError."""
        return read(Config, self.document(point))

    @cached_property
    def start(self) -> Config:
        """The design at the start. Raises InputError."""
        return self.config(self.wishes.start)

    def drawn(self, point: Array) -> Config:
        """The design of a point (n,) with the other values of the start, for what follows from its drawing alone.

        Raises `DesignError`.
        """
        values, known = self.wishes.values(point), self.start.design
        changes = {key.removeprefix(GEOMETRY): values[key] for key in self.wishes.dimensions}
        design: Any = replace(known, **changes)  # type: ignore[type-var]
        changed: Mapping[str, Any] = {"design": design.with_regions(known.regions)}
        return replace(self.start, **changed)


def rounded(point: Array) -> Array:
    """A point (n,) with the digits with which it is written."""
    return np.array([float(f"{value:.{DIGITS}g}") for value in point])
