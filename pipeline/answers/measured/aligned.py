"""Measured rows whose frame is not that of the drawing."""

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from pipeline.answers.measured.predicted import Numbers, Rods, Setup
from pipeline.answers.measured.rows import PLACES, Measurements, Row
from pipeline.values.errors import InputError, argument

#: mm, distance of two points that fix a turn
APART = 5.0
#: what together is a place
PAIRS = PLACES[:2], PLACES[2:]
ANGLES = "end_angle", "tip_direction"


def aligned(measurements: Measurements, rods: Rods, setup: Setup) -> Measurements:
    """The rows in the frame of the drawing, by the rigid motion that puts the rows at rest onto the rod.

    Points, tips and angles move; loads and held heights stay. Raises InputError where the rows at rest do not fix it.
    """
    for row in measurements.rows:
        for x, y in PAIRS:
            if (x in row.values) != (y in row.values):
                raise InputError(
                    f"{measurements.file}: line {row.line}: {argument('align', True)} needs both {x}_mm and {y}_mm"
                )
    rest = Numbers.of(replace(measurements, rows=tuple(map(_places, measurements.rows))))
    read = rest.values.reshape(-1, 2)
    if not len(read) or np.linalg.norm(read[:, None] - read, axis=2).max() < APART:
        raise InputError(
            f"{measurements.file}: {argument('align', True)} needs two points of the arm at zero pressure, apart from "
            "each other"
        )
    rod = rest.predicted(rods, setup).reshape(-1, 2)
    a, b = read - read.mean(axis=0), rod - rod.mean(axis=0)
    turn = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shift = rod.mean(axis=0) - matrix @ read.mean(axis=0)
    rows = tuple(_moved(row, matrix, shift, turn) for row in measurements.rows)
    return replace(measurements, rows=rows, is_aligned=True)


def _places(row: Row) -> Row:
    """With the places alone that were read at rest."""
    is_place = row.state.is_at_rest and row.zero_kPa is None
    names = [name for pair in PAIRS for name in pair if is_place and name in row.values]
    return replace(row, values={name: row.values[name] for name in names})


def _moved(row: Row, matrix: Array, shift: Array, turn: float) -> Row:
    values = dict(row.values)
    for pair in PAIRS:
        if pair[0] in values:
            moved = matrix @ np.array([values[name] for name in pair]) + (shift if row.zero_kPa is None else 0.0)
            values |= dict(zip(pair, moved.tolist(), strict=True))
    for name in ANGLES:
        if name in values and row.zero_kPa is None:
            values[name] += float(np.degrees(turn))
    return replace(row, values=values)
