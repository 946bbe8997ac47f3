"""The claims of the paper as readings: kappa_0, the two slopes, d, lengths, the end force, the rods."""

from collections.abc import Callable

from benchmarks.paper.claims.agreement import end_force, rods_of
from benchmarks.paper.claims.common import ROUND
from benchmarks.paper.claims.curvature import (
    curvature_by_equation_nine,
    curvature_of_arms,
    curvature_of_pneunet,
    curvature_without_clamp,
    middle_of_arm,
)
from benchmarks.paper.claims.lengths import curvature_over_length, rigidity_over_length
from benchmarks.paper.claims.random import falling_rigidity, one_line
from benchmarks.paper.claims.rigidities import (
    contact_is_the_cause,
    straight,
    trend,
    two_lines_everywhere,
    two_slopes,
)
from benchmarks.paper.claims.simulations import three_simulations
from benchmarks.paper.claims.zone import length_of_zone, zone_of_arms, zone_over_height, zone_over_pressure
from benchmarks.paper.data import ARMS, Data
from benchmarks.paper.reading import Claim


def claims(data: Data) -> list[Claim]:
    """All claims, in the order of the paper's figures."""
    return [make(data) for make in _CLAIMS]


_RISE = "Inner cells stiffen as their walls are stretched and touch."
_CLAIMS: tuple[Callable[[Data], Claim], ...] = (
    curvature_of_pneunet,
    curvature_of_arms,
    curvature_without_clamp,
    middle_of_arm,
    two_slopes,
    contact_is_the_cause,
    straight("alpha2"),
    straight("alpha1"),
    trend("6a", ARMS[:1], "alpha2", True, "α₂ of the pneu-net rises with p (Fig. 15 c)", _RISE),
    trend(
        "6b", ARMS[:1], "alpha1", False, "α₁ of the pneu-net falls with p (Fig. 15 b)",
        "It falls where the estimator smooths the curvature next to the clamp; the default, which resolves the softer "
        "zone there, has no significant fall.",
    ),
    trend(
        "7a", ARMS[1:2], "alpha2", True, "α₂ of the semicircular arm rises with p (Fig. 15 c)",
        "Walls stiffen as they are stretched. Where a single line describes an arm, the process puts d far from the "
        "clamp (claim 12), and its slopes say little.",
    ),
    trend(
        "7b", ARMS[1:2], "alpha1", False, "α₁ of the semicircular arm falls with p (Fig. 15 b)",
        "A single line describes this arm, so α₁ is a matter of the estimator.",
    ),
    trend(
        "8a", ARMS[2:], "alpha2", False, "α₂ of the arms with one cavity along the axis falls with p (Fig. 15 c)",
        "It rises by every test number that is not open. The dimensions are our own: the paper prints none for these "
        "arms.",
    ),
    trend(
        "8b", ARMS[2:], "alpha1", True, "α₁ of the arms with one cavity along the axis rises with p (Fig. 15 b)",
        "A single line describes these arms, so α₁ is a matter of the estimator.",
    ),
    falling_rigidity,
    length_of_zone,
    zone_over_pressure,
    zone_over_height,
    zone_of_arms,
    one_line,
    curvature_over_length,
    rigidity_over_length,
    curvature_by_equation_nine,
    end_force,
    rods_of("17a", ARMS[:1], "Rod and finite elements of the pneu-net agree in II and III (Fig. 10)"),
    rods_of("17b", ROUND, "Rod and finite elements of the other arms agree in II and III (Fig. 16)"),
    rods_of("18a", ARMS, "The five-parameter relation is germane to all four arms (abstract)"),
    two_lines_everywhere,
    three_simulations,
)  # fmt: skip
