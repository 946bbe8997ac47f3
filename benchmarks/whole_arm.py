"""Finite elements of a whole arm out of its plane: under a force across it, under a couple, and where it buckles.

The planar state is that of half the arm. The way out of the plane begins where both halves stand as that one.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from fem import Experiment, LineForce, Model, NotConverged, follow
from fem.discretisation import Discretisation
from fem.effects.effect import Effect, at_constant_fraction
from fem.effects.loads import DeadForceTerm, Pressure, volume_gradient
from fem.equations.linearised import Linearised
from fem.materials.material import Material
from fem.path.active_set import ActiveSet
from fem.solution import Step
from fem.supports import Fixed, Support, nodes_at
from geometry.arrays import Array
from pipeline.simulate.scene import Scene
from pipeline.values.pressure import in_MPa

#: mirror image at z = 0 of a position, and of a displacement that is antisymmetric
IMAGE, ANTISYMMETRIC = np.array([1.0, 1.0, -1.0]), np.array([-1.0, -1.0, 1.0])
#: mm, largest displacement of a difference of positions
SLIGHT = 1e-4


@dataclass(frozen=True, eq=False)  # arrays inside
class NodalForces(Effect):
    """Forces of constant direction on nodes, (n, 3) in N at load factor 1."""

    force: Array

    def bind(self, space: Discretisation, material: Material) -> DeadForceTerm:
        """The potential of the forces."""
        return DeadForceTerm("nodal_forces", self.force, constant_fraction=None)


def areas_of_end(space: Discretisation) -> Array:
    """(n,) mm2: area of the end face by node."""
    return np.abs(volume_gradient(space.surface("tip"), space.points)[:, 0])


def turn(weights: Array, before: Array, after: Array) -> Rotation:
    """The rotation of points (n, 3) with weights (n,), by least squares."""
    x, y = (points - np.average(points, axis=0, weights=weights) for points in (before, after))
    rows = weights > 0.0
    rotation, _ = Rotation.align_vectors(y[rows], x[rows], weights=weights[rows])
    return rotation


def force_across(experiment: Experiment, space: Discretisation) -> Array:
    """(n, 3) N: a unit force on the whole body along z, spread over the free edge."""
    out = np.zeros_like(space.points)
    weights = experiment.edge.nodal_weights(space) / experiment.symmetry_factor
    np.add.at(out[:, 2], nodes_at(experiment.edge, space), weights)
    return out


def couple(experiment: Experiment, space: Discretisation, x: Array, axis: Array) -> Array:
    """(n, 3) N: forces on the end face of positions x (n, 3) with a unit torque on the whole body about an axis (3,).

    They are as those of a rigid turn: along the axis times the distance from the middle of the face.
    """
    areas = areas_of_end(space)
    middle = areas @ x / areas.sum() * [1.0, 1.0, 0.0]
    around = np.cross(axis, x - middle)
    return np.asarray(areas[:, None] * around / (experiment.symmetry_factor * (areas @ (around**2).sum(axis=1))))


@dataclass(frozen=True, eq=False)  # arrays inside
class PlanarState:
    """Half an arm in equilibrium under its pressure and a dead force in its plane."""

    scene: Scene
    step: Step
    pressure_kPa: float
    effects: tuple[Effect, ...]  #: all in full from the beginning
    force_N: tuple[float, float] = (0.0, 0.0)

    @staticmethod
    def all_of(scene: Scene, pressures_kPa: Sequence[float]) -> Iterator["PlanarState"]:
        """Those of rising pressures without a force, as far as the arm bears them."""
        experiment, last = Experiment.of("II", scene.body, None), pressures_kPa[-1]
        effects = scene.effects(in_MPa(last))
        model = experiment.model(scene.material, effects, scene.config.mesh.formulation)
        parts = [pressure / last for pressure in pressures_kPa]
        for pressure, part, step in zip(pressures_kPa, parts, reached(model, parts, ()), strict=False):
            yield PlanarState(scene, step, pressure, tuple(at_full_pressure(effect, part) for effect in effects))

    def under(self, force_N: tuple[float, float]) -> "PlanarState | None":
        """The same arm under a dead force (x, y) on its end; None where it does not bear it."""
        fx, fy = (0.5 * (new - old) for new, old in zip(force_N, self.force_N, strict=True))
        added = LineForce(self.experiment.edge, (fx, fy, 0.0))
        start = replace(self._begin(self.step), active=(*self.step.active, True), contacts=(*self.step.contacts, None))
        model = self._model(self.experiment, (*self.effects, added))
        steps = reached(model, [0.0, 1.0], [start])[1:]
        effects = (*self.effects, replace(added, ramp=False))
        return PlanarState(self.scene, steps[0], self.pressure_kPa, effects, force_N) if steps else None

    def buckling_force(self, direction: tuple[float, float], guess: float) -> tuple[float, float]:
        """The dead forces (N) in a direction of the plane, at most 1 % apart, between which the arm buckles out of it.

        guess: N, from which they are sought. Raises ValueError where the arm has no planar state under such a force.
        """
        x, y = direction
        low, high, force, stable = 0.0, 0.0, 0.9 * guess, self
        while not high or high - low > 0.01 * high:
            state = stable.under((force * x, force * y))
            if state is None:
                raise ValueError(f"no planar state under {force:g} N")
            if state.across.negative_pivots:
                high = force
            else:
                low, stable = force, state
            force = 0.5 * (low + high) if high else 1.1 * force
        return low, high

    def _begin(self, step: Step) -> Step:
        return replace(step, factor=0.0, rate=None)

    @cached_property
    def experiment(self) -> Experiment:
        """Half of the arm, clamped."""
        return Experiment.of("II", self.scene.body, None)

    @cached_property
    def whole(self) -> Experiment:
        """Both halves, clamped."""
        return Experiment.of("II", self.scene.body.full(), None)

    def _model(self, experiment: Experiment, effects: Sequence[Effect]) -> Model:
        formulation = self.scene.config.mesh.formulation
        return Model(experiment.body.mesh, self.scene.material, list(experiment.supports), list(effects), formulation)

    @cached_property
    def frame(self) -> Array:
        """(3, 3), columns: the directions in which the axes of the end face point."""
        weights = areas_of_end(self.step.space)
        return self._turn(self.step.points, self.step.displacement, IMAGE, weights).as_matrix()

    def _turn(self, x: Array, displacement: Array, sign: Array, weights: Array) -> Rotation:
        """Of nodes with weights (n,) by displacements (n, 3) from x (n, 3); those of the other half are the image times
        a sign."""
        before = np.vstack([x, x * IMAGE])
        after = before + np.vstack([displacement, displacement * sign])
        return turn(np.tile(weights, 2), before, after)

    @cached_property
    def across(self) -> Linearised:
        """The tangent for displacements that are antisymmetric about z = 0, factorized."""
        held: list[Support] = [Fixed("sym", "xy"), Fixed("clamp")]
        mesh, formulation = self.scene.body.mesh, self.scene.config.mesh.formulation
        system = Model(mesh, self.scene.material, held, list(self.effects), formulation).system()
        terms = at_constant_fraction(ActiveSet.of_step(system.terms, self.step).active, 1.0)
        state = system.state_at(self.step.displacement, 1.0)
        return system.linearise(state, system.assemble(state, terms), terms)

    def slight(self, force: Array, section: float) -> dict[str, Any]:
        """What nodal forces (n, 3) on the half, and their antisymmetric image, do to first order, per N or N mm.

        section: mm from the clamp at rest, of a plane of nodes whose turn is told beside that of the end.
        """
        moved = self.across.solve(-force).displacement
        x, end = self.step.positions, nodes_at(self.experiment.curve, self.step.space)[-1]
        size = SLIGHT / float(np.abs(moved).max())
        on_section = np.abs(self.step.points[:, 0] - section) < 1e-6 * section
        planes = {"turn_rad": areas_of_end(self.step.space), "turn_of_section_rad": on_section.astype(float)}
        turns = {name: self._turn(x, size * moved, ANTISYMMETRIC, rows).as_rotvec() for name, rows in planes.items()}
        work = 2.0 * float(np.vdot(force, moved))  # of a unit load on the whole body
        found = {"lift": float(moved[end, 2]), "work": work, "section_mm": section}
        return found | {name: (vector / size).tolist() for name, vector in turns.items()}

    def bent(self, force: Array, parts: Sequence[float]) -> Iterator["Bent"]:
        """The whole arm under rising parts of nodal forces (n, 3), as far as it bears them."""
        model = self._model(self.whole, [*self.effects, NodalForces(force)])
        moved = self.mirrored(model.space)
        start = replace(
            self._begin(self.step),
            space=model.space,
            displacement=moved,
            gradient=np.zeros_like(moved),
            active=(*self.step.active, True),
            contacts=(None,) * (len(self.effects) + 1),
            added_pairs=self.step.added_pairs[:0],
            exact=None,
        )
        for step in reached(model, [0.0, *parts], [start])[1:]:
            yield Bent(self, moved, step, step.factor * force)

    @cached_property
    def space(self) -> Discretisation:
        """Both halves as elements."""
        return Discretisation.of(self.whole.body.mesh, self.scene.config.mesh.formulation)

    def mirrored(self, space: Discretisation) -> Array:
        """(n, 3) mm: the planar displacement of both halves."""
        beyond = space.points[:, 2] < 0.0
        distance, nodes = cKDTree(self.step.points).query(np.where(beyond[:, None], space.points * IMAGE, space.points))
        if distance.max() > 1e-6 * self.scene.body.length:
            raise ValueError("the halves of the arm have different nodes")
        moved = self.step.displacement[nodes]
        return np.where(beyond[:, None], moved * IMAGE, moved)


def at_full_pressure(effect: Effect, part: float) -> Effect:
    """An effect with the part of its pressure that acts, in full from the beginning."""
    if isinstance(effect, Pressure) and effect.ramp:
        return replace(effect, value=part * effect.value, ramp=False)
    return effect


def reached(model: Model, factors: Sequence[float], resume: Sequence[Step]) -> tuple[Step, ...]:
    """As far as the path goes."""
    try:
        return follow(model, factors, resume=resume).steps
    except NotConverged as ended:
        return ended.partial.steps


@dataclass(frozen=True, eq=False)  # arrays inside
class Bent:
    """A whole arm out of its plane."""

    planar: PlanarState
    before: Array  #: (n, 3) mm, the planar displacement
    step: Step
    force: Array  #: (n, 3) N

    def record(self) -> dict[str, Any]:
        """Loads, displacement of the end of the material curve, turn of the end face, and the curve from its start."""
        space, x = self.step.space, self.step.positions
        curve = nodes_at(self.planar.whole.curve, space)
        lever = x - x[curve[-1]]
        return {
            "force_N": self.force.sum(axis=0).tolist(),
            "moment_about_end_N_mm": np.cross(lever, self.force).sum(axis=0).tolist(),
            "moved_mm": (self.step.displacement - self.before)[curve[-1]].tolist(),
            "turn_rad": turn(areas_of_end(space), space.points + self.before, x).as_rotvec().tolist(),
            "s_mm": space.points[curve, 0].tolist(),
            "curve_mm": (x[curve] - space.points[curve[0]]).tolist(),
            "negative_pivots": self.step.negative_pivots,
            "min_gap_mm": min(float(self.step.min_gap), 1e3),
        }
