"""Other lengths and pressures from one parameterisation (paper, equations (9) and (10)).

The paper's relations are between dimensionless numbers, kappa_0 l and alpha/(m g l^2), with the weight m g of the
reference arm:

    kappa_0 l_i (p_i, l_i)      = kappa_0 l_0 (p_0, l_0) (p_i/p_0) (l_i/l_0)
    alpha/(m g l_i^2)(p_i, l_i) = [alpha/(m g l_0^2)(p_0, l_0) + (p_i - p_0) beta/(m g l_0^2)] (l_0/l_i)^2

In millimetres and newtons they are simpler: curvature and rigidity belong to the cells, and more cells of
the same kind change neither. They hold where the cells are equal and where kappa_0 is proportional to p, and not
otherwise: not for arms stretched without more cells, not near the end cells of short arms, not where alpha(p) or
kappa_0(p) bends. The boundary zone at the clamp belongs to the first cells, so d stays in millimetres; the intercepts
stay in N mm.
"""

from dataclasses import dataclass

from rod.errors import RodError
from rod.law import FiveParameters


@dataclass(frozen=True)
class ReferenceArm:
    """One parameterised arm. Raises `RodError` for a length, weight or pressure that is not positive."""

    length: float  #: mm, l_0
    weight: float  #: N, m g
    pressure: float  #: kPa, p_0
    law: FiveParameters  #: at p_0
    beta1: float  #: N mm2/kPa
    beta2: float  #: N mm2/kPa
    kappa_0: float  #: 1/mm at p_0, in the middle

    def __post_init__(self) -> None:
        for name in ("length", "weight", "pressure"):
            if not getattr(self, name) > 0.0:
                raise RodError(f"The reference {name} must be positive, not {getattr(self, name)}.")


@dataclass(frozen=True)
class ScaledArm:
    """Another arm by equation (9)."""

    length: float  #: mm, l_i
    pressure: float  #: kPa, p_i
    law: FiveParameters
    kappa_0: float  #: 1/mm


def scaled_arm(reference: ReferenceArm, *, length: float, pressure: float) -> ScaledArm:
    """Equation (9) for another length (mm) and pressure (kPa).

    Raises `RodError` when the length or the pressure is not positive, when d lies off the shorter arm, and when a
    rigidity falls to zero on the way to the pressure.
    """
    if not (length > 0.0 and pressure > 0.0):
        raise RodError(f"Length and pressure must be positive, not {length} mm and {pressure} kPa.")
    old, ratio, step = reference.law, length / reference.length, pressure - reference.pressure
    if old.d >= length:
        raise RodError(
            f"The boundary zone of {old.d:g} mm is longer than an arm of {length:g} mm; equation (9) ends before."
        )
    unit = reference.weight * reference.length**2
    hats = [(a + step * b) / unit / ratio**2 for a, b in ((old.alpha1, reference.beta1), (old.alpha2, reference.beta2))]
    kappa_0_l = reference.kappa_0 * reference.length * (pressure / reference.pressure) * ratio
    alpha1, alpha2 = (hat * reference.weight * length**2 for hat in hats)
    law = FiveParameters(alpha1, alpha2, old.m01, old.m02, old.d)
    return ScaledArm(length, pressure, law, kappa_0_l / length)
