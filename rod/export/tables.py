"""The law of a rod over the pressures as tables: CSV, JSON, and a .mat file for SoRoSim."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from rod.arm_law.law import ArmLaw
from rod.export.arm import Arm
from rod.export.robot import Robot
from rod.load import Load
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
    rest = rod.under(Load())
    kappa_0 = np.interp(s, rest.s, rest.kappa)
    return {
        "s_mm": s,
        "kappa_0_per_mm": kappa_0,
        "alpha_N_mm2": rod.five.rigidity(s),
        "m0_N_mm": rod.five.intercept(s),
        "kappa_rest_per_mm": rod.five.kappa_rest(s, kappa_0),
    }


def arm_table(arm: Arm) -> dict[str, Array]:
    """`table` of all pressures one below the other, with pressure, angle at the clamp and standard deviations."""
    s = positions(arm.rods)
    parts: list[dict[str, Array]] = []
    for index, (pressure, rod) in enumerate(zip(arm.pressures, arm.rods, strict=True)):
        ends = {"pressure_kPa": np.full(len(s), pressure), "theta0_rad": np.full(len(s), rod.theta0)}
        part = {**ends, **table(rod, s)}
        first = part["s_mm"] < rod.five.d
        for name, pair in {"alpha_N_mm2": ("alpha1", "alpha2"), "m0_N_mm": ("m01", "m02")}.items():
            if arm.deviations:
                low, high = (arm.deviations[parameter][index] for parameter in pair)
                part[f"{name}_std"] = np.where(first, low, high)
        parts.append(part)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def write_csv(arm: Arm, path: Path) -> None:
    """`arm_table` as comma-separated values."""
    _write_columns(arm_table(arm), path)


def _write_columns(columns: Mapping[str, Array], path: Path) -> None:
    rows = [",".join(columns), *(",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True))]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def write_json(arm: Arm, mass: float | None, path: Path) -> None:
    """The five parameters with their standard deviations, the clamp and the curves over the pressures; mass: g."""
    s = positions(arm.rods)
    tables = [table(rod, s) for rod in arm.rods]
    content = {
        "length_mm": arm.length,
        "mass_g": mass,
        "pressures_kPa": list(arm.pressures),
        "origin": arm.origin,
        "theta0_rad": [rod.theta0 for rod in arm.rods],
        **arm.columns,
        "s_mm": s.tolist(),
        **{name: [part[name].tolist() for part in tables] for name in ("kappa_0_per_mm", "kappa_rest_per_mm")},
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def law_table(law: ArmLaw, pressure: float) -> dict[str, Array]:
    """Columns (n,) over equally spaced moments at a pressure in kPa: the law of the cells. Raises `RodError`."""
    section = law.at(pressure).section
    return {
        "pressure_kPa": np.full(len(section.moment), pressure),
        "moment_N_mm": section.moment,
        "kappa_per_mm": section.kappa,
        "rigidity_N_mm2": 1.0 / np.asarray(section.kappa_slope),
        "stretch": section.stretch,
        "axial_rigidity_N": section.axial_rigidity,
        "shear_rigidity_N": section.shear_rigidity,
    }


def write_law_csv(law: ArmLaw, pressures: Sequence[float], path: Path) -> None:
    """`law_table` of pressures in kPa one below the other. Raises `RodError` for one outside the law."""
    tables = [law_table(law, pressure) for pressure in pressures]
    _write_columns({name: np.concatenate([part[name] for part in tables]) for name in tables[0]}, path)


def write_law_json(law: ArmLaw, robot: Robot, path: Path) -> None:
    """`law_table` of the pressures that are known, and the whole arm as chains. Raises `RodError` as `law_table`."""
    tables = [law_table(law, pressure) for pressure in robot.known]
    content = {
        "pressures_kPa": list(robot.known),
        "length_mm": law.length,
        "pitch_mm": law.pitch,
        "mass_g": None if robot.solid is None else robot.solid.mass,
        **{name: [part[name].tolist() for part in tables] for name in tables[0] if name != "pressure_kPa"},
        "chain": robot.table,
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def write_sorosim(robot: Robot, path: Path) -> None:
    """A .mat file for SoRoSim: reference strain and rigidity over X = s/L and the pressure, SI units.

    The order of the strains is that of SoRoSim: torsion, bending about y and z, stretch, shear along y and z. X goes
    from 0 to 1, as in the `xi_starfn` of a SorosimRod; docs/how_to/robots.md has the lines that put the values there.
    Both ends of every piece are rows, so that a straight line between rows keeps the jumps.
    """
    from scipy.io import savemat

    chains, body = robot.chains, robot.body
    h = robot.length / len(chains[0].s)
    edges = np.append(0.0, chains[0].s)
    s = np.column_stack([edges[:-1], edges[1:] - BEFORE_D]).ravel()
    s[-1] = robot.length
    xi = np.zeros((6, len(s), len(chains)))
    rigidity = []
    in_space: dict[str, list[Array]] = {}
    for k, chain in enumerate(chains):
        xi[2, :, k], xi[3, :, k] = np.repeat(1e3 * chain.neutral / h, 2), chain.legs[0, 0] / h
        rigidity.append(np.repeat(1e-6 * h * chain.springs(chain.neutral)[1], 2))
        if chain.space:
            for name, stiffness in (("GJ", chain.space.twist), ("EI_y", chain.space.bend)):
                in_space.setdefault(name, []).append(np.repeat(1e-6 * h * stiffness, 2))
    content = {
        "pressures_kPa": np.array(robot.pressures),
        "L": 1e-3 * robot.length,
        "mass": 1e-3 * body.mass,
        "r": 1e-3 * body.radius,
        "E": 1e6 * body.modulus,
        "X": s / robot.length,
        "xi_star": xi,
        "EI": np.column_stack(rigidity),
        **{name: np.column_stack(columns) for name, columns in in_space.items()},
        "start": np.column_stack([1e-3 * (chain.base - 0.5 * chain.legs[0]) for chain in chains]),
        "tip_beside": np.column_stack([1e-3 * (chain.points[-1] - 0.5 * chain.legs[0]) for chain in chains]),
    }
    savemat(path, {"rod": content}, oned_as="row")
