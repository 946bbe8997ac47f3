"""Study of effects, a sweep over `effects.*`: what each one changes in the numbers of the rod, and what it costs."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from fem.elements import ELEMENTS
from pipeline.config.config import Config
from pipeline.config.effects import EFFECTS, HOOPS, LAYER, State
from pipeline.config.section import TypeAdapter
from pipeline.simulate.scene import GAP, Scene, faces_of
from pipeline.simulate.too_short import why_too_short
from pipeline.store.progress import Progress
from pipeline.store.result_folder import ResultFolder
from pipeline.study.effects.rows import BASE, EffectRow, compared
from pipeline.study.sweep.points import Point, PointResult
from pipeline.study.sweep.spec import VARIANT
from pipeline.study.sweep.study import Course, PointSet, solve_points
from pipeline.study.sweep.workers import LocalWorkers
from pipeline.values.reasons import render

TABLE = "effects_table.json"


@dataclass(frozen=True)
class EffectsTable:
    """One row per variant and pressure, as in effects_table.json."""

    directory: Path
    rows: list[EffectRow]

    @property
    def failures(self) -> list[str]:
        """A sentence for every reason why numbers are missing."""
        sentences = (f"{row.variant}: {row.reason}" for row in self.rows if row.reason)
        return list(dict.fromkeys(sentences))


def compare_effects(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> EffectsTable:
    """Run II and III with each effect on and off; `out`/effects_table.json has one row per variant and pressure.

    A variant that cannot be solved has its reason there. Raises InputError for a body that cannot be meshed or a folder
    that cannot be used.
    """
    points = variants(Scene.meshed(config), out)
    if reason := why_too_short(config):
        progress.remark(f"{render(reason)}; curvature, force and end are compared without them")
    if keys := _without_density(config):
        example = f"give {' and '.join(keys)}, for example 1130 kg/m^3"
        progress.remark(f"gravity is not varied: no density is given; {example}")

    def save(folder: ResultFolder, solved: Sequence[PointResult], _: bool) -> None:
        ended = [one for one in solved if one.rows or one.reason]
        folder.save_json(TABLE, [*map(asdict, _rows(config, ended))])

    identity = {"name": f"effects of {config.name}", "config_hash": config.hash}
    own = PointSet(out, identity, points, save)
    course = Course(LocalWorkers.of(jobs), fresh, progress.stage)
    return EffectsTable(out, _rows(config, solve_points([own], course)[0]))


def _rows(config: Config, solved: Sequence[PointResult]) -> list[EffectRow]:
    """The rows of the table; without numbers where a variant could not be solved."""
    rows = [
        {"effect": one.values["effect"], "state": one.values["state"], **row}
        for one in solved
        for row in one.rows or [{"pressure_kPa": p, "reason": one.reason} for p in config.pressures_kPa]
    ]
    return compared(TypeAdapter(list[EffectRow]).validate_python(rows))


def _without_density(config: Config) -> list[str]:
    """The keys of the densities that gravity lacks."""
    laws = {"material": config.material, **{f"materials.{name}": law for name, law in config.materials.items()}}
    lacking = [f"{key}.density" for key, law in laws.items() if law.density_tonne_mm3 is None]
    return lacking if config.mass_tonne is None else []


def variants(scene: Scene, out: Path) -> list[Point]:
    """The configuration, and those that differ from it in one effect, in folders below `out`.

    Pressure is not varied: without it the arm does not bend. Contact is left out where no faces can meet, the half body
    where the body is whole, layer and hoops where the mesh has no faces for them, gravity where a density is missing.
    Linear elements cannot treat incompressibility and are replaced by quadratic ones.
    """
    config, body, effects = scene.config, scene.body, scene.config.effects
    flipped: dict[str, State] = {
        "incompressibility": "on" if ELEMENTS[config.mesh.formulation].fully_integrated else "off",
    }
    flipped |= {name: "off" if requested.on else "on" for name, requested in effects.requested.items()}
    if effects.self_contact.faces or GAP in body.mesh.faces:
        flipped["self_contact"] = "auto" if effects.self_contact.off else "off"
    if body.half or effects.symmetry.off:
        flipped["symmetry"] = "off" if body.half else "auto"
    for name in (LAYER, HOOPS):
        if not len(faces_of(body, config, name)):
            del flipped[name]
    if _without_density(config):
        del flipped["gravity"]
    run, out = (VARIANT,), out.resolve()
    points = [Point(1, {"effect": BASE, "state": ""}, config, run, out)]
    for number, name in enumerate(sorted(flipped, key=EFFECTS.index), start=2):
        state = flipped[name]
        setting = {"effect": name, "state": "on" if state == "auto" else state}
        points.append(Point(number, setting, config.with_effect(name, state), run, out))
    return points
