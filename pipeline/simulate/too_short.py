"""Arms that are too short for five parameters, and meshes that are too coarse, known before anything is solved."""

import numpy as np

from fem.elements import ELEMENTS
from geometry import Body, Reason
from pipeline.config.config import Config
from rod import shortest_pitch, too_few_pitches
from rod.identification.observed import FEWEST_PITCHES


def too_short(config: Config) -> Reason | None:
    """Why there will be no five parameters; None where there are some, or none wanted."""
    return None if config.law == "cell" else why_too_short(config)


def why_too_short(config: Config) -> Reason | None:
    """Why an arm has no five parameters whatever its law; None for an arm that is long enough."""
    length, pitch = config.design.length, config.design.pitch
    if not too_few_pitches(length, pitch):
        return None
    return Reason("too_short", {"length_mm": length, "needed_mm": FEWEST_PITCHES * pitch, "averaging_mm": pitch})


def too_coarse(config: Config, body: Body) -> Reason | None:
    """Why a mesh gives no five parameters: nodes along the material curve are too far apart for means over a cell."""
    spacing, pitch = float(np.diff(body.mesh.points[body.curve_vertices, 0]).max()), config.design.pitch
    if ELEMENTS[config.mesh.formulation].quadratic:
        spacing /= 2
    if config.law == "cell" or too_short(config) or pitch >= shortest_pitch(spacing):
        return None
    return Reason("nodes_too_far_apart", {"spacing_mm": spacing, "allowed_mm": pitch / 2, "averaging_mm": pitch})
