"""The mean measured curve of all tests, with which laws are compared, and its standard error.

Near rest the scatter of single points is as large as the stress, so they do not tell a law from one of half its
stiffness. The reduced stress P / (2 (s - s^-2)), the nominal stress over that of a neo-Hookean bar at stretch s, is
smooth and finite at rest (M. Mooney, J. Appl. Phys. 11 (1940) 582). Its values at knots equidistant in ln s are
estimated together by penalised least squares: second differences are small against the values (E. T. Whittaker, Proc.
Edinburgh Math. Soc. 41 (1923) 63). The strength of the penalty maximises the evidence of the data (D. J. C. MacKay,
Neural Comput. 4 (1992) 415).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Index, Mask
from pipeline.material.tensile import TensileTest

#: distance of the nodes in ln(stretch); a side (tension, compression) whose data end closer to rest has no nodes
WIDTH = 0.02
#: |ln(stretch)| of the node next to rest
NEAREST = 1e-3
#: relative error assumed for every point beside the scatter; without it the many large stresses far from rest would
#: dominate the fit
RELATIVE_ERROR = 0.01
#: candidates for the strength of the penalty: inverse variance of the relative second differences of the knots
STIFFNESSES = np.geomspace(1e0, 1e10, 21)
#: iterations in which weights and sizes converge
ITERATIONS = 3
#: standard errors of the mean curve by which a law may exceed the tolerance: with fewer, scatter would reject the true
#: law; with more, wrong laws would be valid beyond the tolerance (tests/pipeline/material/test_material.py)
ALLOWED_ERRORS = 1.0


@dataclass(frozen=True)
class MeanCurve:
    """The points of all tests, and m nodes of a smooth curve through them from the lowest stretch to the highest."""

    stretch: Array  #: (n,) of the points
    stress: Array  #: (n,) MPa
    tests: Index  #: (n,) number of the test of each point
    nodes: Array  #: (m,) stretches, without 1
    mean: Array  #: (m,) MPa
    uncertainty: Array  #: (m,) MPa, of the mean: smaller differences from it are not significant

    @staticmethod
    def of(tests: Sequence[TensileTest]) -> "MeanCurve":
        """The curve through at least one test; all tests together need two strains beside rest."""
        stretch = np.concatenate([test.stretch for test in tests])
        stress = np.concatenate([test.stress for test in tests])
        group = np.concatenate([np.full(len(test.stretch), k) for k, test in enumerate(tests)])
        nodes = _nodes(float(stretch.min()), float(stretch.max()))
        mean, error = _smooth(stretch, stress, max(noise(tests), 1e-9 * float(np.abs(stress).max())), nodes)
        return MeanCurve(stretch, stress, group, nodes, mean, ALLOWED_ERRORS * error)

    def within(self, nominal: Array, tolerance: float) -> Mask:
        """(m,) nodes at which `nominal` (m,), MPa, is within `tolerance` (relative) of the mean; NaN never is."""
        return np.asarray(np.abs(nominal - self.mean) <= tolerance * np.abs(self.mean) + self.uncertainty)

    def resolves(self, tolerance: float) -> Mask:
        """(m,) nodes at which the uncertainty of the mean is `tolerance` (relative) at most."""
        return np.asarray(self.uncertainty <= tolerance * np.abs(self.mean))


def noise(tests: Sequence[TensileTest]) -> float:
    """Standard deviation of the points, MPa, from third divided differences, in which a smooth curve cancels."""
    scaled = [np.zeros(0)]
    for test in tests:
        stretch, first = np.unique(test.stretch, return_index=True)
        if len(stretch) < 4:
            continue
        x = np.lib.stride_tricks.sliding_window_view(stretch, 4)
        y = np.lib.stride_tricks.sliding_window_view(test.stress[first], 4)
        weights = 1 / (x[:, :, None] - x[:, None, :] + np.eye(4)).prod(axis=2)
        scaled.append(np.sum(weights * y, axis=1) / np.linalg.norm(weights, axis=1))
    pooled = np.concatenate(scaled)
    return float(1.4826 * np.median(np.abs(pooled))) if len(pooled) else 0.0  # the median of a normal distribution


def _nodes(low: float, high: float) -> Array:
    sides = [np.zeros(0), np.zeros(0)]
    for side, end in enumerate((-np.log(low), np.log(high))):
        if end > WIDTH:
            sides[side] = np.linspace(NEAREST, end, int(np.ceil(end / WIDTH)) + 1)
    return np.exp(np.concatenate([-sides[0][::-1], sides[1]]))


def _smooth(stretch: Array, stress: Array, scatter: float, nodes: Array) -> tuple[Array, Array]:
    """The curve at the nodes (m,) and its standard error, MPa."""
    ends = np.log(stretch.min()), np.log(stretch.max())
    knots = np.linspace(*ends, max(int(np.ceil((ends[1] - ends[0]) / WIDTH)), 3) + 1)
    at_points, at_nodes = (_neo_hookean(s)[:, None] * _hat_functions(np.log(s), knots) for s in (stretch, nodes))
    second_differences = np.diff(np.eye(len(knots)), 2, axis=0)
    size, weight = np.ones(len(knots)), np.full_like(stress, 1 / scatter)
    for _ in range(ITERATIONS):
        basis, triangle = np.linalg.qr(at_points * weight[:, None])
        projected, penalty_root = basis.T @ (weight * stress), second_differences / size[1:-1, None]
        values, covariance = max(
            (
                _posterior(
                    triangle, projected, np.sqrt(stiffness) * penalty_root, len(penalty_root) * np.log(stiffness)
                )
                for stiffness in STIFFNESSES
            ),
            key=lambda posterior: posterior[0],
        )[1:]
        size = np.maximum(np.abs(values), 0.1 * np.median(np.abs(values)))
        weight = 1 / np.hypot(scatter, RELATIVE_ERROR * (at_points @ values))
    return at_nodes @ values, np.sqrt(np.einsum("ik,kl,il->i", at_nodes, covariance, at_nodes))


def _posterior(
    triangle: Array, projected: Array, penalty_root: Array, log_determinant: float
) -> tuple[float, Array, Array]:
    """Log evidence up to a constant, values at the knots (k,) and their covariance (k, k).

    triangle (j, k), projected (j,): matrix and right-hand side of the least-squares problem of the data, by its QR
    decomposition: normal equations would lose the values at knots far from all data.
    penalty_root (p, k): root of the inverse covariance of the prior; log_determinant: logarithm of the
    pseudo-determinant of that.
    """
    basis, root = np.linalg.qr(np.vstack([triangle, penalty_root]))
    inverse = np.linalg.inv(root)
    explained = basis[: len(triangle)].T @ projected
    evidence = 0.5 * (float(explained @ explained) + log_determinant) - float(np.sum(np.log(np.abs(np.diag(root)))))
    return evidence, inverse @ explained, inverse @ inverse.T


def _neo_hookean(stretch: Array) -> Array:
    """(n,) nominal stress over c10 of an incompressible neo-Hookean bar."""
    return np.asarray(2 * (stretch - stretch**-2))


def _hat_functions(x: Array, knots: Array) -> Array:
    """(n, k) weights of the values at the knots in a linear interpolation at x (n,)."""
    left = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(knots) - 2)
    fraction = (x - knots[left]) / (knots[left + 1] - knots[left])
    weights = np.zeros((len(x), len(knots)))
    weights[np.arange(len(x)), left] = 1 - fraction
    weights[np.arange(len(x)), left + 1] = fraction
    return weights
