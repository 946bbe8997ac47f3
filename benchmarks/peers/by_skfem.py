"""Plain scikit-fem forms and SciPy: law and pressure as decorated functions, SuperLU for the tangent.

    python -m benchmarks.peers.by_skfem four out.json

SuperLU is used in its symmetric mode (minimum degree of A^T + A, diagonal pivots), which takes a fraction of the
time of its default here. Newton's method and the step control are left to the user (`stepping.py`).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import scipy
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, det, dot, eye, grad, identity, inv, mul, trace, transpose

from benchmarks.peers.problem import KPA, LAMBDA, MESH, MU, TOLERANCE, PathResult, report
from benchmarks.peers.stepping import STEPPING, NoEquilibrium, newton


def deformation(u: Any) -> Any:
    return grad(u) + identity(grad(u))


def stress(F: Any) -> Any:
    """Second Piola-Kirchhoff stress, MPa."""
    strain = 0.5 * (mul(transpose(F), F) - identity(F))
    return LAMBDA * eye(trace(strain), 3) + 2 * MU * strain


@skfem.LinearForm
def internal(v: Any, w: Any) -> Any:
    F = deformation(w.now)
    return ddot(mul(F, stress(F)), grad(v))


@skfem.BilinearForm
def stiffness(u: Any, v: Any, w: Any) -> Any:
    F = deformation(w.now)
    du = 0.5 * (mul(transpose(F), grad(u)) + mul(transpose(grad(u)), F))
    dS = LAMBDA * eye(trace(du), 3) + 2 * MU * du
    return ddot(mul(F, dS) + mul(grad(u), stress(F)), grad(v))


@skfem.LinearForm
def push(v: Any, w: Any) -> Any:
    """Forces of a unit pressure on the deformed surface (cof(F) n dA = n da); the normal points out of the body."""
    F = deformation(w.now)
    return det(F) * dot(mul(transpose(inv(F)), w.n), v)


@skfem.BilinearForm
def push_tangent(u: Any, v: Any, w: Any) -> Any:
    F = deformation(w.now)
    back = transpose(inv(F))
    turned = mul(back, mul(transpose(grad(u)), mul(back, w.n)))
    return det(F) * dot(ddot(back, grad(u)) * mul(back, w.n) - turned, v)


@skfem.Functional
def enclosed(w: Any) -> Any:
    F = deformation(w.now)
    return -det(F) * dot(mul(transpose(inv(F)), w.n), w.x + w.now) / 3


class Model:
    """Bases, free degrees of freedom and what the path asks of them."""

    def __init__(self) -> None:
        self.mesh = skfem.MeshTet.load(MESH)
        self.body = skfem.Basis(self.mesh, skfem.ElementVector(skfem.ElementTetP2()), intorder=2)
        self.cavity = self.body.boundary("cavity", intorder=4)
        fixed = np.concatenate([self.body.get_dofs("clamp").all(), self.body.get_dofs("sym").all("u^3")])
        self.free = np.setdiff1d(np.arange(self.body.N), fixed)
        self.pressure, self.factorizations = 0.0, 0

    def residual(self, u: np.ndarray) -> tuple[np.ndarray, float]:
        """Forces on all degrees of freedom, and the free ones' norm over that of the pressure's."""
        load = self.pressure * push.assemble(self.cavity, now=self.cavity.interpolate(u))
        forces = internal.assemble(self.body, now=self.body.interpolate(u)) + load
        return forces, float(np.linalg.norm(forces[self.free]) / np.linalg.norm(load))

    def increment(self, u: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """-K^-1 R."""
        tangent = stiffness.assemble(self.body, now=self.body.interpolate(u))
        tangent += self.pressure * push_tangent.assemble(self.cavity, now=self.cavity.interpolate(u))
        within = tangent[self.free][:, self.free].tocsc()
        self.factorizations += 1
        try:
            factor = splu(within, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError as error:
            raise NoEquilibrium(str(error)) from None
        change = np.zeros_like(u)
        change[self.free] = -factor.solve(forces[self.free])
        return change

    def answer(self, u: np.ndarray) -> tuple[float, float, float]:
        tip = self.body.get_dofs("tip")
        volume = enclosed.assemble(self.cavity, now=self.cavity.interpolate(u))
        return float(u[tip.all("u^1")].mean()), float(u[tip.all("u^2")].mean()), float(volume)

    def walk(self, pressures: Sequence[float]) -> PathResult:
        """Equilibria at the pressures, kPa."""

        def equilibrium(pressure: float, guess: np.ndarray) -> tuple[np.ndarray, int]:
            self.pressure = pressure * KPA
            return newton(guess, STEPPING.iterations, self.residual, self.increment, TOLERANCE)

        return STEPPING.walk(pressures, self.body.zeros(), equilibrium, self.answer, lambda: self.factorizations)


def set_up() -> Callable[[Sequence[float]], PathResult]:
    return Model().walk


if __name__ == "__main__":
    report(f"scikit-fem {skfem.__version__}, SciPy {scipy.__version__}", "SuperLU", set_up)
