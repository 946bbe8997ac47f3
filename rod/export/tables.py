"""The five parameters and kappa_0(s) over the pressures as tables: CSV, JSON, and a .mat file for SoRoSim."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from rod.export.arm import Arm
from rod.law import PARAMETER_COLUMNS
from rod.mechanics.equilibrium import Rod

#: digits after the decimal point of a position in mm that is one of two that are the same
DIGITS = 9
#: distance before d, mm, of the last position with the first pair of parameters
BEFORE_D = 1e-6


def positions(rods: Sequence[Rod], points: int = 225) -> Array:
    """Arc lengths of a table, mm: equally spaced ones, those between which kappa_0 of a rod is linear, and both sides
    of the jump of its parameters at d.

    Without the second kind the peaks of its ripple would be cut at the same side in every cell, and the rotation of the
    end of a pneu-net would be 2 % too small. Without the third a code that interpolates between the rows would spread
    the jump over the distance of two of them.
    """
    knots = [rod.kappa_0[:, 0] for rod in rods if isinstance(rod.kappa_0, np.ndarray) and rod.kappa_0.ndim == 2]
    jumps = [[rod.five.d - BEFORE_D, rod.five.d] for rod in rods if 0.0 < rod.five.d < rod.length]
    return np.unique(np.round(np.concatenate([np.linspace(0.0, rods[0].length, points), *knots, *jumps]), DIGITS))


def table(rod: Rod, s: Array | None = None) -> dict[str, Array]:
    """Columns at s (n,), by default `positions`: s_mm, kappa_0_per_mm, alpha_N_mm2, m0_N_mm, kappa_rest_per_mm."""
    s = positions([rod]) if s is None else s
    rest = rod.solve()
    kappa_0 = np.interp(s, rest.s, rest.kappa)
    return {
        "s_mm": s,
        "kappa_0_per_mm": kappa_0,
        "alpha_N_mm2": rod.five.rigidity(s),
        "m0_N_mm": rod.five.intercept(s),
        "kappa_rest_per_mm": rod.five.kappa_rest(s, kappa_0),
    }


def unloaded_distance(rod: Rod) -> float:
    """Distance (mm) without load between the end of a rod and that of a code with its rigidity and rest curvature.

    Such a code represents a loaded rod: without load it rests at kappa_0 - m0/alpha instead of kappa_0.
    """
    columns = table(rod)
    other = replace(rod, kappa_0=np.column_stack([columns["s_mm"], columns["kappa_rest_per_mm"]]))
    return math.dist(rod.solve().end, other.solve().end)


def arm_table(arm: Arm) -> dict[str, Array]:
    """`table` of all pressures one below the other, with the pressure, the angle at the clamp, standard deviations and
    the smooth kappa_0."""
    smooth = arm.smoothed().rods if arm.smooth else ()
    s = positions([*arm.rods, *smooth])
    parts: list[dict[str, Array]] = []
    for index, (pressure, rod) in enumerate(zip(arm.pressures, arm.rods, strict=True)):
        ends = {"pressure_kPa": np.full(len(s), pressure), "theta0_rad": np.full(len(s), rod.theta0)}
        part = {**ends, **table(rod, s)}
        if smooth:
            part["kappa_0_smooth_per_mm"] = table(smooth[index], s)["kappa_0_per_mm"]
        first = part["s_mm"] < rod.five.d
        for name, pair in {"alpha_N_mm2": ("alpha1", "alpha2"), "m0_N_mm": ("m01", "m02")}.items():
            if arm.deviations:
                low, high = (arm.deviations[parameter][index] for parameter in pair)
                part[f"{name}_std"] = np.where(first, low, high)
        parts.append(part)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def write_csv(arm: Arm, path: Path) -> None:
    """`arm_table` as comma-separated values."""
    columns = arm_table(arm)
    rows = [",".join(columns), *(",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True))]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def write_json(arm: Arm, path: Path) -> None:
    """The five parameters with their standard deviations, the clamp and the curves over the pressures."""
    smooth = arm.smoothed().rods if arm.smooth else ()
    s = positions([*arm.rods, *smooth])
    tables = [table(rod, s) for rod in arm.rods]
    content: dict[str, Any] = {
        "length_mm": arm.length,
        "mass_g": arm.mass,
        "pressures_kPa": list(arm.pressures),
        "origin": arm.origin,
        "theta0_rad": [rod.theta0 for rod in arm.rods],
        **arm.columns,
        "s_mm": s.tolist(),
    }
    for name in ("kappa_0_per_mm", "kappa_rest_per_mm"):
        content[name] = [columns[name].tolist() for columns in tables]
    if smooth:
        content["kappa_0_smooth_per_mm"] = [table(rod, s)["kappa_0_per_mm"].tolist() for rod in smooth]
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def write_sorosim(arm: Arm, path: Path) -> None:
    """A .mat file for SoRoSim: reference strain and rigidity over X = s/L and the pressure, SI units.

    The order of the strains is that of SoRoSim: torsion, bending about y and z, stretch, shear along y and z. X goes
    from 0 to 1, as in the `xi_starfn` of a SorosimRod; docs/how_to/robots.md has the lines that put the values there.
    """
    from scipy.io import savemat

    mass, radius = arm.dynamics
    s = positions(arm.rods)
    tables = [table(rod, s) for rod in arm.rods]
    xi = np.zeros((6, len(s), len(arm.rods)))
    for k, columns in enumerate(tables):
        xi[2, :, k], xi[3, :, k] = 1e3 * columns["kappa_rest_per_mm"], 1.0
    content: dict[str, Any] = {
        "pressures_kPa": np.array(arm.pressures),
        "L": 1e-3 * arm.length,
        "mass": mass,
        "r": radius,
        "E": 1e6 * arm.modulus,
        "theta0": np.array([rod.theta0 for rod in arm.rods]),
        "X": s / arm.length,
        "xi_star": xi,
        "EI": 1e-6 * np.column_stack([columns["alpha_N_mm2"] for columns in tables]),
        **{f"{PARAMETER_COLUMNS[name]}_std": np.array(values) for name, values in arm.deviations.items()},
    }
    savemat(path, {"rod": content}, oned_as="row")
