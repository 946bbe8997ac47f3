"""Synthetic tensile tests: the example that is shipped, drawn from a seed, and known laws tested with warts.

`python -m tests.specimens` writes into docs/materials.md how far the recommended law is off the known one.
"""

import sys
from collections.abc import Callable

import numpy as np

import fem
from benchmarks.markdown import table, write_made
from fem import Yeoh
from geometry.arrays import Array
from pipeline.answers.material.judged import Judged, Need, judge
from pipeline.answers.material.laws import STATES, Points
from pipeline.answers.material.loading import Selection, TensileTest, first_loading
from pipeline.answers.material.table import Series

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


NEED = Need(0.7, 2.0)
#: the largest strains of the tests
TOPS = (2.5, 1.0)
TRUTHS = {
    "neo_hooke": fem.NeoHooke(0.024, 100.0),
    "yeoh": fem.Yeoh(0.06, 0.004, 0.0, 100.0),
    "yeoh of three": fem.Yeoh(0.0895, 0.0085, -0.00025, 100.0),
    "hardening": fem.Yeoh(0.11, 0.02, 0.0, 100.0),
}
#: what a test shows of a truth: stress over strain (n,) -> strain and stress as recorded
Wart = Callable[[Callable[[Array], Array], Array], tuple[Array, Array]]


def cycled(stress: Callable[[Array], Array], strain: Array) -> tuple[Array, Array]:
    """Loaded, unloaded and loaded again, softer than at first."""
    once = stress(strain)
    return np.concatenate([strain, strain[::-1], strain]), np.concatenate([once, 0.7 * once[::-1], 0.8 * once])


def stepped(stress: Callable[[Array], Array], strain: Array) -> tuple[Array, Array]:
    """A load cell with steps of 5 % of the stress at a strain of 100 %."""
    step = 0.05 * float(stress(np.array(1.0)))
    return strain, np.round(stress(strain) / step) * step


def noisy(stress: Callable[[Array], Array], strain: Array) -> tuple[Array, Array]:
    """Scatter of 2 % of the stress at a strain of 100 %."""
    size = 0.02 * float(stress(np.array(1.0)))
    return strain, stress(strain) + size * np.random.default_rng(5).standard_normal(len(strain))


WARTS: dict[str, Wart] = {
    "exact": lambda stress, strain: (strain, stress(strain)),
    "slack of 2 %": lambda stress, strain: (strain, stress(np.maximum(strain - 0.02, 0.0))),
    "rounded start": lambda stress, strain: (strain, stress(0.01 * np.log1p(np.exp((strain - 0.02) / 0.01)))),
    "scatter of 2 % of the stress at 100 % strain": noisy,
    "three cycles, softer after the first": cycled,
    "steps of 5 % of that stress": stepped,
}


def judged(strain: Array, stress: Array, need: Need = NEED) -> Judged:
    series = Series("", strain, stress, np.arange(len(strain)), ())
    test = first_loading("pull.csv", "pull", series, Selection())
    return judge(Points.of((test,)), need, 0.4999)


def errors(truth: str, wart: str, count: int, top: float = 2.5) -> dict[str, float]:
    """Largest errors of the stress of the recommended law between the stretches 1.2 and 2, by state; the test ends at
    the strain `top`."""
    law, s = TRUTHS[truth], np.linspace(1.2, 2.0, 17)
    best = judged(*WARTS[wart](lambda e: law.incompressible(1 + e), np.linspace(0.0, top, count))).laws[0]
    assert best.holds[1] >= 1.9
    ratios = {state: best.law.incompressible(s, of(s)) / law.incompressible(s, of(s)) for state, of in STATES.items()}
    return {state: float(np.abs(ratio - 1).max()) for state, ratio in ratios.items()}


def row_of(wart: str) -> list[float]:
    """Largest errors in % over all truths and two numbers of points: of each state, first with the longer tests."""
    row = []
    for top in TOPS:
        found = [errors(truth, wart, count, top) for truth in TRUTHS for count in (66, 400)]
        row += [100 * max(one[state] for one in found) for state in STATES]
    return row


def main() -> None:
    """The table of docs/materials.md."""
    heads = ["test", *(f"{state}, test to {100 * top:g} %" for top in TOPS for state in STATES)]
    rows = table(heads, [[wart, *(f"{error:.1f} %" for error in row_of(wart))] for wart in WARTS])
    write_made("python -m tests.specimens", rows)
    sys.stdout.write(f"{rows}\n")


if __name__ == "__main__":
    main()
