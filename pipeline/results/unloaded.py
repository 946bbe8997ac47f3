"""The arm without a load, by its own law, and in words."""

from collections.abc import Sequence
from contextlib import suppress
from typing import TypeVar

import numpy as np

from geometry import Reason, Values
from pipeline.results.rod_errors import law_mesh_errors
from pipeline.values.formatting import percent
from pipeline.values.law import DRAFT, DeliveredLaw, Unloaded
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.load import Load, Loading
from rod.mechanics.equilibrium import Rod

State = TypeVar("State")

#: pressures that are named; of more the lowest, the middle and the highest one
MOST_NAMED = 3
#: degrees by 1 % of the pressure from which on an arm is steep, if they are this many times what its angle has of 1 %
STEEP_DEG, STEEPER = 2.0, 4.0
#: degrees within which the angle of such an arm is to be known
KNOWN_DEG = 5.0


def unloaded_states(law: ArmLaw, pressures_kPa: Sequence[float]) -> tuple[Unloaded, ...]:
    """The clamped arm without a load at those of the pressures that the law has; without one that has no rod."""
    states: list[Unloaded] = []
    for pressure in pressures_kPa:
        with suppress(RodError):
            states.append(unloaded_state(law, pressure))
    return tuple(states)


def unloaded_state(law: ArmLaw, pressure: float) -> Unloaded:
    """At a pressure of the law in kPa. Raises `RodError`."""
    at = law.at(pressure)
    shape = Rod(law.length, law=at).under(Load())
    rigidity = 1.0 / float(np.interp(0.0, at.section.moment, at.section.kappa_slope))
    return Unloaded(pressure, at.section.kappa_0, rigidity, abs(shape.bending_deg), shape.end)


def limit_of(law: DeliveredLaw, highest_kPa: float) -> Reason | None:
    """What a limit of the pressure does to the arm, or a range of pressures in which little pressure bends it much.

    highest_kPa: the highest pressure that was asked for, which may be beyond the limit.
    """
    plane = law.plane
    if plane is None:
        return None
    if plane.limit is None:
        return _steep(plane)
    error = "" if plane.limit.std is None else f" ± {plane.limit.std:.1g}"
    values: Values = {"limit_kPa": plane.limit.value, "limit": f"{plane.limit.value:.3g}{error}"}
    if plane.swollen is None or plane.back is None:
        factor = highest_kPa / plane.limit.value
        stiffer = f", or moduli {factor:.2f} times these for {highest_kPa:.4g} kPa" if factor > 1.0 else ""
        return Reason("no_form_beyond", {**values, "stiffer": stiffer})
    rising, swollen = law.angles["rising"][-1:], law.angles["swollen"]
    ends = {
        "from_deg": float(law.angles.get("unstable", rising)[0, 1]),
        "to_deg": float(np.interp(plane.limit.value, *swollen.T)),
    }
    known = {"return_kPa": plane.back.value, "highest_kPa": plane.swollen.pressures[-1]}
    return Reason("snaps", {**values, **ends, **known})


def _steep(law: ArmLaw) -> Reason | None:
    """The pressures at which 1 % of the modulus or the pressure changes the angle by degrees, and by far more of it."""
    pressures, kappa = np.array([(cell.pressure, cell.at(0.0)[0]) for cell in law.cells]).T
    middle, slopes = (
        0.5 * (pressures[1:] + pressures[:-1]),
        np.diff(np.degrees(kappa * law.length)) / np.diff(pressures),
    )
    by_part, angle = np.abs(slopes * middle), np.abs(np.degrees(0.5 * (kappa[1:] + kappa[:-1]) * law.length))
    steep = (by_part > STEEP_DEG * 100.0) & (by_part > STEEPER * angle)
    if not steep.any():
        return None
    low, high = float(pressures[:-1][steep].min()), float(pressures[1:][steep].max())
    change = abs(unloaded_state(law, high).bending_deg - unloaded_state(law, low).bending_deg) / (high - low)
    percent = 100.0 * KNOWN_DEG / (change * 0.5 * (low + high))
    return Reason("steep", {"low_kPa": low, "high_kPa": high, "deg_per_kPa": change, "percent": percent})


def weight_not_borne(law: ArmLaw) -> Reason | None:
    """A reason where a law without gravity does not bear its arm lying at the lowest pressure; None elsewhere."""
    if law.mass is None or any(law.weight):
        return None
    pressure, weight = law.pressures[0], Loading(direction="lying").on(law.length, law.mass, (0.0, 0.0))
    borne = law.at(pressure).part_borne(weight)
    return Reason("weight_not_borne", {"pressure_kPa": pressure, "percent": 100.0 * borne}) if borne < 1.0 else None


def named_states(states: Sequence[State]) -> tuple[State, ...]:
    """At most `MOST_NAMED` of the states."""
    return tuple(states) if len(states) <= MOST_NAMED else (states[0], states[len(states) // 2], states[-1])


def first_numbers(states: Sequence[Unloaded], size_mm: float) -> str:
    """The arm without a load in one sentence, before the error of its mesh is known; size_mm: of that mesh."""
    return f"first numbers, on a mesh of {size_mm:.3g} mm whose error is not known yet: {_numbers(states)}"


def delivered_numbers(law: DeliveredLaw) -> str:
    """The arm without a load in one sentence, with the error of the mesh where it is known."""
    error = law_mesh_errors(law).largest
    known = "" if error is None else f", known to {percent(error)} for the mesh"
    return f"{DRAFT if law.draft else f'numbers of the law{known}'}: {_numbers(law.unloaded)}"


def _numbers(states: Sequence[Unloaded]) -> str:
    """Bending angle, tip, curvature and rigidity."""
    named = named_states(states)
    pressures = ", ".join(f"{state.pressure_kPa:g}" for state in named)
    parts = (
        f"the arm bends by {', '.join(f'{state.bending_deg:.0f}°' for state in named)} at {pressures} kPa",
        f"its tip is at {', '.join('({:.1f}, {:.1f})'.format(*state.tip_mm) for state in named)} mm",
        f"κ₀ = {', '.join(f'{1000.0 * state.kappa_0_per_mm:.3g}' for state in named)} 1/m",
        f"rigidity {', '.join(f'{state.rigidity_N_mm2:.3g}' for state in named)} N mm²",
    )
    return "; ".join(parts)
