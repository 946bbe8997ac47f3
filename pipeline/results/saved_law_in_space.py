"""The law of an arm that bends in space, from the file law_in_space.json."""

import json
from pathlib import Path

from pipeline.values.errors import InputError
from pipeline.values.formats import LAW_IN_SPACE
from rod.arm_law.space_law import SpaceLaw
from rod.errors import RodError


def read_space_law(path: Path) -> SpaceLaw | None:
    """The law of a result folder, or of its law_in_space.json; None where the path is neither. Raises InputError."""
    file = path / LAW_IN_SPACE if path.is_dir() else path
    if file.name != LAW_IN_SPACE or not file.is_file():
        return None
    try:
        return SpaceLaw.from_record(json.loads(file.read_text(encoding="utf-8")))
    except (OSError, TypeError, ValueError, RodError) as failure:
        raise InputError(f"{file}: {failure}") from None
