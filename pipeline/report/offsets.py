"""What the offsets m0 of the five parameters do to a rod that hardly carries a load."""

from pipeline.report.formatting import percent
from pipeline.report.results import Results
from pipeline.rods.saved import pressurised_rod
from rod.export.tables import unloaded_distance

#: distance of the end that is not mentioned, over the length
SMALL = 0.01


def jump_sentence(results: Results) -> str:
    """How far the end of a rod with five parameters moves under the smallest load, at most.

    Of both rods and all pressures; empty where that is little, and without five parameters.
    """
    content = results.parameters
    if not content.get("kappa_0"):
        return ""
    kinds = (False, True) if content.get("eccentricity") else (False,)
    rods = [pressurised_rod(content, extensible) for extensible in kinds]
    distance, pressure = max((unloaded_distance(rod.at(p)), float(p)) for rod in rods for p in rod.pressures)
    if distance <= SMALL * results.length:
        return ""
    return (
        "Under any load, however small, the offsets m₀₁ and m₀₂ bend the rods with five parameters as well: their end "
        f"is then up to {distance:.3g} mm ({percent(distance / results.length)} of l, at {pressure:g} kPa) from its "
        "place without load. The arm itself has no such jump."
    )
