"""Claims on the rigidities: whether two are needed, what contact does, and how they change with the pressure."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from benchmarks.paper.claims.common import (
    DOWN,
    ESTIMATORS,
    NAN,
    NOT_RUN,
    ON_LINE,
    ROUND,
    SHORT,
    SYMBOL,
    TOUCHING,
    UP,
    claim,
    range_of,
    single,
)
from benchmarks.paper.data import ARMS, LAWS, Data, above
from benchmarks.paper.estimates import DEFAULT, control, process
from benchmarks.paper.free_lines import Subtracted
from benchmarks.paper.measures import line
from benchmarks.paper.reading import Claim, Reading

#: what is subtracted before the process of `paper_process`; its default first
SUBTRACTED: tuple[Subtracted, ...] = ("chord", "chord and mean", "mean")
SLOPE_BY_PROCESS = "α₁ by paper_process, 17 to 37 kPa"
SLOPE_OF_ONE_RIGIDITY = "α₁ by paper_process of a rod with one rigidity, 31 kPa"


def two_slopes(data: Data) -> Claim:
    readings = []
    for sweep, beside in (("pneunet", ""), ("contact", ", without contact")):
        for law in LAWS:
            for name, low, high in (("17 to 37 kPa", TOUCHING, 37.0), ("5 and 10 kPa", 5.0, 10.0)):
                estimates = above(data.of(sweep, law, ARMS[0], DEFAULT), low, high)
                if estimates:
                    part = 100.0 * sum(bool(e.two_lines) for e in estimates) / len(estimates)
                    required = None if beside else (100.0, 100.0)
                    what = f"pressures that need two lines, {name}{beside}"
                    readings.append(single(what, part, unit="%", required=required, law=law, pressure=name))
    says = "M over κ - κ₀ of the pneu-net has two slopes (Fig. 9 a)"
    why = (
        "Walls that touch stiffen all cells but the first one; at the lower pressures they do not touch, or only on a "
        "part of the way to the straight cell."
    )
    return claim("4a", says, readings, why, NOT_RUN["pneunet"])


def contact_is_the_cause(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        estimates = above(data.of("contact", law, ARMS[0], DEFAULT), TOUCHING, 37.0)
        if estimates:
            part = 100.0 * sum(bool(e.two_lines) for e in estimates) / len(estimates)
            what = "pressures from 17 to 37 kPa that need two lines without contact"
            readings.append(single(what, part, unit="%", required=(0.0, 0.0), law=law))
            grows = estimates[-1].single_alpha / estimates[0].single_alpha
            readings.append(single("single rigidity at the highest over that at 17 kPa", grows, law=law))
    says = "Walls that touch cause the difference in stiffness (concluding remarks)"
    why = "Without contact in the model one line is enough at all pressures."
    return claim("4b", says, readings, why, "the sweep `contact` has not been run")


def _slopes(
    data: Data, arm: str, name: str, low: float
) -> Iterable[tuple[str, str, list[float], list[float], list[float]]]:
    """Law, estimator, pressures, values and deviations of alpha1 or alpha2 where it has a meaning."""
    for law in LAWS:
        for estimator in ESTIMATORS:
            usable = [e for e in above(data.arm(arm, law, estimator), low, 37.0) if e.is_usable]
            if name == "alpha1" and estimator == DEFAULT:
                usable = [e for e in usable if e.two_lines]
            deviations = [e.deviations[0 if name == "alpha1" else 1] for e in usable if e.deviations is not None]
            yield law, estimator, [e.state.pressure for e in usable], [getattr(e, name) for e in usable], deviations


def straight(name: str) -> Callable[[Data], Claim]:
    def make(data: Data) -> Claim:
        readings = []
        for law, estimator, pressures, values, deviations in _slopes(data, ARMS[0], name, TOUCHING):
            at: dict[str, Any] = {"law": law, "estimator": estimator}
            what = f"{SYMBOL[name]} off a line, 17 to 37 kPa"
            if len(values) < 3:
                readings += (
                    [single(what, NAN, required=ON_LINE, without="fewer than three pressures", **at)]
                    if data.arm(ARMS[0], law)
                    else []
                )
                continue
            fit = line(pressures, values, deviations)
            spread = 100.0 * 2.0 * float(np.mean(deviations)) / max(map(abs, values)) if deviations else 0.0
            value = 100.0 * fit.off
            readings.append(Reading(what, value, max(0.0, value - spread), value + spread, "%", ON_LINE, **at))
            readings.append(single(f"slope of {SYMBOL[name]}", fit.slope, 2.0 * fit.slope_std, unit="N mm²/kPa", **at))
        number = "5a" if name == "alpha2" else "5b"
        says = f"{SYMBOL[name]} of the pneu-net is a linear function of p (Fig. 9 b)"
        return claim(number, says, readings, _WHY_STRAIGHT[name], NOT_RUN["pneunet"])

    return make


_WHY_STRAIGHT = {
    "alpha2": "From 17 kPa on, where walls touch; at lower pressures α₂ is no linear function of p.",
    "alpha1": "The default finds α₁ constant within its interval; a slope comes with the other estimators.",
}


def trend(number: str, arms: Sequence[str], name: str, rises: bool, says: str, why: str) -> Callable[[Data], Claim]:
    def make(data: Data) -> Claim:
        readings = []
        for arm in arms:
            for law, estimator, pressures, values, deviations in _slopes(data, arm, name, 10.0):
                at: dict[str, Any] = {"law": law, "estimator": estimator, "arm": arm, "required": UP if rises else DOWN}
                what = f"slope of {SYMBOL[name]}, {SHORT[arm]}"
                if len(values) >= 3:
                    fit = line(pressures, values, deviations)
                    what += f", {pressures[0]:g} to {pressures[-1]:g} kPa ({values[0]:.0f} to {values[-1]:.0f} N mm²)"
                    readings.append(single(what, fit.slope, 2.0 * fit.slope_std, unit="N mm²/kPa", **at))
                elif data.arm(arm, law):
                    reason = "one line is enough" if estimator == DEFAULT else "d at the end of its range"
                    readings.append(single(what, NAN, without=reason, **at))
        if number == "6b":
            readings += _slopes_by_process(data)
        return claim(number, says, readings, why, NOT_RUN["pneunet" if arms[0] == ARMS[0] else "arms"])

    return make


def _slopes_by_process(data: Data) -> list[Reading]:
    """What the slope of paper_process depends on: what is subtracted before, and the smoothing itself."""
    readings = []
    for law in LAWS:
        states = [s for s in data.states("pneunet", law, ARMS[0]) if TOUCHING <= s.pressure <= 37.0]
        if not states:
            continue
        for name in SUBTRACTED:
            estimates = [e for e in (process(s, subtracted=name) for s in states) if e.is_usable]
            values, zones = [e.alpha1 for e in estimates], [e.d_over_length for e in estimates]
            readings.append(range_of(f"{SLOPE_BY_PROCESS}, {name} subtracted", values, unit="N mm²", law=law))
            readings.append(range_of(f"d/l with it, {name} subtracted", zones, law=law))
        for state in (s for s in states if s.pressure == 31.0):
            alpha = control(state, process(state).single_alpha).alpha1
            readings.append(single(SLOPE_OF_ONE_RIGIDITY, alpha, unit="N mm²", law=law))
    return readings


def two_lines_everywhere(data: Data) -> Claim:
    readings = []
    for arm in ROUND:
        for law in LAWS:
            estimates = above(data.arm(arm, law, DEFAULT), 5.0, 37.0)
            if estimates:
                part = 100.0 * sum(bool(e.two_lines) for e in estimates) / len(estimates)
                what = f"pressures that need two lines, {SHORT[arm]}, 5 to 37 kPa"
                readings.append(single(what, part, unit="%", required=(50.0, 100.0), law=law, arm=arm))
    says = "The three arms without gaps need two lines as well (Fig. 15)"
    why = (
        "One line says as much as two by the Bayesian information criterion: these arms have no gaps, so that no outer "
        "walls meet."
    )
    return claim("18b", says, readings, why, NOT_RUN["arms"])
