"""Arms of other lengths from one parameterization, against finite elements (paper, equations (9) and (10), Fig. 13).

    python benchmarks/scaling.py [mesh size in mm] > table

The parameters are those of the arm with 11 chambers. Rods for 7, 11 and 20 chambers (l = 10 n + 2 mm) get them by
equation (9), at the same pressure and from one pressure alone, and are compared with their own finite elements: largest
distance over the length in experiments II and III, and the relative error of the end force in III.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

# the rooms stand beside this folder
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import fem
from benchmarks.arguments import parser_of, size
from geometry import Centreline, PneuNet
from rod import (
    Curvature,
    Identification,
    Load,
    ReferenceArm,
    Rod,
    cell_averaged,
    end_displacement_closure,
    identify,
    moment_from_load,
    scaled_arm,
    straightness,
    without_stretch,
)

MATERIAL = fem.StVenantKirchhoff(E=1.2, nu=0.495)
DENSITY = 1.13e-9  #: tonne/mm3
REFERENCE, OTHERS = 11, (7, 20)


@dataclass(frozen=True)
class Arm:
    """Finite elements of one arm at one pressure, and the parameters identified from them."""

    chambers: int
    pressure: float  #: kPa
    free: Centreline  #: II
    loaded: Centreline  #: III
    load: Load  #: of III
    kappa_0: Curvature
    numbers: Identification

    @property
    def middle(self) -> float:
        """kappa_0(l/2), 1/mm."""
        return float(np.interp(self.kappa_0.length / 2, self.kappa_0.s, self.kappa_0.kappa))


@dataclass(frozen=True)
class Row:
    """A rod that was scaled from the reference arm, against the arm's own finite elements."""

    chambers: int
    pressure: float  #: kPa
    origin: float  #: kPa, the pressure of the reference
    kappa_0: float  #: scaled over identified, in the middle
    alpha2: float  #: scaled over identified
    distance_II: float  #: over the length
    distance_III: float
    force: float  #: relative error


def solved(chambers: int, pressures: Sequence[float], size: float) -> list[Arm]:
    """II and III of the arm with this many chambers at the pressures (kPa, ascending), mesh size in mm."""
    body = PneuNet(chambers=chambers).body(size)
    largest = pressures[-1]
    effects = [fem.Pressure("cavity", largest / 1000.0), fem.SelfContact("gap")]
    steps = {}
    for name in ("II", "III"):
        experiment = fem.Experiment.of(name, body, 0.0)
        model = experiment.model(MATERIAL, effects, "p2p0")
        for step in fem.follow(model, [p / largest for p in pressures]).steps:
            steps[name, round(step.factor * largest, 6)] = (experiment, step)
    arms = []
    for pressure in pressures:
        curves = {name: steps[name, pressure][0].centreline(steps[name, pressure][1]) for name in ("II", "III")}
        experiment, step = steps["III", pressure]
        fx, fy = experiment.end_force(step)[:2]
        load = Load((float(fx), float(fy)), experiment.end_couple(step))
        kappa_0, kappa = (cell_averaged(curves[name], body.pitch) for name in ("II", "III"))
        moment = moment_from_load(without_stretch(curves["III"]), load)
        numbers = identify(kappa_0, kappa, moment, end_displacement_closure(curves["II"], curves["III"], load))
        arms.append(Arm(chambers, pressure, curves["II"], curves["III"], load, kappa_0, numbers))
    return arms


def reference(arms: Sequence[Arm], origin: float) -> ReferenceArm:
    """The parameterization of the arms of one length at one of their pressures (kPa)."""
    pressures = [arm.pressure for arm in arms]
    beta = []
    for name in ("alpha1", "alpha2"):
        intervals = [getattr(arm.numbers, name) for arm in arms]
        beta.append(straightness(pressures, [i.value for i in intervals], [i.std for i in intervals]).slope)
    arm = next(arm for arm in arms if arm.pressure == origin)
    weight = DENSITY * PneuNet(chambers=arm.chambers).solid_volume * 9810.0
    return ReferenceArm(arm.kappa_0.length, weight, origin, arm.numbers.law, beta[0], beta[1], arm.middle)


def compared(arm: Arm, parent: ReferenceArm) -> Row:
    """The rod scaled to an arm, against its finite elements."""
    guess = scaled_arm(parent, length=arm.free.length, pressure=arm.pressure)
    start = (float(arm.free.x[0]), float(arm.free.y[0]))
    rod = Rod(arm.free.length, guess.kappa_0, guess.law, 0.0, start)
    shape_III = rod.under(arm.load, end_y=float(arm.loaded.y[-1]))
    distances = []
    for shape, curve in ((rod.solve(), arm.free), (shape_III, arm.loaded)):
        off = shape.positions(curve.s - curve.s[0]) - np.column_stack([curve.x, curve.y])
        distances.append(float(np.hypot(off[:, 0], off[:, 1]).max()) / curve.length)
    of_II, of_III = distances
    return Row(
        arm.chambers,
        arm.pressure,
        parent.pressure,
        guess.kappa_0 / arm.middle,
        guess.law.alpha2 / arm.numbers.law.alpha2,
        of_II,
        of_III,
        float(shape_III.force[1]) / arm.load.force[1] - 1.0,
    )


def table(size: float, pressures: Sequence[float], origin: float, others: Sequence[int] = OTHERS) -> list[Row]:
    """Rows for every length, at the pressure of the reference itself and from the pressure `origin` alone."""
    arms = {chambers: solved(chambers, pressures, size) for chambers in (REFERENCE, *others)}
    parent = arms[REFERENCE]
    rows = []
    for chambers in sorted(arms):
        for arm in arms[chambers]:
            rows.append(compared(arm, reference(parent, arm.pressure)))
            if arm.pressure != origin:
                rows.append(compared(arm, reference(parent, origin)))
    return rows


def main() -> None:
    """Print the table."""
    parser = parser_of(__doc__)
    parser.add_argument("size", nargs="?", type=size, default=4.0, help="of the mesh, mm")
    mesh_size = parser.parse_args().size
    print("chambers  p kPa  from kPa  kappa_0  alpha2   II %   III %  force %")  # noqa: T201
    for row in table(mesh_size, (10.0, 17.0, 24.0, 31.0, 37.0), 24.0):
        print(  # noqa: T201
            f"{row.chambers:8d} {row.pressure:6g} {row.origin:9g} {row.kappa_0:8.3f} {row.alpha2:7.3f}"
            f" {100 * row.distance_II:6.2f} {100 * row.distance_III:7.2f} {100 * row.force:+8.1f}"
        )


if __name__ == "__main__":
    main()
