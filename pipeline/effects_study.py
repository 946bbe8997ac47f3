"""Study of effects: each effect on and off, what it changes in the numbers of the rod, and what it costs."""

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from fem.elements import ELEMENTS
from pipeline.config.config import Config
from pipeline.config.effects import EFFECTS, State
from pipeline.context import RunContext, run_context
from pipeline.effects_rows import BASE, EffectRow, Variant, VariantResult, effect_rows
from pipeline.errors import InputError, RunFailed, WorkerLost
from pipeline.identification.too_short import why_too_short
from pipeline.parallel.loading import loaded
from pipeline.progress import Progress
from pipeline.simulation.scene import GAP, Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.store import Store, clear, locked, open_store
from pipeline.study import Study


@dataclass(frozen=True)
class EffectsTable:
    """The results of the variants so far, also in effects_table.json."""

    store: Store
    results: list[tuple[Variant, VariantResult]] = field(default_factory=list)

    def read(self, variant: Variant) -> VariantResult | None:
        """None: what is kept of earlier runs are the states, from which results are made anew."""
        return None

    def save(self, variant: Variant, result: VariantResult) -> None:
        """Add a variant and write the table."""
        self.results.append((variant, result))
        self.store.save_json("effects_table.json", [row.record() for row in self.rows])

    @property
    def rows(self) -> list[EffectRow]:
        """One row per variant and pressure."""
        return effect_rows(self.results)

    @property
    def failures(self) -> list[str]:
        """A sentence for every reason why numbers are missing."""
        sentences = (f"{variant.name}: {why}" for variant, result in self.results for why in result.reasons.values())
        return list(dict.fromkeys(sentences))


def compare_effects(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> EffectsTable:
    """Run II and III with each effect on and off; `out`/effects_table.json has one row per variant and pressure.

    A variant that cannot be solved has its reason there. Raises InputError for a body that cannot be meshed or a folder
    that cannot be used, and WorkerLost.
    """
    with open_store(out, config, fresh=fresh) as store:
        if fresh:
            _clear_variants(out)

        def measure(variant: Variant) -> VariantResult:
            progress.stage(variant.name)
            if variant.effect == BASE:
                with run_context(store, jobs, progress) as context:
                    return _measure(variant, context)
            with open_store(out / variant.folder, variant.config) as own, run_context(own, jobs, progress) as context:
                return _measure(variant, context)

        scene = Scene.meshed(config)
        for sentence in filter(None, (_fewer_numbers(config), _without_density(config))):
            progress.remark(sentence)
        table = EffectsTable(store)
        list(Study(variants(scene), measure, table).run())
    return table


def _clear_variants(out: Path) -> None:
    """Remove what an earlier study left in the folders of its variants."""
    for folder in (out / f"{effect}_{state}" for effect in EFFECTS for state in ("on", "off")):
        if folder.is_dir():
            with locked(folder):
                clear(folder)
            with suppress(OSError):  # other files are in it
                folder.rmdir()


def _fewer_numbers(config: Config) -> str:
    """That there will be no five parameters; empty where there may be."""
    reason = why_too_short(config)
    return f"{reason}; curvature, force and end are compared without them" if reason else ""


def _without_density(config: Config) -> str:
    """Why gravity is not varied; empty where it is."""
    if config.mass_tonne is not None:
        return ""
    laws = {"material": config.material, **{f"materials.{name}": law for name, law in config.materials.items()}}
    keys = [f"{key}.density" for key, law in laws.items() if law.density_tonne_mm3 is None]
    return f"gravity is not varied: no density is given; give {' and '.join(keys)}, for example 1130 kg/m^3"


def variants(scene: Scene) -> list[Variant]:
    """The configuration, and those that differ from it in one effect.

    Pressure is not varied: without it the arm does not bend. Contact is left out where no faces can meet, the half body
    where the body is whole, the layer where the mesh has no faces for it, gravity where a density is missing. Linear
    elements cannot treat incompressibility and are replaced by quadratic ones.
    """
    config, body, effects = scene.config, scene.body, scene.config.effects
    flipped: dict[str, State] = {
        "incompressibility": "on" if ELEMENTS[config.mesh.formulation].fully_integrated else "off",
    }
    for name, effect in effects.requested.items():
        flipped[name] = "off" if effect.on else "on"
    if effects.self_contact.faces or GAP in body.mesh.faces:
        flipped["self_contact"] = "auto" if effects.self_contact.off else "off"
    if body.half or effects.symmetry.off:
        flipped["symmetry"] = "off" if body.half else "auto"
    if not len(body.mesh.plane(1, body.curve_y)):
        del flipped["strain_limiting_layer"]
    if _without_density(config):
        del flipped["gravity"]
    changed = [
        Variant(effect, {"auto": "on"}.get(state, state), config.with_effect(effect, state))
        for effect, state in flipped.items()
    ]
    return [Variant(BASE, "", config), *sorted(changed, key=lambda variant: EFFECTS.index(variant.effect))]


def _measure(variant: Variant, context: RunContext) -> VariantResult:
    """The result of a variant; one that cannot be solved is a result with its reason. Raises WorkerLost."""
    config = variant.config
    try:
        loading = loaded(context, config)
        scene = Scene.meshed(config)
        for pending in loading:
            pending.result()
        return VariantResult.of(scene, simulate(scene, context, ("III", "II")))
    except WorkerLost:
        raise
    except (InputError, RunFailed) as failure:
        return VariantResult.none(config, str(failure))
