"""Which effects took part in a run, and why."""

from collections.abc import Mapping
from typing import Any

from geometry import Body
from pipeline.config import Config
from pipeline.simulate import Outcome

__all__ = ["effect_rows"]


def effect_rows(config: Config, body: Body, outcomes: Mapping[str, Outcome]) -> list[dict[str, Any]]:
    """Rows of effects.json: effect, state, reason, share of the solver's time (null where it has none of its own)."""
    state, reason = _contact(config, body, outcomes)
    return [
        _row("pressure", "on", "the cavities are pressurised; pressure follows the walls", _share("pressure", outcomes)),
        _row("self_contact", state, reason, _share("self_contact", outcomes)),
        _row("symmetry", "on" if body.half else "off", _symmetry(config, body), None),
        _row("gravity", "off", "not asked for: the arm lies on its side in the paper's experiments", 0.0),
        _row("incompressibility", "on", _incompressibility(config), None),
    ]


def _row(effect: str, state: str, reason: str, share: float | None) -> dict[str, Any]:
    return {"effect": effect, "state": state, "reason": reason, "share_of_time": share}


def _share(effect: str, outcomes: Mapping[str, Outcome]) -> float:
    total = sum(outcome.seconds.total for outcome in outcomes.values())
    spent = sum(outcome.seconds.effects.get(effect, 0.0) for outcome in outcomes.values())
    return spent / total if total > 0 else 0.0


def _contact(config: Config, body: Body, outcomes: Mapping[str, Outcome]) -> tuple[str, str]:
    asked = config.effects["self_contact"]
    if asked == "off":
        return "off", "switched off in the config"
    if "gap" not in body.mesh.faces:
        return "off", "no faces of this body look at each other"
    touched = [
        f"{name} from {min(first):g} kPa"
        for name, outcome in outcomes.items()
        if (first := [record.pressure_kPa for record in outcome.records if "self_contact" in record.effects])
    ]
    if asked == "on":
        return "on", "switched on in the config"
    if touched:
        return "on", f"walls came within reach of each other: {', '.join(touched)}"
    nearest = min((record.row["min_gap_mm"] for outcome in outcomes.values() for record in outcome.records), default=0.0)
    return "off", f"no walls came within reach of each other; the smallest gap was {nearest:.2g} mm"


def _symmetry(config: Config, body: Body) -> str:
    if body.half:
        return "body, pressure and loads are mirror images about z = 0: one half is solved"
    return "switched off in the config: the whole body is solved"


def _incompressibility(config: Config) -> str:
    nu = config.material.constants.get("nu")
    value = f" (nu = {nu:g})" if nu is not None else ""
    if config.mesh.formulation == "p2p0":
        return f"nearly incompressible{value}: the volumetric part of the law is taken at one point per element"
    return f"formulation {config.mesh.formulation} chosen in the config{value}"
