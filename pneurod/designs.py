"""Bodies and materials described in Python, for `pneurod.characterize`: keys as in a configuration, units as texts.

    pneurod.PneuNet(chambers=6, wall="1.2 mm")
    pneurod.NeoHooke(mu="0.1 MPa")

Keys that are left out have the defaults of a configuration (docs/configuration.md). A key that does not exist is a
TypeError; values are checked by `pneurod.characterize`. For the laws of the finite element solver, with numbers in MPa,
see `pneurod.fem`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field

from pipeline.api.described import Body, Material

__all__ = [
    "BisectedCircle",
    "BodyFile",
    "Hencky",
    "MooneyRivlin",
    "NamedRubber",
    "NeoHooke",
    "Ogden",
    "PneuNet",
    "Rectangular",
    "Semicircular",
    "SemicircularSingle",
    "StVenantKirchhoff",
    "Yeoh",
]

#: a point of the file, with units: x, y and z
Point = Sequence[str]


class PneuNet(Body):
    """A pneu-net with gaps between its chambers."""

    choice = ("family", "pneunet")

    chambers: int | None = None
    width: str | None = None
    chamber_length: str | None = None
    gap: str | None = None
    chamber_height: str | None = None
    strip: str | None = None
    base: str | None = None
    wall: str | None = None
    side_wall: str | None = None
    roof: str | None = None
    channel: str | None = None
    fillet: str | None = None
    chamber_lengths: Sequence[str] | None = None
    chamber_heights: Sequence[str] | None = None
    gaps: Sequence[str] | None = None


class Semicircular(Body):
    """A half cylinder with a row of cavities."""

    choice = ("family", "semicircular")

    chambers: int | None = None
    radius: str | None = None
    chamber_length: str | None = None
    partition: str | None = None
    end_wall: str | None = None
    base: str | None = None
    wall: str | None = None
    channel: str | None = None


class SemicircularSingle(Body):
    """A half cylinder with one long cavity."""

    choice = ("family", "semicircular_single")

    length: str | None = None
    radius: str | None = None
    end_wall: str | None = None
    base: str | None = None
    wall: str | None = None


class BisectedCircle(Body):
    """A tube that a wall divides into two cavities."""

    choice = ("family", "bisected_circle")

    length: str | None = None
    radius: str | None = None
    end_wall: str | None = None
    wall: str | None = None
    divider: str | None = None


class Rectangular(Body):
    """A bar with a row of cavities under one flat roof."""

    choice = ("family", "rectangular")

    chambers: int | None = None
    width: str | None = None
    height: str | None = None
    chamber_length: str | None = None
    partition: str | None = None
    end_wall: str | None = None
    base: str | None = None
    side_wall: str | None = None
    roof: str | None = None
    channel: str | None = None


class BodyFile(Body):
    """A body of a CAD, mesh or surface file; which keys a kind of file has is in docs/configuration.md."""

    choice = ("family", "own")

    file: str  #: from the working folder
    curve: str  #: y of the material curve
    clamp: str | None = None
    tip: str | None = None
    air: Mapping[str, Point] | None = None
    cell: str | Mapping[str, str] | None = None  #: a length, or two planes: {"from": "40 mm", "to": "44 mm"}
    unit: str | None = None
    axes: Sequence[str] | Mapping[str, Sequence[float]] | None = None
    middle: str | None = None
    plug: bool | Mapping[str, Point] | None = None
    symmetric: bool | None = None
    unite: bool | None = None
    parts: Mapping[str, Point] | None = None


class NamedRubber(Material):
    """A rubber with known constants: NamedRubber("dragon_skin_30")."""

    name: str = field(kw_only=False)
    kappa: str | None = None
    nu: float | None = None


class StVenantKirchhoff(Material):
    """The law of the paper, for stretches from 0.91 to 1.10."""

    choice = ("law", "svk")

    E: str
    nu: float


class Hencky(Material):
    """The law with logarithmic strains."""

    choice = ("law", "hencky")

    E: str
    nu: float


class Rubber(Material):
    """A law of rubber, with its bulk modulus kappa or Poisson's ratio nu; nu is 0.495 without both."""

    kappa: str | None = None
    nu: float | None = None


class NeoHooke(Rubber):
    """The law with a shear modulus alone."""

    choice = ("law", "neo_hooke")

    mu: str


class MooneyRivlin(Rubber):
    """The law with the first power of both invariants."""

    choice = ("law", "mooney_rivlin")

    c10: str
    c01: str


class Yeoh(Rubber):
    """The law with three powers of the first invariant."""

    choice = ("law", "yeoh")

    c10: str
    c20: str
    c30: str


class Ogden(Rubber):
    """The law with powers of the principal stretches; one entry of each list for a term."""

    choice = ("law", "ogden")

    mu: Sequence[str]
    alpha: Sequence[float]
    form: str | None = None  #: "ogden", or "abaqus" for terms with 2 mu / alpha^2
