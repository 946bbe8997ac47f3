"""The closing of a loaded curve: how far its end has moved is what all its changes of curvature add up to.

Averages over cells say little about the ends of an arm: what bends between the clamp and the middle of the first cell
is seen by few of them, and yet it turns the whole arm. The end sees it. With delta(s) the turn of the tangent between
Tests II and III, zero at the clamp, and e the direction of the end force,

    e . (r_III(l) - r_II(l)) = integral of w delta ds,    w = sin(delta/2)/(delta/2) e . (-sin theta_m, cos theta_m)

theta_m being the mean angle of both, exactly and for turns of any size, when both curves are taken without their
stretch. delta is the integral of Delta, so the movement is a weighted mean of Delta, with weights that fall from the
clamp to the end: one more observation. It is what decides the end force of a rod whose end is held.
"""

from dataclasses import dataclass

import numpy as np

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import mean_angle_weights
from rod.law import RodError
from rod.load import Load

#: relative error of the movement that five numbers explain: what wiggles within cells, which a rod has not, add to it
#: where they do not average out, at the clamp and at d
ERROR = 0.03


@dataclass(frozen=True)
class Closure:
    """value = sum over the grid of weights times Delta. The weights are read-only."""

    value: float  #: mm, movement of the end along the end force, without stretch
    weights: Array  #: (GRID_CELLS,) mm2 on `curve.fine_grid`
    error: float  #: mm, standard deviation


def end_displacement_closure(free: Centreline, loaded: Centreline, load: Load) -> Closure:
    """How the end of Test III has moved from where it is in Test II, along its end force (N).

    Raises `RodError` where there is no force or the end has not moved.
    """
    s, size = free.s - free.s[0], load.force_size
    if not size > 0.0:
        raise RodError("Without an end force there is no direction in which the end could be closed.")
    ex, ey = load.force[0] / size, load.force[1] / size
    before, after = free.angle, loaded.angle
    turn, mean = after - before, 0.5 * (before + after)
    lever = np.diff(s) * np.sinc(turn / (2.0 * np.pi)) * (ey * np.cos(mean) - ex * np.sin(mean))
    weights = lever @ mean_angle_weights(s, float(s[-1]))
    weights.setflags(write=False)
    value = float(lever @ turn)
    if value == 0.0:
        raise RodError("The end force has not moved the end; nothing can be learnt from where it is.")
    return Closure(value, weights, ERROR * abs(value))
