"""FElupe: a solid body and a pressure as items of its own Newton method, PARDISO.

    python -m benchmarks.peers.by_felupe four out.json

FElupe ships no boundary region for tetrahedra; `face_region` makes one. Its docs recommend `pypardiso.spsolve`; the
symmetric PARDISO below is faster. The step control is `stepping.py`, because FElupe's CutbackPlugin starts
every increment at the last equilibrium.
"""

from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any

import felupe
import numpy as np
import scipy.sparse as sp
from pypardiso import PyPardisoSolver

from benchmarks.peers.problem import KPA, LAMBDA, MU, TOLERANCE, Body, PathResult, load_pardiso, report, triangle_rule
from benchmarks.peers.stepping import STEPPING, NoEquilibrium


class StVenantKirchhoff(felupe.ConstitutiveMaterial):
    """Stress and tangent by hand; felupe.MaterialStrain gives the same in two and a half times the time."""

    def __init__(self) -> None:
        self.x = [np.zeros(0)]

    def _stress(self, F: np.ndarray) -> np.ndarray:
        strain = 0.5 * (np.einsum("kiqc,kjqc->ijqc", F, F) - np.eye(3)[..., None, None])
        spherical = LAMBDA * np.einsum("kkqc->qc", strain)
        return spherical * np.eye(3)[..., None, None] + 2 * MU * strain

    def _gradient(self, x: Sequence[Any]) -> list[Any]:
        """First Piola-Kirchhoff stress, MPa."""
        return [np.einsum("ikqc,kjqc->ijqc", x[0], self._stress(x[0])), x[-1]]

    def _hessian(self, x: Sequence[Any]) -> list[Any]:
        """dP_iJ / dF_kL, MPa."""
        F, stress = x[0], self._stress(x[0])
        tangent = LAMBDA * np.einsum("iJqc,kLqc->iJkLqc", F, F) + MU * np.einsum("iLqc,kJqc->iJkLqc", F, F)
        left = MU * np.einsum("iKqc,kKqc->ikqc", F, F)
        for i in range(3):
            tangent[:, i, :, i] += left
            tangent[i, :, i, :] += stress
        return [tangent]


class FaceRule:
    """Six points on the face 012 of the tetrahedron, exact to degree four."""

    def __init__(self) -> None:
        barycentric, self.weights = triangle_rule()
        self.points = np.column_stack([barycentric[:, 1:], np.zeros(6)])
        self.npoints, self.dim = 6, 3


def face_region(body: Body, name: str) -> felupe.Region:
    """A boundary region: the tetrahedra behind a named face, turned so that the face is their 021."""
    faces, tets = body.mesh.faces[name], body.mesh.tets
    behind = {tuple(sorted(set(tet) - {apex})): apex for tet in tets.tolist() for apex in tet}
    apexes = np.array([behind[tuple(sorted(face))] for face in faces.tolist()])
    cells = body.quadratic(np.column_stack([faces[:, [0, 2, 1]], apexes]))
    region = felupe.Region(felupe.Mesh(body.points, cells, "tetra10"), felupe.QuadraticTetra(), FaceRule())
    inward = np.cross(region.dXdr[:, 0], region.dXdr[:, 1], axis=0)  # (3, q, c)
    region.dA = -inward * region.quadrature.weights[:, None]
    region.dV = np.linalg.norm(region.dA, axis=0)
    region.normals = region.dA / region.dV
    return region


class Pardiso:
    """PARDISO for symmetric indefinite matrices, through the public part of pypardiso."""

    def __init__(self) -> None:
        self.solver = PyPardisoSolver(mtype=-2)
        self.factorizations = 0

    def __call__(self, matrix: Any, right: np.ndarray) -> np.ndarray:
        self.factorizations += 1
        upper = sp.triu(matrix, format="csr")
        upper.sort_indices()
        return self.solver.solve(upper, right)


class Model:
    """Items, supports and the solver."""

    def __init__(self, body: Body) -> None:
        self.body = body
        mesh = felupe.Mesh(body.points, body.cells, "tetra10")
        self.field = felupe.FieldContainer([felupe.Field(felupe.RegionQuadraticTetra(mesh), dim=3)])
        faces = felupe.FieldContainer([felupe.Field(face_region(body, "cavity"), dim=3)])
        self.pressure = felupe.SolidBodyPressure(faces)
        self.items = [felupe.SolidBody(StVenantKirchhoff(), self.field), self.pressure]
        fixed = {"fixed": felupe.Boundary(self.field[0], mask=body.fixed)}
        dof0, dof1 = felupe.dof.partition(self.field, fixed)
        self.fixed = {"dof0": dof0, "dof1": dof1, "ext0": felupe.dof.apply(self.field, fixed, dof0)}
        self.solver = Pardiso()

    def equilibrium(self, pressure: float, guess: np.ndarray) -> tuple[np.ndarray, int]:
        """FElupe's Newton method at a pressure (kPa); it holds the free residual against the reactions."""
        self.pressure.update(pressure * KPA)
        self.field[0].values[:] = guess
        how = {"solver": self.solver, "tol": TOLERANCE, "maxiter": STEPPING.iterations, "verbose": False}
        try:
            result = felupe.newtonraphson(x0=self.field, items=self.items, **self.fixed, **how)
        except felupe.NewtonConvergenceError as failure:
            raise NoEquilibrium(str(failure)) from None
        return result.x[0].values.copy(), result.iterations

    def walk(self, pressures: Sequence[float]) -> PathResult:
        """Equilibria at the pressures, kPa."""
        rest = np.zeros_like(self.body.points)
        return STEPPING.walk(pressures, rest, self.equilibrium, self.body.answer, lambda: self.solver.factorizations)


def set_up() -> Callable[[Sequence[float]], PathResult]:
    load_pardiso()
    return Model(Body.read()).walk


if __name__ == "__main__":
    report(f"FElupe {felupe.__version__}", f"PARDISO (pypardiso {version('pypardiso')})", set_up)
