"""What a piece does next: slopes of moment and stretch by curvature and pressure, axial and shear rigidity.

Equilibrium at the angle phi says that dw . f = 0 for all displacements dw that the plane admits, f the nodal gradient
of the potential. Along a path of angles the plane's nodes turn with it, by e_z x x per angle, and what they admit turns
as well, so that the remaining change T dq solves

    dw . (K (T dq + e_z x x) - e_z x f) = 0      (the vector products at the nodes of the plane alone),

one more right-hand side for the tangent at hand. The moment M = f . (e_z x x) changes accordingly.

Shear. A constant shear force Q makes a moment -Q s, which no plane of symmetry bears; but what is antisymmetric about
the middle of the cell (s = 0) and its moment -Q h at the plane s = h split there into pure bending, known already, and
a part v that is antisymmetric about the plane: v moves only within the plane, as a rigid body, and no normal force
acts; walls in contact with their mirror image move with it, so this contact has no stiffness. In the middle of the cell
only the normal displacement is free. The energy of one pitch P = 2 h then gives the shear rigidity,

    U = P^3 / (24 EI) + P / (2 GA)        for Q = 1.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import nan
from typing import Any, final

import numpy as np

from fem.cell.air import AirPressure
from fem.cell.mirror_contact import is_with_images
from fem.cell.piece import BendingPiece, PieceState, turn
from fem.effects.effect import LoadTerm, Terms
from fem.equations.constraints import Constraints
from fem.equations.linear import SingularMatrix
from fem.equations.linearised import Linearised
from fem.equations.state import Change, State
from fem.equations.system import System
from fem.materials.regions import laws_of
from fem.path.predictor import weighted_sum
from fem.post.mapped import fields_of, moved
from fem.supports import Fixed, Prescribed, SharedPlane, Support
from geometry.arrays import Array, Index

#: largest displacement of a difference of forces, over the size of the piece: the best for central differences
STEP = 1e-6
#: of position, strain and pressure, the shear strains along the axis, whose sign a mirror image changes
SHEARED = (6, 8)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Slopes:
    """Changes of a piece in equilibrium by the angle of its plane (rad) and by the pressure (MPa)."""

    moment: float  #: N mm, of the whole body
    moment_by_angle: float  #: N mm
    moment_by_pressure: float  #: mm3; minus the change of the air by the angle
    volume_by_pressure: float  #: mm3/MPa, change of the air (`BendingPiece.volume`)
    by_angle: Array  #: (n, 3) displacement, mm
    by_pressure: Array  #: (n, 3) mm/MPa
    angle_rate: State = field(repr=False)  #: change of the state by the angle, per rad
    pressure_rate: State = field(repr=False)  #: per MPa
    distance_by_force: float  #: mm/N, of the plane along its normal, by an axial force at a fixed angle
    #: of the unknowns by a unit force on the end of the material curve, along the normal of the plane and within it;
    #: none for a piece without derivatives by the design
    by_end_force: tuple[Change, ...] = field(default=(), repr=False)
    #: by the pressure of the cavity `other` of the piece alone, mm3 and (n, 3) mm/MPa; none without it
    moment_by_other: float = nan
    by_other: Array = field(default_factory=lambda: np.empty((0, 3)))

    @property
    def energy_hessian(self) -> Array:
        """(2, 2) second derivatives of the energy of volume (mm3) and angle (rad), whose first are pressure and moment.

        The tangent bordered by the volume, from its factor: nothing is singular where the pressure has a maximum.
        """
        by_volume, coupled = 1.0 / self.volume_by_pressure, self.moment_by_pressure / self.volume_by_pressure
        by_angle = self.moment_by_angle + self.moment_by_pressure * coupled
        return np.array([[by_volume, coupled], [coupled, by_angle]])

    @property
    def rates_at_volume(self) -> tuple[State, State]:
        """Change of the state by the volume, per mm3 at the angle, and by the angle, per rad at the volume."""
        by_volume = weighted_sum([(1.0 / self.volume_by_pressure, self.pressure_rate)])
        return by_volume, weighted_sum([(1.0, self.angle_rate), (self.moment_by_pressure, by_volume)])


def slopes(piece: BendingPiece, at: PieceState) -> Slopes:
    """The slopes of a piece with an unknown distance of its plane; one factorization.

    Raises `fem.equations.linear.SingularMatrix` at a limit point.
    """
    return piece.kept("slopes at rest", lambda: _slopes(piece, at)) if at is piece.rest() else _slopes(piece, at)


def _slopes(piece: BendingPiece, at: PieceState) -> Slopes:
    x = piece.space.points + at.state.displacement
    turned = piece.rotation(x)
    assembly, tangent = piece.linearise(at, turned)
    reaction = np.zeros_like(x)
    reaction[piece.plane] = turn(assembly.gradient[piece.plane])
    coupling = tangent.coupling
    load = _load_by_pressure(piece, at, at.terms)
    pull = np.zeros_like(x)
    normal = np.array([np.cos(at.angle), np.sin(at.angle), 0.0])
    node = piece.plane[0]
    pull[node] = -normal / piece.whole
    turning = coupling.displacement - reaction, coupling.pressure
    by_angle, by_pressure, by_force = tangent.solve_each([turning, (load, None), (pull, None)])
    forces = [(force, None) for force in _end_forces(piece, at.angle)] if piece.changes else []
    angle_change = by_angle.displacement + turned

    def moment_change(change: Change, displacement: Array, force: float) -> float:
        """Change of the moment with unknowns and whole displacement; force: d f . (e_z x x) at fixed unknowns."""
        work = float(np.vdot(coupling.displacement, change.displacement)) + force
        work += float(np.vdot(coupling.pressure, change.pressure))
        lever = float(np.vdot(assembly.gradient[piece.plane], turn(displacement[piece.plane])))
        return piece.whole * (work + lever)

    other: dict[str, Any] = {}
    if piece.other:
        alone = AirPressure(piece.other, 1.0).bind(piece.space, laws_of(piece.material)[""])
        own = _load_by_pressure(piece, at, (alone,))
        (by_other,) = tangent.solve_each([(own, None)])
        by_own = moment_change(by_other, by_other.displacement, float(np.vdot(own, turned)))
        other = {"moment_by_other": by_own, "by_other": by_other.displacement}
    return Slopes(
        moment=at.moment,
        moment_by_angle=moment_change(by_angle, angle_change, float(np.vdot(coupling.displacement, turned))),
        moment_by_pressure=moment_change(by_pressure, by_pressure.displacement, float(np.vdot(load, turned))),
        volume_by_pressure=-piece.whole * float(np.vdot(load, by_pressure.displacement)),
        by_angle=angle_change,
        by_pressure=by_pressure.displacement,
        angle_rate=piece.system.rate(at.state, assembly, replace(by_angle, displacement=angle_change)),
        pressure_rate=piece.system.rate(at.state, assembly, replace(by_pressure, factor=1.0)),
        distance_by_force=float(by_force.displacement[node] @ normal),
        by_end_force=tuple(tangent.solve_each(forces)) if forces else (),
        **other,
    )


def _end_forces(piece: BendingPiece, angle: float) -> Iterator[Array]:
    """Gradients (n, 3) of unit forces on the end of the material curve, along the normal of the plane and within it."""
    cosine, sine = np.cos(angle), np.sin(angle)
    for direction in ((cosine, sine, 0.0), (-sine, cosine, 0.0)):
        load = np.zeros_like(piece.space.points)
        load[piece.curve[-1]] = -np.array(direction)
        yield load


def continued(piece: BendingPiece, shorter: BendingPiece, at: PieceState, cell: BendingPiece, of: PieceState) -> State:
    """About the state of an end with two half cells more than a shorter one, which go on as those of a cell.

    at, of: states of the shorter end and of the cell at the same pressure. The plane of the shorter end mirrors the
    cell; behind the middle of this image comes the cell once more.
    """
    x, beyond = piece.space.points, piece.space.points[:, 0] - shorter.body.length
    folded = np.column_stack([np.abs(cell.body.length - np.abs(beyond)), x[:, 1:]])
    begun, frame, height = _fields_at(shorter, at, x)
    further, of_cell, height_of_cell = _fields_at(cell, of, folded)
    behind = beyond > cell.body.length
    further[behind, 0] *= -1.0
    further[:, SHEARED] *= np.where((beyond > 0.0) & ~behind, -1.0, 1.0)[:, None]
    further[:, :3] = further[:, :3] @ of_cell
    further[:, 0] = at.distance + np.sign(beyond) * (of.distance - further[:, 0])
    further[:, 1] += height - height_of_cell
    further[:, :3] = further[:, :3] @ frame.T
    part = np.clip(1.0 + beyond / cell.body.length, 0.0, 1.0)[:, None]
    fields = begun + part * (further - begun) - np.pad(x, ((0, 0), (0, 7)))
    if not piece.system.formulation.unknowns:
        return piece.system.state_at(fields[:, :3], at.pressure)
    return moved(piece.system, piece.rest().state, fields, at.pressure)


def _fields_at(piece: BendingPiece, at: PieceState, points: Array) -> tuple[Array, Array, float]:
    """Position, strain and pressure (m, 10) in a state at the nodes nearest to points (m, 3) at rest, the directions of
    the plane in columns (3, 3), its normal first, and the mean height of its nodes along the second, mm."""
    x, cosine, sine = piece.space.points + at.state.displacement, np.cos(at.angle), np.sin(at.angle)
    frame = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    height = float((x[piece.plane] @ frame[:, 1]).mean())
    fields = np.hstack([x, fields_of(piece.space, at.state)[:, 3:]])
    return fields[piece.space.tree.query(points)[1]], frame, height


def shear_rigidity(piece: BendingPiece, at: PieceState, known: Slopes) -> float:
    """GA in N of the whole body for a half cell between two mirror planes; one factorization.

    Raises `fem.equations.linear.SingularMatrix` where the cell is unstable in shear or bending.
    """
    if known.moment_by_angle <= 0.0:
        raise SingularMatrix("the moment falls with the curvature")
    h = piece.body.length
    bending = known.by_angle / known.moment_by_angle  # displacement per moment of the whole body
    moment = -h  # at the plane, for Q = 1
    contact = tuple(term for term in at.terms if is_with_images(term, piece.plane))
    terms = tuple(term for term in at.terms if term not in contact)
    elastic = force_change(piece.system, piece, at, terms, bending)
    closing = _change(piece, at, bending, lambda u: piece.system.loads(u, at.pressure, contact))
    forces = elastic + closing
    middle = piece.space.surface("clamp").unique_nodes
    prescribed = np.zeros_like(bending)
    prescribed[middle, 1:] = -moment * bending[middle, 1:]
    applied = np.zeros_like(bending)
    applied[middle, 0] = -moment * forces[middle, 0]
    along = np.array([-np.sin(at.angle), np.cos(at.angle), 0.0])
    applied[piece.plane[0]] += along / piece.whole
    tangent = _shear_tangent(piece, at, terms, middle, prescribed)
    solved = tangent.solve(tangent.coupling.displacement - applied, tangent.coupling.pressure)
    shear = solved.displacement + prescribed
    force = force_change(piece.system, piece, at, terms, shear) + moment * elastic
    displacement = shear + moment * bending
    # of the body, and of the contact, which only the bending closes; the half cell has a mirror image along x
    energy = float(np.vdot(force, displacement)) + moment**2 * float(np.vdot(closing, bending))
    energy *= piece.whole
    pitch = 2.0 * h
    bent = pitch**3 / (24.0 * known.moment_by_angle * h)
    if energy <= bent:
        raise SingularMatrix("the cell has no stiffness against shear")
    return pitch / 2.0 / (energy - bent)


def _shear_tangent(piece: BendingPiece, at: PieceState, terms: Terms, middle: Index, increment: Array) -> Linearised:
    """The tangent with these terms where the middle of the cell moves along x alone and the plane within itself."""
    space, angle = piece.space, at.angle
    points = space.points[middle]
    column = points[np.abs(points[:, 2]) < 1e-9 * piece.body.length]
    ends = column[[int(np.argmin(column[:, 1])), int(np.argmax(column[:, 1]))]]
    supports: list[Support] = [
        *([Fixed("sym", "z")] if piece.body.half else []),
        Fixed("clamp", "yz"),
        Fixed("tip", "z"),
        *(Prescribed(end, "x", 0.0) for end in ends),
        SharedPlane("tip", (-float(np.sin(angle)), float(np.cos(angle)), 0.0)),
    ]
    system = piece.other_system("shear", terms, Constraints.of(supports, space))
    return system.linearise(at.state, system.assemble(at.state, terms), terms, increment)


def _load_by_pressure(piece: BendingPiece, at: PieceState, terms: Terms) -> Array:
    """Change (n, 3) of the gradient of the terms per MPa; the loads among them are linear in the pressure."""
    system, displacement = piece.system, at.state.displacement
    loads = tuple(term for term in terms if isinstance(term, LoadTerm))
    more = system.loads(displacement, at.pressure + 0.5, loads)
    return more - system.loads(displacement, at.pressure - 0.5, loads)


def force_change(system: System, piece: BendingPiece, at: PieceState, terms: Terms, displacement: Array) -> Array:
    """Change (n, 3) of the gradient of a piece with a displacement (n, 3), to first order, by central differences.

    With mixed elements the pressures follow.
    """
    return _change(piece, at, displacement, lambda u: system.gradient_at(u, at.pressure, terms))


def _change(piece: BendingPiece, at: PieceState, displacement: Array, gradient: Callable[[Array], Array]) -> Array:
    """Change (n, 3) of a gradient by positions with a displacement (n, 3)."""
    step, u = STEP * piece.body.length / float(np.abs(displacement).max()), at.state.displacement
    return np.asarray((gradient(u + step * displacement) - gradient(u - step * displacement)) / (2.0 * step))
