"""Measured pneumatic arms beside the curvature of their cell: one is calibrated, and two others predicted.

    make measured-arms
    python -m benchmarks.measured_arms [--only given] [--out results/measured_arms]

States of cells are kept in the folder, so that the command repeats in seconds. It writes the tables of
docs/measured_arms.md and studies/measured_arms.md, and their pictures.
"""

import argparse
import sys
from functools import cached_property
from pathlib import Path

import numpy as np

from benchmarks.markdown import table, write_made
from benchmarks.measured_arms.arms import (
    AUTHORS,
    BLIND,
    BROAD,
    GIVEN,
    LONGER,
    MODELS,
    THIN,
    UNIAXIAL,
    Arm,
    angles_of,
    forces_of,
    second_test,
)
from benchmarks.measured_arms.forces import HeldArm, straight_moments
from benchmarks.measured_arms.free import MOST_BENT, Factor, FreeArm, curvatures, limit_at
from benchmarks.measured_arms.pictures import draw_angles
from geometry.arrays import Array, Mask
from pipeline.values.errors import InputError, RunFailed

#: kPa: rows of the calibration, of the tables, and of what is predicted of the arm that was kept back
CALIBRATED = tuple(range(12, 45, 4))
ROWS = (12, 15, 20, 25, 30, 33, 34, 35, 36, 37, 38, 40, 42, 45)
ASKED = (12, 15, 20, 25, 30, 35, 40, 42, 44, 46, 50, 55, 60, 65)
FORCES, FORCES_ASKED = (20, 25, 30, 35, 40, 45, 50), (30, 40, 50, 60)
#: kPa up to which cells are followed, by the walls in mm
MOST = {7.0: 60.0, 10.0: 84.0}
#: kPa at which cells are held straight, by the walls in mm
STRAIGHT = {
    7.0: (10.0, 20.0, 25.0, 30.0, 34.0, 36.0, 38.0, 40.0, 42.0, 44.0, 46.0, 48.0, 51.0, 54.0, 58.0, 62.0, 66.0),
    10.0: (12.0, 24.0, 34.0, 40.0, 44.0, 48.0, 52.0, 56.0, 60.0, 64.0, 68.0, 72.0, 76.0),
}
#: from which kPa on forces are compared: below they are a few hundredths of a newton
FROM = 25.0
#: by how much the angle or the pressure may be off, and above which kPa
NEAR_PART, NEAR_KPA, NEAR_FROM = 0.15, 1.5, 15.0
#: kPa from which on the angle is so large that the zero of a second test hardly matters
STEEP_FROM = 34.0
#: kPa at which the unknowns are compared
UNKNOWN_AT = (20, 30, 36, 40)
COMMAND = "python -m benchmarks.measured_arms --only {}"


def written(value: float, digits: int = 1) -> str:
    """A number of a table; a dash for none."""
    return f"{value:.{digits}f}" if np.isfinite(value) else "-"


def between(low: float, high: float, digits: int = 1) -> str:
    """The ends of an interval, as far as they are known."""
    if np.isfinite(low) and np.isfinite(high):
        return f"{low:.{digits}f}-{high:.{digits}f}"
    return f"from {low:.{digits}f}" if np.isfinite(low) else "-"


class Page:
    """The parts of the page; what several of them need is computed once."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.known: dict[tuple[str, float], Array] = {}

    def bends(self, arm: Arm, model: str = AUTHORS) -> Array:
        """Curvatures of the cell of an arm."""
        key = model, arm.wall
        if key not in self.known:
            cell = BLIND if arm.wall == BLIND.wall else GIVEN
            self.known[key] = curvatures(cell, model, MOST[cell.wall], self.out)
        return self.known[key]

    def law(self, arm: Arm, model: str = AUTHORS) -> FreeArm:
        """The angle of an arm over pressure, by one of the models."""
        return FreeArm.of(arm, self.bends(arm, model))

    def factors(self, arm: Arm, model: str = AUTHORS) -> Array:
        """How stiff an arm is over its law, by its rows of the calibration."""
        pressures, degrees = angles_of(arm)
        chosen = np.isin(pressures, CALIBRATED)
        return self.law(arm, model).factors(pressures[chosen], degrees[chosen])

    @cached_property
    def calibrated(self) -> Factor:
        """That of the given arm."""
        return Factor.of(self.factors(GIVEN))

    def of_both(self, model: str = AUTHORS) -> Factor:
        """That of both arms with walls of 7 mm, by one of the models."""
        return Factor.of(np.concatenate([self.factors(GIVEN, model), self.factors(LONGER, model)]))

    @cached_property
    def both(self) -> Factor:
        """The same by the law of the authors."""
        return self.of_both()

    def laws(self) -> str:
        """What each model says before an arm was seen, and the factor that the given arm has over it."""
        lines = []
        for model in MODELS:
            bends, law = self.bends(GIVEN, model), self.law(GIVEN, model)
            falls = limit_at(bends[:, 0]) < len(bends) - 1
            is_lost = not falls and bends[-1, 0] < MOST[GIVEN.wall] and bends[-1, 1] > -MOST_BENT
            kind = "limit" if falls else "followed to" if is_lost else "steepest"
            pressure = law.steepest if kind == "steepest" else law.pressures[-1]
            angles = [written(float(law.at(np.array([p]))[0])) for p in (20, 30, 35, 40, 45)]
            factors = self.factors(GIVEN, model)
            known = factors[np.isfinite(factors)]
            found = f"{np.exp(np.log(known).mean()):.2f} ± {np.log(known).std(ddof=1):.2f} ({len(known)})"
            lines.append([model, f"{pressure:.1f}", kind, *angles, found])
        pressures, degrees = angles_of(GIVEN)
        steepest = FreeArm(pressures, degrees).steepest
        read = [f"{degrees[pressures == p][0]:.1f}" for p in (20, 30, 35, 40, 45)]
        lines.append(["measured", f"{steepest:.1f}", "steepest", *read, "-"])
        kinds = [f"{p} kPa, °" for p in (20, 30, 35, 40, 45)]
        return table(["model", "at kPa", "it is", *kinds, "factor (rows)"], lines)

    def given(self) -> str:
        """The arm after its calibration."""
        found = self.calibrated
        told = f"Factor of all moduli: {found.value:.3f}, times e^±{found.std:.3f} from row to row."
        return told + "\n\n" + self._beside(GIVEN, another=False)

    def longer(self) -> str:
        """The arm with seven chambers, of whose rows nothing was fitted."""
        pressures, degrees = (np.array(column) for column in zip(*second_test().items(), strict=True))
        steep = pressures >= STEEP_FROM
        near = self._near(self.law(LONGER), pressures[steep], degrees[steep])
        told = f"Of the second test {int(near.sum())} of {len(near)} rows from {STEEP_FROM:g} kPa on are near."
        return self._beside(LONGER, another=True) + " " + told

    def _near(self, law: FreeArm, pressures: Array, measured: Array) -> Mask:
        """(n,) whether readings are near what the calibration says."""
        predicted, low, high = (
            law.at(pressures + shift, self.calibrated.value) for shift in (0.0, -NEAR_KPA, NEAR_KPA)
        )
        return (np.abs(predicted / measured - 1.0) <= NEAR_PART) | ((low <= measured) & (measured <= high))

    def _beside(self, arm: Arm, *, another: bool) -> str:
        pressures, measured = angles_of(arm)
        law, second = self.law(arm), second_test() if another else {}
        predicted, low, high = self.calibrated.intervals(law, pressures, another=another)
        inside = (low <= measured) & (measured <= high)
        near = self._near(law, pressures, measured)
        factors, asked = law.factors(pressures, measured), pressures > NEAR_FROM
        more = [[written(second.get(p, np.nan))] if another else [] for p in pressures]
        lines = [
            [f"{p:g}", f"{m:.1f}", *other, f"{v:.1f}", between(a, b), "yes" if c else "no", "yes" if d else "no",
             f"{f:.2f}"]
            for p, m, other, v, a, b, c, d, f in zip(
                pressures, measured, more, predicted, low, high, inside, near, factors, strict=True)
            if p in ROWS
        ]  # fmt: skip
        draw_angles(arm, (pressures, measured), (pressures, np.array([predicted, low, high])), second)
        second_head = ["second test"] if another else []
        head = ["kPa", "measured", *second_head, "predicted", "90 %", "inside", "near", "factor"]
        off = float(np.sqrt(np.mean((predicted - measured) ** 2)))
        counts = (
            f"{int(inside.sum())} of {len(inside)} rows are within their intervals. "
            f"{int(near[asked].sum())} of {int(asked.sum())} rows above 15 kPa are near. Root mean square: {off:.1f}°."
        )
        return f"{table(head, lines)}\n\n{counts}"

    def unknowns(self) -> str:
        """How much each of what is not known of the given arm changes its angles as calibrated."""
        pressures, factor = np.array(UNKNOWN_AT, float), self.calibrated.value
        bends, law = self.bends(GIVEN), self.law(GIVEN)
        angles = law.at(pressures, factor)
        changed = {
            "angles counted from 10 kPa": angles - law.at(np.array([10.0]), factor),
            "line to the middle of the tip": FreeArm.of(GIVEN, bends, 0.5 * (BROAD + GIVEN.wall)).at(pressures, factor),
            "fabric of 0.1 mm": self.law(GIVEN, THIN).at(pressures, factor),
            "moduli 5 % larger": law.at(pressures, 1.05 * factor),
        }
        rows = {"as calibrated": angles, **changed}
        lines = [[name, *(written(float(value)) for value in values)] for name, values in rows.items()]
        return table(["angle, °", *(f"{p:g} kPa" for p in UNKNOWN_AT)], lines)

    def blind(self) -> str:
        """The arm that was kept back."""
        pressures, law = np.array(ASKED, float), self.law(BLIND)
        intervals = self.both.intervals(law, pressures, another=True)
        others = [self.law(BLIND, model).at(pressures, self.of_both(model).value) for model in (UNIAXIAL, THIN)]
        lines = [
            [f"{p:g}", written(v), between(a, b), *map(written, more)]
            for p, v, a, b, *more in zip(pressures, *intervals, *others, strict=True)
        ]
        fine = np.arange(11.0, 65.5, 0.5)
        draw_angles(BLIND, None, (fine, self.both.intervals(law, fine, another=True)), {})
        told = f"Factor of all moduli: {self.both.value:.3f}, times e^±{self.both.std:.3f} from row to row."
        return "\n\n".join([told, table(["kPa", "angle, °", "90 %", UNIAXIAL, THIN], lines), self._forces_asked()])

    def held(self, arm: Arm, pressures: Array, change: float = 0.0) -> Array:
        """N at pressures in kPa of a tip that is held; change: of the logarithm of the moduli."""
        cell = BLIND if arm.wall == BLIND.wall else GIVEN
        straight = straight_moments(cell, STRAIGHT[cell.wall], self.out)
        return HeldArm(arm, straight).at(pressures, self.both.value * float(np.exp(change)))

    def shares(self, arm: Arm) -> tuple[Array, ...]:
        """kPa, N as measured, N of the rod, and the one over the other, (n,) each, of a tip that is held."""
        pressures, measured = forces_of(arm)
        rod = self.held(arm, pressures)
        return pressures, measured, rod, measured / rod

    @cached_property
    def share(self) -> Factor:
        """Measured forces of both arms over those of the rod."""
        found = [self.shares(arm) for arm in (GIVEN, LONGER)]
        return Factor.of(np.concatenate([part[(p >= FROM) & np.isfinite(part)] for p, _, _, part in found]))

    def forces(self) -> str:
        """Forces of tips that are held."""
        lines = [
            [arm.name, f"{p:g}", written(m, 3), written(r, 2), written(part, 2)]
            for arm in (GIVEN, LONGER)
            for p, m, r, part in zip(*self.shares(arm), strict=True)
            if p in FORCES and np.isfinite(r)
        ]
        told = (
            f"Measured over rod from 25 kPa on: {self.share.value:.3f}, times e^±{self.share.std:.2f} from row to row."
        )
        return table(["arm", "kPa", "measured, N", "rod, N", "measured over rod"], lines) + "\n\n" + told

    def _forces_asked(self) -> str:
        pressures, of_law, share = np.array(FORCES_ASKED, float), self.both.off(another=True), self.share
        stiffer, rod, softer = (self.held(BLIND, pressures, sign * of_law) for sign in (1.0, 0.0, -1.0))
        low, high = (np.exp(np.hypot(share.off(another=False), np.log(other / rod))) for other in (stiffer, softer))
        lines = [
            [f"{p:g}", written(v, 3), between(v / a, v * b, 3), written(r, 2)]
            for p, r, v, a, b in zip(pressures, rod, share.value * rod, low, high, strict=True)
        ]
        return table(["kPa", "force, N", "90 %", "of the rod alone, N"], lines)


PARTS = ("laws", "given", "longer", "unknowns", "blind", "forces")


def main() -> None:
    """Write the parts of the page and their pictures, and print them."""
    parser = argparse.ArgumentParser(description="Measured pneumatic arms, after a calibration.")
    parser.add_argument("--only", choices=PARTS)
    parser.add_argument("--out", type=Path, default=Path("results/measured_arms"))
    given = parser.parse_args()
    page = Page(given.out)
    try:
        for part in [given.only] if given.only else PARTS:
            text = getattr(page, part)()
            write_made(COMMAND.format(part), text)
            sys.stdout.write(text + "\n\n")
    except (InputError, RunFailed) as failure:
        sys.exit(str(failure))


if __name__ == "__main__":
    main()
