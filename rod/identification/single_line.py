"""One straight line M = alpha Delta + m0 for the whole rod, where two lines say no more.

In arms without gaps between their chambers M/Delta is the same all along the middle, and within a diameter of each held
end Delta varies by several times its mean. Nothing but this variation determines an offset there, and a line that
follows it predicts other loads badly. Where the data do not show an offset, the line is therefore fitted once more with
a narrow prior: it passes the origin within ZERO_OFFSET_PRIOR of the largest Delta, for a section without moment does
not bend, and it satisfies the closure condition more closely than two lines do, for it turns the middle and both ends
by as much as the whole arm turns. studies/identification.md compares the forces under other loads with both priors.
"""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod.curves.uncertainty import Bootstrap, Interval, interval, sample_errors
from rod.errors import RodError
from rod.identification.observed import Observed
from rod.identification.regression import MAX_RIGIDITY_RATIO, OFFSET, Regression

#: standard deviations beyond which the data show an offset
OFFSET_SIGNIFICANCE = 3.0
#: prior standard deviation of an offset that the data do not show, over the largest Delta
ZERO_OFFSET_PRIOR = 0.03
#: how many times more the closure weighs for such a line than for two lines: it closes within 1 % instead of 3 %. The
#: bootstrap still draws the closure with 3 %
CLOSURE_WEIGHT = 3.0


@dataclass(frozen=True)
class LineFit:
    """One straight line M = alpha Delta + m0 for the whole rod."""

    alpha: Interval  #: N mm2
    m0: Interval  #: N mm
    r2: float  #: fraction of the variance of Delta that is explained, with the ripple within the cells


def single_line(observed: Observed, bootstrap: Bootstrap) -> LineFit:
    """The line with its intervals. Raises `RodError` where curvature falls as the moment grows."""
    (a, b), drawn, r2 = _fit_line(observed, OFFSET, 1.0, bootstrap)
    if abs(b) < OFFSET_SIGNIFICANCE * float(drawn[1].std()):
        closed = _fit_line(observed, ZERO_OFFSET_PRIOR, CLOSURE_WEIGHT, bootstrap)
        compliance = closed[0][0]
        if compliance > 0.0:  # the end of an arm that hardly bends may move against the moment
            (a, b), drawn, r2 = closed
    if a <= 0.0:
        raise RodError("Curvature falls where the moment grows: no positive rigidity fits these data.")
    compliances = np.maximum(drawn[0], a / MAX_RIGIDITY_RATIO)
    return LineFit(interval(1.0 / a, 1.0 / compliances), interval(b / a, drawn[1] / compliances), r2)


def _fit_line(
    observed: Observed, offset: float, closure_weight: float, bootstrap: Bootstrap
) -> tuple[Array, Array, float]:
    """Compliance and offset of Delta = a M - b (2,), bootstrap draws of them (2, draws), and R squared."""
    weighing = observed.weighing_closure(closure_weight)
    regression = Regression.weighted(weighing, observed.noise, offset, lambda trial: trial.solve())
    fit, weights, random = regression.solve(), regression.weights, bootstrap.generator()
    prior = random.standard_normal((len(fit.prior), bootstrap.draws))
    prior[-1] *= closure_weight  # weighing the closure more does not make its error smaller
    errors = sample_errors(weights.error, bootstrap.draws, random)
    drawn = fit.inverse @ np.vstack([weights.data * errors, prior])
    return fit.parameters[:2], fit.parameters[:2, None] + drawn[:2], observed.r_squared(fit.fitted)
