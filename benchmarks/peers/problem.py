"""The problem that every solver solves, and the form of its results.

The gapped arm of `tests/data/t2_coarse.msh`, clamped at its face `clamp`, with u_z = 0 in its plane of symmetry and a
follower pressure in its cavity; St. Venant-Kirchhoff, quadratic tetrahedra with four points, no contact.
"""

import argparse
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from time import perf_counter

import numpy as np
import scipy.sparse as sp

from geometry import Mesh

E, NU = 1.2, 0.495  #: MPa
LAMBDA, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))  #: MPa
KPA = 1e-3  #: MPa
TOLERANCE = 1e-6  #: of the residual, relative
#: targets of a path: the four pressures, or the last one alone, kPa
PATHS = {"four": (5.0, 17.0, 31.0, 45.0), "straight": (45.0,)}
MESH = Path(__file__).resolve().parents[2] / "tests" / "data" / "t2_coarse.msh"

#: pressure (kPa): mean of u_x and u_y over the nodes of the face `tip` (mm), volume of the half cavity (mm3); NGSolve
#: 6.2.2608 and an independent prototype, which agree to eight digits (the numbers of tests/fem/test_equilibrium.py)
REFERENCE = {
    5.0: (-0.33955159, -11.09217995, 3705.51217),
    17.0: (-5.82325979, -33.76011515, 4019.35991),
    31.0: (-16.85604783, -53.30012655, 4360.59968),
    45.0: (-29.70720306, -66.67194967, 4694.81889),
}


def triangle_rule() -> tuple[np.ndarray, np.ndarray]:
    """Barycentric points (6, 3) and weights (6,) of the reference triangle's rule of degree four (Dunavant 1985)."""
    inner = [[1 - 2 * a, a, a] for a in (0.091576213509771, 0.445948490915965)]
    points = np.array([np.roll(point, k) for point in inner for k in range(3)])
    return points, np.repeat([0.109951743655322, 0.223381589678011], 3) / 2


@dataclass(frozen=True)
class Body:
    """The mesh as quadratic tetrahedra, for the peers that do not make their own nodes."""

    mesh: Mesh

    @classmethod
    def read(cls) -> "Body":
        """The reference arm."""
        return cls(Mesh.read(MESH))

    @cached_property
    def points(self) -> np.ndarray:
        """(n, 3) vertices, then middles of the edges, mm."""
        return np.vstack([self.mesh.points, self.mesh.points[self.mesh.edges].mean(axis=1)])

    @cached_property
    def cells(self) -> np.ndarray:
        """(m, 10) nodes of the tetrahedra."""
        return self.quadratic(self.mesh.tets)

    def quadratic(self, corners: np.ndarray) -> np.ndarray:
        """Vertices (k, 3 or 4), then the middles of the edges 01, 12, 20 (, 03, 13, 23): VTK's and Abaqus' order."""
        pairs = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]][: 3 * (corners.shape[1] - 2)]
        ends, count = np.sort(corners[:, pairs], axis=2), len(self.mesh.points)
        edge = np.searchsorted(self.mesh.edges @ [count, 1], ends @ [count, 1])
        return np.hstack([corners, count + edge])

    def nodes(self, name: str) -> np.ndarray:
        """(k,) nodes of a named face."""
        return np.unique(self.quadratic(self.mesh.faces[name]))

    @property
    def fixed(self) -> np.ndarray:
        """(n, 3) components that are fixed."""
        fixed = np.zeros(self.points.shape, dtype=bool)
        fixed[self.nodes("clamp")] = True
        fixed[self.nodes("sym"), 2] = True
        return fixed

    def answer(self, displacement: np.ndarray) -> tuple[float, float, float]:
        """What is compared: mean (u_x, u_y) of the tip face (mm) and volume of the half cavity (mm3) for (n, 3) mm."""
        tip = displacement[self.nodes("tip")].mean(axis=0)
        return float(tip[0]), float(tip[1]), self.volume(displacement)

    def volume(self, displacement: np.ndarray) -> float:
        """Volume between the cavity's faces and the plane of symmetry, mm3: -1/3 int x . n dA."""
        b, weight = triangle_rule()
        x = (self.points + displacement)[self.quadratic(self.mesh.faces["cavity"])]
        ends, middles = [0, 1, 2], [[0, 1], [1, 2], [2, 0]]
        shape = np.hstack([b * (2 * b - 1), 4 * b[:, middles].prod(axis=2)])
        slope = np.zeros((len(b), 6, 3))  # by the three barycentric coordinates
        slope[:, ends, ends] = 4 * b - 1
        for k, (i, j) in enumerate(middles):
            slope[:, 3 + k, i], slope[:, 3 + k, j] = 4 * b[:, j], 4 * b[:, i]
        along = slope[..., 1:] - slope[..., :1]
        tangent = np.einsum("fac,qad->fqcd", x, along)
        normal = np.cross(tangent[..., 0], tangent[..., 1])
        return -float(np.einsum("q,qa,fac,fqc->", weight, shape, x, normal)) / 3


@dataclass
class Clock:
    """Seconds of this process and of those it started, CPU and wall."""

    cpu: float
    wall: float

    @classmethod
    def now(cls) -> "Clock":
        used = os.times()
        return cls(used.user + used.system + used.children_user + used.children_system, perf_counter())


@dataclass(frozen=True)
class Outcome:
    """The results of a peer and their cost."""

    package: str  #: name and version
    solver: str  #: what factorizes
    answers: dict[str, tuple[float, float, float]]  #: pressure in kPa: u_x, u_y (mm), volume (mm3)
    increments: int  #: converged ones
    failed: int  #: attempts that failed
    factorizations: int  #: failed attempts included
    set_up_cpu: float  #: s before the first increment: imports, mesh, spaces, compiling; from the start of the process
    solve_cpu: float  #: s
    solve_wall: float  #: s
    threads: int = 1  #: that used the processor on the way
    note: str = ""  #: why the path ended early; empty when it did not


def thread_seconds() -> dict[str, float]:
    """CPU seconds of each thread of this process so far, by its number; empty where the system does not say."""
    tick = os.sysconf("SC_CLK_TCK")
    seconds = {}
    for stat in Path("/proc/self/task").glob("*/stat"):
        fields = stat.read_text().rpartition(")")[2].split()  # user and system ticks are numbers 14 and 15 (proc(5))
        seconds[stat.parent.name] = (int(fields[11]) + int(fields[12])) / tick
    return seconds


def busy_threads(before: dict[str, float], after: dict[str, float]) -> int:
    """Threads that used more than a hundredth of the CPU between two calls of `thread_seconds`, at least one."""
    spent = {thread: seconds - before.get(thread, 0.0) for thread, seconds in after.items()}
    total = sum(spent.values())
    return max(1, sum(seconds > 0.01 * total for seconds in spent.values()))


@dataclass(frozen=True)
class PathResult:
    """The way to the last pressure."""

    answers: dict[float, tuple[float, float, float]]
    increments: int
    failed: int
    factorizations: int
    note: str = ""


def load_pardiso() -> None:
    """Load the MKL, which is nobody's path: 0.25 s of CPU."""
    from pypardiso import PyPardisoSolver

    PyPardisoSolver().solve(sp.eye(2, format="csr"), np.ones(2))


def report(package: str, solver: str, set_up: Callable[[], Callable[[Sequence[float]], PathResult]]) -> None:
    """Set up, solve and write the outcome where the command line says.

    set_up: makes everything that does not depend on the path and returns what walks it, given the pressures in kPa.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("path", choices=PATHS)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    walk = set_up()
    threads, begin = thread_seconds(), Clock.now()
    path = walk(PATHS[options.path])
    end = Clock.now()
    outcome = Outcome(
        package=package,
        solver=solver,
        answers={f"{pressure:g}": answer for pressure, answer in path.answers.items()},
        increments=path.increments,
        failed=path.failed,
        factorizations=path.factorizations,
        set_up_cpu=begin.cpu,
        solve_cpu=end.cpu - begin.cpu,
        solve_wall=end.wall - begin.wall,
        threads=busy_threads(threads, thread_seconds()),
        note=path.note,
    )
    options.out.write_text(json.dumps(asdict(outcome), indent=1), encoding="utf-8")
