"""What tensile tests say of the material: the two moduli, and every law fitted twice."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import fem
from pipeline.config.config import LAWS
from pipeline.config.units import DENSITY, STRAIN, Dimension, convert
from pipeline.errors import InputError
from pipeline.material.law_fit import LawFit, Refused, fit_all, fit_widest
from pipeline.material.mean_curve import MeanCurve
from pipeline.material.moduli import Moduli, moduli
from pipeline.material.tensile import TensileTest, up_to

#: how the two fits of a law are called
ALL, WIDEST = "all data", "the widest range it holds for"


@dataclass(frozen=True)
class Asked:
    """What was asked of the fit, checked."""

    nu: float  #: Poisson ratio of the laws that have one; it gives the others their kappa
    density: str  #: as written, for the configuration
    break_strain: float  #: between E_L and E_H
    up_to: float  #: largest strain that is looked at
    within: float  #: relative error up to which a law may be used

    @staticmethod
    def of(nu: float, density: str, break_strain: str, up_to: str | None, within: str) -> "Asked":
        """From the texts of the command line. Raises InputError."""
        try:
            fem.StVenantKirchhoff(1.0, nu)
        except fem.MaterialError as failure:
            raise InputError(f"--nu: {failure}") from None
        _positive("--density", density, DENSITY)
        return Asked(
            nu,
            density,
            _positive("--break", break_strain, STRAIN),
            np.inf if up_to is None else _positive("--up-to", up_to, STRAIN),
            _positive("--within", within, STRAIN),
        )


@dataclass(frozen=True)
class Fits:
    """Everything that was found."""

    asked: Asked
    tests: tuple[TensileTest, ...]
    curve: MeanCurve
    moduli: Moduli
    laws: Mapping[str, Mapping[str, LawFit | Refused]]  #: law -> fitted to `ALL` and to `WIDEST`

    @property
    def usable(self) -> dict[str, LawFit]:
        """The fits as far as each law holds, without the laws that hold nowhere."""
        found = {law: fits[WIDEST] for law, fits in self.laws.items()}
        return {law: fit for law, fit in found.items() if isinstance(fit, LawFit)}


def fitted(tests: Sequence[TensileTest], asked: Asked) -> Fits:
    """Fit both moduli and every law to the tests. Raises InputError where too few points are left."""
    kept = tuple(tests) if np.isinf(asked.up_to) else up_to(tests, asked.up_to)
    curve = MeanCurve.of(kept)
    if not len(curve.nodes):
        raise InputError(f"the tests reach strains of {100 * np.ptp(curve.stretch):.2g} % only; 2 % or more are needed")
    laws = {
        law: {
            ALL: fit_all(law, curve, asked.nu, asked.within),
            WIDEST: fit_widest(law, curve, asked.nu, asked.within),
        }
        for law in LAWS
    }
    return Fits(asked, kept, curve, moduli(kept, asked.break_strain), laws)


def _positive(option: str, text: str, dimension: Dimension) -> float:
    try:
        value = convert(text, dimension)
    except ValueError as failure:
        raise InputError(f"{option}: {failure}") from None
    if value <= 0:
        raise InputError(f"{option}: {text} is not allowed; allowed: above zero, for example '{dimension.example}'")
    return value
