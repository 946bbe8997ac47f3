"""Drawings of arms, and arms "as built" that differ from them: drawn at random, the same for equal seeds.

A seed has two drawings of each family of the paper, one of the law Yeoh, the other of St. Venant-Kirchhoff or Hencky.
An arm as built has a law of the other kind, other moduli, three other dimensions, and a mesh 1.5 times as fine.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, exp, log, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.unseen.designs import constants, three_digits
from geometry import FAMILIES

#: by family: pressure in kPa up to which the law of the arm of the paper (Young's modulus E_PAPER in MPa) is measured;
#: other drawings have the same pressure times air over E times solid
HIGHEST = {"pneunet": 37.0, "semicircular": 60.0, "semicircular_single": 50.0, "bisected_circle": 50.0}
E_PAPER = 1.2
#: pressures of a law over the highest
LAW_PRESSURES = (0.1, 0.25, 0.5, 0.75, 1.0)
#: fewest chambers, so that the two ends do not disturb all cells
LEAST = {"pneunet": 6}
#: the dimension that is no length; numbers of chambers, and lengths in mm of arms with one
COUNT, CHAMBERS, LENGTHS = "chambers", (5, 6), (75.0, 88.0)
#: dimensions of a drawing over those of the paper; Young's modulus in MPa; Poisson's ratio
SCALES, MODULI, NU = (0.87, 1.15), (0.3, 1.5), 0.495
#: mm, size of the elements of a drawing, and how much finer those of an arm as built are
SIZE, FINER = 4.0, 1.5
#: moduli of an arm as built over those of its drawing; how many of its dimensions differ
STIFFNESS, DIFFERENT = (0.6, 1.6), 3
#: a dimension differs by up to so many mm; one up to a thickness (mm) by up to a part of itself, if that is more
MM, PART, THIN_MM = 0.1, 0.08, 4.0
#: pressures over the highest of the law, times the stiffness of the arm as built: those that are measured, one between
#: them and one beyond them that are predicted, and that of the dead force and of the held end
MEASURED, PREDICTED, LOADED = (0.15, 0.3, 0.42, 0.52, 0.6), (0.36, 0.7), 0.52
#: families whose single cavity blows up so early with the law svk that they have Hencky's instead
WITHOUT_SVK = ("semicircular_single", "bisected_circle")


@dataclass(frozen=True)
class VirtualArm:
    """An arm as built, and the drawing that it was built from."""

    seed: int
    number: int  #: from 0 on
    drawing: Mapping[str, Any]  #: its configuration, as in YAML
    built: Mapping[str, Any]  #: that of the arm as built
    stiffness: float  #: moduli as built over those of the drawing
    changes_mm: Mapping[str, float]  #: of dimensions, by key of the geometry
    direction: tuple[float, float]  #: of the dead force

    @property
    def name(self) -> str:
        """Of its folder."""
        return f"arm_{self.seed}_{self.number:02d}"

    @property
    def family(self) -> str:
        """Of the body."""
        return str(self.drawing["geometry"]["family"])

    @property
    def law_name(self) -> str:
        """Of the folder of the law of its drawing, which several arms share."""
        return str(self.drawing["name"])

    @property
    def measured_kPa(self) -> tuple[float, ...]:
        """At which its free end is measured."""
        return self._pressures(MEASURED)

    @property
    def predicted_kPa(self) -> tuple[float, ...]:
        """At which its free end is predicted."""
        return self._pressures(PREDICTED)

    @property
    def loaded_kPa(self) -> float:
        """At which its end is held, or carries the dead force."""
        return self._pressures((LOADED,))[0]

    def _pressures(self, parts: tuple[float, ...]) -> tuple[float, ...]:
        highest = _number(self.drawing["pressures"][-1])
        return tuple(three_digits(part * self.stiffness * highest) for part in parts)


@dataclass(frozen=True)
class _Drawing:
    name: str
    family: str
    dimensions: Mapping[str, float]  #: mm, and counts
    law: str
    E: float  #: MPa

    @property
    def highest_kPa(self) -> float:
        """Of its law."""
        paper = _load_of(self.family, _paper(self.family), E_PAPER)
        return three_digits(HIGHEST[self.family] * paper / _load_of(self.family, self.dimensions, self.E))

    def document(self, size: float, pressures_kPa: tuple[float, ...]) -> dict[str, Any]:
        """A configuration with elements of a size in mm."""
        lengths = {key: value if key == COUNT else f"{value:g} mm" for key, value in self.dimensions.items()}
        return {
            "name": self.name,
            "geometry": {"family": self.family, **lengths},
            "material": {"law": self.law, **constants(self.law, self.E, NU), "density": "1130 kg/m^3"},
            "pressures": [f"{pressure:g} kPa" for pressure in pressures_kPa],
            "mesh": {"size": f"{size:.3g} mm", "grading": False, "coarser": False},
            "accuracy": False,
        }


def arms(seed: int, count: int) -> tuple[VirtualArm, ...]:
    """The first arms of a seed; families take turns."""
    return tuple(_arm(seed, number) for number in range(count))


def _arm(seed: int, number: int) -> VirtualArm:
    rng = np.random.default_rng([seed, number, 1])
    kind = number % (2 * len(HIGHEST))
    drawing = _drawing(seed, kind)
    stiffness = exp(rng.uniform(log(STIFFNESS[0]), log(STIFFNESS[1])))
    changes = _changes(drawing, rng)
    angle = rng.uniform(0.0, 2.0 * pi)
    dimensions = {key: value + changes.get(key, 0) for key, value in drawing.dimensions.items()}
    law = _other(drawing.law, drawing.family, rng)
    built = _Drawing(f"built_{seed}_{number:02d}", drawing.family, dimensions, law, stiffness * drawing.E)
    known = tuple(three_digits(part * drawing.highest_kPa) for part in LAW_PRESSURES)
    arm = VirtualArm(seed, number, drawing.document(SIZE, known), {}, stiffness, changes, (cos(angle), sin(angle)))
    solved = tuple(sorted({*arm.measured_kPa, *arm.predicted_kPa}))
    return replace(arm, built=built.document(SIZE / FINER, solved))


def _drawing(seed: int, kind: int) -> _Drawing:
    """One of the drawings of a seed, of which there are two for each family."""
    rng = np.random.default_rng([seed, kind, 2])
    family = tuple(HIGHEST)[kind % len(HIGHEST)]
    dimensions = {key: three_digits(value * rng.uniform(*SCALES)) for key, value in _paper(family).items()}
    if COUNT in dimensions:
        dimensions[COUNT] = max(int(rng.choice(CHAMBERS)), LEAST.get(family, 0))
    else:
        dimensions["length"] = three_digits(rng.uniform(*LENGTHS))
    E = three_digits(exp(rng.uniform(log(MODULI[0]), log(MODULI[1]))))
    law = "yeoh" if kind // len(HIGHEST) else _other("yeoh", family, rng)
    return _Drawing(f"drawing_{seed}_{kind}", family, dimensions, law, E)


def _other(law: str, family: str, rng: np.random.Generator) -> str:
    """A law of the other kind."""
    if law != "yeoh":
        return "yeoh"
    return "hencky" if family in WITHOUT_SVK else ("svk", "hencky")[int(rng.integers(2))]


def _paper(family: str) -> dict[str, float]:
    """Dimensions of the arm of the paper, mm."""
    geometry = yaml.safe_load(Path(f"configs/{family}_coarse.yaml").read_text(encoding="utf-8"))["geometry"]
    return {key: value if key == COUNT else _number(value) for key, value in geometry.items() if key != "family"}


def _changes(drawing: _Drawing, rng: np.random.Generator) -> dict[str, float]:
    """mm, of some dimensions; not of the length."""
    keys = [key for key in drawing.dimensions if key not in (COUNT, "length")]
    chosen = rng.choice(keys, DIFFERENT, replace=False)
    most = {key: max(MM, PART * value if value <= THIN_MM else 0.0) for key, value in drawing.dimensions.items()}
    return {str(key): round(most[key] * rng.uniform(-1.0, 1.0), 3) for key in chosen}


def _load_of(family: str, dimensions: Mapping[str, float], E: float) -> float:
    """Volume of air over that of the solid and over Young's modulus."""
    design = FAMILIES[family](**dimensions)
    return design.cavity_volumes["cavity"] / design.solid_volume / E


def _number(value: Any) -> float:
    return float(str(value).split()[0])
