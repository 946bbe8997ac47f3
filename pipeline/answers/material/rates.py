"""A specimen that is loaded at two rates or more: branches of relaxation from its stress over the strain.

    s(t) = integral of G(t - u) ds_e(e(u)),    G(t) = 1 + sum g exp(-t / tau)

The stress s_e at long times is any function of the strain. Each rate more gives a branch, whose g and tau are known
within a factor before; stresses are linear in s_e, which is left out of the fit.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from geometry.arrays import Array
from pipeline.answers.material.hold import Hold, read_over_time
from pipeline.values.errors import InputError

#: strains between which the stress at long times goes straight; fewest points of a loading; least ratio of durations
KNOTS, LEAST, APART = 12, 20, 2.0
#: g before anything is known; standard deviation of ln g and of ln tau
USUAL, KNOWN = 0.1, 1.0


def read_rates(paths: Sequence[Path]) -> Hold:
    """The branches of files with a time, a strain and a stress, each of a loading from rest. Raises InputError."""
    curves = sorted((_read(path) for path in paths), key=lambda curve: float(curve[0][-1]))
    last = np.array([curve[0][-1] for curve in curves])
    if len(last) < 2 or (last[1:] < APART * last[:-1]).any():
        raise InputError(f"{paths[0]}: give loadings of two rates or more, each {APART:g} times as slow as the next")
    middles, most = np.sqrt(last[:-1] * last[1:]), max(float(curve[1].max()) for curve in curves)
    knots, scale = np.linspace(0.0, most, KNOTS + 1), max(float(np.abs(curve[2]).max()) for curve in curves)
    parts = [(t, np.array([np.interp(e, knots, hat) for hat in np.eye(KNOTS + 1)[1:]]).T) for t, e, _ in curves]
    read = np.concatenate([s for *_, s in curves]) / scale

    def off(logs: Array) -> Array:
        g, tau = USUAL * np.exp(logs[: len(middles)]), middles * np.exp(logs[len(middles) :])
        basis = np.concatenate([_stresses(t, hats, g, tau) for t, hats in parts])
        return np.asarray(basis @ np.linalg.lstsq(basis, read, rcond=None)[0] - read)

    def with_known(logs: Array) -> Array:
        return np.concatenate([off(logs) / noise, logs / KNOWN])

    logs, noise = np.zeros(2 * len(middles)), 0.01
    for _ in range(3):  # the noise follows from the fit
        found = least_squares(with_known, logs, xtol=1e-6)
        logs, noise = found.x, max(float(np.sqrt(np.mean(off(found.x) ** 2))), 1e-6)
    std = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac))).reshape(2, -1).T
    g, tau = np.exp(logs).reshape(2, -1) * [USUAL * np.ones(len(middles)), middles]
    pairs = tuple((float(a), float(b)) for a, b in std)
    return Hold(tuple(g.tolist()), tuple(tau.tolist()), (float(last[0]), float(last[-1])), noise, pairs)


def _read(path: Path) -> tuple[Array, Array, Array]:
    """Times (n,) in s, strains and stresses of a loading, in the units of the file."""
    time, read = read_over_time(path)
    strain, stress = (
        next((read[kind] for kind in kinds if kind in read), None)
        for kinds in (("stretch", "strain", "extension"), ("stress", "force"))
    )
    if strain is None or stress is None:
        example = "'time (s), strain (%), stress (MPa)'"
        raise InputError(f"{path}: has no strain and stress over time; write titles as {example}")
    kept = np.isfinite(time + strain + stress)
    if kept.sum() < LEAST:
        raise InputError(f"{path}: has {kept.sum()} points; give {LEAST} or more of a loading")
    return time[kept] - time[kept][0], np.abs(strain[kept]), np.abs(stress[kept])


def _stresses(time: Array, hats: Array, g: Array, tau: Array) -> Array:
    """(n, k) of stresses at long times (n, k), which change evenly between times (n,)."""
    found, carried = hats.copy(), np.zeros((len(g), hats.shape[1]))
    left = np.exp(-np.diff(time)[:, None] / tau)
    slowed = g * tau * (1.0 - left) / np.diff(time)[:, None]
    for n in range(1, len(time)):
        carried = left[n - 1][:, None] * carried + np.multiply.outer(slowed[n - 1], hats[n] - hats[n - 1])
        found[n] += carried.sum(axis=0)
    return found
