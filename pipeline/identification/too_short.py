"""Arms that are too short for five parameters, known from the configuration."""

from pipeline.config.arm_law import why_no_arm_law
from pipeline.config.config import Config
from rod import too_few_pitches


def too_short(config: Config) -> str:
    """Why there will be no five parameters, and what to give instead; empty where there are some, or none wanted."""
    if config.law == "cell" or not (sentence := too_few_pitches(config.design.length, config.design.pitch)):
        return ""
    remedies = {"chambers": "more geometry.chambers", "cell": "a smaller geometry.cell"}
    remedy = next((text for key, text in remedies.items() if hasattr(config.design, key)), "a larger geometry.length")
    reason = sentence[0].lower() + sentence[1:].removesuffix(".")
    has_own_law = not why_no_arm_law(config.design, config.effects)
    other = ", or law: cell for the arm's own law alone" if has_own_law else ""
    return f"no five parameters: {reason}; give {remedy}{other}"
