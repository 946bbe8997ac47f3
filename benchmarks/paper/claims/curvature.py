"""Claims on kappa_0 and kappa of experiments I, II and III: over the pressure, along the arm, without the clamp."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.paper.claims.common import (
    AT_MOST,
    NAN,
    NEAR_ONE,
    NOT_RUN,
    ON_LINE,
    ROUND,
    SAME,
    STRAIGHT,
    claim,
    range_of,
    single,
)
from benchmarks.paper.data import ARMS, LAWS, Data
from benchmarks.paper.measures import aligned_distance, line, sign_change
from benchmarks.paper.reading import Claim, Reading
from benchmarks.paper.states import State
from rod import cell_averaged


def _kappa(states: Sequence[State]) -> tuple[list[float], list[float], list[float]]:
    """Pressures (kPa), kappa_0(l/2) and the standard deviation of kappa_0 over the middle third (1/m)."""
    deviations = []
    for state in states:
        s, kappa = state.kappa_0.s, state.kappa_0.kappa
        deviations.append(1000.0 * float(kappa[(s > state.length / 3) & (s < 2 * state.length / 3)].std()))
    return [s.pressure for s in states], [1000.0 * s.kappa_0_middle for s in states], deviations


def _off(what: str, states: Sequence[State], origin: bool, **others: Any) -> Reading:
    """How far kappa_0(l/2) is off a straight line over the pressure, %."""
    pressures, values, deviations = _kappa(states)
    if len(states) < 3:
        return single(what, NAN, without="fewer than three pressures", **others)
    fit = line(pressures, values, origin=origin)
    spread = 100.0 * 2.0 * max(deviations) / max(map(abs, values))
    return Reading(what, 100 * fit.off, max(0.0, 100 * fit.off - spread), 100 * fit.off + spread, "%", **others)


def curvature_of_pneunet(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        if states := [s for s in data.states("pneunet", law, ARMS[0]) if s.pressure <= 37.0]:
            readings.append(_off("off a line through 0, 1 to 37 kPa", states, True, required=ON_LINE, law=law))
            pressures, values, _ = _kappa(states)
            drop = 100.0 * (1.0 - (values[-1] / pressures[-1]) / (values[0] / pressures[0]))
            readings.append(single("fall of κ₀/p from 1 to 37 kPa", drop, unit="%", law=law))
    why = (
        "True St. Venant-Kirchhoff material stiffens in tension, so κ₀ grows less than p. Hencky's law, linear in the "
        "logarithmic strain, has κ₀ proportional to p."
    )
    return claim(
        "1a", "κ₀(l/2) of the pneu-net is linear in p throughout (Fig. 15 a)", readings, why, NOT_RUN["pneunet"]
    )


def curvature_of_arms(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for arm in ROUND:
            states = data.states("arms", law, arm)
            if not states:
                continue
            at: dict[str, Any] = {"law": law, "arm": arm}
            all_of, upper = "off a line, 1 to 37 kPa", "off a line, 24 to 37 kPa"
            bent = (100.0 * STRAIGHT, math.inf)
            readings.append(_off(all_of, states, False, required=bent, part="off one line, 1 to 37 kPa", **at))
            above_20 = [s for s in states if s.pressure > 20.0]
            readings.append(_off(upper, above_20, False, required=ON_LINE, part="off a line, 24 to 37 kPa", **at))
            pressures, values, _ = _kappa(above_20)
            if len(above_20) > 2:
                readings.append(
                    single("line from 24 kPa meets 0 at", line(pressures, values).at_zero, unit="kPa", **at)
                )
    says = "κ₀(l/2) of the other three arms is linear in p only above some 20 kPa (Fig. 15 a)"
    why = "The dimensions of these arms are our own, for the paper prints none."
    return claim("1b", says, readings, why, NOT_RUN["arms"])


def curvature_without_clamp(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        states = [s for s in data.states("pneunet", law, ARMS[0]) if s.unclamped is not None]
        if not states:
            continue
        ratios, distances, inner = [], [], []
        for state in states:
            assert state.unclamped is not None
            free, clamped = cell_averaged(state.unclamped, state.pitch), state.kappa_0
            ratios.append(float(np.interp(state.length / 2, free.s, free.kappa)) / state.kappa_0_middle)
            distances.append(100.0 * aligned_distance(state.unclamped, state.curves.free) / state.length)
            apart = np.abs(
                np.interp(clamped.s, free.s, free.kappa) / state.kappa_0_middle - clamped.kappa / state.kappa_0_middle
            )
            inner.append(100.0 * float(apart[clamped.s < 1.01 * state.pitch].max(initial=0.0)))
        readings += [
            range_of("κ₀(l/2) in I over that in II", ratios, required=NEAR_ONE, law=law, part="curvature"),
            range_of("distance after alignment over l", distances, unit="%", required=AT_MOST, law=law, part="shape"),
            range_of("difference of κ₀ within a pitch of the clamp, over κ₀(l/2)", inner, unit="%", law=law),
        ]
    says = "Tests I and II have the same κ₀ after alignment (Fig. 7)"
    why = "The clamp keeps the first half cell from bulging and changes nothing beyond."
    return claim("2", says, readings, why, NOT_RUN["pneunet"])


def middle_of_arm(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        states = [s for s in data.states("pneunet", law, ARMS[0]) if s.pressure >= 5.0]
        if not states:
            continue
        spreads, changes, slopes = [], [], []
        for state in states:
            kappa_0, kappa = state.kappa_0, cell_averaged(state.curves.loaded, state.pitch)
            middle = (kappa_0.s > state.length / 4) & (kappa_0.s < 3 * state.length / 4)
            spreads.append(100.0 * float(np.ptp(kappa_0.kappa[middle])) / abs(state.kappa_0_middle))
            changes.append(sign_change(kappa.s, kappa.kappa) / state.length)
            slopes.append(100.0 * abs(float(np.ptp(kappa.kappa[middle]))) / float(np.abs(kappa.kappa).max()))
        none = {"without": "the sign does not change at every pressure", "denies": True}
        positions = [NAN] if any(map(math.isnan, changes)) else changes
        at: dict[str, Any] = {"law": law}
        readings += [
            range_of("range of κ₀ over the middle half", spreads, unit="%", required=AT_MOST, part="κ₀ constant", **at),
            range_of("s/l at which κ of III changes sign", positions, required=(0.0, 1.0), part="sign", **none, **at),
            range_of(
                "range of κ of III over the middle half",
                slopes,
                unit="%",
                required=(AT_MOST[1], 100.0),
                part="slope",
                **at,
            ),
        ]
    says = "The middle of II has a constant curvature; κ of III changes its sign and has a slope there (Fig. 8)"
    return claim(
        "3", says, readings, "Equal cells bend equally; III needs a moment that falls to the end.", NOT_RUN["pneunet"]
    )


def curvature_by_equation_nine(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        states = {s.pressure: s for s in data.states("pneunet", law, ARMS[0])}
        if 24.0 not in states or 37.0 not in states:
            continue
        largest = abs(states[37.0].kappa_0_middle)
        for pressure in (5.0, 10.0, 37.0):
            predicted = states[24.0].kappa_0_middle * pressure / 24.0
            error = 100.0 * (abs(predicted) - abs(states[pressure].kappa_0_middle)) / largest
            required = (-100.0 * SAME, 100.0 * SAME)
            what = f"κ₀(l/2) at {pressure:g} kPa by eq. (9) from 24 kPa: error over κ₀ at 37 kPa"
            readings.append(single(what, error, unit="%", required=required, law=law, pressure=f"{pressure:g} kPa"))
    says = "κ₀ at another pressure follows from p/p₀ (eq. 9)"
    why = "It holds where κ₀ is proportional to p, see 1a."
    return claim("15", says, readings, why, NOT_RUN["pneunet"])
