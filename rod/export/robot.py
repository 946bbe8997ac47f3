"""An arm over its pressures as chains, with what programs for robots need beside them: mass, section, damping."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry.arrays import Array
from rod.arm_law.law import ArmLaw
from rod.arm_law.space_law import SpaceLaw
from rod.errors import RodError
from rod.export.arm import Arm, divide_pressures
from rod.export.chain import Chain, chain_in_space, chain_of_five, chain_of_law, linear_chain_of_law
from rod.same_pressure import as_known, is_among

#: pieces of a chain behind the clamped end, and of one with straight springs
PIECES, LINEAR_PIECES = 20, 60
#: frequency (1/s) of the first vibration of a cantilever over sqrt(rigidity / mass per length) / length^2
_FIRST_VIBRATION = 3.516
#: which rod it is
OF_LAW = "the arm's own law"
#: fields of a chain, their names in a table, and the units of the table over those of the field
_COLUMNS = (
    ("base", "base_m", 1e-3),
    ("legs", "legs_m", 1e-3),
    ("points", "points_m", 1e-3),
    ("lift", "lift_m", 1e-3),
    ("angle", "angle_rad", 1.0),
    ("moment", "moment_N_m", 1e-3),
    ("axial", "axial_N", 1.0),
    ("shear", "shear_N", 1.0),
)
#: the same of its hinges out of the plane
_IN_SPACE = (
    ("axis", "sideways_axis_rad", 1.0),
    ("centre", "sideways_centre_m", 1e-3),
    ("twist", "twist_N_m", 1e-3),
    ("bend", "sideways_N_m", 1e-3),
    ("shear", "sideways_shear_N", 1.0),
)


@dataclass(frozen=True)
class Section:
    """The sections of an arm, averaged along it. Heights are above the material curve."""

    low: float  #: mm, height of the lowest point
    high: float  #: mm, height of the highest point
    width: float  #: mm
    centre: float  #: mm, height of the centre of mass
    spread: tuple[float, float]  #: mm2, mean squares of the distance from it, along the height and along the width


@dataclass(frozen=True)
class Solid:
    """The body of an arm. Raises `RodError` for a number that is not positive."""

    mass: float  #: g
    modulus: float  #: MPa, Young's modulus at small strain
    area: float  #: mm2
    section: Section
    loss_factor: float  #: lost over stored energy of a vibration, over a radian

    def __post_init__(self) -> None:
        for name in ("mass", "modulus", "area", "loss_factor"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise RodError(f"{name} must be positive, not {value}.")

    @property
    def radius(self) -> float:
        """mm, of a round section of its area."""
        return math.sqrt(self.area / math.pi)


@dataclass(frozen=True)
class Robot:
    """The chains of an arm at rising pressures, all with as many pieces and states of their springs."""

    pressures: tuple[float, ...]  #: kPa
    chains: tuple[Chain, ...]
    known: tuple[float, ...]  #: kPa, those that were computed, in the name of the file
    length: float  #: mm
    solid: Solid | None  #: None: without mass, for a table
    description: str  #: which rod it is, and where its numbers come from
    in_space: SpaceLaw | None = None  #: its law at every pressure; then the chain is that without pressure

    @staticmethod
    def of_space(law: SpaceLaw, solid: Solid | None) -> "Robot":
        """With a law in space, and straight springs: those of the arm without load at its pressures."""
        chain = chain_in_space(law.at((0.0,) * len(law.cavities)), PIECES)
        return Robot((0.0,), (chain,), (0.0, float(law.pressures.max())), law.length, solid, OF_LAW, law)

    @staticmethod
    def of_law(law: ArmLaw, solid: Solid | None, pressures: Sequence[float], *, has_shear: bool = True) -> "Robot":
        """With the arm's own law at pressures in kPa and between them; has_shear: in the first hinge.

        Raises `RodError` outside those of the law.
        """
        known = tuple(as_known(law.pressures, pressure) for pressure in pressures)
        divided = divide_pressures(known)
        chains = tuple(chain_of_law(law.at(pressure), PIECES, has_shear=has_shear) for pressure in divided)
        return Robot(divided, _alike(chains), known, law.length, solid, OF_LAW)

    @staticmethod
    def linear_of_law(law: ArmLaw, solid: Solid | None, pressures: Sequence[float]) -> "Robot":
        """With straight springs, those of the arm without load at each of the pressures in kPa.

        Raises `RodError` outside those of the law.
        """
        known = tuple(as_known(law.pressures, pressure) for pressure in pressures)
        chains = tuple(linear_chain_of_law(law.at(pressure), LINEAR_PIECES) for pressure in known)
        return Robot(known, _alike(chains), known, law.length, solid, f"{OF_LAW}, linear about the arm without load")

    @staticmethod
    def of_five(arm: Arm, solid: Solid | None, finer: Arm | None = None) -> "Robot":
        """With five parameters; finer: the arm at more pressures, for a program that interpolates between them.

        It is straight at 0 kPa then, and as stiff as at the lowest pressure.
        """
        known = finer or arm
        axial = 1.0 if solid is None else solid.modulus * solid.area
        chains = tuple(chain_of_five(rod, LINEAR_PIECES, axial) for rod in known.rods)
        pressures = known.pressures
        if finer:
            pressures, chains = (0.0, *pressures), (chains[0].straight(), *chains)
        return Robot(pressures, chains, arm.pressures, arm.length, solid, f"five parameters, {arm.origin}")

    @property
    def label(self) -> str:
        """The pressures in the name of a file: 17kPa, or 0_to_37kPa."""
        ends = dict.fromkeys(f"{pressure:g}" for pressure in (self.known[0], self.known[-1]))
        return "_to_".join(ends) + "kPa"

    def single(self, pressure: float) -> "Robot":
        """The arm at one of its pressures in kPa."""
        at = self.pressures.index(pressure)
        return Robot((pressure,), (self.chains[at],), (pressure,), self.length, self.solid, self.description)

    def has(self, pressure: float) -> bool:
        """Whether the file has a pressure in kPa: one of its own, or one between them if it has such at all."""
        if self.pressures == self.known:
            return is_among(self.known, pressure)
        return self.pressures[0] <= pressure <= self.pressures[-1]

    def at(self, pressure: float) -> Chain:
        """The chain that a program has at a pressure in kPa. Raises `RodError` outside the pressures."""
        pressure = as_known(self.pressures, pressure)
        if not self.pressures[0] <= pressure <= self.pressures[-1]:
            raise RodError(
                f"The file goes from {self.pressures[0]:g} to {self.pressures[-1]:g} kPa; {pressure:g} kPa is outside."
            )
        j = max(1, int(np.searchsorted(self.pressures, pressure)))
        if len(self.chains) == 1:
            return self.chains[0]
        low, high = self.pressures[j - 1 : j + 1]
        return self.chains[j - 1].between(self.chains[j], (pressure - low) / (high - low))

    @property
    def body(self) -> Solid:
        """The body with its mass. Raises `RodError` where it is not known."""
        if self.solid is None:
            raise RodError("This format needs the mass of the arm; give material.density in the configuration.")
        return self.solid

    @property
    def damping_times(self) -> Array:
        """(n,) s: damping of the springs over their stiffness, with which the first vibration has the loss factor."""
        return self.body.loss_factor / self.first_rates

    @property
    def first_rates(self) -> Array:
        """(n,) 1/s: of the first vibration."""
        mass_per_length = 1e-6 * self.body.mass / self.length  # tonne/mm
        rigidity = np.array([chain.rigidity for chain in self.chains])
        return np.asarray(_FIRST_VIBRATION / self.length**2 * np.sqrt(rigidity / mass_per_length))

    @property
    def table(self) -> dict[str, object]:
        """The chains over the pressures with units in the names, equal springs of one `kind`; or a law in space."""
        if law := self.in_space:
            of_law = {
                "cavities": law.cavities,
                "rows_kPa": law.rows,
                "onto": law.onto.tolist(),
                "length_mm": law.length,
            }
            parts = {name: getattr(law, name) for name in ("potential", "stretch", "compliance", "clamp", "tip")}
            lists = {k: [v.exponents.tolist(), v.scale.tolist(), v.coefficients.tolist()] for k, v in parts.items()}
            return {**of_law, "pieces": PIECES, "damping_time": float(self.damping_times[0]), **lists}
        columns = {name: scale * np.array([getattr(c, field) for c in self.chains]) for field, name, scale in _COLUMNS}
        springs = np.concatenate([columns["angle_rad"], columns["moment_N_m"]], axis=2)
        _, first, kind = np.unique(springs, axis=1, return_index=True, return_inverse=True)
        for name in ("angle_rad", "moment_N_m"):
            columns[name] = columns[name][:, first]
        if hinges := [chain.space for chain in self.chains if chain.space]:
            columns |= {name: scale * np.array([getattr(h, field) for h in hinges]) for field, name, scale in _IN_SPACE}
        damping = {} if self.solid is None else {"damping_time_s": self.damping_times}
        return {
            "rod": self.description,
            "pressures_kPa": list(self.pressures),
            "s_m": _rounded(1e-3 * self.chains[0].s),
            "kind": kind.ravel().tolist(),
            "rest": self.chains[0].rest,
            "is_limited": self.chains[0].is_limited,
            **{name: _rounded(values) for name, values in {**columns, **damping}.items()},
        }


def _alike(chains: tuple[Chain, ...]) -> tuple[Chain, ...]:
    """Chains that turn out of the plane at all pressures, or at none."""
    if all(chain.space for chain in chains):
        return chains
    return tuple(replace(chain, space=None) for chain in chains)


def _rounded(values: Array) -> Any:
    """As nested lists with nine digits."""
    if values.ndim == 0:
        return float(f"{values:.9g}")
    return [_rounded(row) for row in values]
