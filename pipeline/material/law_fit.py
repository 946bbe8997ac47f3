"""Every law fitted to tensile tests: its constants, their errors, and the stretches over which it may be used.

Rubber is fitted as incompressible, which it nearly is and which makes every law linear in its constants; kappa then
follows from the Poisson ratio that is asked for. The fitted law is judged as the solver has it, with that kappa.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

import fem
from geometry.arrays import Array, Mask
from pipeline.config.config import LAWS
from pipeline.material.mean_curve import MeanCurve
from pipeline.material.regression import TooFewPoints, regress, solve


@dataclass(frozen=True)
class LawFit:
    """One law, fitted to the points between two stretches."""

    law: str  #: as in the YAML
    constants: Mapping[str, float]  #: fitted, MPa
    errors: Mapping[str, float]  #: their standard errors, MPa
    by_tests: bool  #: as in `Regression`
    points: int
    fitted: tuple[float, float]  #: stretches of the first and the last point that it was fitted to
    rms: float  #: MPa, over these points
    rms_solved: float  #: MPa, the same for the law as the solver has it; NaN where it has none at a point
    solved: fem.Material  #: with its Poisson ratio or kappa
    holds: tuple[float, float] | None  #: stretches around 1 over which it may be used
    ends: str  #: what ends this range (in tension where the tests pull), or why there is none


@dataclass(frozen=True)
class Refused:
    """A law for which the data give no constants that it can have."""

    law: str
    reason: str


def fit_all(law: str, curve: MeanCurve, nu: float, share: float) -> LawFit | Refused:
    """The law fitted to all points at which a body of it can be."""
    low, high = (0.0, np.inf) if not _has_nu(law) else _built(law, {"E": 1.0}, nu).stretch_limits
    return _fit(law, curve, (curve.stretch > low) & (curve.stretch < high), nu, share)


def fit_widest(law: str, curve: MeanCurve, nu: float, share: float) -> LawFit | Refused:
    """The law fitted to the widest part of the points around rest over all of which it may be used."""
    reach, points = np.abs(np.log(curve.nodes)), np.abs(np.log(curve.stretch))
    told = reach[curve.tells(share)]
    if not len(told):
        return Refused(law, f"cannot be judged: the points scatter too much to tell {100 * share:g} % of the stress")
    for far in np.unique(reach[reach >= told.min()])[::-1]:
        chosen = points <= far * (1 + 1e-9)
        try:
            numbers = solve(_columns(law, curve.stretch[chosen]), curve.stress[chosen])
            good = _good(_built(law, _named(law, numbers), nu), curve, share)
        except (TooFewPoints, fem.MaterialError):
            continue
        if good[reach <= far].all():
            return _fit(law, curve, chosen, nu, share)
    return Refused(law, f"is nowhere within {100 * share:g} % of the data")


def _fit(law: str, curve: MeanCurve, chosen: Mask, nu: float, share: float) -> LawFit | Refused:
    columns, stretch = _columns(law, curve.stretch), curve.stretch[chosen]
    try:
        found = regress(columns[chosen], curve.stress[chosen], curve.tests[chosen])
        solved = _built(law, _named(law, found.numbers), nu)
    except TooFewPoints as failure:
        return Refused(law, f"cannot be fitted: {failure}")
    except fem.MaterialError as failure:
        return Refused(law, f"has no constants for these data: {failure}")
    left = fem.uniaxial(solved, stretch).nominal - curve.stress[chosen]
    holds, ends = _holds(solved, curve, _columns(law, curve.nodes) @ found.numbers, share)
    return LawFit(
        law,
        _named(law, found.numbers),
        _named(law, found.errors),
        found.by_tests,
        int(chosen.sum()),
        (float(stretch.min()), float(stretch.max())),
        found.rms,
        float(np.sqrt(np.mean(left**2))),
        solved,
        holds,
        ends,
    )


def _holds(
    solved: fem.Material, curve: MeanCurve, fitted: Array, share: float
) -> tuple[tuple[float, float] | None, str]:
    """From rest to the last node in an unbroken row of good ones, on either side, and what ends the row.

    Of tests that pull and press it is the end in tension.
    """
    good = _good(solved, curve, share)
    up, down = np.flatnonzero(curve.nodes > 1), np.flatnonzero(curve.nodes < 1)[::-1]
    rising, falling = (side[: np.argmin([*good[side], False])] for side in (up, down))
    ends, (side, row) = "data", (up, rising) if len(up) else (down, falling)
    if len(row) < len(side):
        first = side[len(row)]
        at = float(fem.uniaxial(solved, curve.nodes[[first]]).nominal[0])
        ends = "kappa" if abs(at - fitted[first]) > abs(fitted[first] - curve.mean[first]) else "misfit"
        if not _stable(solved, curve)[first]:
            ends = "instability"
    if not len(rising) and not len(falling):
        return None, ends
    ends_at = curve.nodes[[*falling[-1:], *rising[-1:]]]
    return (min(1.0, *ends_at.tolist()), max(1.0, *ends_at.tolist())), ends


def _good(solved: fem.Material, curve: MeanCurve, share: float) -> Mask:
    """(m,) nodes at which the law is stable and near enough to the data."""
    near = curve.within(fem.uniaxial(solved, curve.nodes).nominal, share)
    return near & _stable(solved, curve) if near.any() else near


def _stable(solved: fem.Material, curve: MeanCurve) -> Mask:
    low, high = solved.stretch_limits
    return np.asarray((curve.nodes > low) & (curve.nodes < high))


def _columns(law: str, stretch: Array) -> Array:
    """(n, k) nominal stress per unit of each constant."""
    return np.column_stack(list(fem.uniaxial_terms(_model(law), stretch).values()))


def _named(law: str, numbers: Array) -> dict[str, float]:
    return dict(zip(fem.uniaxial_terms(_model(law), np.ones(1)), numbers.tolist(), strict=True))


def _model(law: str) -> type[fem.Material]:
    model: type[fem.Material] = getattr(fem, LAWS[law][0])
    return model


def _has_nu(law: str) -> bool:
    return "nu" in LAWS[law][1]


def _built(law: str, constants: Mapping[str, float], nu: float) -> fem.Material:
    """The law as the solver has it. Raises `fem.MaterialError`."""
    model: Callable[..., fem.Material] = _model(law)
    if _has_nu(law):
        return model(**constants, nu=nu)
    mu = model(**constants, kappa=1.0).shear_modulus
    return model(**constants, kappa=2 * mu * (1 + nu) / (3 * (1 - 2 * nu)))
