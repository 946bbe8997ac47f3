"""An arm with two cavities: the law over both pressures against finite elements of the whole arm."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.config.document import read_document
from pipeline.config.load import load_config
from pipeline.law.rows import read_pairs
from pipeline.run import run
from pipeline.store.progress import Silent
from pipeline.study.pairs.run import run_pairs
from pipeline.values.run import Run
from rod.arm_law.pairs import PairLaw

DESIGN = """
name: two
geometry: {family: bisected_circle, length: 62 mm}
material: {law: hencky, E: 1.2 MPa, nu: 0.495}
experiments: [II, III]
validation: off
accuracy: off
mesh: {size: 5 mm, coarser: off}
"""


def errors(law: PairLaw, results: Run, pair: tuple[float, float]) -> tuple[float, float]:
    """Distance of the tips in II over the length, and difference of the forces in III over EI / l^2: by symmetry this
    arm hardly bends, and its forces are hundredths of that."""
    curve = results.curve("II", max(pair))
    [held] = [state for state in results.states if state.experiment == "III" and state.pressure_kPa == max(pair)]
    rod = law.at(pair)
    scale = float(np.interp(0.0, rod.section.moment, 1.0 / rod.section.kappa_slope)) / law.length**2
    away = np.linalg.norm(np.subtract(rod.solve().end, curve.tip_mm)) / law.length
    return float(away), abs(float(rod.solve(end_y=0.0).force[1]) - held.reaction_N[1]) / scale


@pytest.mark.slow
def test_the_law_over_two_pressures_is_that_of_the_whole_arm(tmp_path: Path) -> None:
    """At pairs of the run, and at one between its ratios that was not used."""
    file = tmp_path / "two.yaml"
    file.write_text(DESIGN, encoding="utf-8")
    pairs = read_pairs(read_document(file, ["pressures=[[30 kPa, 0 kPa], [30 kPa, 20 kPa]]"]))
    assert pairs is not None
    made = run_pairs(pairs, tmp_path / "out", 1, False, Silent())
    made.raise_if_failed()
    unused = (30.0, 5.0)
    fractions = "effects.pressure.cavities={cavity: 1, cavity_lower: 0.16666666666666667}"
    alone = run(
        load_config(file, ["pressures=[30 kPa]", "law=five", fractions]), tmp_path / "alone", 1, False, Silent()
    )
    assert unused[1] / unused[0] not in made.law.directions
    known = [errors(made.law, results, (30.0, 30.0 * direction)) for direction, results in made.runs.items()]
    between = errors(made.law, alone.results, unused)
    assert max(away for away, _ in known) < 5e-4
    assert between[0] < 1e-3
    assert max(force for _, force in (*known, between)) < 2e-3
