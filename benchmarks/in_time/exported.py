"""Arms that move in MuJoCo and PyElastica, from the files of an export, beside the rod that they come from."""

import runpy
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import elastica
import mujoco
import numpy as np

from benchmarks.exports import rest
from benchmarks.in_time.arms import FROM, MovingArm
from benchmarks.in_time.measured import DampedOscillation, Line
from geometry.arrays import Array
from pipeline.answers.rods.solid import solid_of
from pipeline.results.files import read_results
from rod import Loading, Relaxation, Robot, Start, Steps, export_robot, frequencies, move

#: of the files; s that are followed, of a step of the rod, and of one of MuJoCo
LOSS, SECONDS, STEP, FINE = 0.1, 2.5, 0.005, 2e-4
X, Y, NO_LOSS = *np.eye(3)[:2], Relaxation((), ())


class Exported:
    """An arm at its pressure: released from its force, or with a pressure that rises at once."""

    def __init__(self, arm: MovingArm, folder: Path) -> None:
        self.arm = arm
        solid = solid_of(read_results(arm.folder))
        assert solid is not None
        damped, self.files = replace(solid, loss_factor=LOSS), {}
        for name, has_shear in (("MuJoCo", True), ("PyElastica", False)):  # PyElastica has shear of its own
            robot = Robot.of_law(arm.law, damped, arm.law.pressures, has_shear=has_shear)
            folder.mkdir(exist_ok=True)
            file = export_robot(robot, name.lower(), folder)[-1]
            self.files[name] = runpy.run_path(str(file))

    def before(self, released: bool) -> tuple[float, tuple[float, float]]:
        """kPa and N, from which the arm moves."""
        return (self.arm.pressure, (0.0, self.arm.force)) if released else (FROM * self.arm.pressure, (0.0, 0.0))

    def by_rod(self, rubber: Relaxation, released: bool) -> Array:
        """(n, 3) s and mm: the end of the curve."""
        pressure, force = self.before(released)
        start, body = Start(pressure, Loading(force)), replace(self.arm.body, relaxation=rubber)
        motion = move(body, self.arm.pressure, SECONDS, Loading(), start, Steps(STEP))
        return np.column_stack([motion.times_s, motion.tips])

    def in_mujoco(self, released: bool, is_damped: bool) -> Array:
        """The same."""
        program, (pressure, force) = self.files["MuJoCo"], self.before(released)
        model, data = program["load"]()
        program["set_pressure"](model, data, pressure)
        rest(model, data, force, X, Y)
        program["set_pressure"](model, data, self.arm.pressure)
        model.dof_damping *= is_damped
        data.qfrc_applied[:], data.time, model.opt.timestep = 0.0, 0.0, FINE
        rows = []
        while data.time < SECONDS:
            mujoco.mj_kinematics(model, data)
            rows.append([data.time, *1e3 * data.site("tip").xpos[:2]])
            mujoco.mj_step(model, data)
        return np.array(rows)

    def in_pyelastica(self, released: bool, is_damped: bool) -> Array:
        """The same."""
        program, last = self.files["PyElastica"], self.arm.pressure
        rod, simulator = program["build"](*self.before(released)), program["_Simulator"]()
        step, time, rows = program["time_step"](rod, last), np.float64(0.0), []
        simulator.append(rod)
        simulator.add_forcing_to(rod).using(program["Law"], last)
        held: dict[str, Any] = {"constrained_position_idx": (0, 1), "constrained_director_idx": (0,)}
        simulator.constrain(rod).using(elastica.FixedConstraint, **held)
        rate = is_damped * LOSS * program["first_vibration"](last)
        damper = {"uniform_damping_constant": rate, "time_step": step}
        simulator.dampen(rod).using(elastica.AnalyticalLinearDamper, **damper)
        simulator.finalize()
        stepper = elastica.PositionVerlet()
        for k in range(int(SECONDS / step)):
            if k % 20 == 0:
                rows.append([float(time), *1e3 * program["curve"](rod, last)[-1, :2]])
            time = stepper.step(simulator, time, step)
        return np.array(rows)

    def lines(self, name: str) -> Iterator[Line]:
        """Frequency, damping ratio and the way between the ends."""
        first = frequencies(self.arm.body, self.arm.pressure, count=1)[0].frequency_hz
        rubber = Relaxation.from_loss_factor(LOSS, first * 10.0**-0.5, first * 10.0**0.5)
        for program, run in (("MuJoCo", self.in_mujoco), ("PyElastica", self.in_pyelastica)):
            for released in (True, False):
                for is_damped in (False, True):
                    other, own = run(released, is_damped), self.by_rod(rubber if is_damped else NO_LOSS, released)
                    ends = np.column_stack([np.interp(other[:, 0], own[:, 0], column) for column in own.T[1:]])
                    apart = np.linalg.norm(ends - other[:, 1:], axis=1).max() / self.arm.law.length
                    rings = [DampedOscillation.of(each[:, 0], each[:, 2]) for each in (other, own)]
                    how = f"{'released' if released else 'step'}, {'loss' if is_damped else 'no loss'}"
                    case = f"{name} in {program}, {how}"
                    for k, what in enumerate(("frequency, Hz", "damping")[: 1 + is_damped]):
                        more = f"{100.0 * (rings[1][k] / rings[0][k] - 1.0):+.1f} %"
                        yield case, what, f"{rings[0][k]:.4g}", f"{rings[1][k]:.4g}", more, ""
                    yield case, "end", "", "", f"{100.0 * apart:.1f} % of l", ""
