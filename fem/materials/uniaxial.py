"""A bar pulled or pressed along its axis with its sides free: what every law answers, in closed form.

s is the stretch along the axis, t the one across it, J = s t^2, P the force over the area at rest (nominal stress).
The sides carry nothing, so dW/dt = 0 and P = dW/ds.

St. Venant-Kirchhoff: t^2 = 1 - nu (s^2 - 1), P = E s (s^2 - 1) / 2. Hencky: t = s^-nu, P = E ln(s) / s. Both P do not
depend on nu. Rubber W = psi(r) + kappa/2 (J - 1)^2 with the isochoric stretch r = s J^(-1/3): dW/dt = 0 reads
J (J - 1) = r psi'(r) / (3 kappa), with it P = r psi'(r) / s, and r psi'(r) = 2 (r^2 - 1/r) (w' + c / r) as in the
incompressible bar (R. S. Rivlin, D. W. Saunders, Phil. Trans. R. Soc. A 243 (1951) 251). So s is known for each r.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize.elementwise import find_root

from fem.materials.hencky import Hencky
from fem.materials.material import Material, StVenantKirchhoff
from fem.materials.rubber import IsochoricLaw, MooneyRivlin, NeoHooke, Yeoh
from geometry.arrays import Array


@dataclass(frozen=True)
class Uniaxial:
    """The bar at n stretches; NaN where no bar of this law can be."""

    stretch: Array  #: (n,) along the axis
    lateral: Array  #: (n,) stretch across it
    nominal: Array  #: (n,) MPa, force over area at rest

    @property
    def J(self) -> Array:
        """(n,) volume over volume at rest."""
        return np.asarray(self.stretch * self.lateral**2)


def uniaxial(law: Material, stretch: Array) -> Uniaxial:
    """The bar of `law` at stretches (n,), above 0, as the solver has the law: with its Poisson ratio or kappa.

    Raises TypeError for a law without a closed form.
    """
    stretch = np.asarray(stretch, dtype=float)
    if isinstance(law, StVenantKirchhoff):
        square = 1 - law.nu * (stretch**2 - 1)
        lateral = np.sqrt(np.where(square > 0, square, np.nan))
        return _held(stretch, lateral, law.E * uniaxial_terms(StVenantKirchhoff, stretch)["E"])
    if isinstance(law, Hencky):
        return _held(stretch, stretch**-law.nu, law.E * uniaxial_terms(Hencky, stretch)["E"])
    if isinstance(law, IsochoricLaw):
        return _rubber(law, stretch)
    raise TypeError(f"{type(law).__name__} has no closed form here")


def uniaxial_terms(law: type[Material], stretch: Array) -> dict[str, Array]:
    """P of `law` at stretches (n,) is the sum of these terms (n,), each times its constant: name -> MPa per MPa.

    Rubber is incompressible here, kappa being what a tensile test cannot tell. Raises TypeError as `uniaxial`.
    """
    if law is StVenantKirchhoff:
        return {"E": stretch * (stretch**2 - 1) / 2}
    if law is Hencky:
        return {"E": np.log(stretch) / stretch}
    once, invariant = 2 * (stretch - stretch**-2), stretch**2 + 2 / stretch - 3
    if law is NeoHooke:
        return {"mu": once / 2}
    if law is MooneyRivlin:
        return {"c10": once, "c01": once / stretch}
    if law is Yeoh:
        return {"c10": once, "c20": 2 * once * invariant, "c30": 3 * once * invariant**2}
    raise TypeError(f"{law.__name__} has no closed form here")


def _held(stretch: Array, lateral: Array, nominal: Array) -> Uniaxial:
    return Uniaxial(stretch, lateral, np.where(np.isfinite(lateral), nominal, np.nan))


def _rubber(law: IsochoricLaw, stretch: Array) -> Uniaxial:
    """The isochoric stretch lies between 1 and the stretch, for tension swells the bar and pressure shrinks it."""
    found = find_root(
        lambda r, s: r * _volume(law, r) ** (1 / 3) - s, (np.ones_like(stretch), stretch), args=(stretch,)
    )
    isochoric = np.where(found.success & (_bulk(law, found.x) >= 0), found.x, np.nan)
    volume = _volume(law, isochoric)
    return _held(stretch, np.sqrt(volume / stretch), _kirchhoff(law, isochoric) / stretch)


def _kirchhoff(law: IsochoricLaw, isochoric: Array) -> Array:
    """r psi'(r), MPa."""
    slope = law.first(isochoric**2 + 2 / isochoric)[1]
    return np.asarray(2 * (isochoric**2 - 1 / isochoric) * (slope + law.second / isochoric))


def _volume(law: IsochoricLaw, isochoric: Array) -> Array:
    """J; 1/2 where the pressure is more than kappa/2 (J - 1)^2 can bear, and so more than it bears at any J."""
    return np.asarray((1 + np.sqrt(np.maximum(_bulk(law, isochoric), 0))) / 2)


def _bulk(law: IsochoricLaw, isochoric: Array) -> Array:
    """(2 J - 1)^2; below zero where there is no J."""
    return np.asarray(1 + 4 / 3 * _kirchhoff(law, isochoric) / law.kappa)
