"""The arm's own law over two pressures from the pairs.json of a run."""

import json
from pathlib import Path

from pipeline.values.errors import InputError
from pipeline.values.formats import PAIRS
from rod.arm_law.pairs import PairLaw
from rod.errors import RodError


def read_pair_law(path: Path) -> PairLaw | None:
    """The law of a result folder, or of its pairs.json; None where the path is neither. Raises InputError."""
    file = path / PAIRS if path.is_dir() else path
    if file.name != PAIRS or not file.is_file():
        return None
    try:
        return PairLaw.from_record(json.loads(file.read_text(encoding="utf-8")))
    except (OSError, ValueError, RodError) as failure:
        raise InputError(f"{file}: {failure}") from None
