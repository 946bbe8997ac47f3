"""How the nodes of a meshed drawing move with its dimensions: the same elements, other shapes.

Each face of a shape gives the nodes on it their velocity along its normal, which is all that the shape of the body
depends on to first order. Along the faces, and inside, each component of the velocity obeys Laplace's equation.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.curved import CurvedEdges
from geometry.errors import DesignError
from geometry.meshing.mirror import Repetition
from geometry.meshing.shapes import Box, Fillet, RoundBar, Shape
from geometry.meshing.solid import Solid

#: distance from a face up to which a node is on it, over the size of what is meshed
ON_FACE = 1e-7
#: smallest part of the largest eigenvalue for a direction in which the faces at a node hold it
HELD = 1e-6
#: disagreement of the faces at a node, over the largest velocity, from which a dimension tears the body apart
TORN = 1e-6
#: smallest volume of a moved element over that before
FLATTENED = 0.2


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Drawing:
    """The end piece and the half cell of an arm as they are meshed."""

    solid: Solid
    middle: float  #: where the end piece ends, mm
    edge: float  #: where the half cell ends, mm


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Movement:
    """Velocity of a meshed end piece and half cell by one dimension, per mm of it."""

    points: Array  #: (n, 3) of the vertices
    middles: Array  #: (k, 3) of the middles of curved edges
    middle: float
    edge: float

    def moved(self, repetition: Repetition, change: float) -> Repetition:
        """The meshed pieces for a change of the dimension in mm."""
        solid = repetition.solid
        curved = CurvedEdges(solid.curved.ends, solid.curved.middles + change * self.middles)
        return replace(
            repetition,
            solid=replace(solid, points=solid.points + change * self.points, curved=curved),
            middle=repetition.middle + change * self.middle,
            edge=repetition.edge + change * self.edge,
        )


def moved(
    repetition: Repetition, known: Mapping[str, Movement | DesignError], changes: Mapping[str, float]
) -> Repetition:
    """The meshed pieces for changes of dimensions in mm.

    Raises `DesignError` for a dimension that nodes cannot follow, and for changes that fold or flatten an element.
    """
    mesh = repetition
    for name, change in changes.items():
        movement = known.get(name, DesignError(name, "nodes cannot follow a change of it"))
        if isinstance(movement, DesignError):
            raise movement
        mesh = movement.moved(mesh, change)
    tets = np.vstack(list(mesh.solid.regions.values()))
    before, after = (_volumes(one.solid.points, tets) for one in (repetition, mesh))
    if np.any(after < FLATTENED * before):
        raise DesignError(tuple(changes), "so large a change would fold elements of the mesh")
    return mesh


def _volumes(points: Array, tets: Index) -> Array:
    """(m,) mm3, negative of folded elements."""
    corners = points[tets]
    return np.asarray(np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0)


def movements(
    repetition: Repetition, drawn: Drawing, changed: Mapping[str, tuple[Drawing, Drawing, float]]
) -> dict[str, Movement | DesignError]:
    """The velocities of a mesh by name of the dimension, or why there is none.

    changed: the drawings with less and with more of the dimension, and their difference in mm.
    """
    mesh = repetition.solid
    size = float(np.ptp(mesh.points, axis=0).max())
    kept: dict[str, tuple[_Held, _Held]] = {}
    failed: dict[str, Movement | DesignError] = {}
    for name, (less, more, step) in changed.items():
        faces = _faces(drawn.solid, less.solid, more.solid, step)
        if faces is None:
            failed[name] = DesignError(name, "a small change of it adds a part to the body, or takes one away")
            continue
        held = [_held(positions, faces, ON_FACE * size) for positions in (mesh.points, mesh.curved.middles)]
        if any(one.disagreement > TORN for one in held):
            failed[name] = DesignError(name, "faces that meet, or lie in one plane, would part with a change of it")
            continue
        kept[name] = held[0], held[1]
    tets = np.vstack(list(mesh.regions.values()))
    velocities = _spread(mesh.points, tets, [of_points for of_points, _ in kept.values()])
    found: dict[str, Movement | DesignError] = {}
    for (name, (_, of_middles)), velocity in zip(kept.items(), velocities, strict=True):
        less, more, step = changed[name]
        rates = [(getattr(more, key) - getattr(less, key)) / step for key in ("middle", "edge")]
        found[name] = Movement(velocity, of_middles.corrected(velocity[mesh.curved.ends].mean(axis=1)), *rates)
    return found | failed


@dataclass(frozen=True)
class _Face:
    """The values of a shape at a dimension, and their rates by it."""

    shape: Shape
    rate: Mapping[str, Array]


def _faces(drawn: Solid, less: Solid, more: Solid, step: float) -> list[_Face] | None:
    """All shapes with their rates; None where they are not the same ones."""
    triples = list(zip(_shapes(drawn), _shapes(less), _shapes(more), strict=False))
    if len({len(list(_shapes(solid))) for solid in (drawn, less, more)}) > 1:
        return None
    if any(type(now) is not type(a) or type(now) is not type(b) for now, a, b in triples):
        return None
    return [_Face(now, _rates(a, b, step)) for now, a, b in triples]


def _shapes(solid: Solid) -> Iterator[Shape]:
    for blocks in solid.material.values():
        for block in blocks:
            yield from block
    for shapes in solid.air.values():
        for shape in shapes:
            yield shape
            yield from shape.fillets if isinstance(shape, Box) else ()


def _rates(less: Shape, more: Shape, step: float) -> dict[str, Array]:
    with np.errstate(invalid="ignore"):  # an infinite height stays where it is
        return {
            name: np.nan_to_num((np.asarray(vars(more)[name], float) - np.asarray(vars(less)[name], float)) / step)
            for name in vars(more)
            if name != "fillets"
        }


@dataclass(frozen=True, eq=False)  # arrays inside
class _Held:
    """What the faces at some positions prescribe: sum of n n^T and of n times the normal velocity."""

    matrix: Array  #: (n, 3, 3)
    right: Array  #: (n, 3)
    disagreement: float  #: of faces at one position, over the largest velocity

    @property
    def free(self) -> tuple[Array, Array]:
        """Directions (n, 3, 3), one in each column, and which of them (n, 3) are free."""
        values, directions = np.linalg.eigh(self.matrix)
        return directions, values <= HELD * np.maximum(values[:, -1:], 1.0)

    @property
    def velocity(self) -> Array:
        """(n, 3) the smallest velocity that the faces allow."""
        return self.corrected(np.zeros_like(self.right))

    def corrected(self, velocity: Array) -> Array:
        """The velocity (n, 3) with the components that the faces prescribe in place of its own."""
        inverse = np.linalg.pinv(self.matrix, rcond=HELD, hermitian=True)
        missing = self.right - np.einsum("nij,nj->ni", self.matrix, velocity)
        return np.asarray(velocity + np.einsum("nij,nj->ni", inverse, missing))


def _held(positions: Array, faces: Sequence[_Face], tolerance: float) -> _Held:
    matrix, right = np.zeros((len(positions), 3, 3)), np.zeros((len(positions), 3))
    prescribed = []
    for face in faces:
        for which, normal, rate in _on_face(face, positions, tolerance):
            np.add.at(matrix, which, normal[:, :, None] * normal[:, None, :])
            np.add.at(right, which, normal * rate[:, None])
            prescribed.append((which, normal, rate))
    held = _Held(matrix, right, 0.0)
    velocity, largest, worst = held.velocity, 0.0, 0.0
    for which, normal, rate in prescribed:
        if len(which):
            worst = max(worst, float(np.abs(np.einsum("ni,ni->n", normal, velocity[which]) - rate).max()))
            largest = max(largest, float(np.abs(rate).max()))
    return replace(held, disagreement=worst / largest if largest else 0.0)


_Prescribed = tuple[Index, Array, Array]  #: positions (k,) on a face, its normals (k, 3) there, and normal velocities


def _on_face(face: _Face, x: Array, tolerance: float) -> Iterator[_Prescribed]:
    """The positions on each face of a shape."""
    shape = face.shape
    if isinstance(shape, Box):
        low, high = np.array(shape.low), np.array(shape.high)
        inside = np.all((x > low - tolerance) & (x < high + tolerance), axis=1)
        for axis in range(3):
            for side, rate in ((low, face.rate["low"]), (high, face.rate["high"])):
                yield _plane(x, inside, axis, side[axis], rate[axis], tolerance)
    elif isinstance(shape, RoundBar):
        yield from _on_bar(shape, face.rate, x, tolerance)
    else:
        yield from _on_fillet(shape, face.rate, x, tolerance)


def _on_bar(bar: RoundBar, rate: Mapping[str, Array], x: Array, tolerance: float) -> Iterator[_Prescribed]:
    away = x[:, 1:] - [bar.centre, 0.0]
    radius = np.linalg.norm(away, axis=1)
    inside = (x[:, 0] > bar.start - tolerance) & (x[:, 0] < bar.end + tolerance) & (radius < bar.radius + tolerance)
    inside &= (x[:, 1] > bar.bottom - tolerance) & (x[:, 1] < bar.top + tolerance) & (x[:, 2] > -tolerance)
    for axis, name in ((0, "start"), (0, "end"), (1, "bottom"), (1, "top")):
        yield _plane(x, inside, axis, getattr(bar, name), rate[name], tolerance)
    yield _plane(x, inside, 2, 0.0, np.zeros(()), tolerance)
    which = np.flatnonzero(inside & (np.abs(radius - bar.radius) < tolerance))
    normal = np.column_stack([np.zeros(len(which)), away[which] / bar.radius])
    yield which, normal, rate["radius"] + normal[:, 1] * rate["centre"]


def _on_fillet(fillet: Fillet, rate: Mapping[str, Array], x: Array, tolerance: float) -> Iterator[_Prescribed]:
    """The arc; the planes beside it are those of other shapes."""
    side, radius = fillet.side, fillet.radius
    away = x[:, :2] - [fillet.x + side * radius, fillet.y + radius]
    inside = (side * away[:, 0] < tolerance) & (away[:, 1] < tolerance)
    inside &= (x[:, 2] > -tolerance) & (x[:, 2] < fillet.end + tolerance)
    which = np.flatnonzero(inside & (np.abs(np.linalg.norm(away, axis=1) - radius) < tolerance))
    normal = np.column_stack([away[which] / radius, np.zeros(len(which))])
    centre = np.array([rate["x"] + side * rate["radius"], rate["y"] + rate["radius"], 0.0])
    yield which, normal, rate["radius"] + normal @ centre


def _plane(x: Array, inside: Mask, axis: int, value: float, rate: Array, tolerance: float) -> _Prescribed:
    which = np.flatnonzero(inside & (np.abs(x[:, axis] - value) < tolerance))
    return which, np.tile(np.eye(3)[axis], (len(which), 1)), np.full(len(which), float(rate))


def _spread(points: Array, tets: Index, held: Sequence[_Held]) -> list[Array]:
    """Velocities (n, 3) of all points; the faces are those of one drawing, so that one factorization serves all."""
    import scipy.sparse.linalg  # here: what only reads a design imports no scipy

    if not held:
        return []
    directions, free = held[0].free
    count = len(points)
    columns = np.cumsum(free.ravel()) - 1
    node, direction = np.nonzero(free)
    basis = scipy.sparse.csr_matrix(
        (
            directions[node, :, direction].ravel(),
            ((3 * node[:, None] + np.arange(3)).ravel(), np.repeat(columns[free.ravel()], 3)),
        ),
        shape=(3 * count, int(free.sum())),
    )
    local, corner = _laplace(points, tets), (np.repeat(tets, 4, axis=1).ravel(), np.tile(tets, (1, 4)).ravel())
    stiffness = scipy.sparse.kron(
        scipy.sparse.csr_matrix((local.ravel(), corner), shape=(count, count)), scipy.sparse.eye(3), format="csr"
    )
    factor = scipy.sparse.linalg.splu((basis.T @ stiffness @ basis).tocsc())
    spread = []
    for one in held:
        prescribed = one.velocity.ravel()
        inner = basis @ factor.solve(-(basis.T @ (stiffness @ prescribed)))
        spread.append((prescribed + inner).reshape(-1, 3))
    return spread


def _laplace(points: Array, tets: Index) -> Array:
    """(m, 4, 4) of linear elements."""
    corners = points[tets]
    jacobian = corners[:, 1:] - corners[:, :1]
    inner = np.linalg.inv(jacobian).transpose(0, 2, 1)  # gradients of the last three barycentric coordinates
    gradients = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    volume = np.abs(np.linalg.det(jacobian)) / 6.0
    return np.asarray(np.einsum("eai,ebi,e->eab", gradients, gradients, volume))
