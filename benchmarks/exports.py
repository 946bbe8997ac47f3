"""Exported arms, opened in their programs, against the finite elements of their runs.

    make exports
    python -m benchmarks.exports [--results results/exports] [--only NAME]

Five coarse arms, a finger of four chambers and two designs drawn at random, each at its pressures and one between:
free, and under the two small dead forces of every run. Every arm is written for MuJoCo, PyElastica, SoMo and SoRoSim
and as JSON; each file is opened, its arm put under the load until it rests, and its material curve compared with that
of the finite elements. MuJoCo opens the URDF of SoMo, with the springs of the manipulator definition; the file for
SoRoSim and the JSON are read back and solved here. A finished run is used again.
"""

import argparse
import json
import runpy
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from scipy.io import loadmat

from benchmarks.markdown import table, write_made
from benchmarks.unseen.designs import drawn
from pipeline.answers.rods.export import ExportOptions, Reference, distance, exported, references
from pipeline.config.load import load_config
from pipeline.config.validation import middle_of_widest
from pipeline.results.files import read_results
from pneurod import characterize
from rod.export.chain import Chain

#: name of an arm -> its configuration, with what is changed of it
ARMS: dict[str, tuple[str, dict[str, Any]]] = {
    "pneunet": ("configs/pneunet_coarse.yaml", {}),
    "semicircular": ("configs/semicircular_coarse.yaml", {}),
    "semicircular_single": ("configs/semicircular_single_coarse.yaml", {}),
    "bisected_circle": ("configs/bisected_circle_coarse.yaml", {}),
    "finger": ("configs/finger.yaml", {}),
    "four_chambers": ("configs/pneunet_coarse.yaml", {"geometry.chambers": 4}),
}
#: of the designs drawn at random: their seed, how many there are, and the numbers of those that are taken
SEED, COUNT, NUMBERS = 5, 8, (0, 1)
#: elements of these over those that the program chooses
LARGER = 1.5
#: what opens a file of a program: files, states -> the material curve (m, 2) mm and s (m,) mm of each
Opener = Callable[[Sequence[Path], Sequence[Reference]], list[tuple[np.ndarray, np.ndarray] | None]]


def drawn_at_random(folder: Path, numbers: Iterable[int] = NUMBERS) -> dict[str, tuple[str, dict[str, Any]]]:
    """Random designs, with larger elements than those that the program chooses."""
    arms: dict[str, tuple[str, dict[str, Any]]] = {}
    for number in numbers:
        design = drawn(SEED, COUNT)[number]
        path = folder / f"random_{number}.yaml"
        path.write_text(json.dumps(design.document), encoding="utf-8")
        size = LARGER * load_config(path).mesh.size_mm
        arms[f"random_{number}"] = (str(path), {"mesh.size": f"{size:.3g} mm"})
    return arms


def solved(name: str, config: str, changes: Mapping[str, Any], folder: Path) -> Path:
    """The folder of the run of an arm, free and under the small forces of every run, also between its pressures."""
    pressures = load_config(Path(config), [f"{key}={value}" for key, value in changes.items()]).pressures_kPa
    tested = [f"{pressure} kPa" for pressure in sorted((*pressures, middle_of_widest(pressures)))]
    on_mesh_of_arm = {"accuracy": "off", "validation.pressures": tested}  # as the finite elements are
    characterize(config, folder / name, settings={**changes, **on_mesh_of_arm}, progress=True)
    return folder / name


def in_mujoco(files: Sequence[Path], states: Sequence[Reference]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """The arm of the module, at rest."""
    program = runpy.run_path(str(files[1]))
    curves: list[tuple[np.ndarray, np.ndarray] | None] = []
    for state in states:
        model, data = program["load"]()
        program["set_pressure"](model, data, state.pressure_kPa)
        rest(model, data, state.force, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        sites = [model.site(f"curve{k}").id for k in range(model.nq - 1)] + [model.site("tip").id]
        curves.append((1e3 * data.site_xpos[sites, :2], 1e3 * np.array(program["TABLE"]["s_m"])))
    return curves


def rest(model: Any, data: Any, force: tuple[float, float], x: np.ndarray, y: np.ndarray) -> None:
    """Let an arm in MuJoCo come to rest under a dead force in N along two directions, on the site or body `tip`."""
    model.dof_damping *= 5.0
    acting = force[0] * x + force[1] * y
    for step in range(20000):
        if model.nsite:
            point, body = data.site("tip").xpos.copy(), model.site("tip").bodyid[0]
        else:
            point, body = data.body("tip").xpos.copy(), model.body("tip").id
        data.qfrc_applied[:] = 0.0
        mujoco.mj_applyFT(model, data, acting, np.zeros(3), point, body, data.qfrc_applied)
        mujoco.mj_step(model, data)
        if step > 500 and np.abs(data.qvel).max() < 1e-6:
            return
    raise RuntimeError("the arm in MuJoCo does not come to rest")


def in_pyelastica(files: Sequence[Path], states: Sequence[Reference]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """The arm of the program, at rest."""
    program = runpy.run_path(str(files[0]))
    s = 1e3 * np.array(program["TABLE"]["s_m"])
    curves: list[tuple[np.ndarray, np.ndarray] | None] = []
    for state in states:
        arm = program["simulate"](state.pressure_kPa, state.force)
        curves.append((1e3 * program["curve"](arm, state.pressure_kPa), s))
    return curves


def in_json(files: Sequence[Path], states: Sequence[Reference]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """The chain of the file, interpolated and solved."""
    content = json.loads(files[0].read_text(encoding="utf-8"))["chain"]
    known = content["pressures_kPa"]

    def at(name: str, pressure: float) -> np.ndarray:
        values = np.array(content[name])
        flat = values.reshape(len(known), -1)
        between = np.array([np.interp(pressure, known, column) for column in flat.T])
        return between.reshape(values.shape[1:])

    curves: list[tuple[np.ndarray, np.ndarray] | None] = []
    for state in states:
        p = state.pressure_kPa
        springs = [at(name, p)[content["kind"]] for name in ("angle_rad", "moment_N_m")]
        lengths = [1e3 * at(name, p) for name in ("base_m", "legs_m", "points_m", "lift_m")]
        s = 1e3 * np.array(content["s_m"])
        chain = Chain(
            base=lengths[0],
            legs=lengths[1],
            s=s,
            points=lengths[2],
            lift=float(lengths[3]),
            angle=springs[0],
            moment=1e3 * springs[1],
            axial=1.0,
            shear=1.0,
            is_limited=content["is_limited"],
        )
        curves.append((chain.curve(chain.solve(state.force)), s))
    return curves


def in_somo(files: Sequence[Path], states: Sequence[Reference]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """The end of the URDF with the springs of the definition, where there is a file for the pressure."""
    curves: list[tuple[np.ndarray, np.ndarray] | None] = []
    for state in states:
        name = f"rod_somo_{state.pressure_kPa:g}kPa"
        there = {file.suffix: file for file in files if file.stem == name}
        if not there:
            curves.append(None)
            continue
        (actuator,) = json.loads(there[".yaml"].read_text(encoding="utf-8"))["actuator_definitions"]
        spec = mujoco.MjSpec.from_file(str(there[".urdf"]))
        spec.compiler.fusestatic = False
        spec.option.gravity = [0.0, 0.0, 0.0]
        for geom in spec.geoms:
            geom.contype = geom.conaffinity = 0
        model = spec.compile()
        data = mujoco.MjData(model)
        for k, spring in enumerate(actuator["joint_definitions"]):
            model.jnt_stiffness[k] = spring["spring_stiffness"]
            model.qpos_spring[k] = spring["joint_neutral_position"]
        model.dof_damping[:] = 0.004 * model.jnt_stiffness
        data.qpos[:] = model.qpos_spring
        mujoco.mj_forward(model, data)
        rest(model, data, state.force, np.array([0.0, 0.0, 1.0]), np.array([0.0, -1.0, 0.0]))
        _, y, z = 1e3 * data.body("tip").xpos
        length = float(np.ptp(state.curve["s_mm"]))
        curves.append((np.array([[z, -y]]), np.array([length])))
    return curves


def in_sorosim(files: Sequence[Path], states: Sequence[Reference]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """The end of the rod with the strains and rigidities of the file, where it has the pressure."""
    content = loadmat(files[0])["rod"][0, 0]
    known = content["pressures_kPa"].ravel()
    s = 1e3 * content["L"].item() * content["X"].ravel()[::2]
    h = 1e3 * content["L"].item() / len(s)
    curves: list[tuple[np.ndarray, np.ndarray] | None] = []
    for state in states:
        if state.pressure_kPa not in known:
            curves.append(None)
            continue
        k = int(np.flatnonzero(known == state.pressure_kPa)[0])
        turn, stretch = 1e-3 * h * content["xi_star"][2, ::2, k], content["xi_star"][3, 0, k]
        slope = 1e6 * content["EI"][::2, k] / h
        half = np.array([0.5 * stretch * h, 0.0])
        points = np.tile(half, (len(s), 1))
        points[-1] += 1e3 * content["tip_beside"][:, k]
        chain = Chain(
            base=half + 1e3 * content["start"][:, k],
            legs=np.tile(2.0 * half, (len(s) - 1, 1)),
            s=s + h,
            points=points,
            lift=0.0,
            angle=turn[:, None] + np.array([0.0, 1.0]) / slope[:, None],
            moment=np.tile([0.0, 1.0], (len(s), 1)),
            axial=1.0,
            shear=1.0,
            is_limited=False,
        )
        curves.append((chain.curve(chain.solve(state.force))[-1:], chain.s[-1:]))
    return curves


PROGRAMS: dict[str, Opener] = {
    "mujoco": in_mujoco,
    "pyelastica": in_pyelastica,
    "json": in_json,
    "somo": in_somo,
    "sorosim": in_sorosim,
}


def errors_of(name: str, folder: Path) -> list[dict[str, Any]]:
    """The error of every file of an arm under every load, over the length."""
    run = read_results(folder)
    states = {(state.pressure_kPa, state.force): state for state in references(run)}
    rows = []
    for program, opened in PROGRAMS.items():
        options = ExportOptions(rod="law", out=folder / "exports", force=True)
        files = exported(folder, program, options).files
        for state, curve in zip(states.values(), opened(files, tuple(states.values())), strict=True):
            if curve is not None:
                error = distance(*curve, state, run.length_mm)
                row = {"arm": name, "program": program, "pressure_kPa": state.pressure_kPa, "force_N": state.force}
                rows.append({**row, "error": error})
    return rows


def summary(rows: Sequence[Mapping[str, Any]]) -> str:
    """A Markdown table: the largest error over the pressures, per arm, load and program, in percent of the length."""
    largest: dict[tuple[str, float], dict[str, float]] = {}
    for row in rows:
        errors = largest.setdefault((row["arm"], row["force_N"][1]), dict.fromkeys(PROGRAMS, 0.0))
        errors[row["program"]] = max(errors[row["program"]], row["error"])
    lines = [
        [f"{arm}, {f'{force:g} N' if force else 'free'}", *(f"{100 * error:.2f}" for error in errors.values())]
        for (arm, force), errors in largest.items()
    ]
    return table(["arm, force across the end", *PROGRAMS], lines)


def main() -> int:
    """0 where every error is below 1 % of the length."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results/exports"))
    parser.add_argument("--only", help="the name of one arm")
    given = parser.parse_args()
    given.results.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    for name, (config, changes) in {**ARMS, **drawn_at_random(given.results)}.items():
        if given.only in (None, name):
            rows += errors_of(name, solved(name, config, changes, given.results))
            text = json.dumps(rows, indent=1) + "\n"
            (given.results / "exports.json").write_text(text, encoding="utf-8")
    if given.only is None:
        write_made("make exports", summary(rows))
    sys.stdout.write(f"{summary(rows)}\n")
    return int(max(row["error"] for row in rows) > 0.01)


if __name__ == "__main__":
    sys.exit(main())
