"""Which of the fitted laws can be used, over which stretches, and which one to take."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.materials import Material, MaterialError
from geometry.arrays import Array, Mask
from pipeline.answers.material.laws import (
    FORMS,
    PER_LOG,
    STATES,
    Form,
    Points,
    is_stable,
    predicted,
    stretches,
)

#: relative error of the nominal stress up to which a law counts as valid
WITHIN = 0.1
#: largest ratio of the stresses of two laws, in any state, up to which both can be used
FACTOR = 1.5
#: strain from which the misfit of a law is judged relative to the stress; below, relative to the stress there
JUDGED_FROM = 0.2
#: stress over the shear modulus below which a difference is taken relative to it: nearer to rest than any is judged
LEAST_STRESS = 1e-3
#: standard errors of a measured stress by which a law may miss it beyond the tolerance
ALLOWED_ERRORS = 2.0
#: the largest stretch that is tried as the end of a range, over that before in ln(stretch); the smallest one, from
#: which on a law is offered; how many are tried
SHORTER, SHORTEST, NARROWED = 0.85, 1.05, 40
#: stretch below which a law may not part from those before
UNSAFE = 1.3
#: part of the tolerance within which the law of one constant is preferred
SIMPLE = 0.5
#: what ends the range of the law that is offered where none is close to the tests
NEAREST = "misfit from the start on"
#: laws whose biaxial stress follows best from tensile tests come first: those of the first invariant alone, and one
#: term of Ogden's law (R. S. Rivlin, D. W. Saunders 1951; O. H. Yeoh, Rubber Chem. Technol. 63 (1990) 792)
ORDER = ("yeoh", "ogden 1", "neo_hooke", "mooney_rivlin", "ogden 2", "hencky", "svk")


@dataclass(frozen=True)
class LawFit:
    """One law with its constants, and the stretches over which it can be used."""

    form: Form
    constants: Array  #: (k,) MPa; exponents without unit
    law: Material  #: with its Poisson ratio or kappa
    fitted: tuple[float, float]  #: stretches of the first and the last point that it was fitted to
    holds: tuple[float, float] | None  #: smallest and largest principal stretch; None where it cannot be used
    why: str  #: what ends this range, or why there is none
    misfit: float = np.nan  #: root mean square of the differences over the stress, from a strain of 20 % on, over the
    #: points of this range, or else over those that it was fitted to
    largest: float = np.nan  #: the largest of them

    @property
    def name(self) -> str:
        """Name of the law in a table: yeoh, ogden 2."""
        return self.form.name

    @property
    def high(self) -> float:
        """The largest principal stretch at which it can be used; 0 for none."""
        return self.holds[1] if self.holds else 0.0


@dataclass(frozen=True)
class Need:
    """The stretches that a law has to describe."""

    low: float
    high: float

    @property
    def reach(self) -> float:
        """The stretch of a bar with the first invariant of equibiaxial tension to the largest stretch: a law of the
        first invariant is known there if the bar is pulled so far."""
        invariant = 2 * self.high**2 + self.high**-4
        roots = np.roots([1, 0, -invariant, 2])
        return float(np.max(roots.real[np.abs(roots.imag) < 1e-9]))


@dataclass(frozen=True)
class Judged:
    """All laws."""

    laws: tuple[LawFit, ...]  #: the one to take first, then those that can be used, and those that cannot
    refused: dict[str, str]  #: why other laws have no constants, by name

    @property
    def usable(self) -> tuple[LawFit, ...]:
        """The laws that can be used over some stretches, the one to take first."""
        return tuple(fit for fit in self.laws if fit.holds)


def judge(points: Points, need: Need, nu: float, *, is_narrowed: bool = True) -> Judged:
    """Every law fitted and judged. Raises `MaterialError` where no law has constants for these points.

    is_narrowed: a law that does not describe all stretches that are needed is fitted to fewer of them.
    """
    fits, refused = [], {}
    for form in FORMS.values():
        try:
            fits.append(_widest(form, points, need, nu, NARROWED if is_narrowed else 1))
        except MaterialError as failure:
            refused[form.name] = str(failure)
    if not fits:
        raise MaterialError("; ".join(dict.fromkeys(refused.values())))
    end = min(need.high, end_of(points))
    fits.sort(key=lambda fit: _rank(fit, end))
    taken: list[LawFit] = []
    for fit in fits:
        taken.append(_where_they_agree(fit, [other for other in taken if other.holds]))
    if not taken[0].holds:  # the best fit with its misfit, rather than none
        stable = [_as_it_is(fit, points) for fit in taken]
        best = min((fit for fit in stable if fit.holds), key=lambda fit: fit.misfit, default=taken[0])
        taken = [best, *(fit for fit in taken if fit.form is not best.form)]
    stated = [_with_misfit(fit, points) for fit in taken]
    return Judged(tuple(sorted(stated, key=lambda fit: fit.holds is None)), refused)


def end_of(points: Points) -> float:
    """The largest stretch that the tests have in any direction."""
    return max(float(points.stretch[-1]), float(points.stretch[0]) ** -0.5)


def _rank(fit: LawFit, end: float) -> tuple[bool, bool, float, int]:
    """Those first that hold as far as needed, the law of one constant if it is close; else those that hold further."""
    covers = fit.high >= 0.98 * end
    simple = covers and fit.form.constants == ("mu",) and fit.largest <= SIMPLE * WITHIN
    far = 0.0 if covers else -fit.high
    return not covers, not simple, far, ORDER.index(fit.name) if fit.name in ORDER else len(ORDER)


def _widest(form: Form, points: Points, need: Need, nu: float, tries: int) -> LawFit:
    """The law fitted to the stretches that are needed, or else to the widest range of them that it describes."""
    ends = [need.high**SHORTER**k for k in range(NARROWED)]
    if len(form.constants) > 1:
        ends.insert(0, need.reach)
    first, refused = None, None
    for end in (end for end in ends[:tries] if end > SHORTEST):
        chosen = points.within(max(need.low, 1 / end) if end < need.high else need.low, end)
        if len(chosen.stretch) <= len(form.constants):
            break
        try:
            fit = _fitted(form, chosen, need, nu)
        except MaterialError as failure:
            refused = failure
            continue
        fit = _with_range(_with_misfit(fit, points), points)
        first = first or fit
        if fit.high >= min(end, need.high, end_of(chosen)) * 0.99:
            return fit
    if first is None:
        raise refused or MaterialError(
            f"the tests have too few points between the stretches {need.low:.3g} and {need.reach:.3g}"
        )
    return first


def _fitted(form: Form, chosen: Points, need: Need, nu: float) -> LawFit:
    constants = form.fitted(chosen, need.high)
    return LawFit(form, constants, form.solved(constants, nu), (chosen.stretch[0], chosen.stretch[-1]), None, "")


def _with_misfit(fit: LawFit, points: Points) -> LawFit:
    """The same with its differences from the points of its range."""
    chosen = points.within(*(fit.holds or fit.fitted))
    far = np.abs(chosen.stretch - 1) >= min(JUDGED_FROM, 0.5 * float(np.abs(chosen.stretch - 1).max()))
    off = np.abs(predicted(fit.law, chosen) - chosen.stress)[far]
    judged = np.nan_to_num(off, nan=np.inf) / np.maximum(np.abs(chosen.stress[far]), LEAST_STRESS * points.modulus)
    return replace(fit, misfit=float(np.sqrt(np.mean(judged**2))), largest=float(judged.max()))


def _with_range(fit: LawFit, points: Points) -> LawFit:
    """The same with the stretches from rest on over which it is stable in all states and close to the tests."""
    floor = points.modulus * ((1 + JUDGED_FROM) - (1 + JUDGED_FROM) ** -2)
    allowed = WITHIN * np.maximum(np.abs(points.stress), floor) + ALLOWED_ERRORS * points.error
    close = np.abs(predicted(fit.law, points) - points.stress) <= allowed
    up, down = points.stretch > 1, points.stretch < 1
    pulled, pressed = _last(points.stretch[up], close[up]), _last(points.stretch[down][::-1], close[down][::-1])
    high = max(pulled, pressed**-0.5)
    why = "data" if close.all() else "misfit"
    if (stable := _stable_to(fit.law, high)) < high:
        high, why = stable, "instability"
    low = max(high**-2, pressed if down.any() and not close[down].all() else 0.0)
    if high < SHORTEST and (why != "data" or high <= 1):
        return replace(fit, why=f"{why} beyond a stretch of {high:.3g}" if high > 1 else why)
    return replace(fit, holds=(low, high), why=why)


def _last(stretch: Array, close: Mask) -> float:
    """The last stretch from rest on without interruption; 1 where there is none."""
    count = int(np.argmin([*close, False]))
    return float(stretch[count - 1]) if count else 1.0


def _stable_to(law: Material, high: float) -> float:
    """The largest stretch up to which a law is stable in every state, and in compression to its inverse square."""
    low_limit, high_limit = law.stretch_limits
    ends = [high, high_limit, low_limit**-0.5 if low_limit > 0 else np.inf]
    for state in STATES:
        for end in (high**-2, high) if state == "uniaxial" else (high,):
            grid = np.geomspace(1.0, end, int(PER_LOG * abs(np.log(end))) + 2)
            last = _last(grid[1:], is_stable(law, state, grid)[1:])
            ends.append(last if end > 1 else last**-0.5)
    return float(min(ends))


def _where_they_agree(fit: LawFit, others: Sequence[LawFit]) -> LawFit:
    """The same without the stretches at which it is off laws before by more than the factor; it is unsafe if that
    begins at small ones."""
    for other in others:
        if fit.holds is None or other.holds is None:
            continue
        high = min(fit.holds[1], other.holds[1])
        end, state, ratio = parting(fit.law, other.law, high)
        if end < high:
            why = f"{ratio:.2g} times the {state} stress of {other.name} at {high:.3g}"
            holds = (max(fit.holds[0], end**-2), end) if end >= UNSAFE else None
            fit = replace(fit, holds=holds, why=why)
    return fit


def parting(law: Material, other: Material, high: float) -> tuple[float, str, float]:
    """The stretch up to which two laws are within the factor in every state, the state that ends it, and the ratio
    of their stresses at `high` there; `high` and the largest ratio where they do not part."""
    grid = stretches(1.0, high)[1:]
    ends = []
    for state, across in STATES.items():
        ratio = law.incompressible(grid, across(grid)) / other.incompressible(grid, across(grid))
        apart = ~(np.maximum(ratio, 1 / ratio) <= FACTOR)
        end = float([1.0, *grid][int(np.argmax(apart))]) if apart.any() else high
        ends.append((end, -abs(float(np.log(np.abs(ratio[-1])))), state, float(ratio[-1])))
    end, _, state, largest = min(ends)
    return end, state, largest


def _as_it_is(fit: LawFit, points: Points) -> LawFit:
    """The same for all stretches of the tests at which it is stable, however far off it is."""
    high = _stable_to(fit.law, end_of(points))
    return replace(fit, holds=(high**-2, high), why=NEAREST) if high > 1 else fit
