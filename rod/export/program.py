"""Programs for MuJoCo and PyElastica: files of `rod/export/programs`, with the table of an arm in each."""

import pprint
import re
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

from rod.export.robot import Robot
from rod.same_pressure import SAME

#: where a program takes its table from, and an empty table
_IMPORT, _EMPTY = re.compile(r"from rod\.export\.programs\.table import .*\n"), "TABLE = {}\n"


def write_program(name: str, table: Mapping[str, object], path: Path) -> None:
    """Write a program of the folder that needs no other file: the table and `at` stand in it.

    table: numbers in SI units; those over the pressures have names that end in _m, _N, _s or _rad.
    """
    folder = files("rod.export.programs")
    program, beginning = (folder.joinpath(f"{part}.py").read_text(encoding="utf-8") for part in (name, "table"))
    content = pprint.pformat({**table, "same_pressure": SAME}, width=10**6, compact=True, sort_dicts=False)
    _, comment, below = beginning.partition("#: the arm")
    below = below.replace(_EMPTY, f"TABLE = {content}\n")
    path.write_text(_IMPORT.sub(lambda _: f"{comment}{below}", program), encoding="utf-8")


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
