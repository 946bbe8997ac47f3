"""Why a path, a state or a piece of a body is as it is: the sentence of each code of `geometry.Reason`."""

from collections.abc import Iterable, Mapping
from typing import Any

from geometry.errors import Reason, position_text

#: sentence without full stop by code; {at} is the position
SENTENCES: Mapping[str, str] = {
    # Newton's method
    "residual_unbounded": "the residual grew without bound after {iterations} iterations",
    "far_from_equilibrium": "no equilibrium near after {iterations} iterations (relative residual {residual:.1e})",
    "not_converged": "no equilibrium after {iterations} iterations (relative residual {residual:.1e})",
    "tangent_turns_indefinite": "the tangent becomes indefinite",
    "tangent_indefinite": "the tangent is indefinite",
    "tangent_stays_indefinite": "the tangent stays indefinite",
    "tangent_singular": "the tangent is singular ({why})",
    # an equilibrium that is refused
    "element_inverted": "an element is turned inside out at {at} (J = {min_J:.3g})",
    "walls_cross": "two walls pass through each other at {at}",
    "far_walls_cross": "two walls that are {apart_mm:.3g} mm apart at rest pass through each other at {at}",
    "stiffer_contact_fails": "more or stiffer contact does not help",
    "further_walls_meet": "further walls meet",
    "out_of_memory": "{why}",
    "equilibrium_unstable": "the equilibrium is unstable",
    "jump": "the body jumps to another equilibrium, to which no continuous path leads",
    "beyond_limit": "beyond the limit that the path announces there is another equilibrium only",
    # the end of a path
    "nothing_tried": "no increment was tried",
    "given_up": "the target was given up",
    "search_ended": "the search ended after {increments} increments",
    "stretch_too_small": "a stretch of {stretch:.3g} at {at} is below {limit:.3g}, where the law {law}{of_region} in "
    "compression is no longer stable",
    "stretch_too_large": "a stretch of {stretch:.3g} at {at} is above {limit:.3g}, the largest at which the law "
    "{law}{of_region} is stable",
    "body_not_held": "at rest the tangent is singular: a part of the body is not held",
    "limit_point": "the last equilibrium has {stiffness:.1%} of its elastic stiffness left in a motion that is largest "
    "at {at}: a limit point",
    "singular_limit_point": "the tangent at the last equilibrium is singular: a limit point",
    # beyond such limits of half discs and bars of St. Venant-Kirchhoff a prescribed volume did not lead, and
    # neo-Hooke's law led 1.1 to 1.4 times as far, on three designs drawn at random
    "law_exceeded": "the law is beyond its limits there, and another law may lead further",
    "volume_leads_on": "only a prescribed volume (in Python, fem.follow_volume) or displacement leads beyond it",
    # 12 to 16 % on arms of rubber, 78.8 instead of 93.7 kPa
    "early_limit": "(p2p0 elements are too soft and reach limit points up to 16 % early)",
    "unexplained": "neither the law nor a limit point explains it: the last equilibrium has {stiffness:.0%} of its "
    "elastic stiffness left, least in a motion that is largest at {at}; a finer mesh there, another formulation or "
    "pressures in between may lead further",
    "unexplained_under_volume": "the law does not explain it: a finer mesh, another formulation or volumes in between "
    "may lead further",
    # a piece of an arm
    "no_piece_near": "no equilibrium of the {piece} at {pressure_kPa:.4g} kPa and a mean curvature of "
    "{kappa_per_mm:.4g} 1/mm",
    "no_piece_on_the_way": "no equilibrium of the {piece} at {pressure_kPa:.4g} kPa and a mean curvature of "
    "{kappa_per_mm:.4g} 1/mm, on the way to {target_kPa:.4g} kPa",
    "no_piece_at_volume": "no equilibrium of the {piece} at {times:.4g} times its air at rest and a mean curvature of "
    "{kappa_per_mm:.4g} 1/mm",
    "beyond_limit_pressure": "the {piece} has no form at {pressure_kPa:.4g} kPa: beyond its limit pressure of "
    "{limit_kPa:.4g} kPa its chambers swell, and the pressure falls",
    "beyond_air": "the {piece} has no state at {pressure_kPa:.4g} kPa up to the largest air that is tried",
    "piece_unstable": "the {piece} is not stable at {pressure_kPa:.4g} kPa and {kappa_per_mm:.4g} 1/mm",
    "no_piece_without_moment": "the {piece} at {pressure_kPa:.4g} kPa has no state without moment near the last one",
    "cell_moment_falls": "the moment of the cell falls at {pressure_kPa:.4g} kPa",
    "clamp_moment_falls": "at {pressure_kPa:.4g} kPa the clamped end is not described from a moment of "
    "{moment_N_mm:.4g} N mm on, because that moment does not grow when the end is bent further",
    "clamp_not_followed": "the clamped end at {pressure_kPa:.4g} kPa was not followed beyond {moment_N_mm:.4g} N mm",
    "clamp_once": "the clamped end has one state at {pressure_kPa:.4g} kPa only",
    # the stability of a state
    "unstable": "unstable in {directions} direction(s): the smallest push lets it fall along {axis}, most at {at}",
    "unstable_at_limit_point": "unstable in {directions} direction(s), at a limit point",
    "not_followed": "the path was not followed: it lost its stability between {stable:.1%} and {unstable:.1%} of the "
    "way to this state; smaller steps there end at a limit point or follow another branch",
    "not_followed_earlier": "the path was not followed: it lost its stability on the way to an earlier state; smaller "
    "steps there end at a limit point or follow another branch",
    # a body without contact
    "crosses_itself": "the body passes through itself near {at}, where contact is not simulated",
    "crosses_mirror_image": "the body passes through its mirror image near {at}, where contact is not simulated",
}


def position_of(point: Iterable[float]) -> tuple[float, float, float]:
    """Three numbers (3,) as the position of a reason."""
    x, y, z = map(float, point)
    return x, y, z


#: what explains one thing together, in the order of a sentence
Reasons = tuple[Reason, ...]


def sentence(reasons: Iterable[Reason]) -> str:
    """Reasons as one sentence without full stop; empty without reasons."""
    places = [(one, "an unknown place" if one.where is None else position_text(one.where)) for one in reasons]
    return "; ".join(SENTENCES[reason.code].format(**reason.values, at=at) for reason, at in places)


def reasons_of(rows: Iterable[Mapping[str, Any]]) -> Reasons:
    """Reasons from their fields, as JSON gives them."""
    return tuple(Reason(row["code"], row["values"], row["where"] and position_of(row["where"])) for row in rows)


class FailedForReasons(ArithmeticError):
    """A failure that carries its reasons."""

    def __init__(self, *reasons: Reason) -> None:
        super().__init__(*reasons)
        self.reasons: Reasons = reasons

    def __str__(self) -> str:
        return sentence(self.reasons)
