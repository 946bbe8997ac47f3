"""The experiments: how an arm is supported and loaded besides its pressure, and what is measured on it.

I to III are those from which a rod is identified, the fourth puts a force of constant direction on the end.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.effects.effect import Effect
from fem.effects.loads import LineForce
from fem.effects.membrane import StrainLimitingLayer
from fem.effects.mirror_layer import MirroredLayer
from fem.materials.regions import Solid
from fem.model import Model
from fem.path.diagnosis import instability_of
from fem.reasons import Reasons
from fem.solution import Step
from fem.supports import Fixed, Line, Prescribed, Support, nodes_at
from geometry import Body, Centreline
from geometry.arrays import Array
from geometry.centreline import chord_angle

#: names of the experiments
NAMES = ("I", "II", "III", "dead")


@final
@dataclass(frozen=True)
class Experiment:
    """One experiment on a body. Forces, couples and moments are those of the whole body, also where half is meshed.

    I: free, rigid motion removed by three nodal constraints that carry no force; II: clamped at x = 0; III: clamped,
    and u_y, u_x or both of the edge x = l on the material curve prescribed, with a force of constant direction spread
    over that edge along the other axes; dead: clamped, and such a force along both.
    """

    name: str
    body: Body
    supports: tuple[Support, ...]
    edge: Line  #: of the end on the material curve: x = l, y = curve_y, by increasing z
    curve: Line  #: the material curve, by increasing x
    force: tuple[float, float]  #: N, the dead force on the end; zero in I and II and where u_x or u_y is prescribed

    @classmethod
    def of(
        cls,
        name: str,
        body: Body,
        end_y: float | None,
        force: tuple[float, float] = (0.0, 0.0),
        end_x: float | None = None,
    ) -> "Experiment":
        """Experiment "I", "II", "III" or "dead" on `body`.

        end_x, end_y: displacements of the end in III, mm, None for one that is free; force: that of dead, and in III
        along the axes whose displacement is free, N. All are applied in full from the first target on. Raises
        ValueError for other names, and for a force in III along an axis whose displacement is prescribed.
        """
        if name not in NAMES:
            raise ValueError(f"experiment {name!r}: allowed are {', '.join(NAMES)}")
        curve = Line(body.mesh.points[body.curve_vertices])
        edge = Line(body.edge("tip"))
        plane = (Fixed("sym", "z"),) if body.half else ()
        held = {axis: value for axis, value in (("x", end_x), ("y", end_y)) if value is not None}
        if name == "III" and any(component for axis, component in zip("xy", force, strict=True) if axis in held):
            raise ValueError("the end has either a displacement or a force along an axis, not both")
        supports: dict[str, tuple[Support, ...]] = {
            "I": _against_rigid_motion(curve.vertices, body),
            "II": (Fixed("clamp"),),
            "III": (Fixed("clamp"), *(Prescribed(edge, axis, value, ramp=False) for axis, value in held.items())),
            "dead": (Fixed("clamp"),),
        }
        acting = force if name in ("III", "dead") else (0.0, 0.0)
        return cls(name, body, (*plane, *supports[name]), edge, curve, acting)

    def model(self, material: Solid, effects: Sequence[Effect], formulation: str) -> Model:
        """The model of this experiment."""
        layers = [effect for effect in effects if isinstance(effect, StrainLimitingLayer) and self.name != "I"]
        held = [MirroredLayer(layer, "clamp") for layer in layers]  # the slope of layers at the clamp
        acting = [*effects, *held, *self._dead_force()]
        return Model(self.body.mesh, material, list(self.supports), acting, formulation)

    def _dead_force(self) -> list[LineForce]:
        if not any(self.force):
            return []
        fx, fy = (component / self.symmetry_factor for component in self.force)
        return [LineForce(self.edge, (fx, fy, 0.0), ramp=False)]

    @property
    def symmetry_factor(self) -> float:
        """Forces and volumes of the whole body over those of the meshed part: 2 for half a body."""
        return 2.0 if self.body.half else 1.0

    def falls_sideways(self, model: Model, steps: Sequence[Step]) -> list[Reasons]:
        """For each state of half a body, how the whole one falls out of its plane; empty reasons where it does not.

        In its motions that are antisymmetric about z = 0 that plane moves along z alone. One factorization each.
        """
        plane, *others = self.supports
        unmoved = [replace(other, value=0.0) if isinstance(other, Prescribed) else other for other in others]
        system = replace(model, supports=[Fixed(plane.where, "xy"), *unmoved]).system()
        try:
            return [instability_of(system, step) for step in steps]
        finally:
            system.solver.close()

    def centreline(self, step: Step) -> Centreline:
        """The material curve in the state `step`."""
        positions = step.positions[nodes_at(self.curve, step.space)]
        return Centreline(s=self.curve.positions(step.space)[:, 0], x=positions[:, 0], y=positions[:, 1])

    def stretch_of_curve(self, step: Step) -> float:
        """Current length of the material curve over that at rest, out of the plane too."""
        nodes = nodes_at(self.curve, step.space)
        curves = (x[nodes] for x in (step.positions, step.space.points))
        now, rest = (np.linalg.norm(np.diff(curve, axis=0), axis=1).sum() for curve in curves)
        return float(now / rest)

    def end_rotation(self, step: Step) -> float:
        """Mean rotation of the face at x = l about z against that at x = 0, rad; the curve's last part may bulge."""
        rest, now = (x[:, 0] + 1j * x[:, 1] for x in (step.space.points, step.positions))
        faces = (nodes_at(face, step.space) for face in ("tip", "clamp"))
        tip, clamp = (np.vdot(rest[nodes] - rest[nodes].mean(), now[nodes]) for nodes in faces)
        turned, angle = complex(tip * np.conj(clamp)), self.centreline(step).angle
        return chord_angle(turned.real, turned.imag, float(angle[-1] - angle[0]))

    def distance_from_plane(self, step: Step) -> float:
        """Largest distance (mm) of the material curve from the plane z = 0, in which a planar rod lies."""
        return float(np.abs(step.positions[nodes_at(self.curve, step.space), 2]).max())

    def end(self, step: Step) -> Array:
        """Current position (3,) of the curve's end, mm."""
        return np.asarray(step.positions[nodes_at(self.curve.vertices[-1], step.space)[0]])

    def end_force(self, step: Step) -> Array:
        """(2,) force on the end of the whole body, N: in III of the support and the dead force, else the latter."""
        return self._support_force(step) + np.array(self.force)

    def _support_force(self, step: Step) -> Array:
        """(2,) N, of the support of the end on the whole body."""
        return self.symmetry_factor * step.reaction(self.edge)[:2] if self.name == "III" else np.zeros(2)

    def end_couple(self, step: Step) -> float:
        """Moment of the end force about the curve's end, about z, N mm.

        The edge bends across the width, so the force does not pass through the curve exactly.
        """
        nodes = nodes_at(self.edge, step.space)
        lever = step.positions[nodes] - self.end(step)
        force = step.gradient[nodes] if self.name == "III" else np.zeros((len(nodes), 3))
        for dead in self._dead_force():
            force = force + dead.where.nodal_weights(step.space)[:, None] * np.asarray(dead.force)
        return self.symmetry_factor * float(np.sum(lever[:, 0] * force[:, 1] - lever[:, 1] * force[:, 0]))

    def clamp_force(self, step: Step) -> Array:
        """(2,) force of the clamp on the whole body, N; in I that of the nodal constraints, which must vanish."""
        force = step.gradient[:, :2].sum(axis=0) * self.symmetry_factor
        return np.asarray(force - self._support_force(step))

    def clamp_moment(self, step: Step) -> float:
        """Moment of the clamp's forces on the whole body about the curve's start, about z, N mm."""
        force = step.gradient.copy()
        force[nodes_at(self.edge, step.space)] = 0.0
        lever = step.positions - step.positions[nodes_at(self.curve.vertices[0], step.space)[0]]
        return self.symmetry_factor * float(np.sum(lever[:, 0] * force[:, 1] - lever[:, 1] * force[:, 0]))


def _against_rigid_motion(curve: Array, body: Body) -> tuple[Support, ...]:
    """Three constraints that take the rigid motion of half a body, six that take it of a whole one.

    They are in the middle of the curve (k, 3), where the body turns least.
    """
    middle = int(np.argmin(np.abs(curve[:, 0] - body.length / 2)))
    neighbour = int(np.argmin(np.abs(curve[:, 0] - body.length / 2 - body.pitch)))
    in_plane: tuple[Support, ...] = (Fixed(curve[middle], "xy"), Fixed(curve[neighbour], "y"))
    if body.half:
        return in_plane
    return (*in_plane, Fixed(curve[middle], "z"), Fixed(curve[neighbour], "z"), Fixed(body.top, "z"))
