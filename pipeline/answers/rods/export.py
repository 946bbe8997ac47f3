"""The rod of a result folder in the files of other programs, and the error of these against its finite elements."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.answers.rods.choice import check_kind, choose_rod, plane_of, run_along
from pipeline.answers.rods.in_time import is_given, rubber_of
from pipeline.answers.rods.solid import solid_of
from pipeline.config import units
from pipeline.config.material import LOSS_FACTOR
from pipeline.config.validation import SMALL_FORCES
from pipeline.results.files import LAW_ON_MESH_OF_ARM, read_plane_law, read_run
from pipeline.results.options import option_value
from pipeline.store.result_folder import open_folder
from pipeline.values.errors import InputError, argument
from pipeline.values.formats import BODY
from pipeline.values.parameters import RodParameters
from pipeline.values.run import Curve, Run
from rod import EXPORTS, Arm, ArmLaw, Load, Robot, RodError, export_robot
from rod.arm_law.space_law import SpaceLaw
from rod.export.arm import divide_pressures
from rod.export.formats import PROGRAMS, export_files, with_beside
from rod.export.tables import write_csv, write_json, write_law_csv, write_law_json
from rod.pressurised_rod import IDENTIFIED
from rod.same_pressure import as_known


@dataclass(frozen=True)
class ExportOptions:
    """What `pneurod export` was asked for beside the folder and the format."""

    pressure: str | None = None  #: with its unit; None for all pressures
    rod: str | None = None  #: one of KINDS of `choice`; None for the one to take
    out: Path | None = None  #: folder of the files; None for the result folder
    force: bool = False  #: replace files that exist
    ratio: str | None = None  #: of the pressures of a law that has several

    @property
    def pressure_kPa(self) -> float | None:
        """Raises InputError where it has no unit."""
        return None if self.pressure is None else option_value("pressure", self.pressure, units.PRESSURE)


@dataclass(frozen=True)
class Exported:
    """What an export left."""

    files: tuple[Path, ...]
    sentences: tuple[str, ...]  #: the error of the files, and what they leave out

    @property
    def lines(self) -> tuple[str, ...]:
        """The names of the files, and the sentences."""
        return *(f"written: {file}" for file in self.files), *self.sentences


def exported(folder: Path, target: str | None, options: ExportOptions) -> Exported:
    """Write the rod of a result folder for another program. Raises InputError as `exported_run` does."""
    named = _known(target, options)
    if folder.is_file():
        raise InputError(f"{folder}: is a file; give the folder of the run, {folder.parent}")
    run = read_run(folder)
    is_whole = options.ratio is None and run.law is not None and not run.law.law.has_plane
    return exported_run(run if is_whole else run_along(folder, options.ratio), named, options)


def exported_run(run: Run, target: str | None, options: ExportOptions) -> Exported:
    """Write the rod of a run for another program, into the folder of the run by default.

    Raises InputError for an unknown target, which it answers with the known ones, for other options that do not fit,
    for a target that cannot take the rod, and for files that exist or a folder that cannot be written.
    """
    target = _known(target, options)
    try:
        if run.law is not None and isinstance(run.law.law, SpaceLaw) and target == "mujoco":
            return _in_space(run, run.law.law, options)
        law = None if run.law is None or options.rod == "five" else plane_of(run, argument("to", target))
        if law is not None and not (run.directory / "run.json").is_file():  # a law alone
            return _of_law(law, None, run.directory, target, options)
        chosen = choose_rod(run, options.rod)
        if chosen.law.plane is not None:
            done = _of_law(chosen.forms or chosen.law.plane, run, run.directory, target, options)
        else:
            done = _of_five(run, target, options)
        return replace(done, sentences=(*done.sentences, *chosen.notes))
    except RodError as failure:
        raise InputError(f"{argument('to', target)}: {failure}") from None


def _known(target: str | None, options: ExportOptions) -> str:
    """The target. Raises InputError for an unknown one and an unknown rod."""
    if target is None or target not in EXPORTS:
        raise InputError(f"{argument('to', target)}: allowed are {', '.join(EXPORTS)}")
    check_kind(options.rod, "rod")
    return target


def _without_weight(law: ArmLaw) -> ArmLaw:
    """The law of an arm that bears no weight."""
    return replace(law, weight=(0.0, 0.0))


def _of_law(law: ArmLaw, run: Run | None, folder: Path, target: str, options: ExportOptions) -> Exported:
    """The rod with the arm's own law; run: None where the folder has nothing else."""
    solid, light = None if run is None else solid_of(run), _without_weight(law)
    is_alone = run is None or (run.parameters.solid_volume_mm3 is None and not (folder / BODY).is_file())
    if is_alone and target in PROGRAMS:
        raise InputError(f"{folder}: has a law and no body, which {target} needs; give the folder of `pneurod run`")
    is_linear = target in PROGRAMS and PROGRAMS[target].is_linear
    all_pressures = run.given_between(law.pressures[0], law.pressures[-1]) if run and is_linear else ()
    single = options.pressure_kPa
    pressures = tuple(all_pressures or law.pressures) if single is None else (as_known(law.pressures, single),)
    make = Robot.linear_of_law if is_linear else Robot.of_law
    robot, told = _damped(make(light, solid, pressures), run), filter(None, [law.told_at(pressures[-1])])
    written, solid = robot, robot.solid
    if target in PROGRAMS and PROGRAMS[target].has_shear:  # of its own, which the hinges must not have as well
        written = Robot.of_law(light, solid, pressures, has_shear=False)
    writers: dict[str, Callable[[Path], None]] = {
        "csv": lambda path: write_law_csv(light, pressures, path),
        "json": lambda path: write_law_json(light, robot, path),
    }
    files = _write(written, target, options, writers, (options.out or folder) / f"law_{robot.label}.{target}")
    if target == "csv":
        return Exported(files, ("The table has the law of the cells; json has both ends of the arm, too.", *told))
    compared = robot
    if run is not None and (run.directory / LAW_ON_MESH_OF_ARM).is_file():  # as the finite elements of the run
        on_mesh = _without_weight(read_plane_law(run.directory / LAW_ON_MESH_OF_ARM))
        compared = make(on_mesh, solid, pressures if is_linear or single is not None else on_mesh.pressures)
    return Exported(files, (*told, *_sentences(compared, target, run, law)))


def _in_space(run: Run, law: SpaceLaw, options: ExportOptions) -> Exported:
    """The rod with a law in space for MuJoCo, at all of its pressures."""
    if options.pressure is not None or options.rod == "five":
        given = argument("rod", "five") if options.rod == "five" else argument("pressure", options.pressure)
        raise InputError(f"{given}: the file has the arm's own law at every pressure; leave it out")
    files = _write(Robot.of_space(law, solid_of(run)), "mujoco", options, {}, (options.out or run.directory) / "rod")
    taken = f"set_pressure takes those of {', '.join(law.cavities)} in kPa."
    return Exported(files, (taken, "Springs are straight: those of the rod without a load at the pressures."))


def _of_five(run: Run, target: str, options: ExportOptions) -> Exported:
    """The inextensible rod with five parameters."""
    parameters, solid = run.parameters, solid_of(run)
    arm, finer = _arm(parameters, options), None
    if target in PROGRAMS and not PROGRAMS[target].is_linear and len(arm.pressures) > 1:
        more = divide_pressures(arm.pressures)
        finer = Arm(more, tuple(map(parameters.rods().at, more)))
    robot = _damped(Robot.of_five(arm, solid, finer), run)
    writers: dict[str, Callable[[Path], None]] = {
        "csv": lambda path: write_csv(arm, path),
        "json": lambda path: write_json(arm, parameters.mass_g, path),
    }
    files = _write(robot, target, options, writers, (options.out or run.directory) / f"rod_{robot.label}.{target}")
    sentences = [] if arm.origin == IDENTIFIED else [f"The numbers at {options.pressure} are {arm.origin}."]
    if not parameters.straight_without_pressure:
        below = ", nor a pressure below those of the file, where its arm becomes straight"
        below = below if finer else ""
        sentences.append(
            "kappa_0 contains what bends the arm besides the pressure of the run (its weight, a constant pressure in a "
            f"cavity): do not apply that once more in the other program{below}."
        )
    if any(parameters.weight_N_per_mm):
        sentences.append(
            "The exported rod keeps the moments that its weight has without load; how they change when a load moves it "
            "is left out (pneurod rod has it)."
        )
    if target in PROGRAMS:
        return Exported(files, (*sentences, *_sentences(robot, target, run, None)))
    return Exported(files, tuple(sentences))


def _damped(robot: Robot, run: Run | None) -> Robot:
    """The same with the loss factor of its rubber at the first vibration, where the material describes that."""
    if run is None or robot.solid is None or not is_given(run.material):
        return robot
    first = float(robot.first_rates.mean()) / (2.0 * math.pi)
    rubber, _ = rubber_of(run.material, lambda: first)
    return replace(robot, solid=replace(robot.solid, loss_factor=float(rubber.loss_factor(first))))


def _sentences(robot: Robot, target: str, run: Run | None, law: ArmLaw | None) -> tuple[str, ...]:
    """The error of the files of a robot, and the damping in them."""
    if run is None:
        return ()
    sentences = [judged(robot, run, law)]
    if law is not None and any(law.weight):
        sentences.append("The file has no weight, other than the run: let gravity act in the other program.")
    if target in ("mujoco", "pyelastica"):
        loss_factor = robot.body.loss_factor
        default = " (the default of material.loss_factor)" if loss_factor == LOSS_FACTOR else ""
        sentences.append(f"Damping: loss factor {loss_factor:.4g}{default} at the first vibration of the arm.")
        if is_given(run.material):
            more = "more" if target == "mujoco" else "less"
            sentences.append(
                f"Higher vibrations lose {more} there than the rubber; `pneurod move` has it at all of them."
            )
    return tuple(sentences)


def _write(
    robot: Robot, target: str, options: ExportOptions, tables: Mapping[str, Callable[[Path], None]], table: Path
) -> tuple[Path, ...]:
    """Write the file of a table, or those of a program into its folder. Refuses files that exist."""
    if target in tables:
        files = [table]
    else:
        _ = robot.body  # refuses an arm without mass
        files = with_beside(list(export_files(robot, target, table.parent)), target)
    for path in files:
        if path.exists() and not options.force:
            raise InputError(
                f"{path}: exists; give another {argument('out')}, or {argument('force', True)} to replace it"
            )
    open_folder(table.parent)
    if target in tables:
        tables[target](table)
    else:
        export_robot(robot, target, table.parent)
    return tuple(files)


def _arm(parameters: RodParameters, options: ExportOptions) -> Arm:
    """The rods with five parameters at the pressures that are written."""
    rods, single = parameters.rods(), options.pressure_kPa
    if single is None:
        pressures = parameters.pressures_kPa
        return Arm(pressures, tuple(map(rods.at, pressures)), deviations=parameters.deviations_at(pressures))
    pressure, given = as_known(rods.pressures, single), argument("pressure", options.pressure)
    if pressure <= 0.0:
        raise InputError(f"{given}: is not exported; give one above 0 kPa, at which the arm is at rest")
    try:
        selected = rods.at(single)
    except RodError as failure:
        raise InputError(f"{given}: {failure}") from None
    return Arm((pressure,), (selected,), rods.origin_at(pressure), parameters.deviations_at((pressure,)))


@dataclass(frozen=True)
class Reference:
    """A state of the finite elements."""

    pressure_kPa: float
    force: tuple[float, float]  #: N, dead, on the end
    curve: Curve

    def points(self, s: Array) -> Array:
        """(m, 2) mm: the material curve at rest arc lengths s (m,), from its clamped end."""
        at = self.curve["s_mm"] - self.curve["s_mm"][0]
        columns = (self.curve[name] - self.curve[name][0] for name in ("x_mm", "y_mm"))
        return np.column_stack([np.interp(s, at, column) for column in columns])

    @property
    def load(self) -> str:
        """The load in words."""
        return f"{self.force[0]:g}, {self.force[1]:g} N" if any(self.force) else "free"


def references(run: Run) -> Iterator[Reference]:
    """The states of a run without load and under dead forces."""
    for curve in (*run.curves_of("II"), *run.validation_curves):
        if curve.force_N or curve.experiment == "II":
            yield Reference(curve.pressure_kPa, curve.force_N or (0.0, 0.0), curve)


def distance(points: Array, s: Array, reference: Reference, length: float) -> float:
    """The largest distance of points (m, 2) in mm at rest arc lengths s (m,) from a reference, over the length."""
    return float(np.hypot(*(points - reference.points(s)).T).max() / length)


def judged(robot: Robot, run: Run, law: ArmLaw | None) -> str:
    """How far the arm of a file is from the finite elements of its run at most, in words.

    law: that of the arm, with which the file is compared under dead forces where the run has none.
    """
    states = [state for state in references(run) if robot.has(state.pressure_kPa)]
    try:
        found = [_error(robot, state, (0.0, 0.0) if law is None else law.weight) for state in states]
        forces = [math.hypot(*state.force) for state in states if any(state.force)]
        if law is None or forces:
            return _sentence(found, states)
        without = "The run has no dead forces at these pressures. " if states else ""
        return f"{_sentence(found, states)} {without}{_against_rod(robot, law)}"
    except RodError as failure:
        return f"The error of the file is not known: {failure}"


def _error(robot: Robot, state: Reference, weight: tuple[float, float]) -> float:
    chain = robot.at(state.pressure_kPa)
    return distance(chain.curve(chain.solve(state.force, weight, _height(robot))), chain.s, state, robot.length)


def _height(robot: Robot) -> float:
    """mm, of the centre of mass above the material curve."""
    return 0.0 if robot.solid is None else robot.solid.section.centre


def _sentence(found: Sequence[float], states: Sequence[Reference]) -> str:
    if not found:
        return "The error of the file is not known: the run has no finite elements at its pressures."
    worst = states[int(np.argmax(found))]
    largest = max(math.hypot(*state.force) for state in states)
    under = f"free and under dead forces up to {largest:g} N" if largest else "free"
    return (
        f"Error of the file: {100 * max(found):.2g} % of the length at most, against the finite elements of the run "
        f"({under}), at {worst.pressure_kPa:g} kPa, {worst.load}."
    )


def _against_rod(robot: Robot, law: ArmLaw) -> str:
    """The largest distance from the rod itself under dead forces across the end that are small."""
    worst = 0.0
    for pressure in robot.known:
        chain, rod = robot.at(pressure), law.at(pressure)
        for part in (sign * part for part in SMALL_FORCES for sign in (1.0, -1.0)):
            force = (0.0, part * chain.rigidity / robot.length**2)
            turn = chain.solve(force, law.weight, _height(robot))
            apart = chain.curve(turn) - rod.under(Load(force)).positions(chain.s)
            worst = max(worst, float(np.hypot(*apart.T).max()) / robot.length)
    return (
        "Under small tip forces (EI/50l², EI/10l²) the file deviates from its rod by at most "
        f"{100 * worst:.2g} % of the length."
    )
