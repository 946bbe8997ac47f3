"""What stands in the way of a design that misses something, and what lies beyond it, by the model near the design."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.study.wishes.step import Model, propose
from pipeline.study.wishes.wish import Wishes

#: changes of logarithms that are tried, and distance from a bound or a limit at which a design stands at it
STEPS, AT = [0.02 * k for k in range(1, 21)], 0.01
#: part of the largest miss that is left at most where something is in the way
LEFT = 0.9
#: limits, the unit in their names, and the direction in which they are lifted
LIMITS = (("mass", "_g", 1.0), ("largest_stretch", "", 1.0), ("smallest_wall", "_mm", -1.0))


def behind(model: Model) -> tuple[str, ...]:
    """A sentence for each bound, limit and material without which nothing would be missed, or else less."""
    before, told, met = model.worth(np.log(model.point)).misses.max(), dict[int, str](), set[int]()
    for step in STEPS:
        for number, (wider, words) in enumerate(_wider(model, step)):
            worth = wider.worth(np.log(propose(wider, STEPS[-1])))
            if number not in met and worth.is_within(1.0):
                told[number] = f"{words} nothing would be missed"
                met.add(number)
            elif number not in met and (miss := worth.misses.max()) < LEFT * before and np.all(worth.limits <= 1.0):
                told[number] = f"{words} the largest miss would be {miss:.2g} instead of {before:.2g} tolerances"
    return tuple(told[number] for number in sorted(met or told))


def at_bounds(wishes: Wishes, point: Array) -> tuple[str, ...]:
    """A clause for each dimension and pressure of a point (n,) that stands at a bound."""
    ends = ((one, value, bound) for one, value in zip(wishes.free, point, strict=True) for bound in (one.low, one.high))
    return tuple(f"{one.key}, {b:.4g} {one.unit}" for one, value, b in ends if abs(np.log(value / b)) < AT)


def _wider(model: Model, step: float) -> Iterator[tuple[Model, str]]:
    """The model where one bound, one limit or the material gives way by a change of its logarithm, and words for it."""
    wishes, numbers, far = model.file.wishes, model.numbers, float(np.exp(step))
    for k, one in enumerate(wishes.free):
        for name, bound, beyond in (("low", one.low, one.low / far), ("high", one.high, one.high * far)):
            if abs(np.log(model.point[k] / bound)) < AT:
                moved: Any = {name: beyond}
                free = (*wishes.free[:k], replace(one, **moved), *wishes.free[k + 1 :])
                at = f"{one.key} is at its bound, {bound:.4g} {one.unit}; at {beyond:.3g} {one.unit}"
                yield _changed(model, free=free), at
    for name, unit, side in LIMITS if np.any(model.limits(np.log(model.point)) > 1.0 - AT) else ():
        if (limit := getattr(wishes.limits, name + unit)) is not None:
            limits: Any = replace(wishes.limits, **{name + unit: limit * far**side})
            at = f"at {limit * far**side:.3g} {unit[1:]}".rstrip()
            yield _changed(model, limits=limits), f"limits.{name}, {limit:.4g} {unit[1:]}, is in the way; {at}"
    for side, word in ((1.0, "soft"), (-1.0, "stiff")):
        change, is_power = side * step * numbers.by_stiffness, wishes.powers & (numbers.values != 0.0)
        ratios = np.where(is_power, np.exp(change / np.where(is_power, numbers.values, 1.0)), 1.0)
        stiff = replace(numbers, values=np.where(is_power, ratios * numbers.values, numbers.values + change))
        words = f"the material is too {word}; with {far**side:.2g} times its moduli"
        yield replace(model, numbers=stiff), words


def _changed(model: Model, **changes: Any) -> Model:
    return replace(model, file=replace(model.file, wishes=replace(model.file.wishes, **changes)))
