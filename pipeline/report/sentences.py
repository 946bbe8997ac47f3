"""The sentences of the report."""

import re
from collections.abc import Iterable, Sequence

import numpy as np

from pipeline.report.formatting import listed, number, percent, seconds
from pipeline.report.results import END_CELLS, Results
from pipeline.rods.without_parameters import why_no_parameters

#: what a reason remarks on the elements, as `fem.path.diagnosis` writes it, and in it how early they reach a limit
_REMARK, _EARLY = re.compile(r" \(p2p0 [^()]*\)"), re.compile(r"\(p2p0 [^()]*(up to \d+ % early)")
#: the sentence on an experiment that stopped early: its name, and the rest
_OF_EXPERIMENT = re.compile(r"experiment (\w+) (.*)")
#: part of the length that the comparison of I and II leaves out at each end at most, and where the length of a cell is
#: not known
_MOST_LEFT_OUT, _USUALLY_LEFT_OUT = 0.4, 0.1


def opening(results: Results) -> str:
    """What the report is about, in one or two sentences."""
    pressures = ", ".join(f"{pressure:g}" for pressure in results.reached_pressures)
    if not results.curves and not results.experiments:
        return "No pressure was reached; the report shows the configuration only."
    body = f"A body {number(results.length)} mm long was simulated at {pressures} kPa"
    if results.identified_pressures:
        return f"{body}, and rods were made that replace it in design and control. The verdict comes first."
    if results.arm_law:
        made = "a rod with the arm's own law was made that replaces it in design and control"
        return f"{body}, and {made}. The verdict comes first."
    return f"{body}. It has no rod, because neither five parameters nor a law of its own were found."


def not_reached(failures: Iterable[str]) -> list[str]:
    """What was not reached, without the reasons, experiments with the same ending together."""
    return _together(failure.partition(": ")[0] for failure in failures)


def in_short(failures: Iterable[str]) -> list[str]:
    """What was not reached, and of each reason the limit and the first place in the body, experiments with the same
    reason together."""
    return _together(map(_limit_and_position, failures))


def _limit_and_position(failure: str) -> str:
    first, *others = _REMARK.sub("", failure).split("; ")
    position = next((clause for clause in others if ") mm" in clause), "")
    early = _EARLY.search(failure)
    return "; ".join(filter(None, (first, position, f"p2p0 elements reach limits {early[1]}" if early else "")))


def _together(sentences: Iterable[str]) -> list[str]:
    """Sentences that differ in the name of the experiment alone as one sentence."""
    names: dict[str, list[str]] = {}
    for sentence in sentences:
        named = _OF_EXPERIMENT.fullmatch(sentence)
        name, text = named.groups() if named else ("", sentence)
        names.setdefault(text, []).append(name)
    ended = {text: sorted(filter(None, experiments)) for text, experiments in names.items()}
    return [
        f"experiment{'s' if len(experiments) > 1 else ''} {listed(experiments)} {text}" if experiments else text
        for text, experiments in ended.items()
    ]


def not_identified(results: Results) -> str:
    """Why there are no five parameters, for the same reason as at the end of the run."""
    if (results.run.get("config") or {}).get("law") == "cell":
        return "They were not requested (law: cell)."
    return f"They were not identified: {why_no_parameters(results.run)}."


def third_experiment(results: Results) -> str:
    """What the end has in experiment III: its height held, both coordinates, or a force along one axis or both."""
    held, forces = results.end_of_third
    pulls = [f"F_{axis} = {f:g} N" for axis, is_held, f in zip("xy", held, forces, strict=True) if f and not is_held]
    parts = {(True, True): "the end held", (False, True): "the height of the end held"}
    part = parts.get(held, "") or ("the end held along the arm" if held[0] else "")
    pull = f"a force {', '.join(pulls)} on the end" if pulls else ""
    return " and ".join(filter(None, (part, pull))) or "the end free"


def lines_needed(results: Results) -> str:
    """At which pressures the rod has a single line, and why: it describes the data as well as two by the criterion of
    the identification, or nothing changes the rigidity along the arm."""
    verdicts = results.parameters.get("single_line_suffices")
    if not verdicts:
        return ""
    own = results.parameters.get("evidence_for_two_lines") or [0.0] * len(verdicts)
    evidence = results.parameters.get("evidence_of_choice") or own  # results of earlier versions decided by pressure
    single = [
        (pressure, for_two > 0.0)
        for pressure, is_single, for_two in zip(results.identified_pressures, verdicts, evidence, strict=True)
        if is_single
    ]
    if not single and results.parameters.get("d_given_mm") is not None:
        return "At every pressure the rod has two lines, because d is given."
    if not single:
        better = "At every pressure two lines describe the data better than a single one."
        together = "Two lines describe the data of all pressures together better than a single one."
        return together if "evidence_of_choice" in results.parameters and min(own) <= 0.0 else better
    as_well, worse = ([p for p, is_worse in single if is_worse is kind] for kind in (False, True))
    reasons = []
    if as_well:
        reasons.append(
            f"At {_listed(as_well)} kPa a single line is taken, because the data do not justify the additional "
            f"parameters of a second one{_fractions_explained(results, as_well)}"
        )
    if worse:
        reasons.append(
            f"{'at' if as_well else 'At'} {_listed(worse)} kPa two lines fit the data better, but a single line is "
            "taken, because no walls touch, and nothing else changes the rigidity along the arm: two lines then "
            "usually describe the ends of the arm, or of long cells, and predict other loads less well"
        )
    return f"{'; '.join(reasons)}. There α₁ = α₂, and d has no meaning."


def _listed(pressures: Iterable[float]) -> str:
    return ", ".join(f"{pressure:g}" for pressure in pressures)


def _fractions_explained(results: Results, pressures: Iterable[float]) -> str:
    """In brackets R² of two lines and of a single one at these pressures; empty where they are not stored."""
    stored = ((results.at("r2_two_lines", p), results.at("r2_single_line", p)) for p in pressures)
    rows = [(two, one) for two, one in stored if two is not None and one is not None]
    if not rows or any(one > two for two, one in rows):  # two lines also have to give the displacement of the end
        return ""
    of_two, of_one = (_from_to([max(row[k], 0.0) for row in rows]) for k in (0, 1))
    with_each = f"{of_two} with both" if of_two == of_one else f"{of_two} with two lines, {of_one} with one"
    return f" (R², the part of the variance that they describe: {with_each})"


def _from_to(values: Sequence[float]) -> str:
    low, high = f"{min(values):.2f}", f"{max(values):.2f}"
    return low if low == high else f"{low} to {high}"


def difference_of_rest_curvatures(results: Results) -> list[tuple[str, str, str, str]]:
    """Per pressure: p, kappa_0 at half the length in I and II, and the relative difference of the two profiles without
    the ends."""
    rows = []
    part = _part_left_out(results)
    for pressure in results.pressures:
        free, clamped = results.curve("I", pressure), results.curve("II", pressure)
        if free is None or clamped is None:
            continue
        first = np.interp(clamped["s_mm"], free["s_mm"], free["kappa_per_mm"])
        second = clamped["kappa_per_mm"]
        middle = [np.interp(results.length / 2, clamped["s_mm"], kappa) for kappa in (first, second)]
        inner = np.abs(clamped["s_mm"] / results.length - 0.5) < 0.5 - part
        difference = np.sqrt(np.mean((first - second)[inner] ** 2) / np.mean(second[inner] ** 2))
        rows.append((f"{pressure:g}", number(middle[0]), number(middle[1]), percent(difference)))
    return rows


def left_out(results: Results) -> str:
    """How much of the arm `difference_of_rest_curvatures` leaves out at each end."""
    zone = results.end_zone_mm
    if 0.0 < zone <= _MOST_LEFT_OUT * results.length:
        return f"{number(zone)} mm, which is {END_CELLS:g} times the length over which curvatures are averaged,"
    return f"{percent(_part_left_out(results))} of it"


def _part_left_out(results: Results) -> float:
    zone = results.end_zone_mm / results.length
    return min(zone, _MOST_LEFT_OUT) if zone > 0.0 else _USUALLY_LEFT_OUT


def time_of_factorization(results: Results) -> str:
    """Which part of the solver's time the numeric factorizations took."""
    parts = results.run.get("solver_seconds") or {}
    total = sum(parts.values())
    if not total or "factorization" not in parts:
        return ""
    count = sum(row.factorizations or 0 for row in results.experiments)
    fraction = parts["factorization"] / total
    states = "" if all(row.reached for row in results.experiments) else " of the states that were reached"
    return (
        f"Numeric factorization took {percent(fraction)} of {seconds(total)} of the solver's time{states}; there were "
        f"{count} factorizations."
    )


def remarks(results: Results) -> list[str]:
    """Pressures that were not reached, and states to be used with care, each with the reason."""
    return [
        f"{row.experiment} at {row.pressure_kPa:g} kPa: {'' if row.reached else f'{row.status}: '}{row.reason}"
        for row in results.experiments
        if row.reason
    ]
