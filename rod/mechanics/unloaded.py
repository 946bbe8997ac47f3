"""Rods without forces: the shape under one moment, and what the end of an arc gives way."""

from collections.abc import Mapping

import numpy as np

from geometry.arrays import Array
from rod.arm_law.space_rod import PolynomialSection
from rod.frames import cross_matrix, in_frame, rotation

#: fixed-point iterations for the curvature in the middle of an element
ITERATIONS = 8


def shape_under_moment(
    section: PolynomialSection, length: float, frame: Array, moment: Array, steps: int
) -> tuple[Array, Array]:
    """From the end of a rod to its start under a moment (3,) in N mm that is the same everywhere: (3,) mm, and the
    frame (3, 3) of the start. At the end it has the frame (3, 3)."""
    (place, start), (finer, finer_start) = (_integrated(section, length, frame, moment, n) for n in (steps, 2 * steps))
    turned = finer_start @ start.T
    axis = 0.5 * np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
    return finer + (finer - place) / 3.0, rotation(axis / 3.0) @ finer_start


def _integrated(
    section: PolynomialSection, length: float, frame: Array, moment: Array, steps: int
) -> tuple[Array, Array]:
    """With elements of one point, whose errors are those of the square of their length."""
    h, place, at, none = -length / steps, np.zeros(3), frame, np.zeros((1, 3))
    curvature = section.strains(in_frame(at, moment)[None], none)[0][0]
    for _ in range(steps):
        for _ in range(ITERATIONS):
            middle = at @ rotation(0.5 * h * curvature)
            before = curvature
            found, stretch = section.strains(in_frame(middle, moment)[None], none)
            curvature = found[0]
            if np.abs(curvature - before).max() <= 1e-14:
                break
        place = place + h * middle @ stretch[0]
        at = at @ rotation(h * curvature)
    return place, at


def arc_compliance(length: float, kappa: float, stretch: float, rigidities: Mapping[str, float], points: int) -> Array:
    """(6, 6): turn (rad) and motion (mm) of the end of an arc by moment (N mm) and force (N) there, in its frame.

    The arc is held at its start, bears nothing and is rigid in its plane. rigidities: by the names of
    `rod.arm_law.curves.IN_SPACE`; points: odd.
    """
    s, step = np.linspace(0.0, length, points, retstep=True)
    frames = rotation(np.outer(kappa * s, [0.0, 0.0, 1.0]))
    # the arc is integrated exactly: chords of equal elements
    half = rotation(np.outer(kappa * (s[:-1] + 0.5 * step), [0.0, 0.0, 1.0]))[:, :, 0]
    chord = stretch * step * np.sinc(0.5 * kappa * step / np.pi)
    axis = np.concatenate([np.zeros((1, 3)), np.cumsum(chord * half, axis=0)])
    B, GJ, GA, height = (
        rigidities[name] for name in ("lateral_rigidity", "torsional_rigidity", "lateral_shear_rigidity", "twist_axis")
    )
    soft = np.zeros((6, 6))
    soft[1, 1] = 1.0 / B
    soft[np.ix_([0, 5], [0, 5])] = np.array([[1.0, -height], [-height, height**2 + GJ / GA]]) / GJ
    carried = np.zeros((points, 6, 6))  # what a load on the end does in the frame of each point
    carried[:, :3, :3] = carried[:, 3:, 3:] = np.swapaxes(frames, 1, 2)
    carried[:, :3, 3:] = np.swapaxes(frames, 1, 2) @ cross_matrix(axis[-1] - axis)
    weights = np.full(points, 2.0)
    weights[1::2], weights[0], weights[-1] = 4.0, 1.0, 1.0
    inner = np.swapaxes(carried, 1, 2) @ soft @ carried
    whole = np.tensordot(weights * step / 3.0, inner, axes=1)
    frame = np.zeros((6, 6))
    frame[:3, :3] = frame[3:, 3:] = frames[-1]
    return np.asarray(frame.T @ whole @ frame)
