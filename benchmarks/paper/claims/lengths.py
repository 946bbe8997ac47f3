"""Claims on arms of other lengths, compared with that of 11 chambers by eq. (9)."""

from benchmarks.paper.claims.common import NEAR_ONE, NOT_RUN, SYMBOL, claim, range_of
from benchmarks.paper.data import ARMS, LAWS, Data
from benchmarks.paper.estimates import CELLS, DEFAULT, Estimate
from benchmarks.paper.reading import Claim
from benchmarks.paper.states import weight_of


def curvature_over_length(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        pairs = _pairs(data, law, CELLS)
        ratios = [a.state.kappa_0_middle / b.state.kappa_0_middle for a, b in pairs]
        if ratios:
            what = "κ₀(l/2) l over that of 11 chambers, over l/l₀ (7 and 20 chambers; 10, 24, 37 kPa)"
            readings.append(range_of(what, ratios, required=NEAR_ONE, law=law))
    says = "κ₀ l is proportional to l/l₀ (eq. 9, Fig. 12)"
    return claim("13", says, readings, "More equal cells bend each by the same.", NOT_RUN["lengths"])


def rigidity_over_length(data: Data) -> Claim:
    readings = []
    for law in LAWS:
        for estimator in (CELLS, DEFAULT):
            for name in ("alpha1", "alpha2"):
                pairs = [
                    (a, b)
                    for a, b in _pairs(data, law, estimator)
                    if name == "alpha2" or estimator != DEFAULT or (a.two_lines and b.two_lines)
                ]
                ratios = [getattr(a, name) / getattr(b, name) for a, b in pairs]
                at = {"law": law, "estimator": estimator}
                if ratios:
                    what = f"{SYMBOL[name]}/(m g l²) over that of 11 chambers, times (l/l₀)², weight of 11 chambers"
                    readings.append(range_of(what, ratios, required=NEAR_ONE, part=name, **at))
                if ratios and name == "alpha2" and estimator == CELLS:
                    by_own = [
                        getattr(a, name) / getattr(b, name) * weight_of(b.state) / weight_of(a.state) for a, b in pairs
                    ]
                    readings.append(range_of("the same with the weight of each arm", by_own, **at))
    says = "α/(m g l²) is proportional to (l₀/l)² (eq. 9, Fig. 13)"
    why = "Rigidities in N mm² belong to the cells: it holds with the weight of one arm, not with that of each arm."
    return claim("14", says, readings, why, NOT_RUN["lengths"])


def _pairs(data: Data, law: str, estimator: str) -> list[tuple[Estimate, Estimate]]:
    """Arms of other lengths, each with the one of 11 chambers at the same pressure."""
    reference = {e.state.pressure: e for e in data.of("pneunet", law, ARMS[0], estimator)}
    others = data.of("lengths", law, ARMS[0], estimator)
    return [(e, reference[e.state.pressure]) for e in others if e.state.pressure in reference]
