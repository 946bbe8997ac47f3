"""What in the points of a tensile test is most likely not what it is taken for."""

from itertools import pairwise

import numpy as np

from geometry.arrays import Array
from pipeline.material.regression import TooFewPoints, regress

#: part of the range of strains by which the strain has to go back; less is scatter
LEAST_RETURN = 0.05
#: fewest points on the way from one turn to the next, in the mean: rows in any order turn at every second point
POINTS_PER_WAY = 4
#: fewest points after a turn at strains that were passed before
REPEATED = 3
#: the stress before a break and after it, over the largest stress of the test
BEFORE_BREAK, AFTER_BREAK = 0.8, 0.5
#: largest strain within which a specimen breaks, over the largest strain of the test
BREAK_WITHIN = 0.05
#: Young's moduli of rubbers and gels from which arms are made, MPa, and strains of which a test is possible
SOFTEST, STIFFEST = 0.01, 100.0
SMALLEST_STRAIN, LARGEST_STRAIN = 0.02, 15.0

#: largest strain of the points that tell the stress at rest, and the strain at which the stress is compared with it
STRAIN_NEAR_REST, COMPARED_STRAIN = 0.5, 0.1
#: the least strain of a column that has stretches, and the stress there over the largest one; a rubber that is measured
#: from a strain of 1 to one of 6 has a third
STRETCH_AT_REST, STRESS_AT_REST = (0.95, 1.05), 0.1
#: standard errors from which a stress at rest is none of chance
CERTAIN = 4.0


def are_stretches(least_strain: float, stress: float, largest_stress: float) -> bool:
    """Whether values called strains are more likely stretches: the least of them is 1 and has hardly any stress."""
    low, high = STRETCH_AT_REST
    return low <= least_strain <= high and abs(stress) <= STRESS_AT_REST * largest_stress


def goes_back(strain: Array) -> int | None:
    """The point after which the specimen is unloaded or loaded again; strain (n,) in the order of the measurement.

    None where strains grow or fall throughout, are in any order, or come in parts that do not overlap.
    """
    turns = _turns(strain)
    if len(strain) < POINTS_PER_WAY * (len(turns) + 1):
        return None
    again = np.zeros(len(strain), dtype=bool)
    for begin, end in pairwise([0, *turns]):
        way = strain[begin : end + 1]
        if len(way) > REPEATED:  # fewer are a jump, which passes nothing
            again[end + 1 :] |= (strain[end + 1 :] > way.min()) & (strain[end + 1 :] < way.max())
        if np.count_nonzero(again) >= REPEATED:
            return end
    return None


def _turns(strain: Array) -> list[int]:
    """The points at which the strain begins to go back by more than scatter."""
    least = LEAST_RETURN * float(np.ptp(strain))
    turns, low, high, way = [], 0, 0, 0
    for point, value in enumerate(strain):
        low, high = (point if value < strain[low] else low), (point if value > strain[high] else high)
        if way >= 0 and strain[high] - value > least:
            turns += [high] * (way > 0)
            way, low, high = -1, point, point
        elif way <= 0 and value - strain[low] > least:
            turns += [low] * (way < 0)
            way, low, high = 1, point, point
    return turns


def breaks_after(strain: Array, stress: Array) -> int | None:
    """The last point before the break of the specimen; strain (n,) ascending, stress (n,) MPa.

    The stress falls there to less than half within a small strain, further than before, and stays so.
    """
    peak = float(stress.max())
    if peak <= 0:
        return None
    last = int(np.flatnonzero(stress >= BEFORE_BREAK * peak)[-1])
    fallen = np.flatnonzero(stress >= AFTER_BREAK * peak)[-1] + 1
    if fallen == len(stress) or strain[last] <= 0:
        return None
    sharp = fallen == last + 1 or strain[fallen] - strain[last] <= BREAK_WITHIN * strain[-1]
    falls = -np.diff(stress[: last + 1])
    if not sharp or stress[last] - stress[fallen] <= 2 * falls.max(initial=0.0):
        return None
    return last


def usual(strain: float, stress: float) -> bool:
    """Whether a rubber can have this largest strain and this largest stress, MPa."""
    return SMALLEST_STRAIN <= strain <= LARGEST_STRAIN and SOFTEST <= stress / strain <= STIFFEST


def of_modulus(modulus: float) -> str:
    """The sentence on a Young's modulus, MPa, that no rubber has; else empty."""
    if not modulus > 0 or SOFTEST <= modulus <= STIFFEST:
        return ""
    smaller, larger = (modulus / 1000, "smaller", "kPa, not MPa"), (1000 * modulus, "larger", "MPa, not kPa")
    meant, units, example = smaller if modulus > STIFFEST else larger
    likely = "check the units of stress and strain"
    if SOFTEST <= meant <= STIFFEST:
        likely = (
            f"is the unit of the stress 1000 times {units} than the header says (such as {example}), which would make "
            f"it {meant:.3g} MPa?"
        )
    return f"Young's modulus is {modulus:.3g} MPa, and rubbers have {SOFTEST:g} to {STIFFEST:g} MPa: {likely}"


def of_strain(largest: float) -> str:
    """The sentence on a largest strain that no rubber bears; else empty."""
    if largest <= LARGEST_STRAIN:
        return ""
    return (
        f"strains reach {100 * largest:.3g} %, and rubbers break below {100 * LARGEST_STRAIN:g} %: "
        "is the strain in % where the header says 1?"
    )


def of_rest(stretch: Array, stress: Array, within: float) -> str:
    """The sentence on a stress at rest that differs from zero; else empty. All (n,), stress in MPa.

    within: the part of the stress at a strain of 10 % from which it counts.
    """
    near = np.abs(stretch - 1) <= STRAIN_NEAR_REST
    s = stretch[near]
    # with Mooney's two terms, whatever the law
    try:
        fit = regress(
            np.column_stack([np.ones_like(s), s - s**-2, 1 - s**-3]), stress[near], np.zeros(len(s), dtype=np.int64)
        )
    except TooFewPoints:
        return ""
    at, offset = 1 + COMPARED_STRAIN, float(fit.coefficients[0])
    compared = abs(float(fit.coefficients[1:] @ [at - at**-2, 1 - at**-3]))
    nearest = float(stress[np.argmin(np.abs(stretch - 1))])
    if abs(offset) <= max(CERTAIN * float(fit.errors[0]), within * compared) or 2 * nearest < offset > 0:
        return ""
    remedy = "subtract the offset of the load cell from every stress"
    if offset < 0:
        remedy = f"count strains from where a slack specimen begins to carry, or {remedy}"
    return (
        f"the stress at rest, continued from strains up to {100 * STRAIN_NEAR_REST:g} %, is {offset:.2g} MPa instead "
        f"of zero: {remedy}"
    )
