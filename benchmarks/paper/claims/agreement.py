"""Claims on the force at the end, and on how far the rods are from the finite elements."""

from collections.abc import Callable, Iterable, Sequence

from benchmarks.paper.claims.common import AT_MOST, NEAR_ONE, NOT_RUN, SHORT, TOUCHING, claim, range_of, single
from benchmarks.paper.data import ARMS, LAWS, Data, above, states_in
from benchmarks.paper.estimates import DEFAULT, Estimate
from benchmarks.paper.reading import Claim, Reading
from benchmarks.paper.rods import fitted, own
from rod import RodError

#: the force of Fig. 5 (b), N
FORCE = (0.175, 0.07)
_WHY_RODS = "What is left of the distance is mostly the stretch of the curve, which this rod has not."


def end_force(data: Data) -> Claim:
    readings = []
    for end in data.ends:
        if end.config["end"]["force_N"][0] != FORCE[0]:
            continue
        if end.held == (None, None):
            rest = float(end.config["geometry"].get("base", 0.0)) / 2.0
            for axis, value in zip("xy", (end.position[0] - _length(end), end.position[1] - rest), strict=True):
                what = f"u_{axis} of the end under {FORCE[0]:g}, {FORCE[1]:g} N"
                readings.append(single(what, value, unit="mm", law=end.law))
        else:
            what = f"F_y at rest height with F_x = {FORCE[0]:g} N, over {FORCE[1]:g} N"
            readings.append(single(what, end.force[1] / FORCE[1], required=NEAR_ONE, law=end.law))
    says = "The end carries (0.175, 0.07) N at 31 kPa (Fig. 5 b)"
    why = (
        "The paper does not print where the end is; it is taken at its height at rest. Dimensions, material and height "
        "were fixed before this force was compared."
    )
    return claim("16", says, readings, why, "the sweep `forces` has not been run")


def _length(end: object) -> float:
    curve = end.curve  # type: ignore[attr-defined]
    return float(curve.s[-1] - curve.s[0] + curve.x[0])


def rods_of(number: str, arms: Sequence[str], says: str) -> Callable[[Data], Claim]:
    """How far the rods are from the finite elements."""

    def make(data: Data) -> Claim:
        readings = []
        for arm in arms:
            for law in LAWS:
                estimates = above(data.arm(arm, law, DEFAULT), TOUCHING if arm == ARMS[0] else 24.0, 37.0)
                if estimates:
                    readings += list(_errors_of_rods(data, arm, law, estimates))
        return claim(number, says, readings, _WHY_RODS, NOT_RUN["pneunet" if arms[0] == ARMS[0] else "arms"])

    return make


def _errors_of_rods(data: Data, arm: str, law: str, estimates: Sequence[Estimate]) -> Iterable[Reading]:
    at = {"law": law, "arm": arm, "unit": "%"}
    named = f", {SHORT[arm]}" if arm != ARMS[0] else ""
    shapes = {"II": [], "III": []}  # type: dict[str, list[float]]
    forces = []
    for e in estimates:
        assert e.law is not None
        try:
            shapes["II"].append(100.0 * fitted(e.state, e.law, loaded=False).largest)
            held = fitted(e.state, e.law)
        except RodError:
            continue
        shapes["III"].append(100.0 * held.largest)
        forces.append(100.0 * held.force_error)
    for name, values in shapes.items():
        yield range_of(f"distance over l in {name}, five numbers{named}", values, required=AT_MOST, part=name, **at)
    yield range_of(f"error of F_y, five numbers{named}", forces, required=(-AT_MOST[1], AT_MOST[1]), part="force", **at)
    if law_of_arm := data.laws.get((arm, law)):
        apart, off = [], []
        for state in states_in(estimates):
            try:
                shape = own(state, law_of_arm)
            except RodError:
                continue
            apart.append(100.0 * shape.largest)
            off.append(100.0 * shape.force_error)
        if apart:
            yield range_of(f"distance over l in III, the arm's own law{named}", apart, **at)
            yield range_of(f"error of F_y, the arm's own law{named}", off, **at)
