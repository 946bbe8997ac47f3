"""Rotations, and vectors in frames, of many sections at once."""

import numpy as np

from geometry.arrays import Array


def rotation(turn: Array) -> Array:
    """(..., 3, 3) of rotation vectors (..., 3), rad."""
    angle = np.sqrt((turn * turn).sum(axis=-1))[..., None, None]
    turned = cross_matrix(turn)
    return np.asarray(
        np.eye(3) + np.sinc(angle / np.pi) * turned + 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2 * turned @ turned
    )


def turn_of(frames: Array) -> Array:
    """(..., 3) rotation vectors of rotations (..., 3, 3) by less than half a turn."""
    axis = 0.5 * np.stack([frames[..., i, j] - frames[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))], axis=-1)
    sine = np.linalg.norm(axis, axis=-1)
    angle = np.arctan2(sine, 0.5 * (np.trace(frames, axis1=-2, axis2=-1) - 1.0))
    return np.asarray(axis * np.where(sine > 1e-7, angle / np.maximum(sine, 1e-300), 1.0)[..., None])


def cross_matrix(a: Array) -> Array:
    """(..., 3, 3): the matrix of a x, of vectors (..., 3)."""
    return np.asarray(a @ _CROSS.reshape(3, 9)).reshape(*a.shape, 3)


#: that turns a vector into the matrix of its cross product
_CROSS = np.zeros((3, 3, 3))
_CROSS[[0, 1, 2], [2, 0, 1], [1, 2, 0]], _CROSS[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0, -1.0


def in_frame(frame: Array, vector: Array) -> Array:
    """Components (..., 3) of vectors (..., 3) in frames (..., 3, 3)."""
    return np.asarray((vector[..., None, :] @ frame)[..., 0, :])


def planar_frames(angle: Array) -> Array:
    """(N, 3, 3) of angles (N,)."""
    frames = np.zeros((*angle.shape, 3, 3))
    frames[..., 0, 0] = frames[..., 1, 1] = np.cos(angle)
    frames[..., 1, 0] = np.sin(angle)
    frames[..., 0, 1] = -frames[..., 1, 0]
    frames[..., 2, 2] = 1.0
    return frames
