"""Study of effects: each effect on and off, what it changes in the numbers of the rod, and what it costs."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from fem.elements import ELEMENTS
from pipeline.config.config import Config
from pipeline.config.effects import State
from pipeline.config.schema import EFFECTS
from pipeline.context import RunContext, run_context
from pipeline.identification.parameters import Parameters, identify_all
from pipeline.progress import Progress
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import GAP, Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.json_values import JsonObject
from pipeline.store.store import Store, open_store
from pipeline.study import Study

BASE = "as configured"
#: number of a row -> title of its column
COLUMNS = {
    "kappa_0_middle_per_mm": "κ₀(l/2) 1/mm",
    "alpha1_N_mm2": "α₁ N mm²",
    "alpha2_N_mm2": "α₂ N mm²",
    "d_mm": "d mm",
    "end_force_N": "F N",
}


@dataclass(frozen=True)
class Variant:
    """A configuration and the effect that was changed in it."""

    effect: str  #: BASE, or the effect that was changed
    state: str  #: what it was changed to; empty for BASE
    config: Config

    @property
    def name(self) -> str:
        """self_contact off"""
        return f"{self.effect} {self.state}".strip()

    @property
    def folder(self) -> str:
        """Folder of its states, relative to that of the study; the configuration itself is solved in the latter."""
        return f"{self.effect}_{self.state}" if self.state else "."


@dataclass(frozen=True)
class VariantNumbers:
    """The numbers of the rod at one pressure."""

    pressure_kPa: float
    kappa_0_middle_per_mm: float
    end_force_N: float  #: y component in III
    end_y_II_mm: float
    alpha1_N_mm2: float
    alpha2_N_mm2: float
    d_mm: float | None  #: None where a single line suffices, which has no break
    single_line_suffices: bool
    r2_single_line: float
    r2_two_lines: float
    stretch_of_curve: tuple[float, float]  #: in II and III

    @staticmethod
    def of(parameters: Parameters) -> "VariantNumbers":
        """From the parameters at one pressure."""
        free, loaded, lines = parameters.free, parameters.loaded, parameters.by_cells
        numbers = {name: interval.value for name, interval in parameters.numbers.items()}
        return VariantNumbers(
            pressure_kPa=parameters.pressure_kPa,
            kappa_0_middle_per_mm=parameters.kappa_0_middle,
            end_force_N=loaded.load.force[1],
            end_y_II_mm=free.summary.end_mm[1],
            alpha1_N_mm2=numbers["alpha1"],
            alpha2_N_mm2=numbers["alpha2"],
            d_mm=numbers["d"] if parameters.two_lines else None,
            single_line_suffices=not parameters.two_lines,
            r2_single_line=lines.single_line.r2,
            r2_two_lines=lines.r2,
            stretch_of_curve=(free.centreline.stretch, loaded.centreline.stretch),
        )


@dataclass(frozen=True)
class VariantCost:
    """Cost of II and III over all pressures."""

    seconds: float
    factorizations: int
    degrees_of_freedom: int

    @staticmethod
    def of(outcomes: Outcomes) -> "VariantCost":
        """From the experiments."""
        return VariantCost(outcomes.seconds.total, outcomes.factorizations, outcomes.degrees_of_freedom)


@dataclass(frozen=True)
class VariantResult:
    """What one variant gives."""

    numbers: tuple[VariantNumbers, ...]  #: by pressure
    cost: VariantCost
    failures: tuple[str, ...]  #: a sentence for every pressure that was not reached


@dataclass(frozen=True)
class EffectRow:
    """One variant at one pressure, and its relative changes against the configuration at the same pressure."""

    effect: str
    state: str
    numbers: VariantNumbers
    cost: VariantCost
    relative_change: dict[str, float | None]  #: by the names of `COLUMNS`; None where a number is missing

    def record(self) -> JsonObject:
        """As in effects_table.json."""
        return {
            "effect": self.effect,
            "state": self.state,
            **asdict(self.numbers),
            **asdict(self.cost),
            "relative_change": self.relative_change,
        }


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
        base = {
            numbers.pressure_kPa: numbers
            for variant, result in self.results
            if variant.effect == BASE
            for numbers in result.numbers
        }
        return [
            EffectRow(
                variant.effect, variant.state, numbers, result.cost, _changes(numbers, base.get(numbers.pressure_kPa))
            )
            for variant, result in self.results
            for numbers in result.numbers
        ]

    @property
    def failures(self) -> list[str]:
        """A sentence for every pressure that was not reached."""
        return [f"{variant.name}: {sentence}" for variant, result in self.results for sentence in result.failures]


def compare_effects(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> EffectsTable:
    """Run II and III with each effect on and off; `out`/effects_table.json has one row per variant and pressure.

    Raises InputError for a body that cannot be meshed or a folder that cannot be used.
    """
    with open_store(out, config, fresh=fresh) as store:

        def measure(variant: Variant) -> VariantResult:
            progress.stage(variant.name)
            if variant.effect == BASE:
                with run_context(store, jobs, progress) as context:
                    return _measure(variant, context)
            folder = out / variant.folder
            with open_store(folder, variant.config, fresh=fresh) as own, run_context(own, jobs, progress) as context:
                return _measure(variant, context)

        table = EffectsTable(store)
        list(Study(variants(Scene.meshed(config)), measure, table).run())
    return table


def variants(scene: Scene) -> list[Variant]:
    """The configuration, and those that differ from it in one effect.

    Pressure is not varied: without it the arm does not bend. Contact is left out where no faces can meet, the half body
    where the body is whole, the layer where the mesh has no faces for it. Linear elements cannot treat
    incompressibility and are replaced by quadratic ones.
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
    changed = [
        Variant(effect, {"auto": "on"}.get(state, state), config.with_effect(effect, state))
        for effect, state in flipped.items()
    ]
    return [Variant(BASE, "", config), *sorted(changed, key=lambda variant: EFFECTS.index(variant.effect))]


def _measure(variant: Variant, context: RunContext) -> VariantResult:
    scene = Scene.meshed(variant.config)
    outcomes = simulate(scene, context, ("III", "II"))
    # by the criterion alone: whether two lines need contact is what this study shows
    d = scene.config.identification.d_mm
    parameters, failures = identify_all(outcomes, scene.body.pitch, d, equal_cells=False)
    numbers = tuple(VariantNumbers.of(at_pressure) for at_pressure in parameters)
    return VariantResult(numbers, VariantCost.of(outcomes), (*outcomes.failures, *failures))


def _changes(numbers: VariantNumbers, base: VariantNumbers | None) -> dict[str, float | None]:
    return {name: _change(getattr(numbers, name), getattr(base, name) if base else None) for name in COLUMNS}


def _change(value: float | None, reference: float | None) -> float | None:
    return value / reference - 1.0 if value is not None and reference else None


def contact_sentences(rows: Sequence[EffectRow]) -> list[str]:
    """Whether the two slopes are caused by chambers in contact, one sentence per pressure; none without both cases."""
    by_state: dict[float, dict[str, VariantNumbers]] = {}
    for row in rows:
        if row.effect in (BASE, "self_contact"):
            by_state.setdefault(row.numbers.pressure_kPa, {})[row.state] = row.numbers
    return [
        f"{pressure:g} kPa: with contact {_slopes(states.get('on', states['']))}; "
        f"without contact {_slopes(states.get('off', states['']))}"
        for pressure, states in by_state.items()
        if len(states) == 2
    ]


def _slopes(numbers: VariantNumbers) -> str:
    if numbers.d_mm is None:
        return f"a single line suffices, alpha = {numbers.alpha1_N_mm2:.4g} N mm2"
    slopes = f"alpha1 = {numbers.alpha1_N_mm2:.4g}, alpha2 = {numbers.alpha2_N_mm2:.4g} N mm2"
    return f"{slopes}, d = {numbers.d_mm:.3g} mm"
