"""Rods beyond the loads at which they buckle, by name: each falls to a stable shape, or says where it snaps through."""

import math
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from rod import FiveParameters, PointLoad, Rod, RodSolution, RodWarning, SpatialSolution
from rod.weight import WEIGHT_OF_GRAM, Mass
from tests.rod.arm_law.test_spatial import GJ, B, straight
from tests.rod.arm_law.test_spatial import LENGTH as DEEP

EI, LENGTH = 140.0, 90.0
COLUMN = Rod(LENGTH, 0.0, FiveParameters(EI, EI, 0.0, 0.0, 9.0))
#: S. P. Timoshenko and J. M. Gere, "Theory of Elastic Stability", 2.1 and 6.3; A. G. Greenhill (1881): first zero of
#: J_(-1/3)
EULER, GREENHILL, LATERAL = math.pi**2 * EI / (4.0 * LENGTH**2), 7.837347, 4.013 * math.sqrt(B * GJ) / DEEP**2

Shape = RodSolution | SpatialSolution


def column(part: float) -> Shape:
    """Pushed along itself by a part of Euler's load."""
    return COLUMN.solve(force=(-part * EULER, 0.0))


def standing(part: float) -> Shape:
    """A column with a part of the weight of Greenhill."""
    grams = part * GREENHILL * EI / LENGTH**2 / WEIGHT_OF_GRAM
    return replace(COLUMN, mass=Mass.even(LENGTH, grams)).solve(direction="standing")


def shortened(part: float) -> Shape:
    """A column whose end is held at a part of its length."""
    return COLUMN.solve(end=(part * LENGTH, 0.0))


def strip(part: float) -> Shape:
    """A deep strip under a part of the force at which it buckles sideways."""
    return Rod(DEEP, law=straight()).solve(force=(0.0, part * LATERAL, 0.0))


def arch(part: float) -> Shape:
    """Pushed down by a part of 200 EI / l^2 in its middle, with its end held."""
    arch, force = replace(COLUMN, kappa_0=-3.0 / LENGTH, theta0=1.5), (0.0, -200.0 * part * EI / LENGTH**2)
    return arch.solve(end=(0.6 * LENGTH, 0.0), along=[PointLoad(40.0, force)])


RODS: dict[str, Callable[[float], Shape]] = {one.__name__: one for one in (column, standing, shortened, strip, arch)}


def fallen(name: str, part: float, of: str = "end") -> tuple[Shape, Array]:
    """The shape to which a rod falls; sizes of the coordinates of its end over l, or of its force over EI/l^2."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RodWarning)
        shape = RODS[name](part)
    assert "This is the stable shape to which it falls" in " ".join(shape.notes)
    length = float(shape.s[-1])
    return shape, np.abs(shape.end) / length if of == "end" else np.abs(shape.force) * length**2 / EI
