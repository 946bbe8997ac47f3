"""A piece of a periodic body under pressure and pure bending, up to a plane of mirror symmetry.

A body made of cells that are symmetric about their own middle stays so under pressure and a constant moment: the planes
between half cells stay planes. The half cell between two of them, or an end of the body and some half cells, then
stands for the whole body. The plane at the end of the piece contains the direction z; its positions are

    x = c n + eta e2 + zeta e3,   n = (cos phi, sin phi, 0),   e2 = (-sin phi, cos phi, 0),

with the angle phi prescribed and the distance c an unknown, so that no axial force acts. Newton's equations are those
of `fem.equations`, with the constraints of one angle after the other.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar, final

import numpy as np

from fem.cell.air import AirPressure
from fem.cell.boundary import BOUNDARY_NAMES, UPRIGHT, Boundary, supports_of
from fem.cell.mirror_contact import MirrorContact, gap_and_touch, tightened
from fem.discretisation import Discretisation
from fem.effects.contact import SelfContact
from fem.effects.effect import Effect, Terms, near_pairs, settled, stressed
from fem.effects.loads import PressureTerm
from fem.effects.membrane import StrainLimitingLayer
from fem.effects.mirror_layer import MirroredLayer
from fem.equations.constraints import Constraints
from fem.equations.formulation import Formulation
from fem.equations.linearised import Linearised
from fem.equations.pardiso import available_solver
from fem.equations.state import Assembly, State
from fem.equations.system import System
from fem.materials.regions import Solid, laws_of
from fem.path.control import Control, LoadControl, VolumeControl
from fem.path.newton import NewtonOptions, Start, StepFailed, solve
from fem.post.extremes import extremes_of
from fem.reasons import FailedForReasons
from fem.solution import Extremes
from fem.supports import Line, Support, nodes_at
from geometry import Body, Reason, Values
from geometry.arrays import Array, Index

Value = TypeVar("Value")

#: results that a piece keeps
KEPT = 12
#: how often the way between two states is halved where Newton's method does not converge
MAX_HALVINGS = 6
#: iterations after which a predicted state is given up: where walls meet on the way, it takes up to eleven
PREDICTED_ITERATIONS = 12
#: air over that at rest of a swollen piece
SWOLLEN = 2.5
#: rad, difference of angles of one and the same state
SAME_ANGLE = 1e-12
#: Newton's tolerance, finer than that of a load path: slopes of the moment are taken of the states
OPTIONS = NewtonOptions(tolerance=1e-6, reuses=True)
#: largest number of iterations with a limited strain at a pressure near a predicted state: of 142 attempts at a swollen
#: cell those that led anywhere had at most 2. With a prescribed volume a thin sheet takes more where it kinks
LIMITED = 2
#: relative residual of states that only lead to others
ROUGH = 1e-4


class PieceFailed(FailedForReasons):
    """No equilibrium was reached; the first reason tells at which pressure and curvature."""


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class PieceState:
    """Equilibrium of a piece at one pressure and one angle of its plane. Moments are those of the whole body."""

    pressure: float  #: MPa
    angle: float  #: rad, of the plane at the end
    moment: float  #: N mm, that turns the plane, about z; positive towards larger angles
    distance: float  #: c, mm
    gap: float  #: smallest gap between walls, or between a wall and its mirror image, mm; infinity without contact
    touches: bool  #: whether walls are within the activation distance
    extremes: Extremes
    factorizations: int  #: spent on the way to this state
    negative_pivots: int  #: number of unstable directions at this angle under this pressure
    state: State = field(repr=False)
    terms: Terms = field(repr=False)


@final
class BendingPiece:
    """Equations of a piece, kept from one state to the next.

    body: its face `tip` is the plane of mirror symmetry, at rest x = length. pressures: by the name of a cavity, its
    pressure over that of the state. dhat: activation distance of contact on the face `gap` in mm, None for no contact.
    supports, effects: further ones.
    """

    def __init__(
        self,
        body: Body,
        material: Solid,
        start: Boundary,
        formulation: str = "p2p0",
        pressures: Mapping[str, float] | None = None,
        dhat: float | None = None,
        supports: Sequence[Support] = (),
        effects: Sequence[Effect] = (),
    ) -> None:
        self.body = body
        self.material = material
        self.start = start
        self.supports = tuple(supports)
        self.space = Discretisation.of(body.mesh, formulation)
        given = {body.cavities[0]: 1.0} if pressures is None else pressures
        acting: list[Effect] = [AirPressure(name, value) for name, value in given.items() if value]
        if dhat is not None and "gap" in body.mesh.faces:
            acting.append(MirrorContact("gap", "tip", dhat))
            acting.append(SelfContact("gap", dhat, starts_inactive=True, near=np.inf))
        layers = [effect for effect in effects if isinstance(effect, StrainLimitingLayer)]
        acting += [MirroredLayer(layer, plane) for layer in layers for plane in UPRIGHT[start]]
        self.terms = tuple(effect.bind(self.space, laws_of(material)[""]) for effect in (*acting, *effects))
        self._constraints: tuple[float, Constraints] | None = None  #: of the last angle
        self._system = System(self.space, material, self.terms, self.constraints(0.0), available_solver()())
        # all of outer walls: where those of cavities do not meet, a state does not depend on those before, bit for bit
        self._system.storage.enlarge(*near_pairs(self.terms, self.space.points))
        self._other_systems: dict[str, System] = {}  #: by what they are for
        self._formulation = self._system.formulation
        self.changes: Mapping[str, Any] = {}  #: `DesignChange` by parameter of which its states give derivatives
        #: MPa, at which the body snaps whose form after that is wanted (`fem.cell.inflation`); 0: that from rest is
        self.after_snap = 0.0
        self.other = ""  #: the cavity by whose own pressure its states give derivatives as well; empty: none
        #: the last equilibrium and its assembly, which its slopes need again
        self._latest: tuple[State, Assembly] | None = None
        self._kept: dict[Hashable, tuple[Any, int]] = {}  #: by what it is: a result, and its factorizations
        self._repeated = 0  #: factorizations of results that were asked for again

    @property
    def system(self) -> System:
        """The equations, with the constraints of the angle last solved for."""
        return self._system

    @property
    def factorizations(self) -> int:
        """Factorizations of all states and slopes so far, those of attempts without equilibrium included.

        Those of a kept result count each time it is used: numbers do not depend on which process did what before.
        """
        systems = (self._system, *self._other_systems.values())
        return sum(system.solver.times.factorizations for system in systems) + self._repeated

    def kept(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """What was made of this piece under this key before, or what is made now; the latest results are kept."""
        if key in self._kept:
            value, spent = self._kept[key] = self._kept.pop(key)
            self.count_again(spent)
        else:
            before = self.factorizations
            value = make()
            self._kept[key] = value, self.factorizations - before
            if len(self._kept) > KEPT:
                del self._kept[next(iter(self._kept))]
        result: Value = value
        return result

    def count_again(self, factorizations: int) -> None:
        """Count the factorizations of a result that is used again."""
        self._repeated += factorizations

    @property
    def name(self) -> str:
        """Name of the piece in sentences."""
        return BOUNDARY_NAMES[self.start]

    @property
    def whole(self) -> float:
        """Forces of the whole body over those of the meshed part."""
        return 2.0 if self.body.half else 1.0

    @cached_property
    def air(self) -> VolumeControl:
        """The air of the meshed part at rest, each cavity times its part of the pressure: -dPi/dp."""
        loads = tuple(term for term in self.terms if isinstance(term, PressureTerm))
        return VolumeControl.behind(self._system, loads)

    def volume(self, state: State) -> float:
        """Air of the whole body in a state, weighted as in `air`, mm3."""
        return self.whole * self.air.volume(self.space.points + state.displacement)

    def is_swollen(self, volume: float) -> bool:
        """Whether its walls stretch far more than they turn with that air of the whole body in mm3."""
        return self.air.value > 0.0 and volume > SWOLLEN * self.whole * self.air.value

    @cached_property
    def plane(self) -> Index:
        """Nodes (k,) of the plane at the end."""
        return self.space.surface("tip").unique_nodes

    @cached_property
    def curve(self) -> Index:
        """Nodes (m,) of the material curve by increasing x, those in the middle of edges included."""
        return nodes_at(Line(self.body.mesh.points[self.body.curve_vertices]), self.space)

    def rest(self) -> PieceState:
        """The piece without pressure and bending; the same object on each call."""
        return self._rest

    @cached_property
    def _rest(self) -> PieceState:
        x = self.space.points
        state = self._system.rest_state()
        return PieceState(
            0.0,
            0.0,
            0.0,
            self.body.length,
            *gap_and_touch(self.terms, x, self.plane),
            extremes_of(self.space, *self.space.strain_of(state.displacement)),
            0,
            0,
            state,
            self.terms,
        )

    def solve(self, pressure: float, angle: float, start: PieceState, predicted: State | None = None) -> PieceState:
        """Equilibrium at a pressure in MPa and an angle in rad, from another state of this piece.

        Contact is as stiff as there, or stiffer. predicted: where Newton's method is tried first, a state that was
        extrapolated to this pressure and angle. Raises `PieceFailed`.
        """
        if pressure == start.pressure and abs(angle - start.angle) < SAME_ANGLE:
            return replace(start, factorizations=0)
        if predicted is not None:
            with suppress(PieceFailed):
                return self.solve_near(pressure, angle, predicted, start)
        reached, fraction, increment, halvings, spent = start, 0.0, 1.0, 0, 0
        while fraction < 1.0:
            target = min(1.0, fraction + increment)
            p = start.pressure + target * (pressure - start.pressure)
            phi = start.angle + target * (angle - start.angle)
            try:
                reached = self._solve_directly(self._under(p), phi, Start(reached.state, reached.terms))
            except StepFailed as failure:
                halvings += 1
                if halvings > MAX_HALVINGS:
                    raise PieceFailed(self._where(p, phi, pressure), *failure.reasons) from None
                increment /= 2.0
                continue
            fraction = target
            spent += reached.factorizations
        return replace(reached, factorizations=spent)

    def solve_near(
        self,
        pressure: float,
        angle: float,
        predicted: State,
        start: PieceState,
        gives_up: bool = True,
        final: float | None = None,
        rough: float = 0.0,
    ) -> PieceState:
        """Equilibrium at a pressure in MPa and an angle in rad near a predicted state; nothing else is tried.

        start: the state of this piece that it was predicted from, which tells how stiff its contact is. gives_up:
        whether Newton's method ends early, where the tangent is indefinite too. final: MPa, the pressure to which the
        way leads, for the sentence; None for `pressure`. rough: as in `NewtonOptions`. Raises `PieceFailed`.
        """
        iterations = PREDICTED_ITERATIONS if gives_up else None
        try:
            at = Start(predicted, self._stressed(start), iterations, gives_up)
            return self._solve_directly(
                self._under(pressure), angle, at, replace(OPTIONS, limited=LIMITED, rough=rough)
            )
        except StepFailed as failure:
            target = pressure if final is None else final
            raise PieceFailed(self._where(pressure, angle, target), *failure.reasons) from None

    def solve_at_volume(
        self, volume: float, angle: float, predicted: State, start: PieceState, rough: float = 0.0
    ) -> PieceState:
        """Equilibrium at a `volume` of the air in mm3 and an angle in rad near a predicted state, stable or not.

        start, rough: as in `solve_near`. Raises `PieceFailed`.
        """
        try:
            at = Start(predicted, self._stressed(start), PREDICTED_ITERATIONS)
            target = self.air.target(volume / self.whole, 1.0)
            return self._solve_directly(target, angle, at, replace(OPTIONS, rough=rough))
        except StepFailed as failure:
            times = volume / self.volume(self.rest().state)
            values: Values = {"piece": self.name, "times": times, "kappa_per_mm": angle / self.body.length}
            raise PieceFailed(Reason("no_piece_at_volume", values), *failure.reasons) from None

    def _stressed(self, at: PieceState) -> Terms:
        """The terms with the stress of a state: that of a stiff sheet at a predicted one is mostly of its errors."""
        x = self.space.points + at.state.displacement
        return stressed(at.terms, x, np.zeros_like(x))

    def _under(self, pressure: float) -> LoadControl:
        return LoadControl.of(self._system).target(pressure, 1.0)

    def constraints(self, angle: float) -> Constraints:
        """The supports with the plane at an angle in rad, resolved to u = T q + g."""
        if self._constraints is None or self._constraints[0] != angle:
            held = supports_of(self.body, self.space.points[self.curve], self.start, angle)
            self._constraints = angle, Constraints.of([*self.supports, *held], self.space)
        return self._constraints[1]

    def other_system(self, name: str, terms: Terms, constraints: Constraints) -> System:
        """The equations with other terms and constraints; by name, pattern and symbolic analysis are kept as well."""
        if name in self._other_systems:
            self._other_systems[name].replace_body(self.space, self._formulation)
            self._other_systems[name].replace_constraints(constraints)
        else:
            system = System(self.space, self.material, terms, constraints, available_solver()())
            self._other_systems[name] = system
        return self._other_systems[name]

    def varied(self, space: Discretisation, formulation: Formulation) -> "BendingPiece":
        """This piece with its nodes elsewhere, or with other constants of its materials, for `other_system` alone.

        Both share these systems, which are those of the piece that asked for them last.
        """
        piece = copy(self)
        piece.space, piece._formulation = space, formulation
        return piece

    def linearise(self, piece: PieceState, increment: Array) -> tuple[Assembly, Linearised]:
        """Tangent at a state with the constraints of its angle, and its product with an increment (n, 3), mm.

        Raises `fem.equations.linear.SingularMatrix`.
        """
        self._constrain(piece.angle)
        if self._latest is not None and self._latest[0] is piece.state:
            assembly = self._latest[1]
        else:
            assembly = self._system.assemble(piece.state, piece.terms)
        return assembly, self._system.linearise(piece.state, assembly, piece.terms, increment)

    def rotation(self, x: Array) -> Array:
        """Displacement (n, 3) per angle where the nodes of the plane turn about the z axis through the origin and all
        others stay; x (n, 3) are positions in mm."""
        turned = np.zeros_like(x)
        turned[self.plane] = turn(x[self.plane])
        return turned

    def _constrain(self, angle: float) -> None:
        """Bring the equations to the constraints of an angle in rad."""
        constraints = self.constraints(angle)
        if constraints is not self._system.constraints:
            self._system.replace_constraints(constraints)

    def _solve_directly(
        self, control: Control, angle: float, start: Start, options: NewtonOptions = OPTIONS
    ) -> PieceState:
        """By Newton's method, and again with stiffer contact where walls overlap."""
        self._constrain(angle)
        options, spent = replace(options, carries=not self.is_swollen(self.volume(start.state))), 0
        while True:
            converged = solve(start, control, options, lambda iteration, residual: None)
            spent += converged.iterations
            x = self.space.points + converged.state.displacement
            stiffer = tuple(tightened(term, x) for term in start.terms)
            if stiffer == start.terms:
                break
            start = replace(start, state=converged.state, terms=stiffer)
        gradient, self._latest = converged.assembly.gradient, (converged.state, converged.assembly)
        return PieceState(
            converged.state.factor,
            angle,
            self.whole * float(np.vdot(gradient, self.rotation(x))),
            float(x[self.plane[0]] @ (np.cos(angle), np.sin(angle), 0.0)),
            *gap_and_touch(start.terms, x, self.plane),
            extremes_of(self.space, converged.assembly.strain, converged.assembly.jacobian),
            spent,
            converged.negative_pivots,
            converged.state,
            settled(start.terms),
        )

    def where(self, at: PieceState, target: float | None = None) -> Reason:
        """Where a state is, as one that is no equilibrium, has no slopes, or is the last on the way to a pressure, in
        MPa."""
        return self._where(at.pressure, at.angle, at.pressure if target is None else target)

    def _where(self, pressure: float, angle: float, target: float) -> Reason:
        """Where there is no equilibrium; target: MPa, the pressure to which the way led."""
        kPa = {"pressure_kPa": 1000.0 * pressure, "target_kPa": 1000.0 * target}
        return Reason(
            "no_piece_near" if pressure == target else "no_piece_on_the_way",
            {"piece": self.name, "kappa_per_mm": angle / self.body.length, **kPa},
        )


def turn(x: Array) -> Array:
    """e_z x x (k, 3)."""
    return np.stack([-x[:, 1], x[:, 0], np.zeros(x.shape[0])], axis=1)
