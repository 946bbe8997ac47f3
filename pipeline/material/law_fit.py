"""Every law fitted to tensile tests: its constants, their errors, and the range of stretch over which it is valid.

The laws of rubber are fitted as incompressible, which rubber nearly is and which makes every law linear in its
constants; kappa then follows from the given Poisson ratio. Validity is judged for the law as the solver has it, with
that kappa: at every stretch of the range the law is stable, and its nominal stress is within a relative tolerance of
the mean measured curve (plus the uncertainty of that curve).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.materials import LAWS, Constant, Material, MaterialError
from geometry.arrays import Array, Mask
from pipeline.material.mean_curve import MeanCurve
from pipeline.material.regression import TooFewPoints, least_squares, regress


@dataclass(frozen=True)
class LawFit:
    """One law, fitted to the points within a range of stretch."""

    law: str  #: as in the YAML
    constants: Mapping[str, float]  #: fitted, MPa
    errors: Mapping[str, float]  #: their standard errors, MPa
    by_tests: bool  #: as in `Regression`
    points: int
    fitted_range: tuple[float, float]  #: stretches of the first and the last point that it was fitted to
    rms: float  #: MPa, over these points
    rms_solved: float  #: MPa, the same for the law as the solver has it; NaN where it has none at a point
    solved: Material  #: with its Poisson ratio or kappa
    valid_range: tuple[float, float] | None  #: stretches around 1 over which it is valid, None where it never is
    limited_by: str  #: data, misfit, kappa or instability: why the range ends (in tension where there is tension)


@dataclass(frozen=True)
class Refused:
    """A law for which the data give no admissible constants, or no valid range."""

    law: str
    reason: str


def fit_all(law: str, curve: MeanCurve, nu: float, tolerance: float) -> LawFit | Refused:
    """The law fitted to all points within the stretches that it admits."""
    low, high = _possible_stretches(law, nu)
    return _fit(law, curve, (curve.stretch > low) & (curve.stretch < high), nu, tolerance)


def fit_widest(law: str, curve: MeanCurve, nu: float, tolerance: float) -> LawFit | Refused:
    """The law fitted to the widest range of points around rest over all of which it is valid."""
    reach, points = np.abs(np.log(curve.nodes)), np.abs(np.log(curve.stretch))
    resolved = reach[curve.resolves(tolerance)]
    if not len(resolved):
        return Refused(law, f"cannot be judged: the scatter of the points exceeds {100 * tolerance:g} % of the stress")
    for largest in np.unique(reach[reach >= resolved.min()])[::-1]:
        selected = points <= largest * (1 + 1e-9)
        try:
            constants = least_squares(_matrix(law, curve.stretch[selected]), curve.stress[selected])
            valid = _valid(LAWS[law].from_uniaxial(_named(law, constants), nu), curve, tolerance)
        except (TooFewPoints, MaterialError):
            continue
        if valid[reach <= largest].all():
            return _fit(law, curve, selected, nu, tolerance)
    return Refused(law, f"is nowhere within {100 * tolerance:g} % of the data")


def _fit(law: str, curve: MeanCurve, selected: Mask, nu: float, tolerance: float) -> LawFit | Refused:
    matrix, stretch = _matrix(law, curve.stretch), curve.stretch[selected]
    try:
        regression = regress(matrix[selected], curve.stress[selected], curve.tests[selected])
        solved = LAWS[law].from_uniaxial(_named(law, regression.coefficients), nu)
    except TooFewPoints as failure:
        return Refused(law, f"cannot be fitted: {failure}")
    except MaterialError as failure:
        return Refused(law, f"has no admissible constants for these data: {failure}")
    residuals = solved.uniaxial(stretch).nominal - curve.stress[selected]
    incompressible = _matrix(law, curve.nodes) @ regression.coefficients
    valid_range, limited_by = _valid_range(solved, curve, incompressible, tolerance)
    return LawFit(
        law,
        _named(law, regression.coefficients),
        _named(law, regression.errors),
        regression.by_tests,
        int(selected.sum()),
        (float(stretch.min()), float(stretch.max())),
        regression.rms,
        float(np.sqrt(np.mean(residuals**2))),
        solved,
        valid_range,
        limited_by,
    )


def _valid_range(
    solved: Material, curve: MeanCurve, incompressible: Array, tolerance: float
) -> tuple[tuple[float, float] | None, str]:
    """The stretches from rest to the last of consecutive valid nodes on either side, and what limits them.

    incompressible: (m,) nominal stress at the nodes of the law without kappa, as fitted. With tension and compression
    in the tests, the limit is that in tension.
    """
    valid = _valid(solved, curve, tolerance)
    up, down = np.flatnonzero(curve.nodes > 1), np.flatnonzero(curve.nodes < 1)[::-1]
    rising, falling = (side[: np.argmin([*valid[side], False])] for side in (up, down))
    limited_by, (side, nodes) = "data", (up, rising) if len(up) else (down, falling)
    if len(nodes) < len(side):
        first = side[len(nodes)]
        stress = float(solved.uniaxial(curve.nodes[[first]]).nominal[0])
        by_kappa, by_misfit = abs(stress - incompressible[first]), abs(incompressible[first] - curve.mean[first])
        limited_by = "kappa" if by_kappa > by_misfit else "misfit"
        if not _stable(solved, curve)[first]:
            limited_by = "instability"
    if not len(rising) and not len(falling):
        return None, limited_by
    ends = curve.nodes[[*falling[-1:], *rising[-1:]]]
    return (min(1.0, *ends.tolist()), max(1.0, *ends.tolist())), limited_by


def _valid(solved: Material, curve: MeanCurve, tolerance: float) -> Mask:
    """(m,) nodes at which the law is stable and close enough to the data."""
    close = curve.within(solved.uniaxial(curve.nodes).nominal, tolerance)
    return close & _stable(solved, curve) if close.any() else close


def _stable(solved: Material, curve: MeanCurve) -> Mask:
    low, high = solved.stretch_limits
    return np.asarray((curve.nodes > low) & (curve.nodes < high))


def _matrix(law: str, stretch: Array) -> Array:
    """(n, k) nominal stress per unit of each constant."""
    return np.column_stack(list(LAWS[law].uniaxial_terms(stretch).values()))


def _named(law: str, constants: Array) -> dict[str, float]:
    return dict(zip(LAWS[law].uniaxial_terms(np.ones(1)), constants.tolist(), strict=True))


def _possible_stretches(law: str, nu: float) -> tuple[float, float]:
    """The stretches at which a bar of the law can be; they are limited for laws that have a Poisson ratio."""
    if Constant.POISSON_RATIO not in LAWS[law].constants().values():
        return 0.0, np.inf
    return LAWS[law].from_uniaxial(dict.fromkeys(LAWS[law].uniaxial_terms(np.ones(1)), 1.0), nu).stretch_limits
