"""The verdict of a run in at most eight lines: how far the arm bends, which rod to take, and how wrong it is.

The verdict is one value. The terminal, the report, `pneurod run --json` and `pneurod.read_results` show its lines.
"""

import shlex
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from html import escape
from math import inf, isinf
from typing import Any

import numpy as np

from geometry import Reason, Values
from geometry.told import Printable
from pipeline.results.rod_errors import (
    LARGEST_FORCE,
    LARGEST_SHAPE,
    TITLES,
    MeshErrors,
    RodAndMesh,
    RodErrors,
    rod_and_mesh,
    rod_errors,
    rod_to_take,
    uncertain_forces,
    unknown_mesh_error,
)
from pipeline.results.unloaded import limit_of, named_states, weight_not_borne
from pipeline.values.formats import ARM_LAW, FIVE
from pipeline.values.formatting import number, round_down
from pipeline.values.json_values import JsonObject
from pipeline.values.reasons import NO_PARAMETERS, report_reason
from pipeline.values.record import Reported
from pipeline.values.run import Run

#: size of a finer mesh over that of the run
FINER = 2 / 3
#: lines of the verdict, and warnings among them
MOST_LINES, MOST_WARNINGS = 8, 2
#: code of the remark on an arm that no rod describes
OUT_OF_PLANE = "out_of_plane"
#: code of the remark on what the tolerances of the built arm do, which has a line of its own
TOLERANCES = "tolerances"
#: code of the remark on the arm in time, which has one too
IN_TIME = "in_time"
#: codes of the remark that takes the place of that on tolerances where the arm was calibrated to a measurement
CALIBRATED = ("calibrated", "calibrated_alone")
#: codes of remarks that a fit to a measurement is no calibration
NOT_CALIBRATED = "not_calibrated", "unsettled"
#: codes of remarks by rank; others follow in the order in which they were found
RANKS = (
    *("unstable_states", "beyond_law", OUT_OF_PLANE, "volume_lost", "volume_lost_unevenly"),
    *("law_beyond_end", "hardly_bent", "rigidity_open", "one_rigidity_poor"),
)
#: codes of remarks on the five parameters alone
OF_FIVE = frozenset(
    {"rigidity_open", "one_rigidity_poor", "one_line_or_two", "long_cells", "unequal_cells", "few_pressures"}
    | {"few_reached", *NO_PARAMETERS}
)
#: what stands in the record of a verdict only where there is some
OPTIONAL = ("in_time", "limit", "layers", "directions_deg", "ends_error")
#: codes that name the limit at which an experiment ended
NAMES_A_LIMIT = ("has_limit", "end_of_II", "followed_near_end_of_II")


@dataclass(frozen=True)
class Bending:
    """Where the end of the arm without a load is; positions are relative to the clamped end."""

    pressure_kPa: float
    angle_deg: float  #: rotation of the end section
    tip_x_mm: float
    tip_y_mm: float
    tip_z_mm: float | None = None  #: of an arm with several pressures
    row_kPa: tuple[float, ...] = ()  #: its pressures; `pressure_kPa` is the largest

    @property
    def pressure(self) -> str:
        """Pressure or pressures in words."""
        return f"[{', '.join(map('{:g}'.format, self.row_kPa))}]" if self.row_kPa else f"{self.pressure_kPa:g}"

    @property
    def tip(self) -> str:
        """Position of the end in words."""
        tip = (self.tip_x_mm, self.tip_y_mm, self.tip_z_mm)
        return f"({', '.join(f'{value:z.1f}' for value in tip if value is not None)})"


@dataclass(frozen=True)
class Verdict(Printable):
    """What a run has found, and how far it can be relied on."""

    design: str
    length_mm: float  #: NaN where the body was not meshed
    draft: bool  #: whether the law is that of one mesh whose error was not measured
    bending: tuple[Bending, ...]  #: by ascending pressure
    directions_deg: tuple[float, ...]  #: how far an arm in space bends, from y on every 45 degrees towards z
    rod: str  #: the rod to take: five or arm_law; empty where none was compared
    refusal: Reported | None  #: why no rod of this run should be used; None where `rod` can be
    falls: Reported | None  #: that the arm without a load falls over, and from which pressure on
    not_borne: tuple[Reported, ...]  #: what the rod to take does not bear: loads of the run, its own weight
    shape_error: float | None  #: of the rod to take over the length, rod and mesh together
    force_error: float | None  #: over the largest force, rod and mesh together
    mesh: MeshErrors  #: the part of the mesh in them
    ends_error: float | None  #: the part of cells that the ends disturb, where no whole arm was solved; None: none
    pressures_kPa: tuple[float, float] | None  #: between which the rod holds
    moments_N_mm: tuple[float, float] | None  #: for which it holds at the highest pressure
    tolerances: Reported | None  #: what the tolerances of the built arm do, or its calibration; None: not known
    in_time: Reported | None  #: how it vibrates, settles and creeps; None where its material does not say so
    layers: str  #: what threads and sheets do; empty without them
    limit: Reported | None  #: a limit of the pressure, or where the angle rises steeply with it; None: neither is known
    command: str  #: how to use the rod, or what to do instead
    failures: tuple[Reported, ...]
    warnings: tuple[Reported, ...]  #: ranked, at most `MOST_WARNINGS`
    errors: tuple[RodErrors, ...]  #: of every rod against finite elements on the same mesh, the rod to take first

    @property
    def usable(self) -> bool:
        """Whether there is a rod that can be used."""
        return bool(self.rod) and self.refusal is None

    @property
    def lines(self) -> tuple[str, ...]:
        """The verdict in words, at most eight lines."""
        limit = self.limit.text if self.limit else ""
        leaves = f"{self.design}: {self.refusal.text}" if self.refusal and self.refusal.code == OUT_OF_PLANE else ""
        lines = [leaves, *self._bends(), self._takes(), self.layers, limit]
        lines += [self.tolerances.text] if self.usable and self.tolerances else []
        lines += [self.in_time.text] if self.usable and self.in_time else []
        lines += [self._holds(), self.command, *self._not_reached()]
        return tuple(filter(None, (*lines, *(f"Warning: {warning.text}" for warning in self.warnings))))[:MOST_LINES]

    def _repr_html_(self) -> str:
        """For notebooks."""
        return "".join(f"<p>{escape(line)}</p>" for line in self.lines)

    def _bends(self) -> list[str]:
        length, draft = number(self.length_mm), " (draft)" if self.draft else ""
        falls = [f"{self.design}, {length} mm long: {self.falls.text}"] if self.falls else []
        if not self.bending:
            return falls or [f"{self.design}: the arm without a load was not reached at any pressure."]
        named = named_states(self.bending)
        angles = ", ".join(f"{b.angle_deg:.0f}°" for b in named)
        pressures, tips = ", ".join(b.pressure for b in named), ", ".join(b.tip for b in named)
        arm = f"{self.design}{draft}, {length} mm long,"
        told = f"{arm} bends by {angles} at {pressures} kPa; its tip is at {tips} mm."
        if around := ", ".join(f"{angle:.0f}°" for angle in self.directions_deg):
            told += f" Towards y, and then every 45° towards z, it bends by up to {around}."
        return [*falls, told]

    def _takes(self) -> str:
        if self.refusal is not None:
            return "" if self.refusal.code == OUT_OF_PLANE else self.refusal.text
        if self.shape_error is None:
            return "No rod was compared with the finite elements."
        both = self.shape_error, self.force_error, None, self.mesh
        errors = RodAndMesh(*both, bool(self.errors), self.ends_error or 0.0)
        return f"Take the rod with {TITLES[self.rod]}: {errors.text}."

    def _holds(self) -> str:
        if not self.usable or self.pressures_kPa is None:
            return ""
        low, high = self.pressures_kPa
        moments = ""
        if self.moments_N_mm is not None:
            least, most = self.moments_N_mm
            moments = f"; at {high:.4g} kPa for bending moments of {least:.3g} to {most:.3g} N mm"
        not_borne = [one.text for one in self.not_borne]
        return " ".join([f"Valid from {low:.4g} to {high:.4g} kPa{moments}.", *not_borne])

    def _not_reached(self) -> list[str]:
        failures = [one for one in self.failures if not (self.falls and one.code in NO_PARAMETERS)]
        if not failures:
            return []
        more = f" ({len(failures) - 1} more in the report)" if len(failures) > 1 else ""
        return [f"Not reached: {_shorten(failures[0])}{more}"]

    def record(self) -> JsonObject:
        """The verdict as `pneurod run --json` writes it."""
        content = {n: value for n, value in asdict(self).items() if n != "command" and (value or n not in OPTIONAL)}
        return {**content, "usable": self.usable, "lines": self.lines}


def verdict_of(run: Run) -> Verdict:
    """The verdict on the results of a run."""
    errors = rod_errors(run)
    rod, both = rod_to_take(run, errors) or ("", None)
    refusal = _refusal(run, errors, both)
    usable = bool(rod) and refusal is None
    highest = max(run.config.get("pressures_kPa", ()), default=0.0)
    limit = limit_of(run.law, highest) if rod == ARM_LAW and run.law else None
    stands_to: Any = run.falls.values["pressure_kPa"] if run.falls else inf
    return Verdict(
        design=run.design,
        length_mm=run.length_mm,
        draft=bool(run.law and run.law.draft),
        bending=tuple(state for state in _bending(run, rod) if state.pressure_kPa < stands_to),
        directions_deg=run.law.directions_deg if run.law else (),
        rod=rod,
        refusal=refusal,
        falls=run.falls,
        not_borne=tuple(map(report_reason, _not_borne(run, rod, errors))) if usable else (),
        shape_error=both.shape if both and usable else None,
        force_error=both.force if both and usable else None,
        mesh=MeshErrors() if both is None else both.mesh,
        ends_error=(both.ends or None) if both else None,
        pressures_kPa=_pressures(run, rod) if rod else None,
        moments_N_mm=_moments(run, rod) if rod else None,
        tolerances=run.remark(TOLERANCES, *CALIBRATED),
        in_time=run.remark(IN_TIME),
        layers=run.law.layers.text if run.law and run.law.layers else "",
        limit=report_reason(limit) if limit else None,
        command=_use(run, rod) if usable else _instead(run, rod, errors, both),
        failures=run.failures,
        warnings=_warnings(run, rod, both, refusal),
        errors=errors,
    )


def errors_and_notes(run: Run, verdict: Verdict, rod: str) -> tuple[RodAndMesh | None, tuple[str, ...]]:
    """The errors of a rod of a run, None where they are not known, and what limits the trust in it, a sentence each."""
    compared = next((errors for errors in verdict.errors if errors.rod == rod), None)
    taken = rod_to_take(run, verdict.errors)
    errors = rod_and_mesh(run, compared) if compared else taken[1] if taken and taken[0] == rod else None
    notes = [] if verdict.refusal is None else [verdict.refusal.text]
    if errors and errors.mesh.largest is None:
        notes.append(report_reason(unknown_mesh_error(run)).text)
    if errors and verdict.refusal is None and not errors.is_good:
        notes.append(f"The errors of this rod are large: {errors.text}.")
    if verdict.refusal is None and (uncertain := uncertain_forces(run, rod)):
        notes.append(report_reason(uncertain).text)
    return errors, tuple(notes)


def _bending(run: Run, rod: str) -> tuple[Bending, ...]:
    """By the arm's own law where that is the rod to take, because its mesh is finer; else by experiment II."""
    if rod == ARM_LAW and run.law and run.law.unloaded:
        return tuple(Bending(state.pressure_kPa, state.bending_deg, *state.tip_mm) for state in run.law.unloaded)
    if run.law and run.law.most_bent:
        row, shape = run.law.most_bent
        x, y, *z = shape.end
        return (Bending(max(row), shape.bending_deg, x, y, z[0] if z else None, row),)
    bent = (curve for curve in run.curves_of("II") if not curve.load)
    return tuple(Bending(curve.pressure_kPa, run.bending_deg(curve.pressure_kPa), *curve.tip_mm) for curve in bent)


def _refusal(run: Run, errors: tuple[RodErrors, ...], both: RodAndMesh | None) -> Reported | None:
    """Why no rod should be used: the arm leaves its plane, no fit meets it, or shape or force are too far off."""
    if told := run.remark(OUT_OF_PLANE, *NOT_CALIBRATED):
        return told
    if both is None or both.is_good:
        return None
    if isinf(both.shape):
        why = next((row.reason for row in run.errors_of(errors[0].rod) if row.reason), "")
        return report_reason(Reason("no_rod_bends", {"why": why.rstrip(".") or "it was compared under no load"}))
    values: Values = {"shape_percent": 100.0 * both.shape, "force_percent": 100.0 * (both.force or 0.0)}
    limits = {"most_shape_percent": 100.0 * LARGEST_SHAPE, "most_force_percent": 100.0 * LARGEST_FORCE}
    return report_reason(Reason("no_rod_is_near", {"errors": both.text, **values, **limits}))


def _not_borne(run: Run, rod: str, errors: tuple[RodErrors, ...]) -> Iterator[Reason]:
    """What a rod does not bear: loads that it was compared under, and its own weight."""
    if errors and errors[0].loads_without_solution:
        rows = run.errors_of(rod)
        lost = [row.location for row in rows if row.reason]
        yield Reason("loads_not_borne", {"count": len(lost), "loads": len(rows), "load": lost[0]})
    if rod == ARM_LAW and run.law and run.law.plane and (weight := weight_not_borne(run.law.plane)):
        yield weight


def _pressures(run: Run, rod: str) -> tuple[float, float] | None:
    if rod == ARM_LAW and run.law and run.law.has_rows:
        values = np.array(run.law.law.rows)
        return float(values.min()), float(values.max())
    known = run.law.pressures_kPa if rod == ARM_LAW and run.law else run.identified_kPa
    highest = max(run.reached_kPa, default=known[-1] if known else 0.0)
    return (known[0], min(known[-1], highest) if rod == ARM_LAW else known[-1]) if known else None


def _moments(run: Run, rod: str) -> tuple[float, float] | None:
    """The moments for which a rod is known at the highest pressure, N mm."""
    if rod == ARM_LAW and run.law:
        pressures = _pressures(run, rod)
        ends = [(float(c.moment[0]), float(c.moment[-1])) for c in (pressures and run.law.curves(pressures[1])) or ()]
        if not ends:
            return None
        return max(low for low, _ in ends), min(high for _, high in ends)
    return run.parameters.moment_range_N_mm[-1] if run.parameters.moment_range_N_mm else None


def _use(run: Run, rod: str) -> str:
    """The command with which the rod is used, under the load of experiment III where that is a height of the end."""
    pressures = _pressures(run, rod)
    pressure = f" --pressure '{round_down(pressures[1], 4):g} kPa'" if pressures else ""
    if rod == ARM_LAW and run.law and run.law.has_rows:
        row = max(run.law.law.rows, key=max)
        pressure = f" --pressure '[{', '.join(f'{value:g} kPa' for value in row)}]'"
    return f"For example: pneurod rod {shlex.quote(str(run.directory))}{pressure}{_load(run, pressures)}"


def _load(run: Run, pressures: tuple[float, float] | None) -> str:
    """The load of experiment III as options, where it holds a height of the end; else a small force."""
    held = run.curve("III", pressures[1]) if pressures else None
    if held is None or run.held_mm is None:
        return " --force '[0 N, 0.01 N]'"
    return f" --end-y '{round(held.tip_mm[1], 6) + 0.0:g} mm'"


def _instead(run: Run, rod: str, errors: tuple[RodErrors, ...], both: RodAndMesh | None) -> str:
    """What to do where no rod can be used."""
    alone = [replace(both, shape=one.shape, force=one.force) for one in errors[:1] if both]
    if both and not both.is_good and all(one.is_good for one in alone):
        if rod == ARM_LAW:
            return "" if run.is_accurate else "Next: repeat the run with --accuracy 1% and another --out."
        if run.mesh is None or run.mesh.from_file:
            return "Next: run the body with a finer mesh."
        finer = f"--set mesh.size='{FINER * run.mesh.size_mm:.2g} mm'"
        return f"Next: mesh.size was {run.mesh.size_mm:g} mm; repeat the run with {finer} and another --out."
    if run.failures and not run.falls:
        return "Next: give lower pressures, or change walls or material, in another --out."
    return ""


def _warnings(run: Run, rod: str, both: RodAndMesh | None, refusal: Reported | None) -> tuple[Reported, ...]:
    """The most important remarks on the run and on its rod; none on five parameters where another rod is taken."""
    of_rod = []
    if both and both.mesh.largest is None and not (run.law and run.law.has_rows):
        of_rod.append(unknown_mesh_error(run))
    if rod and refusal is None:
        of_rod += filter(None, [uncertain_forces(run, rod)])
    if rod == FIVE:
        of_rod.append(Reason("offsets_bend"))
    said = {TOLERANCES, *CALIBRATED, IN_TIME} | {
        one.code for one in (*run.failures, *filter(None, [refusal, run.falls]))
    }
    said |= (OF_FIVE if rod == ARM_LAW else set()) | ({"hardly_bent"} if run.falls else set())
    shown = [remark for remark in run.remarks if remark.code not in said]
    ranked = sorted(shown, key=lambda remark: RANKS.index(remark.code) if remark.code in RANKS else len(RANKS))
    known = [remark for remark in ranked if remark.code in RANKS]
    return tuple([*known, *map(report_reason, of_rod), *ranked[len(known) :]][:MOST_WARNINGS])


def _shorten(failure: Reported) -> str:
    """The sentence of a failure with what names a limit alone, or else with the first of its reasons."""
    why = failure.values.get("why")
    if not isinstance(why, list):
        return failure.text
    reasons = [Reason(**row) for row in why]
    named = [reason for reason in reasons if reason.code in NAMES_A_LIMIT] or reasons[:1]
    return report_reason(Reason(failure.code, {**failure.values, "why": named}, failure.where)).text
