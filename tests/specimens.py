"""Synthetic tensile tests: the incompressible Yeoh law with scatter, drawn from a seed."""

import numpy as np

from fem import Yeoh
from pipeline.material.tensile import TensileTest

#: the example that is shipped: C10, C20 of Elastosil M4601 in MPa, 0 to 700 % in steps of 2.5 %, five specimens
CONSTANTS = {"c10": 0.11, "c20": 0.02, "c30": 0.0}
TOP, STEP, COUNT, SEED = 7.0, 0.025, 5, 4601
#: standard deviations: of the stiffness of a specimen (relative), of a measured stress (MPa)
BETWEEN, NOISE = 0.02, 0.005

HEADER = """\
# Not measured: five specimens drawn from the incompressible Yeoh law of Elastosil M4601, C10 = 0.11 and C20 = 0.02 MPa.
# Stiffness of a specimen 1 +- 0.02, error of a stress +- 0.005 MPa (normal, seed 4601); made by tests/specimens.py.
"""


def drawn(
    random: np.random.Generator,
    *,
    top: float = TOP,
    step: float = STEP,
    count: int = COUNT,
    between: float = BETWEEN,
    noise: float = NOISE,
) -> tuple[TensileTest, ...]:
    """`count` specimens, strains 0 to `top` in steps of `step`."""
    strain = np.round(np.arange(0.0, top + step / 2, step), 6)
    exact = sum(CONSTANTS[name] * term for name, term in Yeoh.uniaxial_terms(1 + strain).items())
    tests = []
    for k in range(count):
        stiffness = 1 + between * random.standard_normal()
        stress = stiffness * exact + noise * random.standard_normal(len(strain))
        tests.append(TensileTest("ABCDEFGHIJ"[k], 1 + strain, stress))
    return tuple(tests)


def example() -> str:
    """The text of configs/elastosil_m4601_yeoh.csv."""
    rows = [
        f"{test.name},{100 * strain:.6g},{stress:.4f}"
        for test in drawn(np.random.default_rng(SEED))
        for strain, stress in zip(test.strain, test.stress, strict=True)
    ]
    return HEADER + "\n".join(["test,strain (%),stress (MPa)", *rows]) + "\n"
