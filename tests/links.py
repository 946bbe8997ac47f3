"""A clamped rod in its plane as a chain of links with springs between them: an energy of its own."""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod import Rod, RodSolution


@dataclass(frozen=True)
class Links:
    """A rod with five parameters and a curvature that is the same everywhere, by its potential energy.

    Unknown are the angles of its links.
    """

    rod: Rod
    force: Array  #: (2,) N, on the end
    weight: Array  #: (2,) N/mm
    n: int = 400

    @staticmethod
    def of(rod: Rod, shape: RodSolution) -> tuple["Links", Array]:
        """Under what acts on a shape, and the angles (n,) there."""
        links = Links(rod, shape.force, shape.weight / rod.length)
        return links, np.interp((np.arange(links.n) + 0.5) * rod.length / links.n, shape.s, shape.theta)

    def end(self, angle: Array) -> Array:
        """(2,) mm."""
        return np.array([np.cos(angle).sum(), np.sin(angle).sum()]) * self.rod.length / self.n

    def stiffness(self, angle: Array) -> tuple[Array, Array]:
        """Gradient (n,) and Hessian (n, n) of the energy."""
        rod, h = self.rod, self.rod.length / self.n
        joints = np.arange(self.n) * h
        law, kappa_0 = rod.five, float(rod.kappa_0)  # type: ignore[arg-type]
        springs = np.where(joints < law.d, law.alpha1, law.alpha2) / h
        springs[0] *= 2.0  # half a link from the clamp
        moment = springs * (np.diff(angle, prepend=rod.theta0) - kappa_0 * h * np.where(joints > 0.0, 1.0, 0.5))
        beyond = self.force + np.outer(rod.length - joints - 0.5 * h, self.weight)
        c, s = np.cos(angle), np.sin(angle)
        gradient = moment - np.append(moment[1:], 0.0) + h * (beyond[:, 0] * s - beyond[:, 1] * c)
        hessian = np.diag(springs + np.append(springs[1:], 0.0) + h * (beyond[:, 0] * c + beyond[:, 1] * s))
        hessian -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
        return gradient, hessian

    def settled(self, angle: Array) -> tuple[Array, float]:
        """The equilibrium near angles (n,), by Newton's method, and its lowest eigenvalue over the elastic one."""
        for _ in range(40):
            gradient, hessian = self.stiffness(angle)
            step = np.linalg.solve(hessian, -gradient)
            angle = angle + step / max(1.0, 10.0 * float(np.abs(step).max()))
            if np.abs(step).max() < 1e-11:
                break
        elastic = Links(self.rod, np.zeros(2), np.zeros(2), self.n).stiffness(angle)[1]
        factor = np.linalg.inv(np.linalg.cholesky(elastic))
        return angle, float(np.linalg.eigvalsh(factor @ self.stiffness(angle)[1] @ factor.T)[0])
