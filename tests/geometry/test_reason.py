"""Reasons are values: equal by their parts, and usable as keys."""

import json
import math
import pickle

from geometry import Reason


def test_reasons_are_equal_by_code_values_and_place():
    reason = Reason("inverted", {"pressure_kPa": 17.0}, (1.0, 2.0, 3.0))
    assert reason == Reason("inverted", {"pressure_kPa": 17.0}, (1.0, 2.0, 3.0)) != Reason("inverted")
    assert len({reason, pickle.loads(pickle.dumps(reason)), Reason("inverted")}) == 2


def test_a_word_stands_for_a_number_that_is_not_finite() -> None:
    """JSON has no nan, and a sentence that is made from a file again must not need one."""
    values = {"percent": math.nan, "limit": math.inf, "rows": [{"low": -math.inf, "high": 2.0}], "size": 3.0}
    reason = Reason("x", values)
    read = Reason("x", json.loads(json.dumps(reason.values, allow_nan=False)))
    assert read == reason
    assert "{percent:.2g} of {limit:g} to {size:.1f}".format(**read.values) == "unknown of infinite to 3.0"
    assert read.values["rows"] == [{"low": "infinite", "high": 2.0}]
