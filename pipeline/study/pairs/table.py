"""The pairs of a run as a table, and as a page with the law over both pressures."""

from collections.abc import Iterator

from pipeline.results.files import folder_of
from pipeline.results.verdict import verdict_of
from pipeline.store.result_folder import ResultFolder
from pipeline.study.pairs.run import PairRuns
from pipeline.values.formats import ARM_LAW, PAIRS_PAGE
from pipeline.values.formatting import percent
from pipeline.values.page import Section, page
from pipeline.values.plots import Line, Panel, ordered_colour
from pipeline.values.run import Run
from pipeline.values.table import Table
from rod.arm_law.pairs import fractions_of
from rod.same_pressure import is_same

_HEADS = ("bends by (°)", "tip x, y (mm)", "force in III (N)", "rod: shape", "rod: force")


def pairs_table(made: PairRuns) -> Table:
    """One row per pair: the arm by finite elements, and how far the rod with its own law is from them."""
    rows = []
    for direction, larger in _pairs(made):
        rows.append((_told(direction, larger), *_numbers(made.runs[direction], larger)))
    heads = (f"{' and '.join(made.spec.cavities)} (kPa)", *_HEADS)
    return Table(heads, tuple(rows), "rod: with the arm's own law, against finite elements of the whole arm")


def _pairs(made: PairRuns) -> list[tuple[float, float]]:
    """Direction and larger pressure (kPa) of each."""
    return [(direction, larger) for direction, pressures in made.spec.rays.items() for larger in pressures]


def _told(direction: float, larger: float) -> str:
    return ", ".join(f"{fraction * larger:.4g}" for fraction in fractions_of(direction))


def _numbers(results: Run, larger: float) -> tuple[str, ...]:
    curve = results.curve("II", larger)
    held = [s for s in results.states if s.experiment == "III" and s.reached and is_same(s.pressure_kPa, larger)]
    rows = [e for e in results.errors_of(ARM_LAW) if is_same(e.pressure_kPa, larger)]
    shape = max((e.distance_over_length for e in rows if e.distance_over_length is not None), default=None)
    force = max((abs(e.force_error) for e in rows if e.force_error is not None), default=None)
    return (
        "not reached" if curve is None else f"{results.bending_deg(larger):.2f}",
        "" if curve is None else f"{curve.tip_mm[0]:.2f}, {curve.tip_mm[1]:.2f}",
        f"{held[0].reaction_N[1]:.4g}" if held else "not reached",
        percent(shape),
        percent(force),
    )


def save_page(made: PairRuns) -> None:
    """Write pairs.html: the table, what each ratio has found, and moment over curvature at every pair."""
    ResultFolder(made.directory).save_text(PAIRS_PAGE, _page(made))


def _page(made: PairRuns) -> str:
    panels = () if made.law is None else (Panel("Moment over curvature", "κ (1/mm)", "M (N mm)", tuple(_curves(made))),)
    found = (
        Section(
            folder_of(direction).replace("_", " "),
            link=f"{folder_of(direction)}/report.html",
            sentences=verdict_of(results).lines,
        )
        for direction, results in made.runs.items()
    )
    whole = Section(table=pairs_table(made)), Section(sentences=made.sentences, panels=panels)
    return page(f"{made.spec.name}: pairs of pressures", *whole, *found)


def _curves(made: PairRuns) -> Iterator[Line]:
    assert made.law is not None
    pairs = _pairs(made)
    for number, (direction, larger) in enumerate(pairs):
        law = made.law.laws[made.law.directions.index(direction)]
        if larger > law.pressures[-1]:
            continue
        section = law.at(larger).section
        name = f"{_told(direction, larger)} kPa"
        yield Line(section.kappa, section.moment, name, ordered_colour(number, len(pairs)))
