"""Result files written before keys were renamed."""

from pipeline.store.formats import RENAMED, validation_rows, with_present_keys


def test_renamed_keys_are_replaced_at_any_depth_and_others_stay() -> None:
    old = {"sixth_number": {"eccentricity_mm": [1.0]}, "estimators": {"rod_fit": {"one_line_suffices": [True]}}}
    new = {"eccentricity": {"eccentricity_mm": [1.0]}, "estimators": {"rod_fit": {"single_line_suffices": [True]}}}
    assert with_present_keys(old) == new
    assert with_present_keys(new) == new
    rows = [{"force_error_with_sixth_number": 0.01, "load": "II"}]
    assert with_present_keys(rows) == [{"force_error_with_eccentricity": 0.01, "load": "II"}]


def test_no_present_key_is_an_old_one() -> None:
    assert not set(RENAMED) & set(RENAMED.values())


def test_a_row_with_both_rods_becomes_one_row_per_rod() -> None:
    common = {"experiment": "III", "pressure_kPa": 17.0, "load": "", "sample": "in"}
    both = {**common, "distance_over_length": 0.02, "force_error": 0.01, "reason": "", "reason_with_eccentricity": ""}
    both |= {"distance_over_length_with_eccentricity": 0.001, "force_error_with_eccentricity": 0.005}
    five = {**common, "rod": "five", "distance_over_length": 0.02, "force_error": 0.01, "reason": ""}
    extensible = {**common, "rod": "five_extensible", "distance_over_length": 0.001, "force_error": 0.005, "reason": ""}
    assert validation_rows([both]) == [five, extensible]
    assert validation_rows([five, extensible]) == [five, extensible]
    without = {**common, "distance_over_length": 0.02}
    assert validation_rows([without]) == [{**without, "rod": "five"}]
