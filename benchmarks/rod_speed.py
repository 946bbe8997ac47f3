"""The rod of the README, solved a thousand times; the same problem by scipy's `solve_bvp` and by PyElastica at rest.

    python benchmarks/rod_speed.py [LAW.json]

With the law.json of an arm, as `pneurod cell` writes it, the rod that follows it is measured as well, at the highest
pressure and at one between.

All three solve the same arm: the gapped pneu-net at about 31 kPa with its five parameters and a dead end force.
PyElastica integrates in time until the arm hardly moves; it is not made for statics, and its time shows only what
such a use would cost.
"""

import json
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from scipy.integrate import solve_bvp

# the rooms stand beside this folder
sys.path[0] = str(Path(__file__).resolve().parent.parent)

from benchmarks.arguments import parser_of  # noqa: E402  (the path comes first)
from geometry.arrays import Array  # noqa: E402  (the path comes first)
from rod import Arm, FiveParameters, Rod, export_arm  # noqa: E402  (the path comes first)
from rod.arm_law.record import law_from_record  # noqa: E402

LENGTH, FORCE = 112.0, (0.01, -0.05)
LAW = FiveParameters(alpha1=150.0, alpha2=400.0, m01=-0.8, m02=0.1, d=14.0)
CONSTANT = Rod(LENGTH, 0.015, LAW)
SAMPLES = np.linspace(0.0, LENGTH, 113)
SAMPLED = Rod(LENGTH, 0.015 * (1.0 + 0.2 * np.cos(2.0 * np.pi * SAMPLES / 10.0)), LAW)
README = Rod(1.0, 2.0, FiveParameters(alpha1=2.0, alpha2=1.0, m01=0.1, m02=-0.05, d=0.13))


def seconds_each(call: Callable[[], object], count: int) -> float:
    """Mean processor time of a call that has been made once before."""
    call()
    start = time.process_time()
    for _ in range(count):
        call()
    return (time.process_time() - start) / count


def by_scipy() -> Array:
    """Tip (x, y) mm by collocation on two pieces, each on the unit interval."""
    pieces = ((0.0, LAW.d, LAW.alpha1, LAW.m01), (LAW.d, LENGTH, LAW.alpha2, LAW.m02))

    def rates(t: Array, z: Array) -> Array:
        out = []
        for k, (a, b, alpha, m0) in enumerate(pieces):
            theta, moment = z[4 * k], z[4 * k + 1]
            turn = FORCE[0] * np.sin(theta) - FORCE[1] * np.cos(theta)
            rows = (0.015 + (moment - m0) / alpha, turn, np.cos(theta), np.sin(theta))
            out += [(b - a) * row for row in rows]
        return np.array(out)

    def ends(a: Array, b: Array) -> Array:
        return np.array([a[0], a[2], a[3], *(a[4:] - b[:4]), b[5]])

    guess = np.zeros((8, 20))
    guess[2], guess[6] = np.linspace(0, LAW.d, 20), np.linspace(LAW.d, LENGTH, 20)
    return solve_bvp(rates, ends, np.linspace(0, 1, 20), guess, tol=1e-8, max_nodes=20000).y[6:, -1]


def by_pyelastica(elements: int = 40, until: float = 1.3) -> np.ndarray:
    """Tip (x, y) mm of a damped Cosserat rod after `until` seconds of its own time."""
    import elastica

    with tempfile.TemporaryDirectory() as folder:
        scope: dict = {}
        arm = Arm((1.0,), (CONSTANT,), 20.0, 7.0, elements=elements)
        exec(export_arm(arm, "pyelastica", Path(folder))[0].read_text(), scope)
    rod = scope["build"](1.0)

    class Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):
        pass

    simulator, step = Simulator(), 2.4e-5
    simulator.append(rod)
    simulator.constrain(rod).using(elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    end = np.array([*FORCE, 0.0])
    simulator.add_forcing_to(rod).using(elastica.EndpointForces, np.zeros(3), end, ramp_up_time=0.1)
    simulator.dampen(rod).using(elastica.AnalyticalLinearDamper, uniform_damping_constant=20.0, time_step=step)
    simulator.finalize()
    stepper, now = elastica.PositionVerlet(), np.float64(0.0)
    while now < until:
        now = stepper.step(simulator, now, step)
    return 1e3 * rod.position_collection[:2, -1]


def with_law(file: Path) -> list[tuple[str, float, None]]:
    """The rod with the arm's own law: seconds to set it up between two pressures, and of its solutions."""
    law = law_from_record(json.loads(file.read_text(encoding="utf-8")))
    highest, before = law.pressures[-1], law.pressures[-2]
    rows = [
        (
            "rod with a cell law, set up between pressures",
            seconds_each(lambda: law.at((highest + before) / 2), 50),
            None,
        )
    ]
    for name, rod in (("", law.at(highest)), (", between pressures", law.at((highest + before) / 2))):
        rows.append((f"the same, dead force{name}", seconds_each(partial(rod.solve, (0.0, 0.02)), 200), None))
        rows.append((f"the same, experiment III{name}", seconds_each(partial(rod.solve, end_y=0.0), 200), None))
    return rows


def main() -> None:
    """Print one table."""
    parser = parser_of(__doc__)
    parser.add_argument("law", nargs="?", type=Path, metavar="LAW.json", help="of an arm, as pneurod cell writes it")
    law = parser.parse_args().law
    if law is not None and not law.is_file():
        parser.error(f"{law}: is no file")
    shape = CONSTANT.solve(force=FORCE)
    ours = np.array([shape.x[-1], shape.y[-1]])
    rows = [
        ("rod, README example, 1000 solves", seconds_each(lambda: README.solve(force=(0.5, -1.0)), 1000), None),
        ("rod, dead force", seconds_each(lambda: CONSTANT.solve(force=FORCE), 1000), None),
        ("rod, dead force, kappa_0 at 113 nodes", seconds_each(lambda: SAMPLED.solve(force=FORCE), 300), None),
        ("rod, experiment III, kappa_0 at 113 nodes", seconds_each(lambda: SAMPLED.solve(end_y=0.0), 300), None),
    ]
    if law is not None:
        rows += with_law(law)
    tip = by_scipy()
    rows.append(("scipy solve_bvp, tol 1e-8", seconds_each(by_scipy, 10), np.hypot(*(tip - ours)) / LENGTH))
    by_pyelastica(until=0.01)  # compiled
    start = time.process_time()
    tip = by_pyelastica()
    rows.append(
        ("PyElastica, 40 elements, 1.3 s at rest", time.process_time() - start, np.hypot(*(tip - ours)) / LENGTH)
    )
    lines = [f"{'':46s}{'ms':>12s}{'per second':>12s}{'tip off, l':>12s}"]
    lines += [
        f"{name:46s}{1e3 * t:12.3f}{1 / t:12.1f}{'' if off is None else format(off, '12.1e')}" for name, t, off in rows
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
