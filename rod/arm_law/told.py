"""What `print` shows of the laws of an arm."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rod.arm_law.kinds import Law


def told_law(law: "Law") -> dict[str, str]:
    """Of a law of any kind: its pressures, the length and the mass of the arm."""
    pressures = f"{len(law.rows)} of {', '.join(law.cavities)}, up to {max(map(max, law.rows)):g} kPa"
    mass = "not known" if law.mass is None else law.mass.text
    return {"pressures": pressures, "length": f"{law.length:g} mm", "mass": mass}
