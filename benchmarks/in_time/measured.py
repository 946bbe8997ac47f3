"""Measured motions: a solid bar that is released from straight, and a segment whose pressure is held."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, least_squares

from benchmarks.experiments.bar import GRAVITY, Bar, BendingRod
from benchmarks.experiments.cases import read_case
from benchmarks.experiments.fitted_bar import BarNumbers, fit_bar
from geometry.arrays import Array
from pipeline.answers.measured.motions import DampedOscillation
from rod import Body, FiveParameters, Loading, Relaxation, Rod, Start, Steps, move
from rod.weight import Mass

HERE = Path(__file__).parent
#: rows of the static calibration of the bar, Hz between which its loss factor holds, s of its slow branch, and s from
#: when on and how long its creep is looked at
STATIC, BAND, SLOW, EARLY, LATE, LONG = (1, 2, 3, 4), (3.0, 8.0), 1.0, 1.0, 3.5, 0.5
#: s, when and how long holds are looked at for creep, and for the curve; kPa at which it is fitted, and lowest one
BEGUN, HELD, SHORT, CURVE, FITTED, LOWEST = 0.5, 2.7, 0.2, (1.0, 0.5), 40.0, 25.0
#: a row of the table: case, number, measured, computed, difference, goal
Line = tuple[str, str, str, str, str, str]


def mean(signal: Array, at: float, width: float) -> float:
    """Of the values from a time on, for some s; signal (2, n): times in s, and values."""
    time, value = signal
    return float(value[(time >= at) & (time < at + width)].mean())


class ReleasedBar:
    """The bar as a rod: moduli from statics, loss factor and slow branch from the takes without a load."""

    def __init__(self) -> None:
        case = read_case(HERE.parent / "experiments" / "eth_beam")
        assert isinstance(case.body, Bar)
        self.bar = bar = case.body
        rigidity = bar.law.young_modulus * bar.width * bar.height**3 / 12.0
        rigidity *= fit_bar(BarNumbers(case, bar, BendingRod()), STATIC).modulus
        self.rod = Rod(bar.length, 0.0, FiveParameters(rigidity, rigidity, 0.0, 0.0, 0.1 * bar.length))
        takes = pd.read_csv(HERE / "eth_beam_release.csv", comment="#").groupby(["edge_force_N", "repeat"])
        self.takes = {key: take[["t_s", "u_up_mm"]].to_numpy().T for key, take in takes}

    def moves(self, force: float, rubber: Relaxation) -> Array:
        """(2, n) s and mm: held straight until it is released; a mass on its end stands for a force in N."""
        bar, hung = self.bar, Loading(tip_mass=1e6 * force / GRAVITY, direction="lying")
        mass = Mass.even(bar.length, 1e6 * bar.density * bar.length * bar.width * bar.height)
        body = Body(self.rod, rubber, mass, (bar.height**2 / 12.0, bar.width**2 / 12.0))
        motion = move(body, 0.0, 4.2, hung, Start(acting=Loading()), Steps(0.005))
        return np.array([motion.times_s, motion.tips[:, 1]])

    def fitted(self) -> Relaxation:
        """By damping and creep of the takes without a load; nothing else is fitted."""

        def known(signal: Array) -> Array:
            return np.array(
                [DampedOscillation.of(*signal).damping, mean(signal, LATE, LONG) / mean(signal, EARLY, LONG) - 1.0]
            )

        def rubber(loss: float, slow: float) -> Relaxation:
            fast = Relaxation.from_loss_factor(loss, *BAND)
            return Relaxation((*fast.shares, slow), (*fast.times_s, SLOW))

        measured = np.mean([known(take) for key, take in self.takes.items() if key[0] == 0.0], axis=0)
        missed = lambda x: known(self.moves(0.0, rubber(*x))) / measured - 1.0  # noqa: E731
        return rubber(*least_squares(missed, [0.1, 0.05], bounds=(0.005, 0.4), diff_step=0.05, xtol=1e-3).x)

    def lines(self) -> Iterator[Line]:
        """Frequency and damping ratio under each load."""
        rubber = self.fitted()
        for force in sorted({load for load, _ in self.takes}):
            known = np.mean(
                [DampedOscillation.of(*take) for key, take in self.takes.items() if key[0] == force], axis=0
            )
            own = DampedOscillation.of(*self.moves(force, rubber))
            name = f"bar, {1e6 * force / GRAVITY:.0f} g on its end"
            for k, (what, goal) in enumerate((("frequency, Hz", "3 %"), ("damping", "20 %"))):
                shown = f"{100.0 * (own[k] / known[k] - 1.0):+.1f} %"
                yield name, what, f"{known[k]:.3g}", f"{own[k]:.3g}", shown, goal


def segment_lines() -> Iterator[Line]:
    """Creep of the segment at held pressures, by its tip over the pressure and one factor fitted at one pressure.

    It multiplies the pressure that is felt, as a modulus does; or the pressure rises in all holds alike.
    """
    table, known = (pd.read_csv(HERE / f"sopra_{name}.csv", comment="#") for name in ("hold", "segment"))
    holds = {p: hold.to_numpy().T[1:] for p, hold in table.groupby("pressure_kPa")}
    tips = [0.0, *known["tip_distance_mm"], mean(holds[max(holds)], *CURVE)]  # the curve ends below the last hold
    curve = CubicSpline([0.0, *known["pressure_kPa"], max(holds)], tips)

    def felt(p: float, at: float) -> float:
        tip = curve(p) * mean(holds[p], at, SHORT) / mean(holds[p], *CURVE)
        return float(brentq(lambda x: curve(x) - tip, 0.5 * p, 1.2 * p))

    first, last = felt(FITTED, BEGUN), felt(FITTED, HELD)
    for p in (each for each in holds if each >= LOWEST):
        begun, measured = felt(p, BEGUN), curve(felt(p, HELD)) / curve(felt(p, BEGUN)) - 1.0
        for what, later in (("modulus", begun * last / first), ("pressure", begun + last - first)):
            own = curve(later) / curve(begun) - 1.0
            words = f"segment, {p:g} kPa", f"creep of the {what}", f"{100 * measured:.1f} %", f"{100 * own:.1f} %"
            yield *words, f"{100.0 * (own / measured - 1.0):+.0f} %", "20 %"
