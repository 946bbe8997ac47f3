"""The five parameters in the files of other rod codes.

M = alpha (kappa - kappa_0) + m0 is alpha (kappa - kappa_rest) with kappa_rest = kappa_0 - m0/alpha, so every code with
a bending stiffness and a rest curvature per node can represent them, at one pressure and for loaded rods (see `law`).
CSV and JSON are in mm and N like everything here; the files of other codes are in m, kg, s, as those expect. The rod
lies in the plane x, y, clamped at the origin, and bends about z.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.io import savemat

from geometry.arrays import Array
from rod.export.lumped import joints
from rod.law import RodError
from rod.mechanics.equilibrium import Rod

#: N mm rad in N m rad, N mm2 in N m2
NEWTON_METRE, NEWTON_METRE2 = 1e-3, 1e-6


@dataclass(frozen=True)
class Arm:
    """A rod at one pressure with the data of its dynamics. Raises `RodError` for a number that is not positive."""

    rod: Rod
    mass: float  #: g
    radius: float  #: mm, of a round section of about the arm's area: it only sets how stiff stretch and shear are
    modulus: float = 1.2  #: MPa, for stretch and shear
    elements: int = 60  #: pieces of the chain

    def __post_init__(self) -> None:
        for name in ("mass", "radius", "modulus"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise RodError(f"{name} must be positive, not {getattr(self, name)}.")
        if self.elements < 4:
            raise RodError(f"A chain of {self.elements} elements is too coarse; take at least 4.")

    @property
    def piece(self) -> float:
        """mm, length of one element."""
        return self.rod.length / self.elements


def table(rod: Rod, points: int = 225) -> dict[str, Array]:
    """Columns, (points,) each: s_mm, kappa_0_per_mm, alpha_N_mm2, m0_N_mm, kappa_rest_per_mm."""
    s, rest = np.linspace(0.0, rod.length, points), rod.solve()
    kappa_0 = np.interp(s, rest.s, rest.kappa)
    return {
        "s_mm": s,
        "kappa_0_per_mm": kappa_0,
        "alpha_N_mm2": rod.five.rigidity(s),
        "m0_N_mm": rod.five.intercept(s),
        "kappa_rest_per_mm": rod.five.kappa_rest(s, kappa_0),
    }


def write_csv(arm: Arm, path: Path) -> None:
    """`table` as comma-separated values."""
    columns = table(arm.rod)
    rows = [",".join(columns), *(",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True))]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def write_json(arm: Arm, path: Path) -> None:
    """The five parameters, the clamp and `table`, units in the keys."""
    rod, law = arm.rod, arm.rod.five
    content = {
        "length_mm": rod.length,
        "mass_g": arm.mass,
        "theta0_rad": rod.theta0,
        "alpha1_N_mm2": law.alpha1,
        "alpha2_N_mm2": law.alpha2,
        "m01_N_mm": law.m01,
        "m02_N_mm": law.m02,
        "d_mm": law.d,
        **{name: column.tolist() for name, column in table(rod).items()},
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def write_pyelastica(arm: Arm, path: Path) -> None:
    """A Python file whose function `build()` returns an `elastica.CosseratRod`.

    PyElastica bends at the nodes between its elements. The half elements at both ends, which cannot bend, are lumped
    into the nodes beside them.
    """
    rod, h = arm.rod, arm.piece
    edges = np.concatenate([[0.0], h * np.arange(1.5, arm.elements - 1.0), [rod.length]])
    cut = joints(rod, edges)
    content = {
        "elements": arm.elements,
        "length": 1e-3 * rod.length,
        "radius": 1e-3 * arm.radius,
        "density": 1e-3 * arm.mass / (math.pi * arm.radius**2 * rod.length * 1e-9),
        "modulus": 1e6 * arm.modulus,
        "theta0": rod.theta0,
        "bending_stiffness": (h / cut.compliance * NEWTON_METRE2).tolist(),
        "rest_curvature": (cut.rest_rotation / h * 1e3).tolist(),
    }
    path.write_text(_PYELASTICA.replace("@ROD@", json.dumps(content, indent=1)), encoding="utf-8")


def write_mujoco(arm: Arm, path: Path) -> None:
    """An MJCF chain of hinges with springs; the last body carries the site `tip`.

    The first half element is part of the clamp, hinges stand in the middles of the elements. Joint damping makes the
    chain settle.
    """
    rod, h = arm.rod, 1e-3 * arm.piece
    cut = joints(rod, np.linspace(0.0, rod.length, arm.elements + 1))
    stiffness = NEWTON_METRE / cut.compliance
    inner = f'<site name="tip" pos="{0.5 * h:.9g} 0 0"/>'
    for k in range(arm.elements - 1, -1, -1):
        length = h if k < arm.elements - 1 else 0.5 * h
        mass = 1e-3 * arm.mass * length / (1e-3 * rod.length)
        position = 0.5 * h if k == 0 else h
        inner = (
            f'<body name="piece{k}" pos="{position:.9g} 0 0">'
            f'<joint name="joint{k}" type="hinge" axis="0 0 1" stiffness="{stiffness[k]:.9g}" '
            f'springref="{cut.rest_rotation[k]:.9g}" damping="{0.03 * stiffness[k]:.9g}"/>'
            f'<geom type="capsule" fromto="0 0 0 {length:.9g} 0 0" size="{1e-3 * arm.radius:.9g}" mass="{mass:.9g}"/>'
            f"{inner}</body>\n"
        )
    half = 0.5 * rod.theta0
    path.write_text(
        '<mujoco model="pneurod">\n<compiler angle="radian"/>\n'
        '<option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"><flag contact="disable"/></option>\n'
        f'<worldbody>\n<body name="clamp" quat="{math.cos(half):.12g} 0 0 {math.sin(half):.12g}">\n'
        f"{inner}</body>\n</worldbody>\n</mujoco>\n",
        encoding="utf-8",
    )


def write_somo(arm: Arm, path: Path) -> None:
    """A SoMo manipulator definition (JSON, which is YAML): one actuator, one revolute joint per element.

    planar_flag 2 lets every joint have its own spring and neutral position. The arm lies along SoMo's z and bends about
    its x. Lengths, forces and stiffnesses still have to be multiplied by SoMo's world scale.
    """
    cut = joints(arm.rod, np.linspace(0.0, arm.rod.length, arm.elements + 1))
    springs = [
        {
            "joint_type": "revolute",
            "axis": [1, 0, 0],
            "limits": [-math.pi, math.pi, 100, 3],
            "spring_stiffness": NEWTON_METRE / float(c),
            "joint_neutral_position": float(r),
            "neutral_axis_offset": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            "joint_control_limit_force": 0.0,
        }
        for c, r in zip(cut.compliance, cut.rest_rotation, strict=True)
    ]
    actuator = {
        "actuator_length": 1e-3 * arm.rod.length,
        "n_segments": arm.elements,
        "planar_flag": 2,
        "link_definition": _somo_link(arm),
        "joint_definitions": springs,
    }
    content = {
        "manipulator_name": "pneurod",
        "urdf_filename": "pneurod.urdf",
        "n_act": 1,
        "actuator_definitions": [actuator],
        "base_definition": None,
        "tip_definitions": None,
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def _somo_link(arm: Arm) -> dict[str, object]:
    """The box between two joints."""
    mass, width, length = 1e-3 * arm.mass / arm.elements, 2e-3 * arm.radius, 1e-3 * arm.piece
    inertia = mass * (width**2 + length**2) / 12.0
    return {
        "shape_type": "box",
        "dimensions": [width, width, length],
        "mass": mass,
        "inertial_values": [inertia, 0, 0, inertia, 0, mass * width**2 / 6.0],
        "material_color": [0.2, 0.4, 0.7, 1.0],
        "material_name": "rod",
    }


def write_sorosim(arm: Arm, path: Path) -> None:
    """A .mat file for SoRoSim: reference strain and rigidity over X = s/L, in its order (torsion, bending y, z,
    stretch, shear).

    In MATLAB: `xi_starfn = @(X) interp1(rod.X, rod.xi_star', X)'`, and `rod.EI` (N m2) for the bending about z.
    """
    columns = table(arm.rod)
    xi = np.zeros((6, len(columns["s_mm"])))
    xi[2], xi[3] = 1e3 * columns["kappa_rest_per_mm"], 1.0
    content = {
        "L": 1e-3 * arm.rod.length,
        "mass": 1e-3 * arm.mass,
        "r": 1e-3 * arm.radius,
        "E": 1e6 * arm.modulus,
        "theta0": arm.rod.theta0,
        "X": columns["s_mm"] / arm.rod.length,
        "xi_star": xi,
        "EI": NEWTON_METRE2 * columns["alpha_N_mm2"],
    }
    savemat(path, {"rod": content}, oned_as="row")


#: what `pneurod export --to` offers: name -> (file name, writer)
EXPORTS: dict[str, tuple[str, Callable[[Arm, Path], None]]] = {
    "csv": ("rod.csv", write_csv),
    "json": ("rod.json", write_json),
    "pyelastica": ("rod_pyelastica.py", write_pyelastica),
    "mujoco": ("rod_mujoco.xml", write_mujoco),
    "somo": ("rod_somo.yaml", write_somo),
    "sorosim": ("rod_sorosim.mat", write_sorosim),
}


def export(arm: Arm, target: str, folder: Path) -> Path:
    """Write the arm for one of EXPORTS into the folder and return the file. Raises `RodError` for another target."""
    if target not in EXPORTS:
        raise RodError(f"{target!r} is not among the formats of export: {', '.join(EXPORTS)}.")
    name, write = EXPORTS[target]
    write(arm, folder / name)
    return folder / name


_PYELASTICA = '''"""A pressurised arm for PyElastica, written by pneurod. SI units; the arm bends in the plane x, y."""

import numpy as np
import elastica

ROD = @ROD@


def build():
    """The straight CosseratRod with the arm's rest curvature and bending stiffness about z."""
    direction = np.array([np.cos(ROD["theta0"]), np.sin(ROD["theta0"]), 0.0])
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
    rod.bend_matrix[0, 0, :] = ROD["bending_stiffness"]
    rod.rest_kappa[0, :] = ROD["rest_curvature"]
    return rod
'''
