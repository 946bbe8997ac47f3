"""The material of a configuration: its constants, and whether its stiffness fits the pressures."""

import re
from collections.abc import Mapping
from typing import Any

import fem.materials
from fem.materials import LAWS
from pipeline.config.config import Material
from pipeline.config.document import Document
from pipeline.config.schema import BULK, MATERIALS
from pipeline.errors import InputError

#: the largest pressure over the initial Young's modulus with which a body is solved
LARGEST_PRESSURE = 3.0
#: the largest pressure over a modulus written in GPa below which the unit is taken for a mistake
SMALLEST_PRESSURE = 1e-3
_GPA = re.compile(r"\s*\+?(\d+\.?\d*|\.\d+)\s*GPa\s*")


def solids(document: Document, content: Any, laws: Mapping[str, str]) -> dict[str, Material]:
    """The material of the body, whose name is empty, and of each region, all of whose laws are given by name.

    With all constants, kappa from nu where nu is given. Raises InputError.
    """
    return {
        name: _solid(document, content, (MATERIALS, name) if name else ("material",), law) for name, law in laws.items()
    }


def _solid(document: Document, content: Any, key: tuple[str, ...], law: str) -> Material:
    section = content
    for name in key:
        section = getattr(section, name)
    given = {name: getattr(section, name) for name in LAWS[law].constants()}
    if BULK in given:
        given[BULK] = _bulk_modulus(document, key, section, law, given)
    material = Material(law, given, section.density, section.holds_between)
    initial_modulus(document, material, key)  # refuses constants that do not go together
    if content.effects.gravity.state == "on" and material.density_tonne_mm3 is None:
        raise document.wrong((*key, "density"), "is missing, and gravity needs it; for example 1130 kg/m^3")
    return material


def _bulk_modulus(document: Document, key: tuple[str, ...], section: Any, law: str, given: dict[str, Any]) -> float:
    """kappa in MPa as it is given, or from nu: 2 mu (1 + nu) / (3 (1 - 2 nu)) with the initial shear modulus mu."""
    if section.nu is None and section.kappa is None:
        raise document.wrong((*key, BULK), "is missing; for example 'kappa: 20 MPa', or instead 'nu: 0.495'")
    if section.nu is None:
        return float(section.kappa)
    if section.kappa is not None:
        raise document.wrong_together(((*key, "nu"), (*key, BULK)), "give nu or kappa, not both")
    try:
        others = {name: value for name, value in given.items() if name != BULK}
        return float(LAWS[law].from_uniaxial(others, section.nu).kappa)  # type: ignore[attr-defined]
    except fem.materials.MaterialError as failure:
        raise InputError(f"{document.path}: {'.'.join(key)}: {failure}") from None


def initial_modulus(document: Document, material: Material, key: tuple[str, ...] = ("material",)) -> float:
    """Young's modulus at small strain, MPa. Raises InputError for constants that the law cannot have together."""
    try:
        return material.built().young_modulus
    except fem.materials.MaterialError as failure:
        raise InputError(f"{document.path}: {'.'.join(key)}: {failure}") from None


def check_stiffness(document: Document, material: Material, pressures: tuple[float, ...]) -> None:
    """Refuse pressures (kPa) or constants that are off by a factor of thousand. Raises InputError."""
    modulus, highest = initial_modulus(document, material), pressures[-1]
    ratio = 1e-3 * highest / modulus
    if ratio > LARGEST_PRESSURE:
        meant = _unit_meant(document) if 1e-3 * ratio < LARGEST_PRESSURE else ""
        raise document.wrong_together(
            (("pressures",), ("material",)),
            f"{highest:g} kPa is {ratio:.3g} E, with Young's modulus E = {modulus:.4g} MPa of the material at small "
            f"strain; {meant}allowed: at most {LARGEST_PRESSURE:g} E",
        )
    stiff = [] if ratio >= SMALLEST_PRESSURE else _in_gpa(document, material)
    if stiff:
        name, number = stiff[0]
        raise document.wrong(
            ("material", name),
            f"with {number} GPa the highest pressure is {ratio:.2g} E, which does not bend an arm; did you mean "
            f"{number} MPa? A material that is so stiff is written in MPa: {1e3 * float(number):g} MPa",
        )


def _in_gpa(document: Document, material: Material) -> list[tuple[str, str]]:
    """Names and numbers of the constants, other than the bulk modulus, that are written in GPa."""
    constants = []
    for name in material.constants:
        value = document.content["material"].get(name)
        written = [_GPA.fullmatch(str(entry)) for entry in (value if isinstance(value, list) else [value])]
        constants += [(name, number[1]) for number in written if number is not None and name != BULK]
    return constants


def _unit_meant(document: Document) -> str:
    """The question which unit was meant, where a value is written in another one."""
    if str(document.content.get("pressures", [""])[-1]).strip().endswith("MPa"):
        return "did you mean kPa? "
    if any(str(value).strip().endswith("kPa") for value in document.content["material"].values()):
        return "did you mean MPa for the material? "
    return ""
