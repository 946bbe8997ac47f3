"""The arm's own law from the file law.json: rods under loads, and tables for other programs."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.store.atomic_file import write_atomic
from rod.arm_law.law import ArmLaw
from rod.arm_law.record import law_from_record
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod
from rod.same_pressure import as_known

#: formats that take the law itself; others take a straight line between moment and curvature
TARGETS = ("csv", "json")
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

    def file_name(self, target: str, pressure_kPa: float | None = None) -> str:
        """The name of the exported file. Raises InputError for a format that takes no curved law."""
        if target not in TARGETS:
            raise InputError(
                f"--to {target}: takes a straight line between moment and curvature, and the arm's own law is none; "
                f"allowed for it are {', '.join(TARGETS)}"
            )
        ends = (self.law.pressures[0], self.law.pressures[-1]) if pressure_kPa is None else (pressure_kPa,)
        return f"law_{'_to_'.join(f'{pressure:g}' for pressure in ends)}kPa.{target}"

    def export(self, target: str, path: Path, pressure_kPa: float | None = None) -> None:
        """Write the section law at a pressure, or at all of its pressures, as CSV or JSON.

        Raises `RodError` for a pressure outside the law.
        """
        known = self.law.pressures
        pressures = known if pressure_kPa is None else (as_known(known, pressure_kPa),)
        tables = [self.table(pressure) for pressure in pressures]
        if target == "csv":
            rows = [
                ",".join(f"{value:.12g}" for value in (pressure, *row))
                for pressure, columns in zip(pressures, tables, strict=True)
                for row in zip(*columns.values(), strict=True)
            ]
            text = "\n".join([",".join(["pressure_kPa", *tables[0]]), *rows])
        else:
            head = {"pressures_kPa": list(pressures), "length_mm": self.law.length, "pitch_mm": self.law.pitch}
            columns = {name: [table[name].tolist() for table in tables] for name in tables[0]}
            text = json.dumps({**head, **columns}, indent=1)
        write_atomic(path, (text + "\n").encode())

    def table(self, pressure_kPa: float) -> dict[str, Array]:
        """Columns (n,) over equally spaced moments at a pressure, units in their names. Raises `RodError`."""
        section = self.law.at(pressure_kPa).section
        return {
            "moment_N_mm": section.moment,
            "kappa_per_mm": section.kappa,
            "rigidity_N_mm2": 1.0 / np.asarray(section.kappa_slope),
            "stretch": section.stretch,
            "axial_rigidity_N": section.axial_rigidity,
            "shear_rigidity_N": section.shear_rigidity,
        }


def is_law(content: Any) -> bool:
    """Whether the content of a file is the law of an arm rather than the parameters of a rod."""
    return isinstance(content, Mapping) and "kappa_0" not in content and not content.keys().isdisjoint(_PARTS)
