"""Virtual arms: built otherwise than drawn, measured by finite elements, and foretold after a calibration.

    make virtual-arms
    python -m benchmarks.virtual_arms [--seed 5] [--count 20] [--loaded] [--out results/virtual_arms]

Each arm has a folder with its configuration as built, what was measured, and the predictions. Measurements and laws are
kept; the same command goes on with an interrupted campaign. Seed 1 was used while the calibration was written; figures
that are published are those of seed 5.
"""

import argparse
import sys
from pathlib import Path

from benchmarks.markdown import write_made
from benchmarks.virtual_arms.designs import arms
from benchmarks.virtual_arms.measured import measured
from benchmarks.virtual_arms.predicted import Judged, judged
from benchmarks.virtual_arms.table import calibration_page, summary

SEED, COUNT = 5, 20


def judge_all(seed: int, count: int, out: Path, loaded: bool) -> list[Judged]:
    """The arms of a seed, with a line on each; loaded: each is measured under a dead force as well."""
    results = []
    for arm in arms(seed, count):
        folder = out / arm.name
        result = judged(arm, measured(arm, folder), folder, loaded)
        results.append(result)
        after = ", ".join(f"{one.what} {100 * one.after:.2g} %" for one in result.predictions)
        sys.stdout.write(f"{arm.name} {arm.family}: {result.failure or after}\n")
        sys.stdout.flush()
    return results


def main() -> None:
    """Print the table, and write the calibration plot."""
    parser = argparse.ArgumentParser(description="Virtual arms, foretold after a calibration.")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--count", type=int, default=COUNT)
    parser.add_argument("--loaded", action="store_true", help="calibrate on the tip under a dead force too")
    parser.add_argument("--out", type=Path, default=Path("results/virtual_arms"))
    given = parser.parse_args()
    results = judge_all(given.seed, given.count, given.out, given.loaded)
    (given.out / "calibration.html").write_text(calibration_page(results), encoding="utf-8")
    if (given.seed, given.count, given.loaded) == (SEED, COUNT, False):
        write_made("make virtual-arms", summary(results))
    sys.stdout.write(f"\n{summary(results)}\n\nintervals: {given.out / 'calibration.html'}\n")


if __name__ == "__main__":
    main()
