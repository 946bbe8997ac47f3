"""Arms that move: finite elements in time beside the rod with the law of the same mesh."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.in_time.elements import Motion
from fem import Experiment, LineForce, Model, follow
from fem.supports import nodes_at
from geometry.arrays import Array
from pipeline.answers.measured.motions import DampedOscillation
from pipeline.answers.rods.solid import solid_of
from pipeline.config.config import Config
from pipeline.law.study import measure_law
from pipeline.results.files import read_plane_law, read_results
from pipeline.simulate.scene import Scene
from pipeline.store.progress import Silent
from pipeline.values.pressure import in_MPa
from rod import Body, Load, Loading, Relaxation, Start, Steps, frequencies, move
from rod import Motion as OfArm
from rod.in_time.regions import RegionShare, mixed, shares_of

#: without loss; and with a slow branch and two near the period of the arms
RUBBERS = {"no loss": Relaxation((), ()), "loss": Relaxation((0.08, 0.06, 0.06), (0.9, 0.08, 0.02))}
#: with loss: a base of another material
BASE = Relaxation((0.3, 0.3), (0.2, 0.04))
#: steps in a period, periods that are followed, and what a step of finite elements leaves of very fast motions
PARTS, PERIODS, HIGH = 60, 5.5, 0.5
#: part of the pressure from which it rises, in a part of a period; part of the length by which a force moves the end
FROM, RISE, MOVED = 0.8, 0.1, 0.1
#: kPa, of the air outside; N, a force that hardly moves an arm
OUTSIDE, SLIGHT = 101.3, 1e-4


class MovingArm:
    """An arm at a pressure in kPa, by finite elements and by its law; what takes time is kept in a folder."""

    def __init__(self, config: Config, folder: Path, pressure: float) -> None:
        self.config, self.folder, self.pressure = config, folder, pressure
        if not (folder / "law.json").exists():
            measure_law(config, folder, 1, False, Silent()).raise_if_failed()
        self.law, solid = read_plane_law(folder / "law.json"), solid_of(read_results(folder))
        assert solid is not None
        self.body, self.density = Body(self.law, spread=solid.section.spread), config.material.density_tonne_mm3 or 0.0
        self.natural = frequencies(self.body, pressure)[0].frequency_hz
        ends = [self.law.at(pressure).under(Load(force=(0.0, force))).end for force in (0.0, SLIGHT)]
        #: N, on the end, across the arm
        self.force = float(SLIGHT * MOVED * self.law.length / np.linalg.norm(np.subtract(ends[0], ends[1])))
        self.half = Experiment.of("II", Scene.meshed(config).body, None)

    def model(self, force: float = 0.0, part: float = 1.0) -> Model:
        """The half under a part of the pressure and a force (N), which grow with the load factor."""
        scene = Scene(self.config, self.half.body)
        acting = [LineForce(self.half.edge, (0.0, force / self.half.symmetry_factor, 0.0))] if force else []
        return self.half.model(scene.material, [*scene.effects(in_MPa(part * self.pressure)), *acting], "p2p0")

    def rising(self, time: float) -> float:
        """The part of a rising pressure that acts at a time in s."""
        return float(FROM + (1.0 - FROM) * np.sin(0.5 * np.pi * min(time * self.natural / RISE, 1.0)) ** 2)

    def by_elements(self, rubber: str, released: bool) -> Array:
        """(n, 3) s and mm: the end of the curve, released from the force, or under a rising pressure."""
        file = self.folder / f"{'released' if released else 'raised'}_{rubber.replace(' ', '_')}.csv"
        if not file.exists():
            law, model = RUBBERS[rubber], self.model()
            branches = [law, *[BASE if law.shares else law] * len(self.config.materials)]
            motion = Motion(model, self.density, branches, 1.0 / (PARTS * self.natural), HIGH)
            begun = follow(self.model(self.force if released else 0.0), [1.0 if released else FROM]).steps[0]
            begin = motion.begin(begun.displacement)
            moments = motion.run(begin, (lambda _: 1.0) if released else self.rising, round(PERIODS * PARTS))
            end = nodes_at(self.half.curve, model.space)[-1]
            rest = model.space.points[end] - [0.0, self.half.body.curve_y, 0.0]
            rows = [[each.time, *(rest + each.displacement[end])[:2]] for each in moments]
            np.savetxt(file, rows, delimiter=",", header="t_s,tip_x_mm,tip_y_mm", comments="")
        return np.loadtxt(file, delimiter=",", skiprows=1)

    def with_rubber(self, rubber: Relaxation) -> Body:
        """The rod, whose base has another rubber where it is of another material."""
        if not (self.config.materials and rubber.shares):
            return replace(self.body, relaxation=rubber)
        parts = shares_of(self.law, (("material",), ("materials.base",)), self.pressure)
        forces, felt = (mixed((rubber, BASE), [getattr(part, name) for part in parts]) for name in RegionShare._fields)
        return replace(self.body, relaxation=forces, felt=felt)

    def compared(self, rubber: str, released: bool) -> tuple[DampedOscillation, DampedOscillation, float]:
        """How elements and rod ring, and how far their ends are apart at most, over the length."""
        rows = self.by_elements(rubber, released)
        times, last = rows[:, 0], float(rows[-1, 0])
        rises = [[t, self.pressure * self.rising(t)] for t in np.linspace(0.0, RISE / self.natural, 41)]
        pressure = self.pressure if released else [*rises, [last, self.pressure]]
        before = Loading((0.0, self.force if released else 0.0))
        start = Start(self.pressure * (1.0 if released else FROM), before)
        body = self.with_rubber(RUBBERS[rubber])
        motion = move(body, pressure, last, Loading(), start, Steps(float(times[1])))
        if motion.reason:
            raise ValueError(motion.reason)
        own = np.column_stack([np.interp(times, motion.times_s, column) for column in motion.tips.T])
        apart = np.linalg.norm(own - rows[:, 1:], axis=1).max() / self.law.length
        return DampedOscillation.of(times, rows[:, 2]), DampedOscillation.of(times, own[:, 1]), float(apart)

    def moved_by(self, body: Body, size: float) -> OfArm:
        """The motion of a rod from a force that moves its end by a size in mm, in steps by their error."""
        begun = Loading((0.0, self.force * size / (MOVED * self.law.length)))
        return move(body, self.pressure, PERIODS / self.natural, Loading(), Start(self.pressure, begun))

    def closed(self) -> list[float]:
        """kPa, of air that is closed in at the pressure, under twice the force: by finite elements, by the rod."""
        parts, load = np.array([1.0, 1.02, 1.05]), Load(force=(0.0, 2.0 * self.force))
        models = [self.model(), *(self.model(load.force[1], part) for part in parts)]
        steps = [follow(model, [1.0]).steps[0] for model in models]
        by_elements = [sum(map(step.cavity_volume, self.half.body.cavities)) for step in steps]
        rods = [(self.law.at(self.pressure), Load()), *((self.law.at(part * self.pressure), load) for part in parts)]
        by_rod = [rod.volumes(rod.under(one)).sum() for rod, one in rods]
        known = OUTSIDE + parts * self.pressure
        return [float(np.interp(known[0] * a[0], known * a[1:], known)) - OUTSIDE for a in (by_elements, by_rod)]
