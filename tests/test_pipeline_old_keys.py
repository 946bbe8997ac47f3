"""Result files written before keys were renamed."""

from pipeline.store.formats import RENAMED, with_present_keys


def test_renamed_keys_are_replaced_at_any_depth_and_others_stay() -> None:
    old = {"sixth_number": {"eccentricity_mm": [1.0]}, "estimators": {"rod_fit": {"one_line_suffices": [True]}}}
    new = {"eccentricity": {"eccentricity_mm": [1.0]}, "estimators": {"rod_fit": {"single_line_suffices": [True]}}}
    assert with_present_keys(old) == new
    assert with_present_keys(new) == new
    rows = [{"force_error_with_sixth_number": 0.01, "load": "II"}]
    assert with_present_keys(rows) == [{"force_error_with_eccentricity": 0.01, "load": "II"}]


def test_no_present_key_is_an_old_one() -> None:
    assert not set(RENAMED) & set(RENAMED.values())
