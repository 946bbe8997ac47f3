"""Arms that are too short for five parameters, known from the configuration."""

from geometry import CellPlanes, Design
from geometry.families.from_file import FileDesign
from pipeline.config.arm_law import why_no_arm_law
from pipeline.config.config import Config
from rod import too_few_pitches


def too_short(config: Config) -> str:
    """Why there will be no five parameters, and what to give instead; empty where there are some, or none wanted."""
    if config.law == "cell" or not (sentence := why_too_short(config)):
        return ""
    has_own_law = not why_no_arm_law(config.design, config.effects)
    return f"{sentence}, or law: cell for the arm's own law alone" if has_own_law else sentence


def why_too_short(config: Config) -> str:
    """The same where five parameters are identified whatever the law; empty for an arm that is long enough."""
    if not (sentence := too_few_pitches(config.design.length, config.design.pitch)):
        return ""
    reason = sentence[0].lower() + sentence[1:].removesuffix(".")
    return f"no five parameters: {reason}; give {_remedy(config.design)}"


def _remedy(design: Design) -> str:
    if hasattr(design, "chambers"):
        return "more geometry.chambers"
    if not isinstance(design, FileDesign):
        return "a larger geometry.length"
    if isinstance(design.cell, CellPlanes):
        return "an arm of more cells"
    if design.cavity_pitch and not design.averages_within_cavities:
        return (
            "no geometry.cell: a single line is taken then, because the arm has too few cavities "
            f"({design.cavity_pitch:.3g} mm apart) for two"
        )
    return "a smaller geometry.cell"
