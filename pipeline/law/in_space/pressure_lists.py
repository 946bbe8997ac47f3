"""`pressures` of which entries are lists, with a pressure for each cavity."""

from collections.abc import Mapping
from typing import Any

from pipeline.config.document import Document


def pressure_lists(document: Document, what: str) -> list[Any] | None:
    """The entries of `pressures` if one of them is a list; None if none is.

    what: such entries are called. Raises InputError beside fractions of cavities, which contradict them.
    """
    given = document.content.get("pressures")
    if not isinstance(given, list) or not any(isinstance(entry, list) for entry in given):
        return None
    effects = document.content.get("effects")
    pressure = effects.get("pressure") if isinstance(effects, Mapping) else None
    if isinstance(pressure, Mapping) and "cavities" in pressure:
        sentence = f"contradicts {what} of pressures, which say it already; leave it out"
        raise document.wrong(("effects", "pressure", "cavities"), sentence)
    return given
