"""Body families: one module each, and bodies read from files."""

from geometry.families.bisected_circle import BisectedCircle
from geometry.families.design import Design
from geometry.families.pneunet import PneuNet
from geometry.families.rectangular import Rectangular
from geometry.families.semicircular import Semicircular
from geometry.families.semicircular_single import SemicircularSingle

#: The drawn families by the name that a config gives them.
FAMILIES: dict[str, type[Design]] = {
    design.family: design for design in (PneuNet, Semicircular, SemicircularSingle, BisectedCircle, Rectangular)
}

__all__ = ["FAMILIES", "BisectedCircle", "PneuNet", "Rectangular", "Semicircular", "SemicircularSingle"]
