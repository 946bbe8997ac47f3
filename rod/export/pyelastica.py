"""The rod as a program for PyElastica, with a simulator, damping and a plot. Numbers in m, kg, s."""

import json
import math
from pathlib import Path

import numpy as np

from rod.export.arm import Arm
from rod.export.lumped import cut_into_joints
from rod.same_pressure import SAME


def write_pyelastica(arm: Arm, path: Path) -> None:
    """A Python program that simulates the arm; its function `build(pressure_kPa)` returns an `elastica.CosseratRod`.

    PyElastica bends at the nodes between its elements. The half elements at both ends, which cannot bend, are lumped
    into the nodes beside them.
    """
    h, (mass, radius) = arm.piece, arm.dynamics
    edges = np.concatenate([[0.0], h * np.arange(1.5, arm.elements - 1.0), [arm.length]])
    table = arm.tabulated
    cuts = [cut_into_joints(rod, edges) for rod in table.rods]
    content: dict[str, object] = {
        "pressures_kPa": list(arm.pressures),
        "origin": arm.origin,
        "elements": arm.elements,
        "length": 1e-3 * arm.length,
        "radius": radius,
        "density": mass / (math.pi * radius**2 * 1e-3 * arm.length),
        "modulus": 1e6 * arm.modulus,
        "spring_pressures_kPa": list(table.pressures),
        "theta0": [rod.theta0 for rod in table.rods],
        "bending_stiffness": [(1e-6 * h / cut.compliance).tolist() for cut in cuts],
        "rest_curvature": [(1e3 * cut.rest_rotation / h).tolist() for cut in cuts],
        **arm.columns,
    }
    path.write_text(_PROGRAM.replace("@ROD@", json.dumps(content)).replace("@SAME@", str(SAME)), encoding="utf-8")


_PROGRAM = '''"""A pneumatic arm for PyElastica, written by pneurod. SI units; the arm bends in the plane x, y.

    python THIS_FILE --pressure 17 --force 0 0.02 --plot arm.png

simulates the arm until it rests under a pressure in kPa and a force on its end in N, and prints where the end is.
`build` and `simulate` can be imported from another program.
"""

import argparse

import numpy as np
import elastica

ROD = @ROD@
#: a pressure above the highest one by no more than this part is that one, written with fewer digits
SAME_PRESSURE = @SAME@


def spring(pressure_kPa):
    """Bending stiffness (N m2) and rest curvature (1/m) at the inner nodes, and the angle of the clamp (rad).

    Between "spring_pressures_kPa" of ROD the moment is interpolated linearly; without pressure the arm is straight.
    """
    known = [0.0, *ROD["spring_pressures_kPa"]]
    if not 0.0 <= pressure_kPa <= known[-1] * (1.0 + SAME_PRESSURE):
        raise ValueError(f"{pressure_kPa:g} kPa lies outside 0 to {known[-1]:g} kPa")
    stiffness = np.array([ROD["bending_stiffness"][0], *ROD["bending_stiffness"]])
    curvature = np.array([0.0 * stiffness[0], *ROD["rest_curvature"]])
    weights = np.array([np.interp(pressure_kPa, known, row) for row in np.eye(len(known))])
    mean = weights @ stiffness
    return mean, weights @ (stiffness * curvature) / mean, float(weights @ [0.0, *ROD["theta0"]])


def build(pressure_kPa):
    """The straight CosseratRod with the arm's rest curvature and bending stiffness about z."""
    stiffness, curvature, theta0 = spring(pressure_kPa)
    direction = np.array([np.cos(theta0), np.sin(theta0), 0.0])
    rod = elastica.CosseratRod.straight_rod(
        ROD["elements"],
        np.zeros(3),
        direction,
        np.array([0.0, 0.0, 1.0]),
        ROD["length"],
        ROD["radius"],
        ROD["density"],
        youngs_modulus=ROD["modulus"],
    )
    rod.bend_matrix[0, 0, :] = stiffness
    rod.rest_kappa[0, :] = curvature
    return rod


class Pressure(elastica.NoForces):
    """The arm follows a pressure in kPa, given as a function of time in s."""

    def __init__(self, pressure):
        super().__init__()
        self.pressure, self.present = pressure, None

    def apply_forces(self, system, time=0.0):
        """Set bending stiffness and rest curvature where the pressure has changed."""
        pressure = self.pressure(time)
        if pressure == self.present:
            return
        self.present = pressure
        stiffness, curvature, _ = spring(pressure)
        system.bend_matrix[0, 0, :] = stiffness
        system.rest_kappa[0, :] = curvature


class _Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):
    """One clamped rod with a force on its end."""


def simulate(pressure_kPa, force=(0.0, 0.0), seconds=2.0, damping=20.0):
    """The rod after the given time under a pressure in kPa and a dead force (x, y) on its end in N.

    pressure_kPa: a number, which is reached after a quarter of the time, or a function of the time in s. damping: rate
    in 1/s at which velocities decay. The time step is a third of the time a stretch wave needs for an element.
    """
    final = pressure_kPa(seconds) if callable(pressure_kPa) else pressure_kPa
    schedule = pressure_kPa if callable(pressure_kPa) else lambda time: final * min(1.0, 4.0 * time / seconds)
    rod, simulator = build(final), _Simulator()
    step = ROD["length"] / ROD["elements"] / np.sqrt(ROD["modulus"] / ROD["density"]) / 3.0
    simulator.append(rod)
    simulator.add_forcing_to(rod).using(Pressure, schedule)
    simulator.constrain(rod).using(
        elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    end = np.array([force[0], force[1], 0.0])
    simulator.add_forcing_to(rod).using(elastica.EndpointForces, np.zeros(3), end, ramp_up_time=0.1)
    simulator.dampen(rod).using(
        elastica.AnalyticalLinearDamper, uniform_damping_constant=damping, time_step=step
    )
    simulator.finalize()
    stepper, time = elastica.PositionVerlet(), np.float64(0.0)
    while time < seconds:
        time = stepper.step(simulator, time, step)
    return rod


def plot(rods, file):
    """Draw the curves of rods by their labels into a file."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    for label, rod in rods.items():
        axes.plot(*(1e3 * rod.position_collection[:2]), label=label)
    axes.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    axes.legend()
    figure.savefig(file, dpi=150)


def main():
    """Simulate the arm and print where its end comes to rest."""
    options = argparse.ArgumentParser(description="A pneumatic arm in PyElastica.")
    options.add_argument("--pressure", type=float, nargs="+", default=ROD["pressures_kPa"][-1:], help="kPa")
    options.add_argument("--force", type=float, nargs=2, default=(0.0, 0.0), metavar=("FX", "FY"), help="N")
    options.add_argument("--seconds", type=float, default=2.0, help="simulated time")
    options.add_argument("--plot", metavar="FILE", help="draw the curves into this file")
    given = options.parse_args()
    rods = {}
    for pressure in given.pressure:
        rod = rods[f"{pressure:g} kPa"] = simulate(pressure, given.force, given.seconds)
        x, y = 1e3 * rod.position_collection[:2, -1]
        print(f"{pressure:g} kPa: end at x = {x:.2f} mm, y = {y:.2f} mm")
    if given.plot:
        plot(rods, given.plot)
        print(f"picture: {given.plot}")


if __name__ == "__main__":
    main()
'''
