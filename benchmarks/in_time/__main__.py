"""Arms in time: a released bar and a held segment that others measured, finite elements in time, and exported arms.

    make in-time
    python -m benchmarks.in_time [--only bar | segment | calibrated | small | exports | NAME] [--out results/in_time]

Laws and motions of finite elements are kept in the folder.
"""

import argparse
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.exports import drawn_at_random
from benchmarks.in_time.arms import RUBBERS, MovingArm
from benchmarks.in_time.calibrated import calibrated_lines
from benchmarks.in_time.exported import Exported
from benchmarks.in_time.measured import Line, ReleasedBar, segment_lines
from benchmarks.markdown import table
from pipeline.answers.measured.motions import DampedOscillation
from pipeline.config.load import load_config
from rod import frequencies

HEADS = ("case", "number", "measured, finite elements or program", "rod", "difference", "goal")
#: mm, of motions by their size
AMPLITUDES = 6.0, 0.6, 0.06, 0.006
#: of the same density
BASE_OF_ANOTHER = [f"materials.base.{one}" for one in ("law=svk", "E=2.4 MPa", "nu=0.495", "density=1130 kg/m^3")]
#: kPa, and what is changed of an arm, so that its finite elements take minutes
ARMS = {
    "pneunet": (17.0, ["mesh.size=8 mm", "pressures=[17 kPa, 25 kPa]"]),
    "two_rubbers": (17.0, ["mesh.size=8 mm", "pressures=[17 kPa, 25 kPa]", *BASE_OF_ANOTHER]),
    "random_3": (12.2, ["mesh.size=6 mm", "mesh.formulation=p2p0"]),
}


def arm_lines(name: str, out: Path) -> Iterator[Line]:
    """Finite elements of an arm beside its rod."""
    pressure, changes = ARMS[name]
    path = Path(drawn_at_random(out, [3])[name][0] if name.startswith("random") else "configs/pneunet_coarse.yaml")
    arm = MovingArm(load_config(path, [*changes, "accuracy=off"]), out / name, pressure)
    for how in ("released", "raised"):
        for rubber, law in RUBBERS.items():
            case = f"{name}, {how}, {rubber}"
            solid, rod, apart = arm.compared(rubber, how == "released")
            more = [100.0 * (one / other - 1.0) for one, other in zip(rod, solid, strict=True)]
            yield case, "frequency, Hz", f"{solid[0]:.4g}", f"{rod[0]:.4g}", f"{more[0]:+.2f} %", "1 %"
            if law.shares:
                yield case, "damping", f"{solid[1]:.4f}", f"{rod[1]:.4f}", f"{more[1]:+.1f} %", "5 %"
            yield case, "end", "", "", f"{100.0 * apart:.2f} % of l", "1 %"
    air, own = arm.closed()
    yield f"{name}, closed", "pressure, kPa", f"{air:.2f}", f"{own:.2f}", f"{100.0 * (own / air - 1.0):+.2f} %", "1 %"


def small_lines(name: str, out: Path) -> Iterator[Line]:
    """Motions of an arm from large to small ones, in steps by their error, beside its small vibrations."""
    pressure, changes = ARMS[name]
    path = Path(drawn_at_random(out, [3])[name][0] if name.startswith("random") else "configs/pneunet_coarse.yaml")
    arm = MovingArm(load_config(path, [*changes, "accuracy=off"]), out / name, pressure)
    body = arm.with_rubber(RUBBERS["loss"])
    for size in AMPLITUDES:
        mode, begun = frequencies(body, pressure)[0], process_time()
        motion = arm.moved_by(body, size)
        each = 1e3 * (process_time() - begun) / len(motion.times_s)
        time = np.linspace(0.0, motion.times_s[-1], 1000)
        rings = DampedOscillation.of(time, CubicSpline(motion.times_s, motion.tips[:, 1])(time))
        for what, own, known, goal in zip(("frequency, Hz", "damping"), rings, mode, ("0.5 %", "3 %"), strict=False):
            more = f"{100.0 * (own / known - 1.0):+.2f} %"
            yield f"{name}, {size:g} mm, {each:.2g} ms a step", what, f"{known:.4g}", f"{own:.4g}", more, goal


def exported_lines(out: Path) -> Iterator[Line]:
    """The first arm in other programs, beside its rod."""
    pressure, changes = ARMS["pneunet"]
    config = load_config(Path("configs/pneunet_coarse.yaml"), [*changes, "accuracy=off"])
    arm = MovingArm(config, out / "pneunet", pressure)
    yield from Exported(arm, out / "pneunet" / "exports").lines("pneunet")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Arms in time.")
    parser.add_argument("--only", help="bar, segment, calibrated, small, exports, or the name of an arm")
    parser.add_argument("--out", type=Path, default=Path("results/in_time"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    cases = {"bar": lambda: ReleasedBar().lines(), "segment": segment_lines}
    cases["calibrated"] = partial(calibrated_lines, given.out)
    cases |= {name: partial(arm_lines, name, given.out) for name in ARMS}
    cases["small"] = lambda: (line for name in ARMS for line in small_lines(name, given.out))
    cases["exports"] = partial(exported_lines, given.out)
    rows = [line for name, lines in cases.items() if given.only in (None, name) for line in lines()]
    sys.stdout.write(table(HEADS, rows) + "\n")


if __name__ == "__main__":
    main()
