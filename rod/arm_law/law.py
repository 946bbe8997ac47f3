"""The arm's own law over all pressures, and the rod that follows it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Annotated, Any, ClassVar

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import ACROSS, CellCurve, ClampCurve, TipCurve
from rod.arm_law.law_rod import LawRod
from rod.arm_law.limit import PressureLimit
from rod.arm_law.moved import growing, moved_cell, moved_clamp, scaled_curve, scaled_rate, second_order
from rod.arm_law.quantities import UNITS, QuantityAt, Rods, jacobian
from rod.arm_law.rates import LawRate, changed_cells, changed_clamps, onset_rate
from rod.arm_law.section import clamp_at, section_at, tip_at
from rod.checked import Amount, finite, positive
from rod.errors import RodError
from rod.same_pressure import Pressures, pressures_of
from rod.weight import Mass

#: change of the moments of the law in difference quotients, over the largest one, and that of the parameter at most
STEP, LARGEST_STEP = 1e-4, 1e-2
#: of a limit of the pressure, over it: there the limit is named where the law does not bear a moment
NEAR = 0.1
#: how the names of parameters of a layer or of hoops begin
OF_LAYERS = "effects."


@dataclass(frozen=True, eq=False)  # arrays inside
class ArmLaw:
    """The law of an arm with one pressure: a cell, its clamped end and its tip over pressures that rise.

    Where its chambers swell at a limit of the pressure, these are the pressures below it, and the form after the snap
    has a law of its own. Nothing is interpolated between both forms.

    Raises `RodError` where there is no curve, the pressures of the parts differ, or a swollen form has no limits.
    """

    kind: ClassVar[str] = "plane"
    has_plane: ClassVar[bool] = True
    cavities: ClassVar[tuple[str, ...]] = ("the arm",)
    fractions: ClassVar[Mapping[str, float]] = {"the arm": 1.0}
    ratios: ClassVar[tuple[Pressures, ...]] = ()
    notes: ClassVar[tuple[str, ...]] = ()
    pitch: Annotated[float, "pitch_mm"]  #: mm
    first_middle: Annotated[float, "first_middle_mm"]  #: mm, from the clamp to the middle of the first cell
    length: Annotated[float, "length_mm"]  #: mm, of the arm whose pieces were solved
    cells: Annotated[tuple[CellCurve, ...], "curves"]
    clamps: Annotated[tuple[ClampCurve, ...], "clamp.curves"]
    tips: Annotated[tuple[TipCurve, ...], "tip.curves"]
    mass: Annotated[Mass | None, "mass"] = None  #: None: not known, because the configuration has no density
    #: N/mm, x and y per rest length, that always acts; zero without gravity
    weight: Annotated[tuple[float, float], "weight_N_per_mm"] = (0.0, 0.0)
    #: derivatives by parameter of the design
    rates: Annotated[Mapping[str, LawRate], "derivatives"] = field(default_factory=dict, repr=False)
    limit: Annotated[PressureLimit | None, "limit_kPa"] = None  #: at which its chambers swell at once; None: not found
    back: Annotated[PressureLimit | None, "return_kPa"] = None  #: below which the swollen form is lost
    swollen: "ArmLaw | None" = field(default=None, repr=False)  #: the form after the snap; None: not found

    def __post_init__(self) -> None:
        parts = [[curve.pressure for curve in curves] for curves in (self.cells, self.clamps, self.tips)]
        if not parts[0] or any(part != parts[0] for part in parts) or np.any(np.diff(parts[0]) <= 0.0):
            raise RodError("A law must have a cell, a clamped end and a tip at each pressure, in ascending order.")
        if self.swollen and not (self.limit and self.back and self.swollen.limit is None):
            raise RodError("A law with a form after the snap has a limit pressure, and one below which it snaps back.")

    def __repr__(self) -> str:
        low, high = self.pressures[0], self.pressures[-1]
        return f"ArmLaw({len(self.cells)} pressures from {low:g} to {high:g} kPa, cells of {self.pitch:g} mm)"

    @property
    def pressures(self) -> tuple[float, ...]:
        """kPa"""
        return tuple(curve.pressure for curve in self.cells)

    @property
    def plane(self) -> "ArmLaw":
        """Itself."""
        return self

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """The pressures at which it was measured, kPa."""
        return tuple((pressure,) for pressure in self.pressures)

    @property
    def is_in_space(self) -> bool:
        """Whether cells have rigidities out of the plane, at one pressure at least."""
        return any(cell.is_in_space for cell in self.cells)

    @property
    def dimensions(self) -> dict[str, float]:
        """Dimensions of the body by which it has derivatives, mm."""
        return {name: r.value for name, r in self.rates.items() if r.unit == "mm" and not name.startswith(OF_LAYERS)}

    @property
    def moduli(self) -> dict[str, float]:
        """Moduli of the materials by which it has derivatives, MPa."""
        return {name: r.value for name, r in self.rates.items() if r.unit == "MPa" and not name.startswith(OF_LAYERS)}

    def scaled(self, factor: float) -> "ArmLaw":
        """The law of an arm whose moduli are all multiplied by a factor, with the same Poisson ratios; exact.

        It is known at the pressures of this one times the factor. Mass and weight stay as they are. Raises `RodError`
        unless the factor is above zero.
        """
        factor = positive(factor, "The factor of all moduli")
        units = {name: rate.unit for name, rate in self.rates.items()}
        return replace(
            self._forms(lambda law: law.scaled(factor), lambda limit: limit.scaled(factor, units)),
            cells=tuple(scaled_curve(cell, factor) for cell in self.cells),
            clamps=tuple(scaled_curve(clamp, factor) for clamp in self.clamps),
            tips=tuple(scaled_curve(tip, factor) for tip in self.tips),
            rates={name: scaled_rate(rate, factor) for name, rate in self.rates.items()},
        )

    def stiffened(self, trend: float) -> "ArmLaw":
        """The law of an arm whose moduli grow with the pressure, to exp(trend) times these at the highest one.

        It stands for a rubber that stiffens more, or less, than that of the law. The states are those of this law, at
        the pressures p exp(trend p / highest), and at moments and forces that are as many times as large. Raises
        `RodError` unless the trend is a number above -1.
        """
        if finite(trend, "The trend of the moduli") <= -1.0:
            raise RodError(f"The trend of the moduli must be above -1, not {trend:g}: pressures would not rise.")
        return self._growing(trend / self.pressures[-1])

    def _growing(self, rate: float) -> "ArmLaw":
        factors, moves = zip(*(growing(pressure, rate) for pressure in self.pressures), strict=True)
        cells, clamps = zip(self.cells, moves, factors, strict=True), zip(self.clamps, moves, factors, strict=True)
        return replace(
            self._forms(lambda law: law._growing(rate), lambda limit: limit.growing(rate)),
            cells=tuple(scaled_curve(moved_cell(cell, move), factor) for cell, move, factor in cells),
            clamps=tuple(scaled_curve(moved_clamp(clamp, move), factor) for clamp, move, factor in clamps),
            tips=tuple(scaled_curve(tip, factor) for tip, factor in zip(self.tips, factors, strict=True)),
            rates={name: known.with_moments(factors) for name, known in self.rates.items()},
        )

    def with_second_order(self, bend: float, stretch: float) -> "ArmLaw":
        """The law of an arm whose rubber departs from that of this law in the second order of the strain (`moved`).

        The curvature without moment differs by bend e^2 / h, the stretch by stretch e^2; both factors are of the order
        of 1 for another law of the rubber. Ends, rigidities and derivatives stay. Raises `RodError` for what is no
        number.
        """
        bend, stretch = finite(bend, "The bend of second order"), finite(stretch, "The stretch of second order")
        if bend == stretch == 0.0:
            return self
        cells = tuple(moved_cell(cell, second_order(cell, bend, stretch)) for cell in self.cells)
        return replace(self._forms(lambda law: law.with_second_order(bend, stretch), lambda limit: limit), cells=cells)

    def with_changes(self, changes: Mapping[str, Amount]) -> "ArmLaw":
        """The law of an arm whose parameters differ a little, to first order: `{"geometry.wall": 0.1}`.

        changes: by parameter, in mm, MPa or 1, or as "0.1 mm". Mass, tip, volumes, and rigidities other than against
        bending and twist stay. The derivatives are left out. Raises `RodError` for a parameter without them, and for a
        change so large that no law is left.
        """
        if not changes:
            return replace(self._forms(lambda law: law.with_changes({}), lambda limit: limit), rates={})
        amounts = {name: finite(by, f"The change of {name}", self.rate(name).unit) for name, by in changes.items()}
        found = [(self.rates[name], amount) for name, amount in amounts.items()]
        cells = changed_cells(self.cells, [[one.times(amount) for one in rate.cells] for rate, amount in found])
        clamps = changed_clamps(self.clamps, [[one.times(amount) for one in rate.clamps] for rate, amount in found])
        lengths = np.array([self.pitch, self.first_middle, self.length])
        for rate, amount in found:
            lengths = lengths + amount * np.array([rate.pitch, rate.first_middle, rate.length])
        pitch, first_middle, length = (float(value) for value in lengths)
        # a swollen form without derivatives by one of the parameters is left out
        forms = self._forms(
            lambda law: law.with_changes(amounts) if amounts.keys() <= law.rates.keys() else None,
            lambda limit: limit.changed(amounts),
        )
        changed = replace(forms, cells=cells, clamps=clamps, rates={})
        return replace(changed, pitch=pitch, first_middle=first_middle, length=length)

    def carried(self, changes: Mapping[str, float]) -> "ArmLaw":
        """The law of `with_changes`, with derivatives that are at each curvature those of this law."""
        law, rates = self.with_changes(changes), self.rates.items()
        new = {name: r.carried(self.cells, law.cells, changes.get(name, 0.0)) for name, r in rates}
        return replace(law, swollen=law.swollen and self.swollen and self.swollen.carried(changes), rates=new)

    def derivative(self, name: str) -> dict[str, Array]:
        """Derivative by a parameter, per mm, MPa or 1, at the pressures of the law (n,); NaN where no such number is.

        name: a key of `rates`, such as "geometry.wall". The numbers are those of `UNITS`, out of the plane where the
        law has them; contact_onset, the curvature beyond which walls touch up to the end of a curve, and
        largest_stretch, that of a cell without moment. Raises `RodError` for a parameter without derivatives.
        """
        rate, pressures = self.rate(name), self.pressures
        names = [number for number in UNITS if number not in ACROSS or self.is_in_space]
        asked = [QuantityAt(number, pressure, self.at(pressure)).or_nan for number in names for pressure in pressures]
        try:
            rows = jacobian(self.rods_after([name]), asked, [self.step(name)]).reshape(len(names), -1)
        except RodError:
            rows = np.full((len(names), len(pressures)), np.nan)
        onset = np.array([onset_rate(*pair) for pair in zip(self.cells, rate.cells, strict=True)])
        stretch = np.array([float(cell.largest_stretch) for cell in rate.cells])
        return dict(zip(names, rows, strict=True)) | {"contact_onset": onset, "largest_stretch": stretch}

    def rods_after(self, names: Sequence[str]) -> Callable[[Array], Rods]:
        """The rods by pressure after changes (k,) of parameters, as `jacobian` takes them."""

        def rods(changes: Array) -> Rods:
            amounts = {name: float(x) for name, x in zip(names, changes, strict=True) if x}
            changed = cache(lambda form: form.with_changes(amounts))
            return cache(lambda pressure: changed(self.form_at(pressure)).at(pressure))

        return rods

    def step(self, name: str) -> float:
        """A change of a parameter for difference quotients. Raises `RodError` for one without derivatives."""
        rate = self.rate(name)
        largest, change = (max(float(np.abs(c.moment).max()) for c in curves) for curves in (self.cells, rate.cells))
        most = LARGEST_STEP * abs(rate.value) or STEP  # of a parameter that the cells do not have
        return min(most, STEP * largest / change) if change else most

    def rate(self, name: str) -> LawRate:
        """The derivatives of the curves by a parameter. Raises `RodError` for one without."""
        if name not in self.rates:
            known = f"it has those by {', '.join(self.rates)}" if self.rates else "it has none"
            raise RodError(f"The law has no derivatives by {name!r}; {known}.")
        return self.rates[name]

    def _forms(self, form: Callable[["ArmLaw"], Any], limit: Callable[[PressureLimit], Any]) -> "ArmLaw":
        """With both limits of the pressure, and the law after the snap, changed."""
        limits = self.limit and limit(self.limit), self.back and limit(self.back)
        return replace(self, limit=limits[0], back=limits[1], swollen=self.swollen and form(self.swollen))

    @cached_property
    def before_snap(self) -> "ArmLaw":
        """Without the swollen form: beyond the limit of the pressure it has no rod."""
        return replace(self, swollen=None) if self.swollen else self

    def with_limit(self, rising: bool, *values: Any) -> "ArmLaw":
        """With the limit of the form from rest, or of that after the snap, from the values of a `PressureLimit`."""
        limit = PressureLimit(*values)
        return replace(self, limit=limit) if rising else replace(self, back=limit)

    def form_at(self, pressure: float, *, after_snap: bool = False) -> "ArmLaw":
        """The law of one form: that which inflation from rest reaches at a pressure in kPa, or the swollen one.

        Raises `RodError` for a form that the law does not have there.
        """
        if after_snap and self.swollen is None:
            raise RodError("The law has no form after a snap.")
        if self.limit is None or (pressure <= self.limit.value and not after_snap):
            return self.before_snap
        if self.swollen is None:
            raise RodError(f"{self.snap} This form of the arm ends there, below {pressure:.4g} kPa.")
        return self.swollen

    @property
    def snap(self) -> str:
        """What happens at the limit of the pressure, a sentence; empty without one."""
        return "" if self.limit is None else f"At {self.limit.value:.4g} kPa its chambers swell at once."

    def told_at(self, pressure: float, *, after_snap: bool = False) -> str:
        """Which of two forms that at a pressure in kPa is, in sentences; empty where there is one, far from a limit."""
        if self.limit is None or self.back is None or self.swollen is None or pressure < self.back.value:
            is_near = self.limit is not None and self.swollen is None and pressure >= (1.0 - NEAR) * self.limit.value
            return self.snap if is_near else ""
        if after_snap or pressure > self.limit.value:
            return f"{self.snap} This is the swollen form, which is lost below {self.back.value:.4g} kPa."
        return f"{self.snap} At {pressure:.4g} kPa this is the form before that; there is a swollen one, too."

    def at(
        self, pressure: Amount | Sequence[Amount], length: Amount | None = None, *, after_snap: bool = False
    ) -> "LawRod":
        """The rod at a pressure in kPa or as "20 kPa", which may be a tuple of one.

        length: mm, of the arm, or another one that is made of the same cells. after_snap: of a pressure at which the
        law has two forms, the swollen one; else the one that inflation from rest reaches.

        A body with cells has lengths that differ from the arm's by whole cells; that is not checked here.
        Raises `RodError` for a pressure outside those of the law and a length without room for both ends.
        """
        (p,) = pressures_of(pressure, self.cavities)
        form = self.form_at(p, after_snap=after_snap)
        lost = self.back if form is self.swollen else self.limit
        cells = [cell.placed for cell in form.cells]
        try:
            section = section_at(cells, p, p)
        except RodError as outside:
            raise RodError(" ".join(filter(None, [str(outside), self.snap]))) from None
        return LawRod(
            section,
            clamp_at([clamp.placed for clamp in form.clamps], cells, p, p),
            tip_at([tip.placed for tip in form.tips], p, p),
            form.pitch,
            form.first_middle,
            form.length if length is None else finite(length, "The length", "mm"),
            form.mass,
            form.weight,
            lost.value if lost and abs(p - lost.value) <= NEAR * lost.value else None,
        )
