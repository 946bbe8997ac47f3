"""Measured numbers that cannot be of an arm: in radians, of its mirror image, out of its reach, or met by no fit."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from geometry import Reason
from geometry.arrays import Array
from pipeline.answers.measured.aligned import ANGLES, PAIRS
from pipeline.answers.measured.predicted import Compared, Numbers
from pipeline.answers.measured.rows import COLUMNS, OF_DISPLACEMENTS, PLACES, Measurements
from pipeline.values.errors import InputError, argument

#: degrees of a rod from which an angle is checked, and the part of it below which it was read in radians
LARGE, IN_RADIANS = 15.0, 0.06
#: part of the length, and degrees, from which the sign of a number is checked: laws of rubber differ by less. The
#: mirrored numbers of moduli within a factor of 3 are nearer than half as far
CLEAR, CLEAR_DEG, NEARER = 0.05, 5.0, 0.5
#: part of the length by which a place may be farther from the clamp than the arm is long: it stretches, and the frame
#: of a photograph may be shifted
BEYOND = 0.2
#: part of the distance of the rod's places from the clamp within which all that were read are in another unit, and of
#: the length from which a distance counts
SMALLER, LARGER = 0.12, 0.3
CHECK = "check the unit and the origin"
#: part of the motion that a fit may miss: measured bodies leave at most 0.08, one misread row of five 0.5, columns in
#: pixels or mirrored 1; and over the usual scatter, so that an arm that hardly moves may be read as roughly as others
MISSED, SCATTERS = 0.3, 3.0
#: step of a linear fit over its deviation, from which a fit has not ended: of fits that stay at the drawing it is 4 or
#: more
UNSETTLED = 2.0
#: relative change of a density from which it is not that of the rubber
DENSER = 0.1


def check_numbers(numbers: Numbers, predicted: Array, length_mm: float) -> None:
    """Raise InputError, with line and column, for numbers that cannot be of an arm of which a rod is known.

    predicted: (n,) the same numbers by the rod, whose moduli may be others.
    """
    _check_degrees(numbers, predicted)
    _check_displacements(numbers, predicted, length_mm)
    _check_signs(numbers, predicted, length_mm)
    _check_reach(numbers, predicted, length_mm)


def _check_degrees(numbers: Numbers, predicted: Array) -> None:
    angles = [k for k, name in enumerate(numbers.names) if name in ANGLES and abs(predicted[k]) > LARGE]
    for k in angles:
        value, rod = numbers.values[k], predicted[k]
        turned = value + math.copysign(360.0, rod)
        # else it is that of the mirrored arm
        if value * rod < 0.0 < turned * rod and abs(turned - rod) < abs(value + rod):
            raise InputError(f"{numbers.where(k)}: {numbers.names[k]}_deg is a turn off; write it as {turned:.4g}")
    if angles and np.median([abs(numbers.values[k] / predicted[k]) for k in angles]) < IN_RADIANS:
        first, name = angles[0], numbers.names[angles[0]]
        raise InputError(
            f"{numbers.where(first)}: {name}_deg is {numbers.values[first]:.3g}, where the rod has "
            f"{predicted[first]:.3g}°; if it is in radians, name the column {name}_rad"
        )


def _check_displacements(numbers: Numbers, predicted: Array, length_mm: float) -> None:
    """Places along x that would be those of the rod if the straight arm ended at the clamp."""
    rows, straight = zip(numbers.rows, numbers.names, strict=True), numbers.straight(length_mm)
    at = [k for k, (row, name) in enumerate(rows) if name in ("tip_x", "x") and row.zero_kPa is None and straight[k]]
    off, straight = numbers.values[at] - predicted[at], straight[at]
    if at and np.linalg.norm(off + straight) < NEARER * np.linalg.norm(off) and numbers.values[at].max() < CLEAR:
        raise InputError(
            f"{numbers.where(at[0])}: every {COLUMNS[numbers.names[at[0]]]} is about the length at rest, "
            f"{straight[0]:.4g} mm, too small; if these are displacements, add a column {OF_DISPLACEMENTS}"
        )


def _check_signs(numbers: Numbers, predicted: Array, length_mm: float) -> None:
    """Columns all of whose numbers without load have the other sign than the rod, and about its size."""
    sentences = []
    for name in ("tip_x", "tip_y", "x", "y", *ANGLES):
        clear = CLEAR_DEG if name in ANGLES else CLEAR * length_mm
        kinds = zip(numbers.rows, numbers.names, predicted, strict=True)
        at = [k for k, (row, kind, by) in enumerate(kinds) if kind == name and not row.state.load and abs(by) > clear]
        read, rod = numbers.values[at], predicted[at]
        is_other = bool(at) and bool(np.all(read * rod < 0.0))
        if is_other and np.linalg.norm(read + rod) < NEARER * np.linalg.norm(read - rod):
            sign, written = ("-", "a minus sign") if rod[0] < 0.0 else ("+", "a plus sign")
            sentences.append(
                f"{numbers.where(at[0])}: {COLUMNS[name]} is {read[0]:.3g}, with the sign of the mirrored arm; this "
                f"one bends towards {sign}{'x' if name.endswith('x') else 'y'}: write the column with {written}, or "
                f"its title as -{COLUMNS[name]}"
            )
    if sentences:
        raise InputError(*sentences)


def _check_reach(numbers: Numbers, predicted: Array, length_mm: float) -> None:
    """Places farther from the clamp than the arm is long, with twice the stretch of the rod; or all near it."""
    pairs = zip(numbers.rows, numbers.names, predicted.tolist(), strict=True)
    by_rod, parts = {(row.line, name): value for row, name, value in pairs}, list[float]()
    for row in numbers.measurements.rows:
        for place, length in zip(PAIRS, (length_mm, row.s_mm or 0.0), strict=True):
            given = [name for name in place if name in row.values]
            if not given:
                continue
            far = math.hypot(*(row.values[name] for name in given))
            of_rod = math.hypot(*(by_rod[row.line, name] for name in given))
            parts += [far / of_rod] if row.zero_kPa is None and of_rod > LARGER * length_mm else []
            where = f"{numbers.measurements.file}: line {row.line}"
            columns = ", ".join(COLUMNS[name] for name in given)
            if far > length + BEYOND * length_mm + 2.0 * max(0.0, of_rod - length):
                of = f"an arm of {length:.4g} mm" if place == PAIRS[0] else f"a point at s = {length:.4g} mm"
                raise InputError(f"{where}: the place in {columns} is {far:.4g} mm from the clamp of {of}; {CHECK}")
    if parts and max(parts) < SMALLER:
        raise InputError(
            f"{numbers.measurements.file}: places are {max(parts):.2g} times as far from the clamp as those of the rod "
            f"at most; {CHECK}"
        )


def _told(row: Compared) -> dict[str, float | str]:
    return {"line": row.line, "quantity": row.quantity, "measured": row.measured, "fitted": row.predicted}


def doubt_of_origin(measurements: Measurements) -> list[str]:
    """A sentence where no row shows the origin of places."""
    rest = [row for row in measurements.rows if row.state.is_at_rest and {*row.values} & {*PLACES}]
    cure = f"Read two points of the arm at 0 kPa as well, and give {argument('align', True)}."
    is_shown = rest or measurements.is_aligned or not measurements.places
    return [] if is_shown else [f"No row at rest shows the origin of the places. {cure}"]


def failure_of(
    numbers: Numbers, rows: Sequence[Compared], usual: Mapping[str, float], length_mm: float, step: float
) -> Reason | None:
    """Why a fit is no calibration: it misses a large part of the motion, or did not end, and numbers lie outside.

    rows: beside the fit. usual: scatter by unit, by which numbers of all units are weighed. step: as of `Gaussian`.
    None where it is a calibration.
    """
    scatter = np.array([usual[unit] for unit in numbers.units])
    off, motion = np.array([row.difference for row in rows]), numbers.values - numbers.straight(length_mm)
    off, motion = off / scatter, motion / scatter
    part = float(np.linalg.norm(off)) / (float(np.linalg.norm(motion)) or 1.0)
    if part >= MISSED and np.sqrt(np.mean(off**2)) >= SCATTERS:
        return Reason("not_calibrated", {"percent": 100.0 * part, **_told(rows[int(np.abs(off).argmax())])})
    outside = [row for row in rows if not row.is_within]
    if step < UNSETTLED or not outside:
        return None
    return Reason("unsettled", {"outside": len(outside), "numbers": len(rows), **_told(outside[0])})


def doubts_of(measurements: Measurements, numbers: Numbers, residual: Array) -> list[str]:
    """Sentences on the origin, and where the frequencies that were measured would need another density.

    residual: (n,) measured less fitted.
    """
    is_hz, said = np.array(numbers.units) == "Hz", doubt_of_origin(measurements)
    denser = float(np.mean((1.0 - residual[is_hz] / numbers.values[is_hz]) ** 2)) if is_hz.any() else 1.0
    if abs(denser - 1.0) < DENSER:
        return said
    return [
        *said,
        f"The frequencies would need {denser:.2f} times the density, which is known better: masses are wrong, or the "
        "modulus in motion is another one.",
    ]
