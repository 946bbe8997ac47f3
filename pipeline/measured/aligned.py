"""Measured rows whose frame is not that of the drawing, and angles whose unit is not what it says."""

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from pipeline.errors import InputError
from pipeline.measured.predicted import Numbers, Rods
from pipeline.measured.rows import Measurements, Row

#: degrees of a rod from which an angle is checked, and the part of it below which it was read in radians
LARGE, IN_RADIANS = 15.0, 0.06
#: mm, distance of two points that fix a turn
APART = 5.0


def check_degrees(numbers: Numbers, predicted: Array) -> None:
    """Raise InputError, with a line, where end angles of some size are as small as if they were in radians."""
    angles = [k for k, name in enumerate(numbers.names) if name == "end_angle" and abs(predicted[k]) > LARGE]
    if angles and np.median([abs(numbers.values[k] / predicted[k]) for k in angles]) < IN_RADIANS:
        first = angles[0]
        raise InputError(
            f"{numbers.measurements.file}: line {numbers.rows[first].line}: end_angle_deg is "
            f"{numbers.values[first]:.3g}, where the rod has {predicted[first]:.3g}°; if it is in radians, name the "
            "column end_angle_rad"
        )


def aligned(measurements: Measurements, rods: Rods) -> Measurements:
    """The rows in the frame of the drawing, by the rigid motion that puts the rows at rest onto the rod.

    Points, tips and angles move; loads and held heights stay. Raises InputError where the rows at rest do not fix it.
    """
    rest = Numbers.of(replace(measurements, rows=tuple(row for row in measurements.rows if row.state.is_at_rest)))
    pairs = _pairs(rest, rest.predicted(rods) if rest.rows else np.zeros(0))
    far = max((float(np.hypot(*(a[0] - b[0]))) for a in pairs for b in pairs), default=0.0)
    if far < APART:
        raise InputError(
            f"{measurements.file}: --align needs two points of the arm at zero pressure, apart from each other"
        )
    read, rod = (np.array(points) for points in zip(*pairs, strict=True))
    a, b = read - read.mean(axis=0), rod - rod.mean(axis=0)
    turn = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shift = rod.mean(axis=0) - matrix @ read.mean(axis=0)
    return replace(
        measurements, rows=tuple(_moved(measurements, row, matrix, shift, turn) for row in measurements.rows)
    )


def _pairs(rest: Numbers, predicted: Array) -> list[tuple[Array, Array]]:
    """Places that were read, and those of the rod."""
    places: dict[tuple[int, str], dict[str, tuple[float, float]]] = {}
    for k, (row, name) in enumerate(zip(rest.rows, rest.names, strict=True)):
        if name in ("tip_x", "tip_y", "x", "y"):
            place = places.setdefault((row.line, name[:-1]), {})
            place[name[-1]] = float(rest.values[k]), float(predicted[k])
    full = [place for place in places.values() if len(place) == 2]
    return [(np.array([p["x"][0], p["y"][0]]), np.array([p["x"][1], p["y"][1]])) for p in full]


def _moved(measurements: Measurements, row: Row, matrix: Array, shift: Array, turn: float) -> Row:
    values = dict(row.values)
    for x, y in (("tip_x", "tip_y"), ("x", "y")):
        if (x in values) != (y in values):
            raise InputError(f"{measurements.file}: line {row.line}: --align needs both {x}_mm and {y}_mm")
        if x in values:
            values[x], values[y] = (float(v) for v in matrix @ np.array([values[x], values[y]]) + shift)
    if "end_angle" in values:
        values["end_angle"] += float(np.degrees(turn))
    return replace(row, values=values)
