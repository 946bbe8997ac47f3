"""Claims on d, the length of the soft zone at the clamp: its size, over the pressure, over the height, of all arms."""

import math
from collections.abc import Sequence
from typing import Any

from benchmarks.paper.claims.common import (
    ESTIMATORS,
    NAN,
    NOT_RUN,
    ON_LINE,
    ROUND,
    SAME,
    SHORT,
    TOUCHING,
    claim,
    range_of,
    single,
)
from benchmarks.paper.data import ARMS, LAWS, Data, above
from benchmarks.paper.drawing import PRINTED_D
from benchmarks.paper.estimates import DEFAULT, LENGTH_SCALE, PROCESS, Estimate, control
from benchmarks.paper.measures import line
from benchmarks.paper.reading import Claim, Reading


def length_of_zone(data: Data) -> Claim:
    readings = []
    wide = (PRINTED_D[0] * (1.0 - SAME), PRINTED_D[1] * (1.0 + SAME))
    for law in LAWS:
        for estimator in ESTIMATORS:
            estimates = [e for e in above(data.arm(ARMS[0], law, estimator), TOUCHING, 37.0) if e.is_usable]
            values = [e.d_over_length for e in estimates if not math.isnan(e.d_over_length)]
            if estimates:
                readings.append(range_of("d/l, 17 to 37 kPa", values, required=wide, law=law, estimator=estimator))
        for e in data.arm(ARMS[0], law, PROCESS):
            if e.state.pressure == 31.0:
                estimate = control(e.state, e.single_alpha)
                what = f"d/l that the process (L = {LENGTH_SCALE:g} mm) makes of a rod with one rigidity, 31 kPa"
                readings.append(single(what, estimate.d_over_length, law=law))
        default = [e for e in above(data.arm(ARMS[0], law, DEFAULT), TOUCHING, 37.0) if e.two_lines]
        if default:
            zone = [e.d_over_length * e.state.length for e in default]
            readings.append(range_of("d of the default, 17 to 37 kPa", zone, unit="mm", law=law))
    says = f"d/l of the pneu-net is {PRINTED_D[0]} to {PRINTED_D[1]}"
    why = (
        "Means over a pitch widen the soft first cell, and the Gaussian process makes such a d of a rod that has one "
        "rigidity (its length scale was chosen because it prints 0.13). The default compares the law as the estimate "
        "resolves it and finds the zone itself."
    )
    return claim("9", says, readings, why, NOT_RUN["pneunet"])


def _off_of_zone(what: str, off: float, estimates: Sequence[Estimate], at: dict[str, Any]) -> Reading:
    """How far d/l is off a line, %, known as well as d itself."""
    spread = 2.0 * max(e.d_deviation for e in estimates) / max(e.d_over_length for e in estimates)
    low, high = (100.0 * max(0.0, off + sign * spread) for sign in (-1.0, 1.0))
    return Reading(what, 100.0 * off, low, high, "%", ON_LINE, **at)


def zone_over_pressure(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for estimator in ESTIMATORS:
            estimates = [e for e in above(data.arm(ARMS[0], law, estimator), 5.0, 40.0) if e.is_usable]
            estimates = [e for e in estimates if not math.isnan(e.d_over_length)]
            if len(estimates) > 2:
                fit = line([e.state.pressure for e in estimates], [e.d_over_length for e in estimates])
                at: dict[str, Any] = {"law": law, "estimator": estimator}
                what = f"d/l off a line, {estimates[0].state.pressure:g} to {estimates[-1].state.pressure:g} kPa"
                readings.append(_off_of_zone(what, fit.off, estimates, at))
                change = 1e3 * fit.slope
                readings.append(single("slope of d/l", change, 2e3 * fit.slope_std, unit="10⁻³/kPa", **at))
    says = "d/l is linear in p from 5 to 40 kPa (Fig. 11 b)"
    return claim(
        "10", says, readings, "Below 10 to 17 kPa no two slopes exist that d could divide.", NOT_RUN["pneunet"]
    )


def zone_over_height(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for estimator in ESTIMATORS:
            of_law = [*data.of("pneunet", law, ARMS[0], estimator), *data.of("heights", law, ARMS[0], estimator)]
            estimates = [
                e for e in of_law if e.state.pressure == 24.0 and e.is_usable and not math.isnan(e.d_over_length)
            ]
            heights = [float(e.state.config["geometry"]["chamber_height"]) for e in estimates]
            at: dict[str, Any] = {"law": law, "estimator": estimator}
            if len(set(heights)) > 2:
                fit = line(heights, [e.d_over_length for e in estimates])
                what = f"d/l off a line over H, {min(heights):g} to {max(heights):g} mm, 24 kPa"
                readings.append(_off_of_zone(what, fit.off, estimates, at))
                readings.append(single("slope of d/l", 1e3 * fit.slope, 2e3 * fit.slope_std, unit="10⁻³/mm", **at))
            elif data.of("heights", law):
                reason = f"two lines are needed at {len(set(heights))} of 5 heights"
                readings.append(single("d/l over H", NAN, required=ON_LINE, without=reason, **at))
    says = "d/l is linear in the height H of the chambers from 4 to 19 mm (Fig. 11 b)"
    why = "The walls of low chambers do not touch, and without contact there is no second slope."
    return claim("11", says, readings, why, "the sweep `heights` has not been run")


def zone_of_arms(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for arm in ROUND:
            for estimator in ESTIMATORS:
                estimates = above(data.arm(arm, law, estimator), 24.0, 37.0)
                usable = [e.d_over_length for e in estimates if e.is_usable and not math.isnan(e.d_over_length)]
                if estimates:
                    reason = "one line is enough" if estimator == DEFAULT else "d at the end of its range"
                    what = f"d/l, {SHORT[arm]}, 24 to 37 kPa"
                    required = (0.048 * (1.0 - SAME), 0.048 * (1.0 + SAME))
                    at = {
                        "law": law,
                        "arm": arm,
                        "estimator": estimator,
                        "required": required,
                        "without": "" if usable else reason,
                    }
                    readings.append(range_of(what, usable, denies=estimator == DEFAULT, **at))
    says = "d = 0.048 l for the other three arms (Fig. 16)"
    why = "A single line describes these arms, and means over a pitch show no break within half a pitch of the clamp."
    return claim("12", says, readings, why, NOT_RUN["arms"])
