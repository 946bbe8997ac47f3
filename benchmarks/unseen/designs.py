"""Designs drawn at random: a Latin hypercube over families, laws, dimensions and pressures, the same for equal seeds.

A configuration gives what a user must give, and nothing else: dimensions, material and two pressures. Mesh, elements,
contact and everything else are left to the program. The pressures are scaled to the design: the highest is drawn as
p V_air / (E V_solid), about half the strain of a wall (V: volumes of air and of material). The arms of the paper have
0.003 to 0.03 and reach a limit at 0.02 to 0.06, so that some of the designs drawn are meant to meet one.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, log
from typing import Any

import numpy as np
from scipy.stats import qmc

from fem.materials import LAWS
from geometry import FAMILIES
from pipeline.values.pressure import in_kPa

#: what is drawn: the columns of the hypercube
COLUMNS = (
    *("family", "law", "nu", "E", "size", "cells", "length", "height", "wall", "side", "base", "gap", "fillet", "load"),
)
#: half-open ranges that are drawn uniformly in the logarithm: Young's modulus in MPa, height or diameter of the arm in
#: mm, p V_air / (E V_solid) at the highest pressure
MODULUS, SIZE, LOAD = (0.1, 3.0), (8.0, 40.0), (0.01, 0.08)
#: this part of the designs has a Poisson ratio of the first range, the others of the second
COMPRESSIBLE, POISSON = 0.2, ((0.3, 0.45), (0.45, 0.4995))
#: this part of the gapped arms has rounded edges
ROUNDED = 0.25
#: numbers of cells, all equally probable; five parameters need a length of 6.5 cells
CELLS = (7, 7, 8, 10)
#: length over the radius of arms with one cavity, which have a nominal cell for every 4/3 of the radius
SLENDER = (9.0, 11.0)
#: the lower pressure over the higher one
LOWER = 0.5
#: second constant of Mooney-Rivlin over the first, second and third of Yeoh over the first
MOONEY, YEOH = 0.25, (0.05, 0.001)
#: exponents of Ogden, and the part of the shear modulus of each
OGDEN = ((1.3, 0.8), (5.0, 0.2))
#: kg/m3
DENSITY = 1130


@dataclass(frozen=True)
class Drawn:
    """A design of a seed."""

    seed: int
    number: int  #: from 0 on
    document: Mapping[str, Any]  #: the configuration, as in YAML
    load: float  #: p V_air / (E V_solid) at the highest pressure

    @property
    def name(self) -> str:
        """Its name and that of its folder."""
        return f"design_{self.number:02d}"

    @property
    def family(self) -> str:
        """The family of its body."""
        return str(self.document["geometry"]["family"])

    @property
    def law(self) -> str:
        """The law of its material."""
        return str(self.document["material"]["law"])

    @property
    def pressures_kPa(self) -> tuple[float, ...]:
        """Its pressures."""
        return tuple(float(text.split()[0]) for text in self.document["pressures"])

    @property
    def words(self) -> str:
        """Family, law, height and highest pressure."""
        high = FAMILIES[self.family](**self.dimensions).extent[1]
        return f"{self.family}, {self.law}, {high:.3g} mm high, {self.pressures_kPa[-1]:g} kPa"

    @property
    def dimensions(self) -> dict[str, Any]:
        """The dimensions in mm and the counts."""
        entries = {key: value for key, value in self.document["geometry"].items() if key != "family"}
        return {key: float(v.split()[0]) if isinstance(v, str) else v for key, v in entries.items()}


def drawn(seed: int, count: int) -> tuple[Drawn, ...]:
    """The designs of a seed; each column of the hypercube has one value in every `count`-th part of its range.

    The designs of a seed change with their number.
    """
    rows = qmc.LatinHypercube(len(COLUMNS), rng=np.random.default_rng(seed)).random(count)
    return tuple(_drawn(seed, number, dict(zip(COLUMNS, row, strict=True))) for number, row in enumerate(rows))


def _drawn(seed: int, number: int, u: Mapping[str, float]) -> Drawn:
    family = tuple(_DIMENSIONS)[int(u["family"] * len(_DIMENSIONS))]
    law = tuple(LAWS)[int(u["law"] * len(LAWS))]
    dimensions = {
        key: value if isinstance(value, int) else three_digits(value) for key, value in _DIMENSIONS[family](u).items()
    }
    E, nu = three_digits(_logarithmic(MODULUS, u["E"])), _poisson(u["nu"])
    design = FAMILIES[family](**dimensions)
    air = sum(design.cavity_volumes.values()) if family != "bisected_circle" else design.cavity_volumes["cavity"]
    load = _logarithmic(LOAD, u["load"])
    high = three_digits(in_kPa(load * E * design.solid_volume / air))
    document = {
        "name": f"unseen_{seed}_{number:02d}",
        "geometry": {"family": family}
        | {key: value if isinstance(value, int) else f"{value:g} mm" for key, value in dimensions.items()},
        "material": {"law": law, **constants(law, E, nu), "density": f"{DENSITY} kg/m^3"},
        "pressures": [f"{three_digits(LOWER * high):g} kPa", f"{high:g} kPa"],
    }
    return Drawn(seed, number, document, load)


def three_digits(value: float) -> float:
    """As a user writes a number."""
    return float(f"{value:.3g}")


def _between(low: float, high: float, u: float) -> float:
    return low + (high - low) * u


def _logarithmic(limits: tuple[float, float], u: float) -> float:
    low, high = limits
    return exp(_between(log(low), log(high), u))


def _poisson(u: float) -> float:
    """Four digits, as small differences from 1/2 matter."""
    low, high = POISSON
    if u < COMPRESSIBLE:
        return round(_between(*low, u / COMPRESSIBLE), 2)
    return round(_between(*high, (u - COMPRESSIBLE) / (1.0 - COMPRESSIBLE)), 4)


def constants(law: str, E: float, nu: float) -> dict[str, Any]:
    """The constants of a law with these moduli at small strain, as in YAML; rubber-like laws have nu instead of
    kappa."""
    mu = E / (2.0 * (1.0 + nu))
    if law == "ogden":
        moduli = [f"{three_digits(in_kPa(2.0 * mu * part / alpha)):g} kPa" for alpha, part in OGDEN]
        return {"mu": moduli, "alpha": [alpha for alpha, _ in OGDEN], "nu": nu}
    tensile: dict[str, dict[str, float]] = {
        "svk": {"E": E},
        "hencky": {"E": E},
        "neo_hooke": {"mu": mu},
        "mooney_rivlin": {"c10": mu / 2.0 / (1.0 + MOONEY), "c01": MOONEY * mu / 2.0 / (1.0 + MOONEY)},
        "yeoh": {"c10": mu / 2.0, "c20": YEOH[0] * mu / 2.0, "c30": YEOH[1] * mu / 2.0},
    }
    return {name: f"{three_digits(in_kPa(value)):g} kPa" for name, value in tensile[law].items()} | {"nu": nu}


def _cells(u: Mapping[str, float]) -> int:
    return CELLS[int(u["cells"] * len(CELLS))]


def _pneunet(u: Mapping[str, float]) -> dict[str, Any]:
    size = _logarithmic(SIZE, u["size"])
    gap, strip = size * _between(0.08, 0.2, u["gap"]), size * _between(0.14, 0.22, u["wall"])
    return {
        "chambers": _cells(u),
        "width": size * _between(0.7, 1.3, u["height"]),
        "chamber_length": size * _between(0.4, 0.75, u["length"]),
        "gap": gap,
        "chamber_height": size * _between(0.5, 0.85, 1.0 - u["height"]),
        "strip": strip,
        "base": size * _between(0.08, 0.2, u["base"]),
        "wall": size * _between(0.06, 0.12, u["wall"]),
        "side_wall": size * _between(0.08, 0.16, u["side"]),
        "roof": size * _between(0.08, 0.16, 1.0 - u["side"]),
        "channel": 0.6 * strip,
        **({"fillet": 0.3 * gap} if u["fillet"] < ROUNDED else {}),
    }


def _semicircular(u: Mapping[str, float]) -> dict[str, Any]:
    radius = _logarithmic(SIZE, u["size"]) / 2.0
    return {
        "chambers": _cells(u),
        "radius": radius,
        "chamber_length": radius * _between(0.8, 1.4, u["length"]),
        "partition": radius * _between(0.15, 0.4, u["gap"]),
        "end_wall": radius * _between(0.2, 0.5, u["fillet"]),
        "base": radius * _between(0.15, 0.4, u["base"]),
        "wall": radius * _between(0.11, 0.25, u["wall"]),
        "channel": radius * _between(0.15, 0.4, u["side"]),
    }


def _semicircular_single(u: Mapping[str, float]) -> dict[str, Any]:
    radius = _logarithmic(SIZE, u["size"]) / 2.0
    return {
        "length": radius * _between(*SLENDER, u["length"]),
        "radius": radius,
        "end_wall": radius * _between(0.2, 0.5, u["fillet"]),
        "base": radius * _between(0.15, 0.4, u["base"]),
        "wall": radius * _between(0.11, 0.25, u["wall"]),
    }


def _bisected_circle(u: Mapping[str, float]) -> dict[str, Any]:
    radius = _logarithmic(SIZE, u["size"]) / 2.0
    return {
        "length": radius * _between(*SLENDER, u["length"]),
        "radius": radius,
        "end_wall": radius * _between(0.2, 0.5, u["fillet"]),
        "wall": radius * _between(0.11, 0.25, u["wall"]),
        "divider": radius * _between(0.15, 0.35, u["base"]),
    }


def _rectangular(u: Mapping[str, float]) -> dict[str, Any]:
    size = _logarithmic(SIZE, u["size"])
    return {
        "chambers": _cells(u),
        "width": size * _between(0.8, 1.3, u["height"]),
        "height": size,
        "chamber_length": size * _between(0.4, 0.75, u["length"]),
        "partition": size * _between(0.08, 0.2, u["gap"]),
        "end_wall": size * _between(0.1, 0.25, u["fillet"]),
        "base": size * _between(0.14, 0.28, u["base"]),
        "side_wall": size * _between(0.08, 0.16, u["side"]),
        "roof": size * _between(0.08, 0.16, u["wall"]),
        "channel": size * _between(0.08, 0.16, 1.0 - u["side"]),
    }


#: by family: the dimensions in mm (counts are whole numbers) from the numbers that were drawn
_DIMENSIONS = {
    "pneunet": _pneunet,
    "semicircular": _semicircular,
    "semicircular_single": _semicircular_single,
    "bisected_circle": _bisected_circle,
    "rectangular": _rectangular,
}
assert set(_DIMENSIONS) == set(FAMILIES), "every family is drawn"
