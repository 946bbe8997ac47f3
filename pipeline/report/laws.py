"""Table and sentences of the report about laws with fewer and with more parameters than five."""

from pipeline.report.formatting import percent
from pipeline.report.results import Results
from pipeline.validation.validate import LawRow

#: the laws of laws.json whose name is not what the table shows
_LAWS = {"five parameters": "five parameters, free offsets", "two slopes": "two slopes, no offsets"}


def law_rows(results: Results) -> list[list[str]]:
    """Rows of the table of laws: p, law, numbers, errors in and out of sample."""
    return [
        [
            f"{row.pressure_kPa:g}",
            _LAWS.get(row.law, row.law),
            str(row.numbers),
            percent(row.in_sample),
            percent(row.out_of_sample),
        ]
        for row in results.laws
    ]


def simplest_laws(results: Results) -> list[str]:
    """The simplest sufficient law, one sentence per pressure."""
    return [
        f"At {row.pressure_kPa:g} kPa the simplest law that predicts the other loads as well as any is "
        f"“{_LAWS.get(row.law, row.law)}” with {row.numbers} parameters{_otherwise(results, row)}."
        for row in results.laws
        if row.simplest
    ]


def _otherwise(results: Results, row: LawRow) -> str:
    """Why the rod has another number of lines at this pressure; empty where it has not."""
    single = results.at("single_line_suffices", row.pressure_kPa)
    has_two = {"one line": False, "two slopes": True, "five parameters": True}.get(row.law)
    if single is None or has_two is None or has_two != bool(single):
        return ""
    lines = "a single line" if single else "two lines"
    return (
        f", although the rod has {lines} there: its lines are chosen from experiment III, these laws are compared by "
        "the other loads"
    )
