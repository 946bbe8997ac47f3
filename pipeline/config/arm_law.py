"""Which configurations have a law of their own (docs/cell.md), as far as that is known before anything is meshed."""

from geometry import Design
from pipeline.config.effects import Effects


def why_no_arm_law(design: Design, effects: Effects) -> str:
    """Why an arm or its effects have no law of their own, a clause; empty where they may have one."""
    if not design.repeats:
        return design.why_no_cell
    if effects.gravity.on:
        return "the weight loads every cell differently, so there is no law of one cell with effects.gravity"
    cavities = effects.pressure.cavities
    if any(cavity.constant_kPa for cavity in cavities.values()):
        return "a cavity has a constant pressure, and the law of a cell has one pressure that all follow"
    if not effects.pressure.acts:
        return "no cavity is pressurised, so the law of a cell has nothing to depend on"
    faces = effects.self_contact.faces or ()
    if not effects.self_contact.off and (len(faces) > 1 or any(face in cavities for face in faces)):
        return "the law of a cell has contact on one outer face alone, not on all those the user names"
    return ""
