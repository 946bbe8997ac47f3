"""Reasons are values: equal by their parts, and usable as keys."""

import pickle

from geometry import Reason


def test_reasons_are_equal_by_code_values_and_place():
    reason = Reason("inverted", {"pressure_kPa": 17.0}, (1.0, 2.0, 3.0))
    assert reason == Reason("inverted", {"pressure_kPa": 17.0}, (1.0, 2.0, 3.0)) != Reason("inverted")
    assert len({reason, pickle.loads(pickle.dumps(reason)), Reason("inverted")}) == 2
