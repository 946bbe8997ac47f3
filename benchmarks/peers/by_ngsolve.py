"""NGSolve: energy and enclosed volume as symbolic forms, sparse Cholesky factors whose ordering is kept.

    python -m benchmarks.peers.by_ngsolve four out.json

Newton's method and the step control are left to the user (`stepping.py`).
"""

from collections.abc import Callable, Sequence
from typing import Any

import netgen.meshing
import ngsolve
import numpy as np
from ngsolve import BND, TET, TRIG, BilinearForm, Cof, Grad, GridFunction, Id, InnerProduct, IntegrationRule, Trace, dx

from benchmarks.peers.problem import KPA, LAMBDA, MU, TOLERANCE, Body, PathResult, report
from benchmarks.peers.stepping import STEPPING, newton


def mesh_of(body: Body) -> ngsolve.Mesh:
    """The same points, tetrahedra and named faces as an NGSolve mesh."""
    made = netgen.meshing.Mesh(dim=3)
    made.AddPoints(body.mesh.points)
    for index, (name, triangles) in enumerate(body.mesh.faces.items(), start=1):
        made.Add(netgen.meshing.FaceDescriptor(surfnr=index, domin=1, bc=index))
        made.SetBCName(index - 1, name)
        made.AddElements(dim=2, index=index, data=triangles.astype(np.int32), base=0)
    made.AddElements(dim=3, index=1, data=body.mesh.tets.astype(np.int32), base=0)
    return ngsolve.Mesh(made)


class Model:
    """Spaces, forms and the factor."""

    def __init__(self, body: Body) -> None:
        self.body, self.mesh = body, mesh_of(body)
        self.space = ngsolve.VectorH1(self.mesh, order=2, dirichlet="clamp", dirichletz="sym")
        self.free = np.array(self.space.FreeDofs(), dtype=bool)
        self.pressure = ngsolve.Parameter(0.0)
        self.u = GridFunction(self.space)
        self.elastic, self.load = self.forms(self.space.TrialFunction())
        self.whole = BilinearForm(self.space, symmetric=True)
        self.whole += self.elastic
        self.whole += self.load
        self.loads = BilinearForm(self.space)
        self.loads += self.load
        self.forces, self.answering = self.u.vec.CreateVector(), self.u.vec.CreateVector()
        self.factor: Any = None
        self.factorizations = 0

    def forms(self, u: Any) -> tuple[Any, Any]:
        """Elastic energy (four points) and -p times the enclosed volume, V = -1/3 int x . cof(F) n dA."""
        F = Id(3) + Grad(u)
        strain = 0.5 * (F.trans * F - Id(3))
        energy = LAMBDA / 2 * Trace(strain) ** 2 + MU * InnerProduct(strain, strain)
        x = ngsolve.CF((ngsolve.x, ngsolve.y, ngsolve.z)) + u
        outward = Cof(Id(3) + Grad(u).Trace()) * ngsolve.specialcf.normal(3)
        work = self.pressure / 3 * InnerProduct(x, outward)
        inside = dx(intrules={TET: IntegrationRule(TET, 2)})
        surface = ngsolve.ds("cavity", intrules={TRIG: IntegrationRule(TRIG, 4)})
        return ngsolve.Variation(energy.Compile() * inside), ngsolve.Variation(work.Compile() * surface)

    def residual(self, unknowns: np.ndarray) -> tuple[np.ndarray, float]:
        """Forces on all degrees of freedom, and the free ones' norm over that of the pressure's."""
        self.u.vec.FV().NumPy()[:] = unknowns
        self.loads.Apply(self.u.vec, self.answering)
        scale = np.linalg.norm(self.answering.FV().NumPy())
        self.whole.Apply(self.u.vec, self.forces)
        forces = self.forces.FV().NumPy()
        return forces, float(np.linalg.norm(forces[self.free]) / scale)

    def increment(self, unknowns: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """-K^-1 R; the ordering and the symbolic factor are those of the first call."""
        self.whole.AssembleLinearization(self.u.vec)
        if self.factor is None:
            self.factor = self.whole.mat.Inverse(self.space.FreeDofs(), inverse="sparsecholesky")
        else:
            self.factor.Update()
        self.factorizations += 1
        self.answering.data = self.factor * self.forces
        return -self.answering.FV().NumPy()

    def answer(self, unknowns: np.ndarray) -> tuple[float, float, float]:
        """Tip and volume; the unknowns are hierarchical, so values at nodes are evaluated at their positions."""
        self.u.vec.FV().NumPy()[:] = unknowns
        positions = self.body.points[self.body.nodes("tip")]
        tip = np.mean([self.u(self.mesh(*position)) for position in positions], axis=0)
        x = ngsolve.CF((ngsolve.x, ngsolve.y, ngsolve.z)) + self.u
        outward = Cof(Id(3) + Grad(self.u)) * ngsolve.specialcf.normal(3)
        cavity = self.mesh.Boundaries("cavity")
        volume = -ngsolve.Integrate(InnerProduct(x, outward) / 3, self.mesh, BND, definedon=cavity, order=4)
        return float(tip[0]), float(tip[1]), float(volume)

    def walk(self, pressures: Sequence[float]) -> PathResult:
        """Equilibria at the pressures, kPa."""

        def equilibrium(pressure: float, guess: np.ndarray) -> tuple[np.ndarray, int]:
            self.pressure.Set(pressure * KPA)
            return newton(guess, STEPPING.iterations, self.residual, self.increment, TOLERANCE)

        rest = np.zeros(self.space.ndof)
        return STEPPING.walk(pressures, rest, equilibrium, self.answer, lambda: self.factorizations)


def set_up() -> Callable[[Sequence[float]], PathResult]:
    ngsolve.SetNumThreads(1)
    return Model(Body.read()).walk


if __name__ == "__main__":
    report(f"NGSolve {ngsolve.__version__}", "sparsecholesky", set_up)
