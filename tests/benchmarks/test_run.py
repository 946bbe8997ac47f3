"""What the benchmark of whole runs says about two runs: differences of their numbers, medians with ranges."""

from benchmarks.run import Spent, table


def test_medians_and_their_ratio_are_in_the_table() -> None:
    other = [Spent(wall, 2.0 * wall, 100.0, 5000, {"experiments": wall}) for wall in (10.0, 12.0, 20.0)]
    this = [Spent(6.0, 18.0, 90.0, 500, {"experiments": 3.0, "pictures": 1.0})]
    lines = list(table(other, this))
    assert "| wall s | 12.0 (10.0 to 20.0) | 6.0 (6.0 to 6.0) | 0.50 |" in lines
    assert "| experiments s | 12.0 (10.0 to 20.0) | 3.0 (3.0 to 3.0) | 0.25 |" in lines
    assert lines[-1] == "| pictures s | 0.0 (0.0 to 0.0) | 1.0 (1.0 to 1.0) |  |"
