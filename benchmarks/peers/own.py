"""pneurod alone, on what the others were not given: the experiments of an arm with contact, and larger meshes.

    python -m benchmarks.peers.own coarse out.json       # experiments I, II and III of configs/pneunet_coarse.yaml
    python -m benchmarks.peers.own 1.2 out.json          # one increment to 5 kPa on a mesh of 1.2 mm

A mesh of 0.56 mm has a million degrees of freedom and needs 9 GB and four to five minutes.
"""

import argparse
import json
import resource
from dataclasses import asdict, dataclass
from pathlib import Path
from time import process_time


@dataclass(frozen=True)
class Case:
    """What was computed, and its cost."""

    name: str
    unknowns: int
    factorizations: int
    cpu: float  #: s, of all load paths, without meshing
    factorization: float  #: s each
    peak: float  #: GB
    date: str = ""


def experiments() -> Case:
    """Experiments I, II and III as the configuration of the coarse arm has them, with contact."""
    from fem import Experiment, Pressure, SelfContact, StVenantKirchhoff, compile_kernels, follow
    from geometry import PneuNet

    compile_kernels()
    body, pressures = PneuNet().body(4.0), [17.0, 37.0]
    begin, count, seconds, unknowns = process_time(), 0, 0.0, 0
    for name in ("I", "II", "III"):
        effects = [Pressure("cavity", 1e-3), SelfContact("gap", starts_inactive=True)]
        model = Experiment.of(name, body, 0.0).model(StVenantKirchhoff(1.2, 0.495), effects, "p2p0")
        solution = follow(model, pressures)
        count, seconds = count + solution.factorizations, seconds + solution.seconds.factorization
        unknowns = max(unknowns, solution.degrees_of_freedom)
    spent = process_time() - begin
    name = "experiments I, II and III of `pneunet_coarse` at 17 and 37 kPa, with contact"
    return Case(name, unknowns, count, spent, seconds / count, _peak())


def increment(size: float) -> Case:
    """One increment from rest to 5 kPa in experiment II without contact, on a mesh of that size (mm)."""
    from benchmarks.size import measured

    row = measured(size, single=False)
    name = f"experiment II in one increment to 5 kPa, mesh {size:g} mm"
    unknowns, count = int(row["degrees_of_freedom"]), int(row["iterations"])
    return Case(name, unknowns, count, row["total"], row["factorization"], row["memory_GB"])


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", help='"coarse", or the size of a mesh in mm')
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    case = experiments() if options.what == "coarse" else increment(float(options.what))
    options.out.write_text(json.dumps(asdict(case)), encoding="utf-8")


if __name__ == "__main__":
    main()
