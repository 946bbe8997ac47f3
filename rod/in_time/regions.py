"""A body of several rubbers: how much of what an arm does belongs to each."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.in_time.relaxation import Relaxation

#: change of the moduli of a region for its share
STEP = 5e-3


class RegionShare(NamedTuple):
    """The part of a region, by the change of the arm with its moduli; the parts of all regions add up to 1."""

    rigidity: float  #: of the rigidity without pressure, where the arm is bent by the pressure
    pressure: float  #: of the resistance to a pressure that bends the arm


def shares_of(law: ArmLaw, regions: Sequence[Sequence[str]], pressure: float) -> tuple[RegionShare, ...]:
    """The shares of regions at a pressure in kPa, each by the names of its materials, as material or materials.base.

    With all moduli E of an arm its rigidity grows by the sum of E times the derivative by it, and so does the pressure
    that it bears. Raises `RodError` for a law without the derivatives by its moduli, or of a pressure that is unknown.
    """
    arm, found = law.at(pressure), []
    for materials in regions:
        starts = tuple(f"{name}." for name in materials)
        moduli = {name: value for name, value in law.moduli.items() if name.startswith(starts)}
        if not moduli:
            raise RodError(f"The law has no derivatives by the moduli of {materials[0]}; `pneurod cell` measures them.")
        less, more = (
            law.with_changes({name: part * value for name, value in moduli.items()}) for part in (-STEP, STEP)
        )
        stiffer = more.at(0.0).rigidity_at(arm.kappa_0) - less.at(0.0).rigidity_at(arm.kappa_0)
        found.append((stiffer, less.at(pressure).section.kappa_0 - more.at(pressure).section.kappa_0))
    parts = np.array(found)
    return tuple(RegionShare(*row) for row in (parts / parts.sum(axis=0)).tolist())


def mixed(rubbers: Sequence[Relaxation], shares: Sequence[float]) -> Relaxation:
    """The relaxation of what several rubbers carry together; one that hinders the others is left out."""
    branches: dict[float, float] = {}
    for rubber, share in zip(rubbers, shares, strict=True):
        for g, tau in zip(rubber.shares, rubber.times_s, strict=True):
            branches[tau] = branches.get(tau, 0.0) + max(share, 0.0) * g
    kept = {tau: g for tau, g in branches.items() if g > 0.0}
    return Relaxation(tuple(kept.values()), tuple(kept))
