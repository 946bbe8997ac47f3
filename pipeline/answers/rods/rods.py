"""The rods of an arm over its pressures."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

from pipeline.results.rod_errors import RodAndMesh
from pipeline.values.errors import InputError, argument
from rod.arm_law.kinds import Law
from rod.arm_law.law import ArmLaw
from rod.inverse import Branch
from rod.load import Loading
from rod.mechanics.equilibrium import Rod
from rod.pressurised_rod import PressurisedRod
from rod.same_pressure import Pressures, pressures_of


@dataclass(frozen=True, eq=False)  # arrays inside
class Rods:
    """The rods of an arm over its pressures, by its own law or by five parameters."""

    law: Law | PressurisedRod
    kind: str  #: one of the KINDS of `choice`
    errors: RodAndMesh | None = None  #: None where it was not compared with finite elements
    notes: tuple[str, ...] = ()  #: what limits the trust in it, a sentence each
    branches: dict[Loading, tuple[Branch, ...]] = field(default_factory=dict, repr=False)  #: by load, once made
    forms: ArmLaw | None = None  #: the law of an arm with a limit of the pressure; `law` is that of one form
    after_snap: bool = False  #: whether that is the swollen one

    @property
    def error_text(self) -> str:
        """Its errors against finite elements in words; empty where it was not compared."""
        return "" if self.errors is None or not isfinite(self.errors.shape) else self.errors.text

    @property
    def pressures_kPa(self) -> tuple[float, float]:
        """The lowest and the highest pressure."""
        known = self.over_one_pressure
        return known[0], known[-1]

    @property
    def over_one_pressure(self) -> Sequence[float]:
        """The pressures of a rod that has one, kPa, rising. Raises InputError for a law of several pressures."""
        if len(self.law.cavities) > 1:
            raise InputError(f"its law has the pressures of {', '.join(self.law.cavities)}; give their ratio")
        return tuple(float(pressure) for (pressure,) in self.law.rows)

    def at(self, pressures_kPa: float | Pressures) -> Rod:
        """The rod at the pressures of all cavities; its origin is the clamped end of the material curve.

        Raises `RodError` outside its pressures, and for another number of them.
        """
        if self.forms is None:
            found = self.law.at(pressures_kPa)
            rod, told = found if isinstance(found, Rod) else Rod(self.law.length, law=found), ""
        else:
            (pressure,) = pressures_of(pressures_kPa, self.forms.cavities)
            rod = Rod(self.forms.length, law=self.forms.at(pressure, after_snap=self.after_snap))
            told = self.forms.told_at(pressure, after_snap=self.after_snap)
        return replace(rod, notes=(*self.notes, *filter(None, [told]), *rod.notes))

    @property
    def swollen(self) -> "Rods | None":
        """This arm after the snap; None where it has no such form, and for that form itself."""
        law = self.forms.swollen if self.forms and not self.after_snap else None
        return None if law is None else replace(self, law=law, after_snap=True, branches={})

    def wanted(self, *, after_snap: bool) -> "Rods":
        """This arm, or the same after the snap. Raises InputError where it has no such form."""
        found = self.swollen if after_snap else self
        if found is None:
            raise InputError(f"{argument('after_snap', True)}: this arm has no form after a snap; leave it out")
        return found
