"""Arms that move: finite elements in time beside the rod with the law of the same mesh."""

from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from benchmarks.in_time.elements import Motion, frequencies
from benchmarks.in_time.ringing import Ringing
from fem import Experiment, LineForce, Model, follow
from fem.supports import nodes_at
from geometry.arrays import Array
from pipeline.answers.rods.solid import solid_of
from pipeline.config.config import Config
from pipeline.law.study import measure_law
from pipeline.results.files import read_results
from pipeline.simulate.scene import Scene
from pipeline.store.progress import Silent
from pipeline.values.pressure import in_MPa
from rod import Acting, ArmLaw, Body, Load, Relaxation, Start, Steps, move

#: without loss; and with a slow branch and two near the period of the arms
RUBBERS = {"no loss": Relaxation((), ()), "loss": Relaxation((0.08, 0.06, 0.06), (0.9, 0.08, 0.02))}
#: steps in a period, periods that are followed, and what a step of finite elements leaves of very fast motions
PARTS, PERIODS, HIGH = 60, 5.5, 0.5
#: periods in which a pressure rises; part of the length by which a force moves the end that is then released
RISE, MOVED = 0.1, 0.1
#: kPa, of the air outside
OUTSIDE = 101.3


class MovingArm:
    """An arm at a pressure in kPa, by finite elements and by its law; what takes time is kept in a folder."""

    def __init__(self, config: Config, folder: Path, pressure: float) -> None:
        self.config, self.folder, self.pressure = config, folder, pressure
        if not (folder / "law.json").exists():
            measure_law(config, folder, 1, False, Silent()).raise_if_failed()
        run = read_results(folder)
        solid, self.density = solid_of(run), config.material.density_tonne_mm3 or 0.0
        assert isinstance(law := run.law.law if run.law else None, ArmLaw)
        assert solid is not None
        self.law, self.spread = law, solid.section.spread
        slight, at = Load(force=(0.0, 1e-5 * self.law.length)), self.law.at(pressure)
        moved = np.linalg.norm(np.subtract(at.under(slight).end, at.under(Load()).end))
        self.force = float(slight.force[1] * MOVED * self.law.length / moved)  #: N, on the end, across the arm
        self.half = Experiment.of("II", Scene.meshed(config).body, None)
        self.still = follow(self.model(), [1.0]).steps[0]
        self.natural = frequencies(self.model(), self.still.displacement, self.density, 1)[0]  #: Hz

    def model(self, force: float = 0.0, part: float = 1.0) -> Model:
        """The half under a part of the pressure and a force (N), which grow with the load factor."""
        scene = Scene(self.config, self.half.body)
        acting = [LineForce(self.half.edge, (0.0, force / self.half.symmetry_factor, 0.0))] if force else []
        return self.half.model(scene.material, [*scene.effects(in_MPa(part * self.pressure)), *acting], "p2p0")

    def rising(self, time: float) -> float:
        """The part of a pressure that acts at a time in s."""
        return float(np.sin(0.5 * np.pi * min(time * self.natural / RISE, 1.0)) ** 2)

    def by_elements(self, rubber: str, released: bool) -> Array:
        """(n, 3) s and mm: the end of the curve, released from the force, or from rest under the pressure."""
        file = self.folder / f"{'released' if released else 'inflated'}_{rubber.replace(' ', '_')}.csv"
        if not file.exists():
            law, model = RUBBERS[rubber], self.model()
            branches = list(zip(law.shares, law.times_s, strict=True))
            motion = Motion(model, self.density, branches, 1.0 / (PARTS * self.natural), HIGH)
            begin = motion.begin(follow(self.model(self.force), [1.0]).steps[0].displacement if released else None)
            moments = motion.run(begin, (lambda _: 1.0) if released else self.rising, round(PERIODS * PARTS))
            end = nodes_at(self.half.curve, model.space)[-1]
            rest = model.space.points[end] - [0.0, self.half.body.curve_y, 0.0]
            rows = [[each.time, *(rest + each.displacement[end])[:2]] for each in moments]
            np.savetxt(file, rows, delimiter=",", header="t_s,tip_x_mm,tip_y_mm", comments="")
        return np.loadtxt(file, delimiter=",", skiprows=1)

    def by_rod(self, rubber: str, released: bool, times: Array) -> Array:
        """(n, 2) mm: the same of the rod, at times (n,) in s, a step each."""
        rises = [[t, self.pressure * self.rising(t)] for t in np.linspace(0.0, RISE / self.natural, 41)]
        pressure = self.pressure if released else [*rises, [times[-1], self.pressure]]
        start = Start(self.pressure if released else 0.0, Acting(Load(force=(0.0, self.force if released else 0.0))))
        body = Body(self.law, RUBBERS[rubber], spread=self.spread)
        motion = move(body, pressure, float(times[-1]), Acting(), start, Steps(float(times[1])))
        if motion.reason:
            raise ValueError(motion.reason)
        return np.column_stack([np.interp(times, motion.times_s, column) for column in motion.tips.T])

    def compared(self, rubber: str, released: bool) -> tuple[Ringing, Ringing, float]:
        """How both ring, and how far their ends are apart at most, over the length."""
        rows = self.by_elements(rubber, released)
        own = self.by_rod(rubber, released, rows[:, 0])
        apart = np.linalg.norm(own - rows[:, 1:], axis=1).max() / self.law.length
        return Ringing.of(rows[:, 0], rows[:, 2]), Ringing.of(rows[:, 0], own[:, 1]), float(apart)

    def closed(self) -> list[float]:
        """kPa, of air that is closed in at the pressure, under twice the force: by finite elements, by the rod."""
        parts, force = np.array([1.0, 1.02, 1.05]), 2.0 * self.force
        steps = [self.still, *(follow(self.model(force, part), [1.0]).steps[0] for part in parts)]
        airs = [self.half.symmetry_factor * sum(map(step.cavity_volume, self.half.body.cavities)) for step in steps]
        fitted = np.polynomial.Polynomial.fit(parts * self.pressure, airs[1:], 2)

        def of_rod(pressure: float, force: float) -> float:
            rod = self.law.at(pressure)
            return float(rod.volumes(rod.under(Load(force=(0.0, force)))).sum())

        first, limits = of_rod(self.pressure, 0.0), (self.pressure, 1.05 * self.pressure)
        amount = OUTSIDE + self.pressure
        return [
            brentq(lambda p: (OUTSIDE + p) * fitted(p) - amount * airs[0], *limits),
            brentq(lambda p: (OUTSIDE + p) * of_rod(p, force) - amount * first, *limits),
        ]
