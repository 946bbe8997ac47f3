"""Rubbers by name, and constants in the forms of other programs.

The constants of the silicones are those that `pneurod material` finds in tensile tests (ASTM D412, type C) of the Soft
Robotics Materials Database of L. Maréchal et al., Soft Robotics 2021, one batch each; densities are of the data sheets
of their maker, Smooth-On.
Elastosil M4601 as the Soft Robotics Toolkit has it, without a range.
"""

from collections.abc import Callable, Mapping, Sequence

from pipeline.config.kinds import number
from pipeline.config.section import not_known, raise_all, wrong
from pipeline.config.units import STRESS, convert
from pipeline.values.json_values import Written


def _yeoh(c10: float, c20: float, c30: float, density: int, holds: list[float] | None) -> dict[str, Written]:
    constants: dict[str, Written] = {"c10": f"{c10} MPa", "c20": f"{c20} MPa", "c30": f"{c30} MPa"}
    written = {"law": "yeoh", **constants, "density": f"{density} kg/m^3"}
    return written if holds is None else written | {"holds_between": holds}


#: the section `material` of a configuration by name, with texts as a user may write them
RUBBERS: dict[str, dict[str, Written]] = {
    "dragon_skin_10": _yeoh(0.02349, 0.002701, -7.615e-05, 1070, [0.12, 2.95]),
    "dragon_skin_20": _yeoh(0.06148, 0.009699, -0.0006031, 1080, [0.22, 2.17]),
    "dragon_skin_30": _yeoh(0.09182, 0.01025, -0.0005306, 1080, [0.19, 2.35]),
    "ecoflex_00_30": _yeoh(0.0082, 6.45e-05, 1.275e-06, 1070, [0.07, 3.94]),
    "ecoflex_00_50": {"law": "neo_hooke", "mu": "0.02391 MPa", "density": "1070 kg/m^3", "holds_between": [0.17, 2.49]},
    "mold_star_16": _yeoh(0.04346, 0.002615, 4.244e-06, 1180, [0.07, 3.93]),
    "elastosil_m4601": _yeoh(0.11, 0.02, 0.0, 1130, None),
}
#: keys that may stand beside a name
BESIDE = ("nu", "kappa", "density", "holds_between", "loss_factor", "relaxation", "form")
#: ways to write Ogden's terms, of which the first one is meant here: by what mu is multiplied at an exponent
FORMS: dict[str, Callable[[float], float]] = {
    "ogden": lambda alpha: 1.0,
    "abaqus": lambda alpha: 2 / alpha,
    "ansys": lambda alpha: 1.0,
    "febio": lambda alpha: 1 / alpha,
}
#: those in which branches are parts of the modulus at once, not of that at long times
OF_MODULUS_AT_ONCE = ("abaqus", "ansys")
_BULK = {"d1": "write kappa, 2 / d1, or leave it out where d1 is 0"}
_NEO_HOOKE = {"c10": "write mu, 2 c10", "c1": "write mu, 2 c1", "g": "write mu"}
#: what to write instead of the constants of other programs, in small letters
INSTEAD: dict[str, dict[str, str]] = {
    "neo_hooke": _BULK | _NEO_HOOKE,
    "mooney_rivlin": _BULK | {"c1": "write c10", "c2": "write c01"},
    "yeoh": _BULK | {"c1": "write c10", "c2": "write c20", "c3": "write c30"},
    "ogden": _BULK,
}


def form_of(section: Mapping[str, Written]) -> tuple[str | None, Mapping[str, Written]]:
    """The form in which constants are given, and the section without it. Raises ValueError for another one."""
    form = section.get("form")
    if form is not None and form not in FORMS:
        raise_all([wrong(not_known(form, tuple(FORMS)), ("form",))])
    return None if form is None else str(form), {key: value for key, value in section.items() if key != "form"}


def ogden_terms(rest: Mapping[str, Written], form: str | None) -> Mapping[str, Written]:
    """The section of Ogden's law in which terms are written as mu / alpha.

    Raises ValueError where terms are most likely those of Abaqus and no form is given. Values that are no lists of
    numbers are left to the checks of the section.
    """
    stresses, exponents = rest.get("mu"), rest.get("alpha")
    if not (isinstance(stresses, Sequence) and isinstance(exponents, Sequence)):
        return rest
    try:
        mu, alpha = [convert(value, STRESS) for value in stresses], [number(value) for value in exponents]
        modulus = sum(m * a for m, a in zip(mu, alpha, strict=True)) / 2
    except ValueError:
        return rest
    if form is None and any(m > 0 > a for m, a in zip(mu, alpha, strict=True)):
        raise ValueError(
            "an entry of mu is above zero where alpha is below; write form: abaqus if the energy has 2 mu / alpha^2 "
            f"(shear modulus {sum(mu):.4g} MPa), or form: ogden if it has mu / alpha as here ({modulus:.4g} MPa)"
        )
    if form is None or 0.0 in alpha:
        return rest
    return {**rest, "mu": [f"{m * FORMS[form](a)!r} MPa" for m, a in zip(mu, alpha, strict=True)]}
