"""Why a pressure was not reached, in the units of the configuration."""

from dataclasses import replace

from fem import End
from pipeline.simulation.loadcase import LoadCase, PressureSchedule
from pipeline.simulation.simulate import failure_in_kPa


def test_where_a_path_ended_in_the_units_of_the_configuration() -> None:
    end = End("load factor", 1.0, 0.4, 0.5, 3, 40, "no luck")
    schedule = PressureSchedule((45.0,), 45.0)
    free, held = LoadCase("II", "II", schedule), LoadCase("III", "III", schedule, end_y_mm=-30.0)
    assert failure_in_kPa(end, free) == "no equilibrium found beyond 18 kPa on the way to 45 kPa: no luck"
    assert failure_in_kPa(end, held) == (
        "no equilibrium found beyond 18 kPa with the end moved -15 mm on the way to 45 kPa and -30 mm: no luck"
    )
    assert "moved" not in failure_in_kPa(replace(end, constant_fraction=1.0), held)
