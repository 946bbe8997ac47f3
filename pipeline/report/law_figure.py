"""The figure of the arm's own law beside the lines of the five parameters."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from pipeline.report.chart import Chart, Marks
from pipeline.report.figures import Entry, Figure, colour
from pipeline.report.law_range import curves_of_experiments
from pipeline.report.results import Results


def arm_law(results: Results) -> Figure | None:
    """Moment over curvature: the curves of a cell, the lines of the five parameters, and the finite elements.

    The lines are those beyond s = d with kappa_0 in the middle of the arm, over the moments of experiment III; dots are
    changes of cell averages from II to III beyond d, added to kappa_0 in the middle, without those near the ends of the
    arm, which another law describes.
    """
    curves = curves_of_experiments(results)
    if not curves:
        return None
    marks = [mark for curve in curves for mark in _of_pressure(results, curve)]
    pressures = tuple(float(curve["pressure_kPa"]) for curve in curves)
    entries = [Entry(f"line p{colour(results, pressure)}", f"{pressure:g} kPa") for pressure in pressures]
    entries += [Entry("line", "law of a cell"), Entry("rod", "five parameters, s > d")]
    entries += [Entry("dots", "finite elements, III"), Entry("touch", "walls touch")]
    chart = Chart("Moment of a cell over its curvature", "κ (1/mm)", "M (N mm)", tuple(marks))
    return Figure((chart,), tuple(entries), pressures)


def _of_pressure(results: Results, curve: Mapping[str, Any]) -> list[Marks]:
    pressure = float(curve["pressure_kPa"])
    number, label = colour(results, pressure), f"{pressure:g} kPa"
    kappa, moment = (np.array(curve[key], dtype=float) for key in ("kappa_per_mm", "moment_N_mm"))
    touching = np.array(curve["contact"], dtype=bool)
    marks = [Marks(kappa, moment, f"law of a cell, {label}", "line", number, pressure)]
    if touching.any():
        marks.append(Marks(kappa[touching], moment[touching], f"walls touch, {label}", "touch", None, pressure))
    return [*marks, *_five_parameters(results, pressure), *_finite_elements(results, pressure)]


def _five_parameters(results: Results, pressure: float) -> list[Marks]:
    alpha, m0 = results.at("alpha2_N_mm2", pressure), results.at("m02_N_mm", pressure)
    middles = results.parameters.get("kappa_0", {}).get("middle_per_mm")
    ranges = results.parameters.get("moment_range_N_mm")
    if alpha is None or m0 is None or middles is None or ranges is None:
        return []
    row = results.identified_pressures.index(pressure)
    moment = np.array(ranges[row])
    kappa = middles[row] + (moment - m0) / alpha
    return [Marks(kappa, moment, f"five parameters, {pressure:g} kPa", "rod", None, pressure)]


def _finite_elements(results: Results, pressure: float) -> list[Marks]:
    """Experiment III against II, where their points are those of inner cells."""
    if not (pair := results.loaded_and_free(pressure)):
        return []
    loaded, free = pair
    s, ends = loaded["s_mm"], results.end_zone_mm
    middle = np.interp(results.length / 2.0, s, free["kappa_per_mm"])
    kappa = loaded["kappa_per_mm"] - free["kappa_per_mm"] + middle
    inner = (s > max(results.break_mm(pressure) or 0.0, ends)) & (s < results.length - ends) & np.isfinite(kappa)
    name = f"finite elements, {pressure:g} kPa"
    moment = loaded["moment_N_mm"][inner]
    return [Marks(kappa[inner], moment, name, "dots", colour(results, pressure), pressure)]
