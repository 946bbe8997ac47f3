"""Why a pressure was not reached, in the units of the configuration."""

from dataclasses import replace

from fem import End
from pipeline.simulation.loadcase import Case
from pipeline.simulation.simulate import in_kPa


def test_where_a_path_ended_in_the_units_of_the_configuration() -> None:
    end = End("load factor", 1.0, 0.4, 0.5, 3, 40, "no luck")
    free, held = Case("II", "II", (45.0,)), Case("III", "III", (45.0,), end_y_mm=-30.0)
    assert in_kPa(end, 0.045, free) == "no equilibrium found beyond 18 kPa on the way to 45 kPa: no luck"
    assert in_kPa(end, 0.045, held) == (
        "no equilibrium found beyond 18 kPa with the end moved -15 mm on the way to 45 kPa and -30 mm: no luck"
    )
    assert "moved" not in in_kPa(replace(end, share=1.0), 0.045, held)
