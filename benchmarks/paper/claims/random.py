"""Claims on arms (b) to (d) as a class of bodies: of half cells drawn at random, how many the claim is true of."""

import math
from collections.abc import Callable

from benchmarks.paper.claims.common import SHORT, STRAIGHT, claim
from benchmarks.paper.data import Data
from benchmarks.paper.random_cells import FAMILIES, RandomCell
from benchmarks.paper.reading import Claim, Reading

#: of a claim on a class of bodies, %: of most of them
MOST = (50.0, 100.0)
#: angle by which an arm bends far, rad
BENT = math.pi / 4.0
_NOT_RUN = "`python -m benchmarks.paper.random_cells` has not been run"


def falling_rigidity(data: Data) -> Claim:
    says = "α₂ of arms with one cavity along the axis falls with p (Fig. 15 c), bodies drawn at random"
    why = (
        "Walls stiffen as they are stretched. Bisected circles that bend far soften instead: they are near the "
        "pressure at which they balloon."
    )
    name = "with a rigidity that falls with p"
    return claim(
        "8c", says, _parts(data, FAMILIES[1:], lambda c: c.rigidity_high < c.rigidity_low, name), why, _NOT_RUN
    )


def one_line(data: Data) -> Claim:
    says = "Arms without gaps have two slopes (Fig. 16), cells of bodies drawn at random"
    why = (
        "No outer walls meet. The law of a cell alone is meant: the clamped end adds a zone of its own, whose length "
        "no cell tells."
    )
    name = f"whose M over κ is off a line by more than {100 * STRAIGHT:g} %"
    return claim("12b", says, _parts(data, FAMILIES, lambda c: c.off_line > STRAIGHT, name), why, _NOT_RUN)


def _parts(data: Data, families: tuple[str, ...], is_true: Callable[[RandomCell], bool], what: str) -> list[Reading]:
    """Of the solved cells of each family the part of which it is true, with its interval; beside it that of arms that
    bend far."""
    readings = []
    for family in families:
        solved = [cell for cell in data.random_cells if cell.family == family and cell.is_solved]
        far = [cell for cell in solved if abs(cell.turn) >= BENT]
        for cells, bend, required in ((solved, "", MOST), (far, ", that bend by 45 degrees or more", None)):
            if cells:
                true = sum(map(is_true, cells))
                words = f"cells {what}, {SHORT[family]}{bend}: {true} of {len(cells)}"
                low, high = _wilson(true, len(cells))
                readings.append(Reading(words, 100.0 * true / len(cells), low, high, "%", required, arm=family))
    return readings


def _wilson(true: int, count: int) -> tuple[float, float]:
    """Two standard deviations of a part, in per cent (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927))."""
    z, part = 2.0, true / count
    middle = part + z**2 / (2.0 * count)
    spread = z * (part * (1.0 - part) / count + z**2 / (4.0 * count**2)) ** 0.5
    low, high = ((middle + sign * spread) / (1.0 + z**2 / count) for sign in (-1.0, 1.0))
    return 100.0 * max(low, 0.0), 100.0 * min(high, 1.0)
