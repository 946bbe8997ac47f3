"""Which effects took part in a run, and why."""

from math import isfinite

from fem.elements import ELEMENTS
from pipeline.config.config import Config
from pipeline.config.effects import CavityPressure
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.values.run import Effect


def list_effects(scene: Scene, outcomes: Outcomes) -> tuple[Effect, ...]:
    """Every effect with its state in a run and the reason for it."""
    config = scene.config
    states = {
        "pressure": _pressure(config),
        "self_contact": _contact(config, outcomes),
        "symmetry": _symmetry(scene),
        "incompressibility": _incompressibility(config),
        **{name: ("on" if effect.on else "off", effect.reason) for name, effect in config.effects.requested.items()},
    }
    timeless = ("symmetry", "incompressibility")
    return tuple(
        Effect(effect, state, reason, None if effect in timeless else _fraction_of_time(effect, outcomes))
        for effect, (state, reason) in states.items()
    )


def _fraction_of_time(effect: str, outcomes: Outcomes) -> float:
    seconds = outcomes.seconds
    return seconds.effects.get(effect, 0.0) / seconds.total if seconds.total > 0 else 0.0


def _pressure(config: Config) -> tuple[str, str]:
    if config.effects.pressure.off:
        return "off", "switched off in the config"
    parts = [f"{name} {_inside(pressure)}" for name, pressure in config.effects.pressure.cavities.items()]
    reason = f"the pressure follows the walls; {', '.join(parts)}"
    if config.design.is_open_at_clamp:
        reason += (
            "; the clamp carries the pressure on the inlet (plug), and experiment I, without a clamp, is not simulated"
        )
    for name, depth in config.design.plug_depths.items():
        reason += f"; inlet (plug.{name}) filled with the material of the body to a depth of {depth:.3g} mm"
    return "on", reason


def _inside(pressure: CavityPressure) -> str:
    if pressure.constant_kPa:
        return f"at {pressure.constant_kPa:g} kPa throughout the run"
    if pressure.fraction == 1.0:
        return "at the pressure of the run"
    return f"at {pressure.fraction:g} times the pressure of the run" if pressure.fraction else "without pressure"


def _contact(config: Config, outcomes: Outcomes) -> tuple[str, str]:
    state = config.effects.self_contact.state
    if state == "off":
        return "off", "switched off in the config"
    if state == "on":
        return "on", "switched on in the config"
    touched = [
        f"{outcome.name} from {min(first):g} kPa"
        for outcome in outcomes
        if (first := [record.pressure_kPa for record in outcome.records if "self_contact" in record.effects])
    ]
    if touched:
        return "on", f"walls came within the activation distance of contact: {', '.join(touched)}"
    if not outcomes.records:
        return "on", "no pressure was reached; on the way contact acts on walls that come near each other"
    gaps = [gap for record in outcomes.records if isfinite(gap := record.state.min_gap_mm)]
    smallest = f"the smallest gap was {min(gaps):.2g} mm" if gaps else "no walls face each other"
    return "off", f"no walls came within the activation distance of contact; {smallest}"


def _symmetry(scene: Scene) -> tuple[str, str]:
    if scene.body.half:
        return "on", "body, pressure and loads are mirror images about z = 0: half of it is solved"
    if scene.config.effects.symmetry.off:
        return "off", "switched off in the config: the full body is solved"
    if scene.config.effects.gravity.breaks_symmetry:
        return "off", "gravity acts across the plane z = 0: the full body is solved"
    return "off", "the body is not known to be symmetric about z = 0: the full body is solved"


def _incompressibility(config: Config) -> tuple[str, str]:
    element, nu = ELEMENTS[config.mesh.formulation], config.poisson_ratio
    return "off" if element.fully_integrated else "on", f"nu = {nu:.5g}: {element.summary}"
