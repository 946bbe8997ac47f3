"""A solid bar that is clamped at one end, under its weight and a dead force on the upper edge of its free face.

Two models: finite elements of half the bar, and a rod. Both take all moduli times a factor c from one path of loads,
because an equilibrium under loads and moduli times c is the same.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, degrees, sin
from typing import NamedTuple, Protocol

import numpy as np
from scipy.interpolate import CubicSpline

import fem
from fem.supports import Line, nodes_at
from geometry import Mesh
from geometry.arrays import Array
from geometry.meshing.mirror import name_faces
from geometry.meshing.shapes import Box
from geometry.meshing.solid import Solid, mesh_solid
from rod import FiveParameters, Load, Rod

#: mm/s2
GRAVITY = 9810.0
#: loads over those of c = 1 at which a bar is solved, so that 1/c may lie between the first and the last
FACTORS = (0.2, 0.35, 0.5, 0.7, 0.9, 1.1, 1.4)


class Tip(NamedTuple):
    """The middle of the free face, from the middle of the clamped one, and the turn of the face."""

    x_mm: float
    y_mm: float
    angle_deg: float


@dataclass(frozen=True)
class Bar:
    """x along it, y up, z across."""

    length: float  #: mm
    height: float  #: mm
    width: float  #: mm
    law: fem.Material
    density: float  #: tonne/mm3


class Model(Protocol):
    """Loads (F_x, F_y) on the edge in N, times a factor together with the weight -> the tip."""

    def tips(self, bar: Bar, force: tuple[float, float], factors: Sequence[float]) -> list[Tip]:
        """At rising factors."""


@dataclass(frozen=True)
class Elements:
    """Finite elements."""

    size: float  #: mm

    def tips(self, bar: Bar, force: tuple[float, float], factors: Sequence[float]) -> list[Tip]:
        """At rising factors."""
        mesh, top = self._mesh(bar)
        edge = Line(top)
        loads: list[fem.Effect] = [fem.Gravity(bar.density, (0.0, -GRAVITY, 0.0))]
        if any(force):
            loads.append(fem.LineForce(edge, (0.5 * force[0], 0.5 * force[1], 0.0)))
        model = fem.Model(mesh, bar.law, [fem.Fixed("clamp"), fem.Fixed("sym", "z")], loads, "mixed")
        middle, upper = np.array([bar.length, 0.0, 0.0]), np.array([bar.length, bar.height / 2.0, 0.0])
        tips = []
        for step in fem.follow(model, factors=list(factors)).steps:
            at, above = (step.positions[nodes_at(point, step.space)[0]] for point in (middle, upper))
            turn = np.arctan2(at[0] - above[0], above[1] - at[1])
            tips.append(Tip(float(at[0]), float(at[1]), degrees(turn)))
        return tips

    def _mesh(self, bar: Bar) -> tuple[Mesh, Array]:
        """Half the bar, and the vertices of its upper edge."""
        up, across = bar.height / 2.0, bar.width / 2.0
        parts = [[Box((0.0, low, 0.0), (bar.length, low + up, across))] for low in (-up, 0.0)]  # a vertex in the middle
        solid = mesh_solid(Solid({"bar": parts}, {}), self.size)
        planes = {"clamp": (0, 0.0), "tip": (0, bar.length), "sym": (2, 0.0)}
        mesh = name_faces(solid.points, solid.regions["bar"], {}, planes)
        on_edge = np.isclose(mesh.points[:, :2], (bar.length, up)).all(axis=1)
        edge = mesh.points[on_edge]
        return mesh, edge[np.argsort(edge[:, 2])]


@dataclass(frozen=True)
class BendingRod:
    """A rod that does not stretch or shear."""

    def tips(self, bar: Bar, force: tuple[float, float], factors: Sequence[float]) -> list[Tip]:
        """At rising factors."""
        mu, nu = bar.law.shear_modulus, bar.law.poisson_ratio
        rigidity = 2.0 * mu * (1.0 + nu) * bar.width * bar.height**3 / 12.0
        weight = bar.density * GRAVITY * bar.width * bar.height
        rod = Rod(bar.length, kappa_0=0.0, law=FiveParameters(rigidity, rigidity, 0.0, 0.0, 0.1 * bar.length))
        turn, tips = 0.0, []
        for factor in factors:
            for _ in range(30):  # the edge turns with the face, which gives the force another lever
                along, up = -0.5 * bar.height * sin(turn), 0.5 * bar.height * cos(turn)
                couple = factor * (along * force[1] - up * force[0])
                shape = rod.under(Load((factor * force[0], factor * force[1]), couple, (0.0, -factor * weight)))
                before, turn = turn, float(shape.end_angle)
                if abs(turn - before) < 1e-9:
                    break
            x, y = shape.end
            tips.append(Tip(float(x), float(y), degrees(turn)))
        return tips


class Response:
    """The tip of a bar under one load over the factor c of all its moduli."""

    def __init__(self, model: Model, bar: Bar, force: tuple[float, float]) -> None:
        self._spline = CubicSpline([0.0, *FACTORS], [(bar.length, 0.0, 0.0), *model.tips(bar, force, FACTORS)])

    def at(self, c: float) -> Tip:
        """Of a bar whose moduli are c times as large; raises ValueError outside the loads that were solved."""
        if not FACTORS[0] <= 1.0 / c <= FACTORS[-1]:
            raise ValueError(f"moduli times {c:g} are outside {1.0 / FACTORS[-1]:.2g} to {1.0 / FACTORS[0]:.2g}")
        return Tip(*(float(value) for value in self._spline(1.0 / c)))
