"""Bodies and materials described in Python, for `pneurod.characterize`: keys as in a configuration, units as texts.

    pneurod.PneuNet(chambers=6, wall="1.2 mm")
    pneurod.NeoHooke(mu="0.1 MPa")

Keys that are left out have the defaults of a configuration (docs/configuration.md). Values are checked by
`pneurod.characterize`. For the laws of the finite element solver, with numbers in MPa, see `pneurod.fem`.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar

from pneurod.arguments import Setting, given_settings


class Description:
    """One section of a configuration: what is described, and the values of its keys."""

    _choice: ClassVar[tuple[str, str]]  #: the key that says what is described, and its value

    def __init__(self, **values: Setting) -> None:
        key, value = self._choice
        self.values: Mapping[str, Any] = MappingProxyType({key: value, **dict(given_settings(values, str))})

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and isinstance(other, Description) and other.values == self.values

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        given = ", ".join(f"{key}={value!r}" for key, value in self.values.items() if key != self._choice[0])
        return f"{type(self).__name__}({given})"


class Body(Description):
    """A body: a family with its dimensions, or a file."""


class PneuNet(Body):
    """A pneu-net with gaps between its chambers: chambers, width, chamber_height, wall, ..."""

    _choice = ("family", "pneunet")


class Semicircular(Body):
    """A half cylinder with a row of cavities: chambers, radius, partition, wall, ..."""

    _choice = ("family", "semicircular")


class SemicircularSingle(Body):
    """A half cylinder with one long cavity: length, radius, wall, ..."""

    _choice = ("family", "semicircular_single")


class BisectedCircle(Body):
    """A tube that a wall divides into two cavities: length, radius, wall, divider, ..."""

    _choice = ("family", "bisected_circle")


class Rectangular(Body):
    """A bar with a row of cavities under one flat roof: chambers, width, height, roof, ..."""

    _choice = ("family", "rectangular")


class BodyFile(Body):
    """A body of a CAD, mesh or surface file: file (from the working folder), clamp, tip, cavity, ..."""

    _choice = ("family", "own")


class Material(Description):
    """A law of the material and its constants; density as well, such as density="1130 kg/m^3"."""


class NamedRubber(Material):
    """A rubber with known constants: NamedRubber("dragon_skin_30")."""

    def __init__(self, name: str, **values: Setting) -> None:
        self.values = MappingProxyType({"name": name, **dict(given_settings(values, str))})

    def __repr__(self) -> str:
        return f"NamedRubber({', '.join(f'{key}={value!r}' for key, value in self.values.items())})"


class StVenantKirchhoff(Material):
    """E and nu: the law of the paper, for stretches from 0.91 to 1.10."""

    _choice = ("law", "svk")


class Hencky(Material):
    """E and nu, with logarithmic strains."""

    _choice = ("law", "hencky")


class NeoHooke(Material):
    """mu, with kappa or nu."""

    _choice = ("law", "neo_hooke")


class MooneyRivlin(Material):
    """c10 and c01, with kappa or nu."""

    _choice = ("law", "mooney_rivlin")


class Yeoh(Material):
    """c10, c20 and c30, with kappa or nu."""

    _choice = ("law", "yeoh")


class Ogden(Material):
    """Lists mu and alpha, with kappa or nu."""

    _choice = ("law", "ogden")
