"""Why a pressure was not reached, in the units of the configuration."""

from dataclasses import replace

from fem import End
from geometry import Reason
from pipeline.config.config import End as ArmEnd
from pipeline.simulate.case_path import why_ended, why_left
from pipeline.simulate.known_limit import EndOfII
from pipeline.simulate.loadcase import LoadCase, PressureSchedule
from pipeline.values.reasons import render_all

SCHEDULE = PressureSchedule((45.0,), 45.0)
END = End("load factor", 1.0, 0.4, 0.5, 3, 40, (Reason("stiffer_contact_fails"),))


def test_where_a_path_ended_in_the_units_of_the_configuration() -> None:
    free, held, drawn = (
        LoadCase(name, name, SCHEDULE, at_end)
        for name, at_end in (("II", ArmEnd()), ("III", ArmEnd(y_mm=-30.0)), ("III", ArmEnd(force_N=(0.2, 0.0))))
    )
    assert why_ended(END, free) == (Reason("ends_beyond", {"reached_kPa": 18.0, "target_kPa": 45.0}), *END.reasons)
    first, limit, *_ = why_ended(replace(END, limit=0.5), held)
    assert (first.code, limit) == ("ends_with_part", Reason("has_limit", {"limit_kPa": 22.5}))
    assert first.values == {"reached_kPa": 18.0, "target_kPa": 45.0, "percent": 50.0, "on_end": "u_y = -30 mm"}
    assert why_ended(END, drawn)[0].values["on_end"] == "F_x = 0.2 N"
    assert why_ended(replace(END, constant_fraction=1.0), held)[0].code == "ends_beyond"
    assert render_all(why_ended(END, free)) == (
        "no equilibrium found beyond 18 kPa on the way to 45 kPa; more or stiffer contact does not help"
    )


def test_how_far_a_path_was_followed_that_was_given_up() -> None:
    case, second = LoadCase("I", "I", SCHEDULE, ArmEnd()), EndOfII(17.0, 20.0, is_limit=True)
    because = Reason("end_of_II", {"end": "limit", "end_kPa": 20.0})
    assert why_left(END, case, second) == (Reason("followed_to", {"reached_kPa": 18.0}), because)
    assert why_left(replace(END, reached=0.0), case, second) == (Reason("not_tried"), because)
