"""The arm's own law from the file law.json of a run, and its rods."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.values.errors import InputError
from rod.arm_law.law import ArmLaw
from rod.arm_law.record import law_from_record
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod

#: keys of a law.json, by any of which it is known
_PARTS = ("curves", "clamp", "tip")


@dataclass(frozen=True)
class SavedLaw:
    """The law of a law.json."""

    law: ArmLaw

    @staticmethod
    def of(path: Path, content: Mapping[str, Any]) -> "SavedLaw":
        """From the content of a file. Raises InputError."""
        try:
            return SavedLaw(law_from_record(content))
        except (RodError, TypeError, ValueError) as failure:
            raise InputError(f"{path}: {failure}") from None

    @staticmethod
    def read(path: Path) -> "SavedLaw":
        """From a law.json. Raises InputError."""
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except OSError as failure:
            raise InputError(f"{path}: cannot be read ({failure.strerror}); give the law.json of a run") from None
        except ValueError as failure:
            raise InputError(f"{path}: is not the law of an arm: {failure}") from None
        if not is_law(content):
            raise InputError(f"{path}: is not the law of an arm, as `pneurod cell` writes it")
        return SavedLaw.of(path, content)

    def rod(self, pressure_kPa: float) -> Rod:
        """The rod at a pressure; its origin is the clamped end of the material curve. Raises `RodError` outside."""
        return Rod(self.law.length, law=self.law.at(pressure_kPa))


def is_law(content: Any) -> bool:
    """Whether the content of a file is the law of an arm rather than the parameters of a rod."""
    return isinstance(content, Mapping) and "kappa_0" not in content and not content.keys().isdisjoint(_PARTS)
