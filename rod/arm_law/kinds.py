"""Every kind of law of an arm: over one pressure, over two, or in space over any; one file, and one way to a rod."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
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

    @property
    def cavities(self) -> tuple[str, ...]:
        """Cavities of whose pressures it is a law; one name for an arm with one pressure."""

    @property
    def fractions(self) -> Mapping[str, float]:
        """Pressure of each cavity over that of a law over one pressure; none for several pressures."""

    @property
    def ratios(self) -> tuple[Pressures, ...]:
        """Ratios in which a law of several pressures was measured, each as parts of the largest pressure."""

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """Pressures at which it was measured, kPa."""

    @property
    def has_plane(self) -> bool:
        """Whether the arm bends in its plane under its pressures; else in space."""

    @property
    def plane(self) -> ArmLaw | None:
        """The law over one pressure of an arm in its plane; None: it is none."""

    @property
    def length(self) -> float:
        """Length of the arm, mm."""

    @property
    def mass(self) -> Mass | None:
        """None: not known."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What limits the trust in it, a sentence each."""

    def at(self, pressures: float | Sequence[float]) -> LawRod | SpaceRod:
        """The rod at pressures in kPa. Raises `RodError` where the law is not known."""


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class LawAtRatio:
    """A law of several pressures in one ratio of them, over the largest; what is not said here is that of the law."""

    law: PairLaw | SpaceLaw
    parts: Pressures  #: of the largest pressure
    ratios: tuple[Pressures, ...] = field(init=False)
    has_plane: bool = field(init=False)
    length: float = field(init=False)  #: mm
    mass: Mass | None = field(init=False)
    notes: tuple[str, ...] = field(init=False)
    cavities: ClassVar[tuple[str, ...]] = ("the largest",)
    plane: ClassVar[None] = None

    def __post_init__(self) -> None:
        for name in ("ratios", "has_plane", "length", "mass", "notes"):
            object.__setattr__(self, name, getattr(self.law, name))

    @property
    def fractions(self) -> Mapping[str, float]:
        """Fractions as of any law."""
        return dict(zip(self.law.cavities, self.parts, strict=True))

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """The largest pressures, rising."""
        return tuple((pressure,) for pressure in self.law.pressures_along(self.parts))

    def at(self, pressures: float | Sequence[float]) -> LawRod | SpaceRod:
        """The rod where the largest pressure is so high, kPa. Raises `RodError` as the law does."""
        (largest,) = pressures_of(pressures, self.cavities)
        return self.law.at(tuple(part * largest for part in self.parts))


#: those that law.json may hold
Saved: TypeAlias = ArmLaw | PairLaw | SpaceLaw


def along(law: Law, ratio: Sequence[float]) -> ArmLaw | LawAtRatio:
    """A law of several pressures in one ratio of them. Raises `RodError` for a ratio that it does not have."""
    if not isinstance(law, PairLaw | SpaceLaw):
        raise RodError("This law has one pressure and no ratio.")
    parts = pressures_of(tuple(ratio), law.cavities)
    if min(parts) < 0.0 or not max(parts):
        raise RodError("A ratio of pressures has no part below 0, and one above.")
    ray = LawAtRatio(law, tuple(part / max(parts) for part in parts))
    known = law.ray(ray.parts)
    if known is None and len(ray.rows) < 2:
        raise RodError("The law has no pressures in this ratio.")
    return known or ray
