"""Arms that are too short for five parameters, and meshes that are too coarse, known before anything is solved."""

import numpy as np

from fem.elements import ELEMENTS
from geometry import Body, Design
from pipeline.config.arm_law import why_no_arm_law
from pipeline.config.config import Config
from rod import shortest_pitch, too_few_pitches


def too_short(config: Config) -> str:
    """Why there will be no five parameters, and what to give instead; empty where there are some, or none wanted."""
    if config.law == "cell" or not (sentence := why_too_short(config)):
        return ""
    has_own_law = not why_no_arm_law(config.design, config.effects)
    return f"{sentence}, or law: cell for the arm's own law alone" if has_own_law else sentence


def why_too_short(config: Config) -> str:
    """Why an arm is too short for five parameters, whatever its law; empty for one that is long enough."""
    if not (sentence := too_few_pitches(config.design.length, config.design.pitch)):
        return ""
    reason = sentence[0].lower() + sentence[1:].removesuffix(".")
    return f"no five parameters: {reason}; give {_remedy(config.design)}"


def too_coarse(config: Config, body: Body) -> str:
    """Why nodes along the material curve are too far apart for means over a cell; empty where they are not."""
    design, spacing = config.design, float(np.diff(body.mesh.points[body.curve_vertices, 0]).max())
    if ELEMENTS[config.mesh.formulation].quadratic:
        spacing /= 2
    if config.law == "cell" or too_short(config) or design.pitch >= shortest_pitch(spacing):
        return ""
    finer = "a smaller mesh.size" if design.is_resizable else "a mesh with smaller elements there"
    longer = float(f"{1.1 * shortest_pitch(spacing):.2g}")
    if design.has_free_pitch and not too_few_pitches(design.length, longer):
        finer = f"geometry.cell, for example {longer:g} mm, or {finer}"
    return (
        f"no five parameters: nodes along the material curve are up to {spacing:.3g} mm apart, more than half of the "
        f"{design.pitch:.3g} mm over which curvatures are averaged; give {finer}"
    )


def _remedy(design: Design) -> str:
    if design.key_of_cells == "chambers":
        return "more geometry.chambers"
    if design.key_of_cells == "length":
        return "a longer geometry.length"
    return "a smaller geometry.cell, or none" if design.has_free_pitch else "an arm of more cells"
