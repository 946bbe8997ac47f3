"""The arm as a program for PyElastica: a Cosserat rod that follows its law, a simulator and a plot. m, kg, s."""

from pathlib import Path

from rod.export.program import write_program
from rod.export.robot import Robot


def write_pyelastica(robot: Robot, path: Path) -> None:
    """A Python program that simulates the arm; `build(pressure_kPa)` returns an `elastica.CosseratRod`.

    The nodes between its elements are the hinges of the chain; there a rod of PyElastica bends.
    """
    solid = robot.body
    more = {
        "length": 1e-3 * robot.length,
        "radius": 1e-3 * solid.radius,
        "mass": 1e-3 * solid.mass,
        "loss_factor": solid.loss_factor,
        "known_kPa": list(robot.known),
    }
    write_program("pyelastica_arm", {**robot.table, **more}, path)
