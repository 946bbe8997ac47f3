"""Why a pressure was not reached, in the units of the configuration."""

from dataclasses import replace

from fem import End
from geometry import Reason
from pipeline.config.config import End as ArmEnd
from pipeline.simulation.case_path import failure_in_kPa, given_up_in_kPa
from pipeline.simulation.loadcase import LoadCase, PressureSchedule


def test_where_a_path_ended_in_the_units_of_the_configuration() -> None:
    end = End("load factor", 1.0, 0.4, 0.5, 3, 40, (Reason("given_up", {"why": "no luck"}),))
    schedule = PressureSchedule((45.0,), 45.0)
    free, held, drawn = (
        LoadCase(name, name, schedule, at_end)
        for name, at_end in (("II", ArmEnd()), ("III", ArmEnd(y_mm=-30.0)), ("III", ArmEnd(force_N=(0.2, 0.0))))
    )
    assert failure_in_kPa(end, free) == "no equilibrium found beyond 18 kPa on the way to 45 kPa: no luck"
    assert failure_in_kPa(end, held) == (
        "no equilibrium found beyond 18 kPa with 50 % of u_y = -30 mm at the end on the way to 45 kPa with all of it: "
        "no luck"
    )
    assert "50 % of F_x = 0.2 N at the end" in failure_in_kPa(end, drawn)
    assert "at the end" not in failure_in_kPa(replace(end, constant_fraction=1.0), held)


def test_how_far_a_path_was_followed_that_was_given_up() -> None:
    why = Reason("given_up", {"why": "experiment II of the same arm has its limit at 20 kPa"})
    end = End("load factor", 1.0, 0.4, 1.0, 3, 40, (why,))
    case = LoadCase("I", "I", PressureSchedule((45.0,), 45.0), ArmEnd())
    assert given_up_in_kPa(end, case) == (
        "it was followed up to 18 kPa only, because experiment II of the same arm has its limit at 20 kPa"
    )
    assert given_up_in_kPa(replace(end, reached=0.0), case).startswith("it was not solved, because experiment II")
