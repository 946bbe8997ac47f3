"""Every kind of law of an arm: over one pressure, over two, or in space over any; one file, and one way to a rod."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol, TypeAlias, final

from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.arm_law.pairs import PairLaw
from rod.arm_law.space_law import SpaceLaw
from rod.arm_law.space_rod import SpaceRod
from rod.errors import RodError
from rod.same_pressure import Pressures, pressures_of
from rod.weight import Mass


class Law(Protocol):
    """The law of an arm over the pressures of its cavities; a number is a tuple of one pressure."""

    kind: ClassVar[str]  #: as law.json has it: plane, pairs, space

    @property
    def cavities(self) -> tuple[str, ...]:
        """Of which it has the pressures; one name for an arm with one pressure."""

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """Pressures at which it was measured, kPa."""

    @property
    def length(self) -> float:
        """Of the arm, mm."""

    @property
    def mass(self) -> Mass | None:
        """None: not known."""

    def at(self, pressures: float | Sequence[float]) -> LawRod | SpaceRod:
        """The rod at pressures in kPa. Raises `RodError` where the law is not known."""


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Ray:
    """A law of several pressures in one ratio of them, over the largest."""

    law: PairLaw | SpaceLaw
    fractions: Pressures  #: of the largest pressure
    kind: ClassVar[str] = "ray"
    cavities: ClassVar[tuple[str, ...]] = ("the largest",)

    @property
    def pressures(self) -> tuple[float, ...]:
        """The largest, kPa, rising."""
        return self.law.pressures_along(self.fractions)

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """As of any law."""
        return tuple((pressure,) for pressure in self.pressures)

    @property
    def length(self) -> float:
        """Of the arm, mm."""
        return self.law.length

    @property
    def mass(self) -> Mass | None:
        """None: not known."""
        return self.law.mass

    def at(self, pressures: float | Sequence[float]) -> LawRod | SpaceRod:
        """The rod where the largest pressure is so high, kPa. Raises `RodError` as the law does."""
        (largest,) = pressures_of(pressures, self.cavities)
        return self.law.at(tuple(part * largest for part in self.fractions))


#: those that law.json may hold
Saved: TypeAlias = ArmLaw | PairLaw | SpaceLaw
AnyLaw: TypeAlias = Saved | Ray  #: the same, and a law along a ratio


def along(law: AnyLaw, ratio: Sequence[float]) -> ArmLaw | Ray:
    """A law of several pressures in one ratio of them. Raises `RodError` for a ratio that it does not have."""
    if not isinstance(law, PairLaw | SpaceLaw):
        raise RodError("This law has one pressure and no ratio.")
    parts = pressures_of(tuple(ratio), law.cavities)
    if min(parts) < 0.0 or not max(parts):
        raise RodError("A ratio of pressures has no part below 0, and one above.")
    ray = Ray(law, tuple(part / max(parts) for part in parts))
    known = law.ray(ray.fractions) if isinstance(law, PairLaw) else None
    if known is None and len(ray.pressures) < 2:
        raise RodError("The law has no pressures in this ratio.")
    return known or ray


def ratios_of(law: AnyLaw) -> tuple[Pressures, ...]:
    """The ratios in which a law of several pressures was measured, each as parts of the largest pressure."""
    highest = [row for row in law.rows if max(row) > 0.0]
    return tuple(dict.fromkeys(tuple(float(f"{p / max(row):.9g}") for p in row) for row in highest))
