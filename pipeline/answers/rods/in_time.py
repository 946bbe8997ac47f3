"""The arm of a result folder in time: its rubber, its mass, its vibrations, and how it settles and creeps."""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import Any

from geometry import Reason
from pipeline.answers.rods.choice import choose_rod
from pipeline.answers.rods.rods import Rods
from pipeline.answers.rods.solid import solid_of
from pipeline.config.material import LOSS_FACTOR
from pipeline.values.errors import InputError
from pipeline.values.reasons import report_reason
from pipeline.values.run import Run
from rod import ArmLaw, Body, Relaxation, RodError, frequencies
from rod.in_time.regions import RegionShare, mixed, shares_of

#: lowest and highest frequency over that of the first vibration, of a loss factor without frequencies
BAND = 10.0**-0.5, 10.0**0.5
#: what a material has of its rubber in time
KEYS = ("loss_factor", "loss_between_Hz", "relaxation_g", "relaxation_tau_s")
#: part of a vibration with which the arm has settled, s at a held pressure at which the creep is told
SETTLED, HELD = 0.02, (1, 10, 100)


def is_given(material: Mapping[str, Any]) -> bool:
    """Whether a material describes its rubber in time: by branches, or by a loss factor with its frequencies."""
    return not {"relaxation_g", "loss_between_Hz"}.isdisjoint(material)


def rubber_of(material: Mapping[str, Any], first_Hz: Callable[[], float]) -> tuple[Relaxation, str]:
    """The rubber of an arm in time, and what it is in a sentence; first_Hz: gives its first vibration.

    Raises `RodError` for a loss factor that no branches have.
    """
    slow = Relaxation(material.get("relaxation_g", ()), material.get("relaxation_tau_s", ()))
    loss, band = float(material.get("loss_factor", LOSS_FACTOR)), material.get("loss_between_Hz")
    kept = f"the branches of material.relaxation (a held stretch keeps {100 / float(slow.modulus(0.0)):.3g} %)"
    if band is None and slow.shares and "loss_factor" not in material:
        return slow, f"Its rubber has {kept}."
    low, high = band or (first_Hz() * part for part in BAND)
    fast = Relaxation.from_loss_factor(loss, low, high)
    told = f"Its rubber has a loss factor of {loss:.3g} from {low:.2g} to {high:.2g} Hz"
    both = Relaxation((*fast.shares, *slow.shares), (*fast.times_s, *slow.times_s))
    return both, f"{told}, and {kept}." if slow.shares else f"{told}."


def body_of(run: Run, rods: Rods) -> tuple[Body, str]:
    """The arm with its rubber and its mass, and what is taken for its rubber, in a sentence.

    Raises InputError without a mass, and `RodError` for a loss factor that no branches have.
    """
    if rods.law.mass is None:
        raise InputError(f"{run.directory}: has no mass; give material.density in the configuration and run it again")
    material, solid = run.material, solid_of(run)
    body = Body(rods.law, spread=solid.section.spread if solid else (0.0, 0.0))
    first = cache(lambda: frequencies(body, rods.law.rows[-1], count=1)[0].frequency_hz)
    rubber, told = rubber_of(material, first)
    of_run = run.parameters.materials or run.config.get("materials") or {}
    regions = {f"materials.{name}": one for name, one in of_run.items()}
    others = {name: one for name, one in regions.items() if any(one.get(k) != material.get(k) for k in KEYS)}
    body = replace(body, relaxation=rubber)
    if not others:
        return body, told
    own = ("material", *(name for name in regions if name not in others))
    try:
        rubbers = {name: rubber_of(one, first) for name, one in others.items()}
        return _of_several(body, rods.law.plane, told, own, rubbers)
    except RodError as failure:
        also = f"Loss and relaxation of {', '.join(others)} differ; those of the arm are taken there too."
        return body, f"{told} {also} {failure}"


def _of_several(
    body: Body, law: ArmLaw | None, told: str, same: Sequence[str], others: Mapping[str, tuple[Relaxation, str]]
) -> tuple[Body, str]:
    """The arm with the rubbers of other regions as well, by the names of their materials; same: those that it has.

    Raises `RodError` for a law that does not know their shares.
    """
    if law is None:
        raise RodError("Its share is known to a law of one pressure in a plane alone.")
    known = law.pressures
    parts = shares_of(law, (same, *((name,) for name in others)), known[len(known) // 2])
    rubbers = (body.relaxation, *(rubber for rubber, _ in others.values()))
    for part, (name, (_, own)) in zip(parts[1:], others.items(), strict=True):
        told += f" {own.replace('Its rubber', f'That of {name}, {100.0 * part.rigidity:.0f} % of the rigidity,')}"
    forces, felt = (mixed(rubbers, [getattr(part, name) for part in parts]) for name in RegionShare._fields)
    return replace(body, relaxation=forces, felt=felt), told


def in_time(run: Run, rods: Rods) -> list[dict[str, float]]:
    """The arm without loads at each pressure of its run, by names with units.

    Vibrations and damping ratios in the plane, and across it where the law knows that; s until the first is below 2 %;
    mm that are left of the way of the tip, some time after the pressure has come. Raises as `body_of`.
    """
    body, _ = body_of(run, rods)
    known, found = rods.over_one_pressure, []
    for pressure in run.given_between(known[0], known[-1]) or known:
        modes = frequencies(body, pressure)
        row = {"pressure_kPa": float(pressure)}
        for name, in_plane in (("", True), ("across_", False)):
            for k, mode in enumerate((mode for mode in modes if mode.in_plane is in_plane), start=1):
                row |= {f"frequency_{name}{k}_Hz": mode.frequency_hz, f"damping_ratio_{name}{k}": mode.damping_ratio}
        damped = 2.0 * math.pi * row["frequency_1_Hz"] * row["damping_ratio_1"]
        row["settles_s"] = -math.log(SETTLED) / damped if damped else math.inf
        rest = rods.at(pressure).solve().end
        for t in HELD:
            felt = pressure * float(body.creep.compliance(t))
            row[f"creep_after_{t}_s_mm"] = math.dist(rods.at(felt).solve().end, rest) if felt >= known[0] else math.nan
        found.append(row)
    return found


def with_remark(run: Run) -> Run:
    """A run with a remark on its arm in time, where its material describes that."""
    if not is_given(run.material):
        return run
    with suppress(InputError, RodError):
        rows = in_time(run, choose_rod(run))
        remark = report_reason(Reason("in_time", {**rows[-1], "rows": rows}))
        return replace(run, record=replace(run.record, remarks=(*run.remarks, remark)))
    return run
