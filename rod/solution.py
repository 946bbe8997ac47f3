"""Rods in equilibrium, in their plane and in space, whichever law they follow."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import final

import numpy as np

from geometry.arrays import Array, read_only
from geometry.centreline import END_PART, Centreline, chord_angle
from geometry.told import Printable, listed, placed
from rod.along import Reaction, Triple, reactions_of, resultant
from rod.arm.path import Path
from rod.arm.response import Parameter, Posed, Response, SolvedPath
from rod.arm.stability import Stability, stability_of
from rod.cubics import hermite
from rod.errors import RodError
from rod.load import Load


@dataclass(frozen=True)
class RodSolution(Printable):
    """A rod in equilibrium. All arrays are read-only; kappa at the s = d of five parameters is that beyond d.

    `curve`, `end`, `end_angle` and `positions` are those of the material curve, which finite elements have as well. x,
    y and theta are those of the axis, which follows r' = stretch t + shear n with t = (cos theta, sin theta) and
    n = (-sin theta, cos theta). With five parameters the axis is the material curve; where the rod follows the arm's
    own law, the material curve lies beside the axis.

    The origin is that of the rod's `start`: with the usual start = (0, 0) it is where the material curve is clamped.
    """

    s: Array  #: (n,) mm, rest arc length
    x: Array  #: (n,) mm, of the axis; that of the material curve is curve[:, 0]
    y: Array  #: (n,) mm, of the axis; that of the material curve is curve[:, 1]
    theta: Array  #: (n,) rad, angle of the cross sections' normals; the tangent angle where the rod does not shear
    kappa: Array  #: (n,) 1/mm, rotation per rest length
    moment: Array  #: (n,) N mm
    stretch: Array  #: (n,), 1 on an inextensible rod
    force: Array  #: (2,) N, F_x and F_y on the end s = l
    reactions: tuple[Reaction, ...]  #: of the supports along the arm, in their order, and of that of its end
    weight: Array  #: (2,) N, x and y of the weight of the rod itself
    load_steps: int  #: steps of the load
    path: SolvedPath = field(repr=False)  #: how it was found
    shear: Array | None = field(default=None, repr=False)  #: (n,) slope Q/GA; None: the rod does not shear
    notes: tuple[str, ...] = ()  #: what limits the trust in this shape, a sentence each
    #: (m, 2) mm at s (m,): the material curve beside the axis, along and normal to it; None: it is the axis
    beside: Callable[[Array], Array] | None = field(default=None, repr=False)
    #: (n,) N mm, what bends a rod with two lines: its moment about the neutral axis, less that of its own weight where
    #: nothing else acts; None: a rod with another law
    bending_moment: Array | None = field(default=None, repr=False)

    @property
    def axis(self) -> Array:
        """(n, 2) mm: x and y."""
        return np.column_stack([self.x, self.y])

    @cached_property
    def curve(self) -> Array:
        """(n, 2) mm: x and y of the material curve at `s`, read-only."""
        curve = np.column_stack([self.x, self.y]) if self.beside is None else self.positions(self.s)
        curve.setflags(write=False)
        return curve

    @property
    def end(self) -> tuple[float, float]:
        """x and y of the end of the material curve, mm."""
        x, y = self.curve[-1]
        return float(x), float(y)

    @property
    def told(self) -> dict[str, str]:
        """Place, turn and force of the end, the moment at the clamp, and the weight."""
        return _told(self, {}, f"{self.clamp_moment:.5g} N mm")

    def derivative(self, by: Parameter) -> Response:
        """What one more right-hand side gives: how fast the rod and its force on the end change with a parameter.

        by: a load, `Load(force=(0.0, 1.0))` per newton of it; or two arms, `(law.at(19.9), law.at(20.1))` for the
        change between these pressures. Raises `RodError` for a load off the rod or across its plane.
        """
        return self.path.derivative(by)

    @property
    def clamp_moment(self) -> float:
        """Moment at s = 0 about the clamped end of the material curve, N mm, positive where it raises the curvature.

        moment[0] is that about the axis, which begins beside the clamped end where the rod follows the arm's own law.
        The clamp exerts its negative on the body (`clamp_moment_N_mm` of the finite elements).
        """
        x, y = self.x[0] - self.curve[0, 0], self.y[0] - self.curve[0, 1]
        force = self.force + self.weight + resultant(self.path.load.along, self.s)[:2]
        force += sum((one.force[:2] for one in self.reactions if one.s < self.s[-1]), np.zeros(2))
        return float(self.moment[0] + x * force[1] - y * force[0])

    @property
    def bending_deg(self) -> float:
        """Rotation of the end section from rest, degrees; positive to the side to which the arm bends without load."""
        return float(self.path.bending_deg(self.path.state))

    @property
    def end_angle(self) -> float:
        """Angle of the end of the material curve from the x axis, rad: that of its chord over the last 2 % of its rest
        length.

        `geometry.Centreline.end_angle` has this chord of the finite elements. The angle of the end of the axis is
        theta[-1]; it differs where the material curve ripples beside the axis.
        """
        length = self.s[-1]
        x, y = np.diff(self.positions(np.array([(1.0 - END_PART) * length, length])), axis=0)[0]
        return chord_angle(float(x), float(y), float(self.theta[-1]))

    def positions(self, s: Array) -> Array:
        """(m, 2) mm: x and y of the material curve at the rest arc lengths s (m,).

        The axis is joined by cubic Hermite interpolation with its exact derivatives. Raises `RodError` for an s off
        the rod, or that is no array (m,) of numbers.
        """
        try:
            s = np.asarray(s, float)
        except (TypeError, ValueError):
            s = np.full(1, np.nan)
        if s.ndim != 1 or np.isnan(s).any():
            raise RodError("s is an array (m,) of rest arc lengths in mm, such as [10.0, 20.0].")
        if s.size and (s.min() < -1e-9 * self.s[-1] or s.max() > (1 + 1e-9) * self.s[-1]):
            raise RodError(
                f"The rod goes from s = 0 to {self.s[-1]:g} mm; it has no point at s = {s.min():g} ... {s.max():g}."
            )
        i = np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.s) - 2)
        h = self.s[i + 1] - self.s[i]
        t = (s - self.s[i]) / h
        slip = np.zeros(len(self.s)) if self.shear is None else self.shear
        cosine, sine = np.cos(self.theta), np.sin(self.theta)
        slopes = (self.stretch * cosine - slip * sine, self.stretch * sine + slip * cosine)
        x, y = (
            hermite(t, v[i], v[i + 1], h * slope[i], h * slope[i + 1])
            for v, slope in zip((self.x, self.y), slopes, strict=True)
        )
        if self.beside is not None:
            along, normal = self.beside(s).T
            theta = self.theta[i] + (self.theta[i + 1] - self.theta[i]) * t
            x += along * np.cos(theta) - normal * np.sin(theta)
            y += along * np.sin(theta) + normal * np.cos(theta)
        return np.column_stack([x, y])

    def along(self, curve: Centreline) -> Centreline:
        """The material curve at the nodes of that of finite elements."""
        return Centreline(curve.s, *self.positions(curve.s - curve.s[0]).T)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpatialSolution(Printable):
    """A rod in equilibrium in space. All arrays are read-only; the origin is the clamped end of the material curve.

    Columns of a frame are the normal of the cross section, its direction in the plane of symmetry, and that across it.
    """

    s: Array  #: (n,) mm, rest arc length
    axis: Array  #: (n, 3) mm
    frames: Array  #: (n, 3, 3)
    curvature: Array  #: (n, 3) 1/mm, twist, lateral curvature and curvature in the plane of symmetry
    stretch: Array  #: (n, 3) stretch, shear in the plane of symmetry and across it
    moment: Array  #: (n, 3) N mm, along x, y and z
    force: Array  #: (3,) N, on the end
    reactions: tuple[Reaction, ...]  #: of the supports along the arm, in their order, and of that of its end
    weight: Array  #: (3,) N, of the rod itself
    load_steps: int  #: steps of the load
    notes: tuple[str, ...]  #: what limits the trust in this shape, a sentence each
    #: (n, 2) or (n, 3) mm, of the material curve beside the axis, along the first directions of the frames
    beside: Array
    path: SolvedPath = field(repr=False)  #: how it was found

    @property
    def told(self) -> dict[str, str]:
        """The lines of `RodSolution.told`, with the stability."""
        left = f"{self.stability.lowest:.3f} of the rigidity without load is left in the softest direction"
        turn = {"points along": listed(self.frames[-1, :, 0])}
        return _told(self, turn, listed(self.moment[0], "N mm")) | {"stability": left}

    @cached_property
    def stability(self) -> Stability:
        """Against small motions; the path to this state was stable."""
        return stability_of(self.path)

    def derivative(self, by: Parameter) -> Response:
        """The derivative as of `RodSolution.derivative`; a load may have three components."""
        return self.path.derivative(by)

    @property
    def curve(self) -> Array:
        """(n, 3) mm: the material curve, which finite elements have as well."""
        return np.asarray(self.axis + (self.frames[:, :, : self.beside.shape[1]] @ self.beside[..., None])[..., 0])

    @property
    def bending_deg(self) -> float:
        """Angle of the end section's normal from that at rest, degrees; 0 to 180."""
        return float(self.path.bending_deg(self.path.state))

    @property
    def end(self) -> Triple:
        """x, y and z of the end of the material curve, mm."""
        x, y, z = (float(value) for value in self.curve[-1])
        return x, y, z


def _told(shape: RodSolution | SpatialSolution, turn: dict[str, str], moment: str) -> dict[str, str]:
    weight = {"weight": f"{listed(shape.weight, 'N')}, which the rod carries besides"} if shape.weight.any() else {}
    bends = f"{shape.bending_deg:z.2f}°"
    at_end = {"end": f"{placed(shape.end)} from the clamped end of the curve", "bends by": bends, **turn}
    return {**at_end, "end force": listed(shape.force, "N"), "moment at the clamp": moment, **weight}


def solved_in_space(rod: Posed, path: Path, load: Load, strains: tuple[Array, ...], beside: Array) -> SpatialSolution:
    """An arm in space from the end of its path.

    With curvatures and with stretch and shears (N, 3) at the nodes; beside: (N, 2 or 3) mm, the material curve.
    """
    nodes = path.nodes
    return SpatialSolution(
        s=read_only(nodes.s),
        axis=read_only(nodes.place),
        frames=read_only(nodes.frames),
        curvature=read_only(strains[0]),
        stretch=read_only(strains[1]),
        moment=read_only(nodes.moment),
        force=read_only(nodes.force),
        reactions=reactions_of(load.supports, nodes.reaction),
        weight=read_only(np.array(rod.posed(load)[1].weight) * float(nodes.s[-1])),
        load_steps=path.steps,
        notes=path.notes,
        beside=read_only(beside),
        path=SolvedPath(rod, load, path.chains, in_space=True, fall=path.fall),
    )
