"""Every law fitted to tensile tests: its constants, their errors, and the range of stretch over which it is valid.

The laws of rubber are fitted as incompressible (`pipeline.material.form`), which rubber nearly is; kappa then follows
from the given Poisson ratio. Validity is judged for the law as the solver has it, with
that kappa: at every stretch of the range the law is stable, and its nominal stress is within a relative tolerance of
the mean measured curve (plus the uncertainty of that curve).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.materials import Material, MaterialError
from geometry.arrays import Array, Mask
from pipeline.material.form import Form
from pipeline.material.forms import FORMS
from pipeline.material.mean_curve import MeanCurve
from pipeline.material.regression import TooFewPoints, regress


@dataclass(frozen=True)
class LawFit:
    """One law, fitted to the points within a range of stretch."""

    name: str  #: of the law, for Ogden's with the number of its terms
    law: str  #: as in the YAML
    constants: Mapping[str, float]  #: fitted, MPa; exponents without unit
    errors: Mapping[str, float]  #: their standard errors, in the same units
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

    name: str
    reason: str


def fit_all(name: str, curve: MeanCurve, nu: float, tolerance: float) -> LawFit | Refused:
    """The law fitted to all points within the stretches that it admits."""
    form = FORMS[name]
    low, high = form.possible_stretches(nu)
    return _fit(form, curve, (curve.stretch > low) & (curve.stretch < high), nu, tolerance)


def fit_widest(name: str, curve: MeanCurve, nu: float, tolerance: float) -> LawFit | Refused:
    """The law fitted to the widest range of points around rest over all of which it is valid.

    The range is shortened where the law does not describe large strains. A law that the data do not determine is
    refused, whatever the range.
    """
    form = FORMS[name]
    reach, points = np.abs(np.log(curve.nodes)), np.abs(np.log(curve.stretch))
    resolved = reach[curve.resolves(tolerance)]
    if not len(resolved):
        return Refused(name, f"cannot be judged: the scatter of the points exceeds {100 * tolerance:g} % of the stress")
    refusals: list[MaterialError] = []
    too_few = ""
    ends = np.unique(reach[reach >= resolved.min()])[::-1]
    ends = ends[:: -(-len(ends) // form.ranges)]
    for number, largest in enumerate(ends):
        selected = points <= largest * (1 + 1e-9)
        try:
            constants = form.fitted(curve.stretch[selected], curve.stress[selected])
            valid = _valid(form.solved(constants, nu), curve, tolerance)
        except TooFewPoints as failure:  # and fewer points determine less
            if not number:
                return Refused(name, f"cannot be fitted: {failure}")
            too_few = f"over a range that determines it: {failure}"
            break
        except MaterialError as failure:
            refusals.append(failure)
            continue
        if valid[reach <= largest].all():
            return _fit(form, curve, selected, nu, tolerance)
    if len(refusals) == len(ends):
        return Refused(name, f"cannot be fitted: {refusals[0]}")
    return Refused(name, f"is not within {100 * tolerance:g} % of the data {too_few or 'anywhere'}")


def _fit(form: Form, curve: MeanCurve, selected: Mask, nu: float, tolerance: float) -> LawFit | Refused:
    """The constants and, from the law linearised at them, their errors."""
    stretch, stress = curve.stretch[selected], curve.stress[selected]
    try:
        constants = form.fitted(stretch, stress)
        slopes = form.slopes(constants, stretch)
        linearised = stress - form.nominal(constants, stretch) + slopes @ constants
        regression = regress(slopes, linearised, curve.tests[selected])
        solved = form.solved(constants, nu)
        if undetermined := form.undetermined(constants, regression.covariance, stretch, stress):
            raise TooFewPoints(undetermined)
    except TooFewPoints as failure:
        return Refused(form.name, f"cannot be fitted: {failure}")
    except MaterialError as failure:
        return Refused(form.name, f"has no admissible constants for these data: {failure}")
    residuals = solved.uniaxial(stretch).nominal - stress
    incompressible = form.nominal(constants, curve.nodes)
    valid_range, limited_by = _valid_range(solved, curve, incompressible, tolerance)
    return LawFit(
        form.name,
        form.law,
        form.named(constants),
        form.named(regression.errors),
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
