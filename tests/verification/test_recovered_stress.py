"""The error indicator on manufactured solutions (`test_manufactured`), whose error is known: its effectivity index, the
indicator over the true energy norm of the error, tends to a constant (O. C. Zienkiewicz, J. Z. Zhu, 1992)."""

from collections.abc import Callable

import numpy as np
import pytest

from fem import Step, stress_error
from fem.elements import ELEMENTS
from geometry.arrays import Array
from tests.loads import tetrahedron_rule
from tests.verification.test_manufactured import CASES, ONE, Case, solve

SIZES = (2, 4, 6)


def squared(case: Case, gradient: Array, other: Array | None = None) -> Array:
    """S : S of the shear part of the law at displacement gradients (..., 3, 3), or of its difference to another one."""
    stress = case.law.shear(_green_lagrange(gradient)).stress
    if other is not None:
        stress = stress - case.law.shear(_green_lagrange(other)).stress
    return np.asarray(np.sum(stress**2 * [1, 1, 1, 2, 2, 2], axis=-1))


def _green_lagrange(gradient: Array) -> Array:
    f = (ONE + gradient).reshape(-1, 3, 3)
    e = (np.swapaxes(f, -1, -2) @ f - ONE) / 2
    return np.stack([e[:, 0, 0], e[:, 1, 1], e[:, 2, 2], 2 * e[:, 0, 1], 2 * e[:, 1, 2], 2 * e[:, 0, 2]], axis=-1)


def true_energy(step: Step, case: Case) -> float:
    """Energy of the error of the shear stress over that of the computed one, by a rule of degree 6."""
    _, slope, x, weight = tetrahedron_rule(step.space, 6)
    gradient = np.einsum("eai,eqaj->eqij", step.displacement[step.space.nodes], slope)
    error = np.vdot(weight.ravel(), squared(case, case.gradient(x), gradient))
    strain, _ = step.space.strain_of(step.displacement)
    own = np.sum(case.law.shear(strain[:, :4]).stress ** 2 * [1, 1, 1, 2, 2, 2], axis=-1)
    return float(error / np.vdot(step.space.weight[:, :4], own))


#: formulation -> least effectivity on the coarsest and on the finest mesh, and least order of the indicator
LEAST = {"p1": (0.35, 0.6, 0.5), "p2p0": (0.6, 0.7, 0.3)}
QUADRATIC = (0.55, 0.7, 1.8)


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("name", CASES)
def test_effectivity(name: str, formulation: str, record_property: Callable[[str, object], None]) -> None:
    """Measured: 0.59 to 0.92 on these meshes, 0.75 to 0.89 on the finest; p1 0.39 to 0.72.

    With p2 and mixed, what is missing to 1 is the error between the stress points, which lie where stresses are best:
    at these points alone the index is 0.88 to 1.0 on the finest mesh.
    """
    case = CASES[name]
    index, indicated = [], []
    for n in SIZES:
        step = solve(n, case, formulation)
        indicator = stress_error(step, case.law)
        assert indicator.fraction.shape == (len(step.space.nodes),)
        index.append(np.sqrt(indicator.energy / true_energy(step, case)))
        indicated.append(np.sqrt(indicator.energy))
    rate = np.log(indicated[1] / indicated[2]) / np.log(SIZES[2] / SIZES[1])
    measured = f"effectivity {', '.join(f'{value:.2f}' for value in index)}, order {rate:.2f}"
    record_property("measured", measured)
    coarsest, finest, order = LEAST.get(formulation, QUADRATIC)
    assert index[0] > coarsest, measured
    assert index[-1] > finest, measured
    assert max(index) < 1.0, measured
    assert rate > order, measured
