"""Whether the rod has a single line or two, decided once for all pressures at which two are possible.

The criterion of one pressure depends on the mesh where the two are close to each other, and alpha2 would jump where the
number of lines changes between two pressures. So the criteria are added over the pressures at which two lines are
possible: with independent errors the sum approximates twice the logarithm of the evidence for two lines at all of these
pressures against a single line at all, if each parameter is penalised with the observations of its own pressure.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from geometry import Design
from pipeline.simulation.outcome import Record


@dataclass(frozen=True)
class Choice:
    """Of a single line or two, at a pressure."""

    evidence: float  #: for two lines: the criterion of a single line minus that of two, of one pressure or of several
    two_lines: bool


def counts_as_equal_cells(design: Design) -> bool:
    """Whether an arm consists of equal cells, or its curvature is averaged over less than the distance of its cavities:
    it then changes between a cavity and the wall beside it, which two lines would describe."""
    return design.repeats or design.averages_within_cavities


def has_one_rigidity(equal_cells: bool, free: Record, loaded: Record) -> bool:
    """Whether nothing but its ends makes one part of the arm different from another: equal cells, and in II and III no
    walls came within the activation distance of contact up to that pressure."""
    return equal_cells and not any("self_contact" in record.effects for record in (free, loaded))


def choices(evidence: Sequence[float], one_rigidity: Sequence[bool], d_given: bool) -> list[Choice]:
    """By pressure, from the evidence for two lines that each has alone.

    Where the rigidity may vary along the arm the sum over all such pressures decides for each of them. Elsewhere each
    keeps its own evidence, and a single line is taken unless d is given.
    """
    together = sum(own for own, is_one in zip(evidence, one_rigidity, strict=True) if not is_one)
    used = [own if is_one else together for own, is_one in zip(evidence, one_rigidity, strict=True)]
    return [Choice(e, takes_two_lines(e, is_one, d_given)) for e, is_one in zip(used, one_rigidity, strict=True)]


def takes_two_lines(evidence: float, one_rigidity: bool, d_given: bool) -> bool:
    """Whether two lines are wanted, or worth their parameters by the criterion and not excluded by one rigidity."""
    return d_given or (evidence > 0.0 and not one_rigidity)
