"""The closure condition of a loaded curve: its end displacement is the sum of all its changes of curvature.

Averages over cells contain little information on the ends of an arm: few of them cover the stretch between the clamp
and the middle of the first cell, and yet what bends there turns the whole arm. The end displacement contains it. With
delta(s) the rotation of the tangent between experiments II and III, zero at the clamp, and e the direction of the end
force,

    e . (r_III(l) - r_II(l)) = integral of w delta ds,    w = sin(delta/2)/(delta/2) e . (-sin theta_m, cos theta_m)

where theta_m is the mean angle of both. This is exact for rotations of any size when both curves are taken without
their stretch. delta is the integral of Delta, so the displacement is a weighted mean of Delta, with weights that fall
from the clamp to the end: one more observation, and the one that decides the end force of a rod whose end is held.
"""

from dataclasses import dataclass

import numpy as np

from geometry import Centreline
from geometry.arrays import Array, read_only
from rod.curves.curve import mean_angle_weights
from rod.errors import RodError
from rod.load import Load

#: relative standard deviation of the displacement as five parameters explain it: the ripple within cells, which a rod
#: does not have, adds to it where it does not average out, at the clamp and at d
CLOSURE_ERROR = 0.03


@dataclass(frozen=True)
class Closure:
    """The condition value = sum over the grid of weights times Delta. The weights are read-only."""

    value: float  #: mm, displacement of the end along the end force, without stretch
    weights: Array  #: (GRID_CELLS,) mm2 on `curve.fine_grid`
    error: float  #: mm, standard deviation


def end_displacement_closure(free: Centreline, loaded: Centreline, load: Load) -> Closure:
    """Displacement of the end from experiment II (free) to III (loaded), along the end force of the load.

    Both curves have the same points s.

    Raises `RodError` where there is no force or the end has not moved.
    """
    s, size = free.s - free.s[0], load.force_size
    if not size > 0.0:
        raise RodError(
            "No force acts on the end in experiment III, so that its displacement says nothing about the rigidities."
        )
    ex, ey = load.force[0] / size, load.force[1] / size
    before, after = free.angle, loaded.angle
    turn, mean = after - before, 0.5 * (before + after)
    lever = np.diff(s) * np.sinc(turn / (2.0 * np.pi)) * (ey * np.cos(mean) - ex * np.sin(mean))
    weights = read_only(lever @ mean_angle_weights(s, float(s[-1])))
    value = float(lever @ turn)
    if value == 0.0:
        raise RodError("The end force has not moved the end; its position contains no information.")
    return Closure(value, weights, CLOSURE_ERROR * abs(value))
