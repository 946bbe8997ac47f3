"""Small bodies made of bricks, each brick of six tetrahedra, for the tests of `fem`."""

from collections.abc import Sequence
from itertools import permutations
from pathlib import Path

import numpy as np

from fem.elements import ELEMENTS
from geometry import Design, Mesh
from geometry.arrays import Array, Mask

Grid = Mask

#: those with quadratic displacements, which bend on coarse meshes
QUADRATIC = tuple(name for name, element in ELEMENTS.items() if element.quadratic)

DATA = Path(__file__).resolve().parent / "data"

#: the six tetrahedra of a brick: one for each order in which its corners are walked along the axes
WALKS = [
    np.cumsum([(0, 0, 0), *(np.eye(3, dtype=int)[axis] for axis in order)], axis=0) for order in permutations(range(3))
]


def bricks(filled: Grid, lines: Sequence[Array]) -> Mesh:
    """The filled cells (i, j, k) of the grid whose lines stand at the given x, y and z, without named faces."""
    counts = [line.shape[0] for line in lines]
    number = np.arange(np.prod(counts)).reshape(counts)
    points = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.argwhere(filled)
    tets = [number[tuple((cells[:, None, :] + walk).transpose(2, 0, 1))] for walk in WALKS]
    return Mesh(points, np.concatenate(tets), {})


def named(mesh: Mesh, **where: Array) -> Mesh:
    """The mesh with names for the boundary triangles that `where` marks, (k,) bool in the order of `mesh.boundary`."""
    return Mesh(mesh.points, mesh.tets, {name: mesh.boundary[marked] for name, marked in where.items()})


def on_plane(mesh: Mesh, axis: int, value: float) -> Array:
    """Which boundary triangles (k,) lie in the plane x[axis] = value."""
    return np.asarray(np.isclose(mesh.points[mesh.boundary][..., axis], value).all(axis=1))


def box(counts: tuple[int, int, int], sides: tuple[float, float, float]) -> Mesh:
    """A box from the origin with the faces left, right (x), bottom, top (y), back and front (z)."""
    mesh = bricks(
        np.ones(counts, dtype=bool), [np.linspace(0, side, n + 1) for side, n in zip(sides, counts, strict=True)]
    )
    ends = {}
    for axis, names in enumerate((("left", "right"), ("bottom", "top"), ("back", "front"))):
        ends |= {name: on_plane(mesh, axis, value) for name, value in zip(names, (0.0, sides[axis]), strict=True)}
    return named(mesh, **ends)


def hollow_box(half: bool, parts: int = 1) -> Mesh:
    """A box of 3 x 3 x 3 mm with a cavity of 1 mm in its middle, faces clamp (x = 0), cavity and, for the half, sym.

    Every brick of it is cut into `parts` along each axis.
    """
    filled = np.ones((3, 3, 3), dtype=bool)
    filled[1, 1, 1] = False
    steps = np.arange(4.0)
    lines = [steps, steps, np.array([0.0, 0.5, 1.5]) if half else steps]
    lines = [np.interp(np.arange(parts * (len(line) - 1) + 1) / parts, np.arange(len(line)), line) for line in lines]
    filled = filled[..., 1:] if half else filled
    for axis in range(3):
        filled = np.repeat(filled, parts, axis)
    mesh = bricks(filled, lines)
    middle = mesh.points[mesh.boundary].mean(axis=1) - [1.5, 1.5, 0.0 if half else 1.5]
    faces = {"clamp": on_plane(mesh, 0, 0.0), "cavity": np.abs(middle).max(axis=1) < 0.6}
    if half:
        faces |= {"sym": on_plane(mesh, 2, 0.0)}
        faces["cavity"] &= ~faces["sym"]
    return named(mesh, **faces)


def fork(gap: float, length: float = 6.0, layers: int = 3) -> Mesh:
    """Two prongs of 1 mm along x, `gap` mm apart in y, joined at x < 1.

    Faces: clamp (x = 0), prongs (what looks into the gap), above and below.
    """
    filled = np.ones((layers + 1, 3, 1), dtype=bool)
    filled[1:, 1] = False
    x = np.concatenate([[0.0], np.linspace(1.0, length, layers + 1)])
    mesh = bricks(filled, [x, np.array([0.0, 1.0, 1.0 + gap, 2.0 + gap]), np.array([0.0, 1.0])])
    inner = on_plane(mesh, 1, 1.0) | on_plane(mesh, 1, 1.0 + gap) | on_plane(mesh, 0, 1.0)
    above = on_plane(mesh, 1, 2.0 + gap) & (mesh.points[mesh.boundary][..., 0].min(axis=1) > 0.99)
    below = on_plane(mesh, 1, 0.0) & (mesh.points[mesh.boundary][..., 0].min(axis=1) > 0.99)
    return named(mesh, clamp=on_plane(mesh, 0, 0.0), prongs=inner, above=above, below=below)


def cell_boundaries(design: Design) -> Array:
    """Positions x (k,) of the planes between the cells of a drawn body, mm: as many cells as fit, centred."""
    count = int(design.length / design.pitch)
    return design.length / 2 + design.pitch * (np.arange(count + 1) - count / 2)


def inside(mesh: Mesh, low: float, high: float) -> tuple[Array, np.ndarray]:
    """Points and tetrahedra between two planes x = const, the points sorted by position and numbered anew."""
    centre = mesh.points[mesh.tets][:, :, 0].mean(axis=1)
    tets = mesh.tets[(centre > low) & (centre < high)]
    used = np.unique(tets)
    points = mesh.points[used] - [low, 0, 0]
    order = np.lexsort(np.round(points, 6).T)
    rank = np.empty(len(mesh.points), dtype=int)
    rank[used[order]] = np.arange(len(used))
    return points[order], rank[tets]


def reference_arm() -> Mesh:
    """The mesh on which other finite element codes solved experiment II (`tests/verification`)."""
    return Mesh.read(DATA / "t2_coarse.msh")


def difference(function, x: Array, direction: Array, step: float):
    """Derivative of function along direction at x by a central difference of fourth order."""
    near = function(x + step * direction) - function(x - step * direction)
    far = function(x + 2 * step * direction) - function(x - 2 * step * direction)
    return (8 * near - far) / (12 * step)
