"""Everything that is identified from tensile tests: the two moduli, and every law fitted to two ranges of stretch."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem.materials import MaterialError, StVenantKirchhoff
from pipeline.config.units import DENSITY, STRAIN, Dimension, convert
from pipeline.errors import InputError
from pipeline.material.doubts import of_modulus, of_rest, of_strain
from pipeline.material.forms import FORMS
from pipeline.material.law_fit import LawFit, Refused, fit_all, fit_widest
from pipeline.material.mean_curve import MeanCurve
from pipeline.material.moduli import Moduli, moduli
from pipeline.material.tensile import TensileTest, up_to

#: names of the two fits of a law
ALL, WIDEST = "all data", "the widest range it holds for"


@dataclass(frozen=True)
class FitOptions:
    """The options of the command line, checked."""

    nu: float  #: Poisson ratio of the laws that have one; it gives the others their kappa
    density: str | None  #: as written, for the configuration; None where it is not given
    break_strain: float  #: E_L below, E_H above
    up_to: float  #: largest strain that is used
    within: float  #: relative error of the nominal stress up to which a law counts as valid

    @staticmethod
    def read(nu: float, density: str | None, break_strain: str, up_to: str | None, within: str) -> "FitOptions":
        """From the texts of the command line. Raises InputError."""
        try:
            StVenantKirchhoff(1.0, nu)
        except MaterialError as failure:
            raise InputError(f"--nu: {failure}") from None
        if density is not None:
            _positive("--density", density, DENSITY)
        return FitOptions(
            nu,
            density,
            _positive("--break", break_strain, STRAIN),
            np.inf if up_to is None else _positive("--up-to", up_to, STRAIN),
            _positive("--within", within, STRAIN),
        )


@dataclass(frozen=True)
class Fits:
    """Moduli and laws identified from tensile tests."""

    options: FitOptions
    tests: tuple[TensileTest, ...]
    curve: MeanCurve
    moduli: Moduli
    laws: Mapping[str, Mapping[str, LawFit | Refused]]  #: name -> fitted to `ALL` and to `WIDEST`
    notes: tuple[str, ...]  #: sentences on what is most likely wrong with the data, or was left out

    @property
    def usable(self) -> dict[str, LawFit]:
        """The fits over the widest valid range of each law, without laws that are valid nowhere."""
        widest = {law: fits[WIDEST] for law, fits in self.laws.items()}
        return {law: fit for law, fit in widest.items() if isinstance(fit, LawFit)}


def fit_laws(tests: Sequence[TensileTest], options: FitOptions) -> Fits:
    """Fit both moduli and every law to the tests. Raises InputError where too few points are left."""
    kept = tuple(tests) if np.isinf(options.up_to) else up_to(tests, options.up_to)
    strains = np.round(np.concatenate([test.strain for test in kept]), 9)
    if len(np.unique(strains[strains != 0])) < 2:
        raise InputError("the tests have one strain beside rest; stress must be given over strain")
    curve = MeanCurve.of(kept)
    read = [note for test in kept for note in test.notes]
    if not len(curve.nodes):
        short = f"the tests reach strains of {100 * np.ptp(curve.stretch):.2g} % only; 2 % or more are needed"
        raise InputError(*read, f"{short}: check the unit of the strain, % or 1")
    laws = {
        law: {
            ALL: fit_all(law, curve, options.nu, options.within),
            WIDEST: fit_widest(law, curve, options.nu, options.within),
        }
        for law in FORMS
    }
    lines = moduli(kept, options.break_strain)
    doubts = (
        of_strain(float(np.abs(curve.stretch - 1).max())),
        of_modulus(lines.low),
        of_rest(curve.stretch, curve.stress, options.within),
    )
    return Fits(options, kept, curve, lines, laws, (*read, *filter(None, doubts)))


def _positive(option: str, text: str, dimension: Dimension) -> float:
    try:
        value = convert(text, dimension)
    except ValueError as failure:
        raise InputError(f"{option}: {failure}") from None
    if value <= 0:
        raise InputError(f"{option}: {text} is not allowed; allowed: above zero, for example '{dimension.example}'")
    return value
