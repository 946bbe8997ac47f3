"""The claims of the paper as readings: kappa_0, the two slopes, d, lengths, the end force, the rods."""

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from benchmarks.paper.data import ARMS, LAWS, Data, above, states_in
from benchmarks.paper.drawing import PRINTED_D
from benchmarks.paper.estimates import CELLS, DEFAULT, LENGTH_SCALE, PROCESS, Estimate, control, process
from benchmarks.paper.measures import aligned_distance, line, sign_change
from benchmarks.paper.reading import Claim, Reading
from benchmarks.paper.rods import fitted, own
from benchmarks.paper.states import State, weight_of
from rod import RodError, cell_averaged
from rod.identification.paper import Subtracted

#: two numbers are equal if they differ by at most this part
SAME = 0.05
#: points lie on a line if they are off it by at most this part of the largest value, about what a printed figure shows
STRAIGHT = 0.02
#: from this pressure on (kPa) the walls of the pneu-net touch
TOUCHING = 17.0
ESTIMATORS = (CELLS, PROCESS, DEFAULT)
ROUND = ARMS[1:]
NAN = math.nan
UP, DOWN = (0.0, math.inf), (-math.inf, 0.0)
AT_MOST, ON_LINE = (0.0, 100.0 * SAME), (0.0, 100.0 * STRAIGHT)
NEAR_ONE = (1.0 - SAME, 1.0 + SAME)
#: the force of Fig. 5 (b), N
FORCE = (0.175, 0.07)


def claims(data: Data) -> list[Claim]:
    """All claims, in the order of the paper's figures."""
    return [make(data) for make in _CLAIMS]


#: what is subtracted before the process of `paper_process`; its default first
SUBTRACTED: tuple[Subtracted, ...] = ("chord", "chord and mean", "mean")
SLOPE_BY_PROCESS = "α₁ by paper_process, 17 to 37 kPa"
SLOPE_OF_ONE_RIGIDITY = "α₁ by paper_process of a rod with one rigidity, 31 kPa"


def _claim(number: str, says: str, readings: Iterable[Reading], why: str, missing: str) -> Claim:
    found = tuple(readings)
    return Claim(number, says, found, why if found else "", "" if found else missing)


def _single(what: str, value: float, spread: float = 0.0, **others: object) -> Reading:
    """A reading with its interval on both sides; without a number if it is nan."""
    return Reading(what, value, value - spread, value + spread, **others)  # type: ignore[arg-type]


def _range(what: str, values: Sequence[float], **others: object) -> Reading:
    """The mean of values and their range."""
    if not len(values):
        return Reading(what, NAN, NAN, NAN, **others)  # type: ignore[arg-type]
    return Reading(what, float(np.mean(values)), float(min(values)), float(max(values)), **others)  # type: ignore[arg-type]


def _kappa(states: Sequence[State]) -> tuple[list[float], list[float], list[float]]:
    """Pressures (kPa), kappa_0(l/2) and the standard deviation of kappa_0 over the middle third (1/m)."""
    deviations = []
    for state in states:
        s, kappa = state.kappa_0.s, state.kappa_0.kappa
        deviations.append(1000.0 * float(kappa[(s > state.length / 3) & (s < 2 * state.length / 3)].std()))
    return [s.pressure for s in states], [1000.0 * s.kappa_0_middle for s in states], deviations


def _off(what: str, states: Sequence[State], origin: bool, **others: object) -> Reading:
    """How far kappa_0(l/2) is off a straight line over the pressure, %."""
    pressures, values, deviations = _kappa(states)
    if len(states) < 3:
        return _single(what, NAN, without="fewer than three pressures", **others)
    found = line(pressures, values, origin=origin)
    spread = 100.0 * 2.0 * max(deviations) / max(map(abs, values))
    return Reading(what, 100 * found.off, max(0.0, 100 * found.off - spread), 100 * found.off + spread, "%", **others)  # type: ignore[arg-type]


def curvature_of_pneunet(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        if states := [s for s in data.states("pneunet", law, ARMS[0]) if s.pressure <= 37.0]:
            readings.append(_off("off a line through 0, 1 to 37 kPa", states, True, asked=ON_LINE, law=law))
            pressures, values, _ = _kappa(states)
            drop = 100.0 * (1.0 - (values[-1] / pressures[-1]) / (values[0] / pressures[0]))
            readings.append(_single("fall of κ₀/p from 1 to 37 kPa", drop, unit="%", law=law))
    why = (
        "True St. Venant-Kirchhoff material stiffens in tension, so κ₀ grows less than p. Hencky's law, linear in the "
        "logarithmic strain, has κ₀ proportional to p."
    )
    return _claim("1a", "κ₀(l/2) of the pneu-net is linear in p throughout (Fig. 15 a)", readings, why, _NO["pneunet"])


def curvature_of_arms(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for arm in ROUND:
            states = data.states("arms", law, arm)
            if not states:
                continue
            at = {"law": law, "arm": arm}
            all_of, upper = "off a line, 1 to 37 kPa", "off a line, 24 to 37 kPa"
            bent = (100.0 * STRAIGHT, math.inf)
            readings.append(_off(all_of, states, False, asked=bent, part="bent below 20 kPa", **at))
            above_20 = [s for s in states if s.pressure > 20.0]
            readings.append(_off(upper, above_20, False, asked=ON_LINE, part="straight above 20 kPa", **at))
            pressures, values, _ = _kappa(above_20)
            if len(above_20) > 2:
                readings.append(
                    _single("line from 24 kPa meets 0 at", line(pressures, values).at_zero, unit="kPa", **at)
                )
    says = "κ₀(l/2) of the other three arms is linear in p only above some 20 kPa (Fig. 15 a)"
    why = "The dimensions of these arms are our own, for the paper prints none."
    return _claim("1b", says, readings, why, _NO["arms"])


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
            _range("κ₀(l/2) in I over that in II", ratios, asked=NEAR_ONE, law=law, part="curvature"),
            _range("distance after alignment over l", distances, unit="%", asked=AT_MOST, law=law, part="shape"),
            _range("difference of κ₀ within a pitch of the clamp, over κ₀(l/2)", inner, unit="%", law=law),
        ]
    says = "Tests I and II have the same κ₀ after alignment (Fig. 7)"
    why = "The clamp keeps the first half cell from bulging and changes nothing beyond."
    return _claim("2", says, readings, why, _NO["pneunet"])


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
        place = [NAN] if any(map(math.isnan, changes)) else changes
        at = {"law": law}
        readings += [
            _range("range of κ₀ over the middle half", spreads, unit="%", asked=AT_MOST, part="κ₀ constant", **at),
            _range("s/l at which κ of III changes sign", place, asked=(0.0, 1.0), part="sign", **none, **at),
            _range(
                "range of κ of III over the middle half",
                slopes,
                unit="%",
                asked=(AT_MOST[1], 100.0),
                part="slope",
                **at,
            ),
        ]
    says = "The middle of II has a constant curvature; κ of III changes its sign and has a slope there (Fig. 8)"
    return _claim(
        "3", says, readings, "Equal cells bend equally; III needs a moment that falls to the end.", _NO["pneunet"]
    )


def two_slopes(data: Data) -> Claim:
    readings = []
    for sweep, beside in (("pneunet", ""), ("contact", ", without contact")):
        for law in LAWS:
            for name, low, high in (("17 to 37 kPa", TOUCHING, 37.0), ("5 and 10 kPa", 5.0, 10.0)):
                found = above(data.of(sweep, law, ARMS[0], DEFAULT), low, high)
                if found:
                    part = 100.0 * sum(bool(e.two_lines) for e in found) / len(found)
                    asked = None if beside else (100.0, 100.0)
                    what = f"pressures that need two lines, {name}{beside}"
                    readings.append(_single(what, part, unit="%", asked=asked, law=law, pressure=name))
    says = "M over κ - κ₀ of the pneu-net has two slopes (Fig. 9 a)"
    why = "Walls that touch stiffen all cells but the first one; below 17 kPa they do not touch."
    return _claim("4a", says, readings, why, _NO["pneunet"])


def contact_is_the_cause(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        found = above(data.of("contact", law, ARMS[0], DEFAULT), TOUCHING, 37.0)
        if found:
            part = 100.0 * sum(bool(e.two_lines) for e in found) / len(found)
            what = "pressures from 17 to 37 kPa that need two lines without contact"
            readings.append(_single(what, part, unit="%", asked=(0.0, 0.0), law=law))
            grows = found[-1].single_alpha / found[0].single_alpha
            readings.append(_single("single rigidity at the highest over that at 17 kPa", grows, law=law))
    says = "Walls that touch cause the difference in stiffness (concluding remarks)"
    why = "The same arm with walls that may pass through each other."
    return _claim("4b", says, readings, why, "the sweep `contact` has not been run")


def _slopes(
    data: Data, arm: str, name: str, low: float
) -> Iterable[tuple[str, str, list[float], list[float], list[float]]]:
    """Law, estimator, pressures, values and deviations of alpha1 or alpha2 where it has a meaning."""
    for law in LAWS:
        for estimator in ESTIMATORS:
            found = [e for e in above(data.arm(arm, law, estimator), low, 37.0) if e.is_usable]
            if name == "alpha1" and estimator == DEFAULT:
                found = [e for e in found if e.two_lines]
            deviations = [e.deviations[0 if name == "alpha1" else 1] for e in found if e.deviations is not None]
            yield law, estimator, [e.state.pressure for e in found], [getattr(e, name) for e in found], deviations


def _straight(name: str) -> Callable[[Data], Claim]:
    def make(data: Data) -> Claim:
        readings = []
        for law, estimator, pressures, values, deviations in _slopes(data, ARMS[0], name, TOUCHING):
            at = {"law": law, "estimator": estimator}
            what = f"{_SYMBOL[name]} off a line, 17 to 37 kPa"
            if len(values) < 3:
                readings += (
                    [_single(what, NAN, asked=ON_LINE, without="fewer than three pressures", **at)]
                    if data.arm(ARMS[0], law)
                    else []
                )
                continue
            found = line(pressures, values, deviations)
            spread = 100.0 * 2.0 * float(np.mean(deviations)) / max(map(abs, values)) if deviations else 0.0
            value = 100.0 * found.off
            readings.append(Reading(what, value, max(0.0, value - spread), value + spread, "%", ON_LINE, **at))
            readings.append(
                _single(f"slope of {_SYMBOL[name]}", found.slope, 2.0 * found.slope_std, unit="N mm²/kPa", **at)
            )
        number = "5a" if name == "alpha2" else "5b"
        says = f"{_SYMBOL[name]} of the pneu-net is a linear function of p (Fig. 9 b)"
        return _claim(number, says, readings, _WHY_STRAIGHT[name], _NO["pneunet"])

    return make


_SYMBOL = {"alpha1": "α₁", "alpha2": "α₂"}
_WHY_STRAIGHT = {
    "alpha2": "From 17 kPa on, where walls touch; below, the law bends.",
    "alpha1": "The default finds α₁ constant within its interval; a slope comes with the other estimators.",
}


def _trend(number: str, arms: Sequence[str], name: str, rises: bool, says: str, why: str) -> Callable[[Data], Claim]:
    def make(data: Data) -> Claim:
        readings = []
        for arm in arms:
            for law, estimator, pressures, values, deviations in _slopes(data, arm, name, 10.0):
                at = {"law": law, "estimator": estimator, "arm": arm, "asked": UP if rises else DOWN}
                what = f"slope of {_SYMBOL[name]}, {_SHORT[arm]}"
                if len(values) >= 3:
                    found = line(pressures, values, deviations)
                    what += f", {pressures[0]:g} to {pressures[-1]:g} kPa ({values[0]:.0f} to {values[-1]:.0f} N mm²)"
                    readings.append(_single(what, found.slope, 2.0 * found.slope_std, unit="N mm²/kPa", **at))
                elif data.arm(arm, law):
                    reason = "one line is enough" if estimator == DEFAULT else "d at the end of its range"
                    readings.append(_single(what, NAN, without=reason, **at))
        if number == "6b":
            readings += _slopes_by_process(data)
        return _claim(number, says, readings, why, _NO["pneunet" if arms[0] == ARMS[0] else "arms"])

    return make


def _slopes_by_process(data: Data) -> list[Reading]:
    """What the slope of paper_process depends on: what is subtracted before, and the smoothing itself."""
    readings = []
    for law in LAWS:
        states = [s for s in data.states("pneunet", law, ARMS[0]) if TOUCHING <= s.pressure <= 37.0]
        if not states:
            continue
        for name in SUBTRACTED:
            found = [e for e in (process(s, subtracted=name) for s in states) if e.is_usable]
            values, zones = [e.alpha1 for e in found], [e.d_over_length for e in found]
            readings.append(_range(f"{SLOPE_BY_PROCESS}, {name} subtracted", values, unit="N mm²", law=law))
            readings.append(_range(f"d/l with it, {name} subtracted", zones, law=law))
        for state in (s for s in states if s.pressure == 31.0):
            alpha = control(state, process(state).single_alpha).alpha1
            readings.append(_single(SLOPE_OF_ONE_RIGIDITY, alpha, unit="N mm²", law=law))
    return readings


_SHORT = {
    "pneunet": "pneu-net",
    "semicircular": "semicircular",
    "semicircular_single": "one cavity",
    "bisected_circle": "bisected circle",
}


def length_of_zone(data: Data) -> Claim:
    readings = []
    wide = (PRINTED_D[0] * (1.0 - SAME), PRINTED_D[1] * (1.0 + SAME))
    for law in LAWS:
        for estimator in ESTIMATORS:
            found = [e for e in above(data.arm(ARMS[0], law, estimator), TOUCHING, 37.0) if e.is_usable]
            values = [e.d_over_length for e in found if not math.isnan(e.d_over_length)]
            if found:
                readings.append(_range("d/l, 17 to 37 kPa", values, asked=wide, law=law, estimator=estimator))
        for e in data.arm(ARMS[0], law, PROCESS):
            if e.state.pressure == 31.0:
                one = control(e.state, e.single_alpha)
                what = f"d/l that the process (L = {LENGTH_SCALE:g} mm) makes of a rod with one rigidity, 31 kPa"
                readings.append(_single(what, one.d_over_length, law=law))
        default = [e for e in above(data.arm(ARMS[0], law, DEFAULT), TOUCHING, 37.0) if e.two_lines]
        if default:
            zone = [e.d_over_length * e.state.length for e in default]
            readings.append(_range("d of the default, 17 to 37 kPa", zone, unit="mm", law=law))
    says = f"d/l of the pneu-net is {PRINTED_D[0]} to {PRINTED_D[1]}"
    why = (
        "Means over a pitch widen the soft first cell, and the Gaussian process makes such a d of a rod that has one "
        "rigidity (its length scale was chosen because it prints 0.13). The default compares the law as the estimate "
        "resolves it and finds the zone itself."
    )
    return _claim("9", says, readings, why, _NO["pneunet"])


def _off_of_zone(what: str, off: float, found: Sequence[Estimate], at: dict[str, str]) -> Reading:
    """How far d/l is off a line, %, known as well as d itself."""
    spread = 2.0 * max(e.d_deviation for e in found) / max(e.d_over_length for e in found)
    low, high = (100.0 * max(0.0, off + sign * spread) for sign in (-1.0, 1.0))
    return Reading(what, 100.0 * off, low, high, "%", ON_LINE, **at)


def zone_over_pressure(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for estimator in ESTIMATORS:
            found = [e for e in above(data.arm(ARMS[0], law, estimator), 5.0, 40.0) if e.is_usable]
            found = [e for e in found if not math.isnan(e.d_over_length)]
            if len(found) > 2:
                fit = line([e.state.pressure for e in found], [e.d_over_length for e in found])
                at = {"law": law, "estimator": estimator}
                what = f"d/l off a line, {found[0].state.pressure:g} to {found[-1].state.pressure:g} kPa"
                readings.append(_off_of_zone(what, fit.off, found, at))
                change = 1e3 * fit.slope
                readings.append(_single("slope of d/l", change, 2e3 * fit.slope_std, unit="10⁻³/kPa", **at))
    says = "d/l is linear in p from 5 to 40 kPa (Fig. 11 b)"
    return _claim("10", says, readings, "Below 10 to 17 kPa no two slopes exist that d could divide.", _NO["pneunet"])


def zone_over_height(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for estimator in ESTIMATORS:
            of_law = [*data.of("pneunet", law, ARMS[0], estimator), *data.of("heights", law, ARMS[0], estimator)]
            found = [e for e in of_law if e.state.pressure == 24.0 and e.is_usable and not math.isnan(e.d_over_length)]
            heights = [float(e.state.config["geometry"]["chamber_height"]) for e in found]
            at = {"law": law, "estimator": estimator}
            if len(set(heights)) > 2:
                fit = line(heights, [e.d_over_length for e in found])
                what = f"d/l off a line over H, {min(heights):g} to {max(heights):g} mm, 24 kPa"
                readings.append(_off_of_zone(what, fit.off, found, at))
                readings.append(_single("slope of d/l", 1e3 * fit.slope, 2e3 * fit.slope_std, unit="10⁻³/mm", **at))
            elif data.of("heights", law):
                reason = f"two lines are needed at {len(set(heights))} of 5 heights"
                readings.append(_single("d/l over H", NAN, asked=ON_LINE, without=reason, **at))
    says = "d/l is linear in the height H of the chambers from 4 to 19 mm (Fig. 11 b)"
    why = "The walls of low chambers do not touch, and without contact there is no second slope."
    return _claim("11", says, readings, why, "the sweep `heights` has not been run")


def zone_of_arms(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for arm in ROUND:
            for estimator in ESTIMATORS:
                found = above(data.arm(arm, law, estimator), 24.0, 37.0)
                usable = [e.d_over_length for e in found if e.is_usable and not math.isnan(e.d_over_length)]
                if found:
                    reason = "one line is enough" if estimator == DEFAULT else "d at the end of its range"
                    what = f"d/l, {_SHORT[arm]}, 24 to 37 kPa"
                    asked = (0.048 * (1.0 - SAME), 0.048 * (1.0 + SAME))
                    at = {
                        "law": law,
                        "arm": arm,
                        "estimator": estimator,
                        "asked": asked,
                        "without": "" if usable else reason,
                    }
                    readings.append(_range(what, usable, denies=estimator == DEFAULT, **at))
    says = "d = 0.048 l for the other three arms (Fig. 16)"
    why = "A single line describes these arms, and means over a pitch show no break within half a pitch of the clamp."
    return _claim("12", says, readings, why, _NO["arms"])


def curvature_over_length(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        pairs = _pairs(data, law, CELLS)
        ratios = [a.state.kappa_0_middle / b.state.kappa_0_middle for a, b in pairs]
        if ratios:
            what = "κ₀(l/2) l over that of 11 chambers, over l/l₀ (7 and 20 chambers; 10, 24, 37 kPa)"
            readings.append(_range(what, ratios, asked=NEAR_ONE, law=law))
    says = "κ₀ l is proportional to l/l₀ (eq. 9, Fig. 12)"
    return _claim("13", says, readings, "More equal cells bend each by the same.", _NO["lengths"])


def rigidity_over_length(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for estimator in (CELLS, DEFAULT):
            for name in ("alpha1", "alpha2"):
                pairs = [
                    (a, b)
                    for a, b in _pairs(data, law, estimator)
                    if name == "alpha2" or estimator != DEFAULT or (a.two_lines and b.two_lines)
                ]
                ratios = [getattr(a, name) / getattr(b, name) for a, b in pairs]
                at = {"law": law, "estimator": estimator}
                if ratios:
                    what = f"{_SYMBOL[name]}/(m g l²) over that of 11 chambers, times (l/l₀)², weight of 11 chambers"
                    readings.append(_range(what, ratios, asked=NEAR_ONE, part=name, **at))
                if ratios and name == "alpha2" and estimator == CELLS:
                    by_own = [
                        getattr(a, name) / getattr(b, name) * weight_of(b.state) / weight_of(a.state) for a, b in pairs
                    ]
                    readings.append(_range("the same with the weight of each arm", by_own, **at))
    says = "α/(m g l²) is proportional to (l₀/l)² (eq. 9, Fig. 13)"
    why = "Rigidities in N mm² belong to the cells: it holds with the weight of one arm, not with that of each arm."
    return _claim("14", says, readings, why, _NO["lengths"])


def _pairs(data: Data, law: str, estimator: str) -> list[tuple[Estimate, Estimate]]:
    """Arms of other lengths, each with the one of 11 chambers at the same pressure."""
    reference = {e.state.pressure: e for e in data.of("pneunet", law, ARMS[0], estimator)}
    others = data.of("lengths", law, ARMS[0], estimator)
    return [(e, reference[e.state.pressure]) for e in others if e.state.pressure in reference]


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
            asked = (-100.0 * SAME, 100.0 * SAME)
            what = f"κ₀(l/2) at {pressure:g} kPa by eq. (9) from 24 kPa: error over κ₀ at 37 kPa"
            readings.append(_single(what, error, unit="%", asked=asked, law=law, pressure=f"{pressure:g} kPa"))
    says = "κ₀ at another pressure follows from p/p₀ (eq. 9)"
    why = "It holds where κ₀ is proportional to p, see 1a."
    return _claim("15", says, readings, why, _NO["pneunet"])


def end_force(data: Data) -> Claim:
    readings = []
    for end in data.ends:
        if end.config["end"]["force_N"][0] != FORCE[0]:
            continue
        if end.held == (None, None):
            rest = float(end.config["geometry"].get("base", 0.0)) / 2.0
            for axis, value in zip("xy", (end.position[0] - _length(end), end.position[1] - rest), strict=True):
                what = f"u_{axis} of the end under {FORCE[0]:g}, {FORCE[1]:g} N"
                readings.append(_single(what, value, unit="mm", law=end.law))
        else:
            what = f"F_y at rest height with F_x = {FORCE[0]:g} N, over {FORCE[1]:g} N"
            readings.append(_single(what, end.force[1] / FORCE[1], asked=NEAR_ONE, law=end.law))
    says = "The end carries (0.175, 0.07) N at 31 kPa (Fig. 5 b)"
    why = (
        "The paper does not print where the end is; it is taken at its height at rest. Dimensions, material and height "
        "were fixed before this force was compared."
    )
    return _claim("16", says, readings, why, "the sweep `forces` has not been run")


def _length(end: object) -> float:
    curve = end.curve  # type: ignore[attr-defined]
    return float(curve.s[-1] - curve.s[0] + curve.x[0])


def rods_of(number: str, arms: Sequence[str], says: str) -> Callable[[Data], Claim]:
    """How far the rods are from the finite elements."""

    def make(data: Data) -> Claim:
        readings = []
        for arm in arms:
            for law in LAWS:
                found = above(data.arm(arm, law, DEFAULT), TOUCHING if arm == ARMS[0] else 24.0, 37.0)
                if found:
                    readings += list(_errors_of_rods(data, arm, law, found))
        return _claim(number, says, readings, _WHY_RODS, _NO["pneunet" if arms[0] == ARMS[0] else "arms"])

    return make


def _errors_of_rods(data: Data, arm: str, law: str, found: Sequence[Estimate]) -> Iterable[Reading]:
    at = {"law": law, "arm": arm, "unit": "%"}
    named = f", {_SHORT[arm]}" if arm != ARMS[0] else ""
    shapes = {"II": [], "III": []}  # type: dict[str, list[float]]
    forces = []
    for e in found:
        assert e.law is not None
        try:
            shapes["II"].append(100.0 * fitted(e.state, e.law, loaded=False).largest)
            held = fitted(e.state, e.law)
        except RodError:
            continue
        shapes["III"].append(100.0 * held.largest)
        forces.append(100.0 * held.force_error)
    for name, values in shapes.items():
        yield _range(f"distance over l in {name}, five numbers{named}", values, asked=AT_MOST, part=name, **at)
    yield _range(f"error of F_y, five numbers{named}", forces, asked=(-AT_MOST[1], AT_MOST[1]), part="force", **at)
    if law_of_arm := data.laws.get((arm, law)):
        apart, off = [], []
        for state in states_in(found):
            try:
                shape = own(state, law_of_arm)
            except RodError:
                continue
            apart.append(100.0 * shape.largest)
            off.append(100.0 * shape.force_error)
        if apart:
            yield _range(f"distance over l in III, the arm's own law{named}", apart, **at)
            yield _range(f"error of F_y, the arm's own law{named}", off, **at)


def five_numbers_everywhere(data: Data) -> Claim:
    readings = []
    for arm in ROUND:
        for law in LAWS:
            found = above(data.arm(arm, law, DEFAULT), 5.0, 37.0)
            if found:
                part = 100.0 * sum(bool(e.two_lines) for e in found) / len(found)
                what = f"pressures that need two lines, {_SHORT[arm]}, 5 to 37 kPa"
                readings.append(_single(what, part, unit="%", asked=(50.0, 100.0), law=law, arm=arm))
    says = "The five-parameter relation holds for all four arms"
    why = "One line says as much as two by the Bayesian information criterion: nothing outside these bodies can touch."
    return _claim("18", says, readings, why, _NO["arms"])


_WHY_RODS = "What is left of the distance is mostly the stretch of the curve, which this rod has not."
_NO = {name: f"the sweep `{name}` has not been run" for name in ("pneunet", "arms", "lengths")}
_RISE = "Inner cells stiffen as their walls are stretched and touch."
_CLAIMS: tuple[Callable[[Data], Claim], ...] = (
    curvature_of_pneunet,
    curvature_of_arms,
    curvature_without_clamp,
    middle_of_arm,
    two_slopes,
    contact_is_the_cause,
    _straight("alpha2"),
    _straight("alpha1"),
    _trend("6a", ARMS[:1], "alpha2", True, "α₂ of the pneu-net rises with p (Fig. 15 c)", _RISE),
    _trend(
        "6b", ARMS[:1], "alpha1", False, "α₁ of the pneu-net falls with p (Fig. 15 b)",
        "It falls in data that smoothing has widened; where the zone itself is resolved no fall is found.",
    ),
    _trend(
        "7a", ARMS[1:2], "alpha2", True, "α₂ of the semicircular arm rises with p (Fig. 15 c)",
        "Walls stiffen as they are stretched. Where a single line describes an arm, the process puts d far from the "
        "clamp (claim 12), and its slopes say little.",
    ),
    _trend(
        "7b", ARMS[1:2], "alpha1", False, "α₁ of the semicircular arm falls with p (Fig. 15 b)",
        "A single line describes this arm, so α₁ is a matter of the estimator.",
    ),
    _trend(
        "8a", ARMS[2:], "alpha2", False, "α₂ of the arms with one cavity along the axis falls with p (Fig. 15 c)",
        "It rises in every reading that decides. The dimensions are our own: the paper prints none for these arms.",
    ),
    _trend(
        "8b", ARMS[2:], "alpha1", True, "α₁ of the arms with one cavity along the axis rises with p (Fig. 15 b)",
        "A single line describes these arms, so α₁ is a matter of the estimator.",
    ),
    length_of_zone,
    zone_over_pressure,
    zone_over_height,
    zone_of_arms,
    curvature_over_length,
    rigidity_over_length,
    curvature_by_equation_nine,
    end_force,
    rods_of("17a", ARMS[:1], "Rod and finite elements of the pneu-net agree in II and III (Fig. 10)"),
    rods_of("17b", ROUND, "Rod and finite elements of the other arms agree in II and III (Fig. 16)"),
    five_numbers_everywhere,
)  # fmt: skip
