"""Curves of rods whose parameters are known, which every estimator must recover.

An arm like the gapped pneu-net arm: a curvature with a ripple within each cell, in the rest state and in its response
to a moment, nodes as a mesh spaces them, and measured positions with white noise.
"""

from dataclasses import dataclass, replace

import numpy as np

from geometry import Centreline
from geometry.arrays import Array
from rod import Curvature, FiveParameters, Load, Rod
from rod.curves.curve import GRID_CELLS, fine_grid


@dataclass(frozen=True)
class SyntheticArm:
    """An arm with known numbers. Wiggles are relative: curvature times 1 + ripple cos(2 pi s/pitch + phase)."""

    law: FiveParameters
    kappa_0: float = 0.03  #: 1/mm, mean over a cell
    length: float = 112.0  #: mm
    pitch: float = 10.0  #: mm
    node_spacing: float = 1.0  #: mm, a whole fraction of the pitch
    ripple: float = 0.0  #: of kappa_0
    compliance_ripple: float = 0.0  #: of Delta
    phase: float = 0.0  #: rad
    noise: float = 0.0  #: mm, standard deviation of each measured coordinate
    force_noise: float = 0.0  #: relative standard deviation of the measured force

    def curves(self, seed: int = 0) -> tuple[Centreline, Centreline, Load]:
        """Experiment II, experiment III (end height zero), both with noise, and the load of III."""
        nodes = np.linspace(0.0, self.length, round(self.length / self.node_spacing) + 1)
        rest, loaded = self._rods()
        held = loaded.solve(end_y=0.0)
        random = np.random.default_rng(seed)
        free, bent = (
            shape.positions(nodes) + self.noise * random.standard_normal((len(nodes), 2))
            for shape in (rest.solve(), held)
        )
        force = (float(held.force[0]), float(held.force[1]) * (1.0 + self.force_noise * random.standard_normal()))
        return Centreline(nodes, *free.T), Centreline(nodes, *bent.T), Load(force)

    def _rods(self) -> tuple[Rod, Rod]:
        s = np.linspace(0.0, self.length, 1121)
        wave = np.cos(2.0 * np.pi * s / self.pitch + self.phase)
        kappa_0 = self.kappa_0 * (1.0 + self.ripple * wave)
        rest = Rod(self.length, np.column_stack([s, kappa_0]), self.law)
        loaded = rest
        for _ in range(6 if self.compliance_ripple else 0):  # the ripple follows Delta, which follows the moment
            moment = loaded.solve(end_y=0.0)
            delta = self.law.deviation(s, np.interp(s, moment.s, moment.moment))
            loaded = replace(rest, kappa_0=np.column_stack([s, kappa_0 + self.compliance_ripple * wave * delta]))
        return rest, loaded


def exact_curvature(s: Array, kappa: Array, *, length: float, pitch: float) -> Curvature:
    """Curvature known without error at the points s, (n,) mm; its resolution is linear interpolation."""
    grid = fine_grid(length)
    position = np.clip((np.asarray(s) - grid[0]) / (grid[1] - grid[0]), 0.0, GRID_CELLS - 1.0)
    left = np.minimum(position.astype(int), GRID_CELLS - 2)
    resolution = np.zeros((len(s), GRID_CELLS))
    resolution[np.arange(len(s)), left] = 1.0 - (position - left)
    resolution[np.arange(len(s)), left + 1] += position - left
    return Curvature(length, pitch, s, kappa, np.zeros(len(s)), np.zeros((len(s), len(s))), resolution)
