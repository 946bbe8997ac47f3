"""A pressure of a run: kPa in configurations and results, MPa in the solver, one spelling in names of files.

`rod.same_pressure` says which pressures are the same.
"""

KPA_PER_MPA = 1000.0


def in_MPa(pressure_kPa: float) -> float:
    """kPa as MPa with twelve digits, without the last ones that a conversion from another unit leaves."""
    return float(f"{pressure_kPa / KPA_PER_MPA:.12g}")


def in_kPa(pressure_MPa: float) -> float:
    """MPa as kPa, for messages."""
    return KPA_PER_MPA * pressure_MPa


def name_of_state(experiment: str, pressure_kPa: float) -> str:
    """What the files of a state are called: III_17kPa."""
    return f"{experiment}_{pressure_kPa:.12g}kPa"
