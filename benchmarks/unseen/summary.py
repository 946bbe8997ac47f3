"""The parts of docs/unseen.md: what all designs together say."""

from collections import Counter
from collections.abc import Sequence
from math import degrees
from statistics import median
from textwrap import fill

import numpy as np
from scipy.stats import beta

from benchmarks.peers.page import table
from benchmarks.unseen.checks import ALLOWED
from benchmarks.unseen.confirm import BY_VOLUME
from benchmarks.unseen.sorting import (
    EARLY,
    GOOD_MESHES,
    GOOD_STATES,
    LIMIT,
    MESH_ERROR,
    NO_LIMIT,
    OUTCOMES,
    TOO_SLOW,
    TRACEBACK,
    WRONG,
    checks_in,
    has_numbers,
    limits_in,
    outcome,
    rod_errors,
    run_seconds,
    states_of_all,
    within_mesh_error,
)
from benchmarks.unseen.wording import WIDTH, Record, item, name_of, percent, share

#: change of direction along an arm, rad, from which it bends visibly
BENT = 0.03
#: degrees from which it bends far
FAR = 45.0
#: seeds whose results are given beside those of all: those that were published last
LAST_SEEDS = 3
#: words in the sentence of a confirmed limit, and how that is told
WAYS = {
    BY_VOLUME: "by a prescribed volume",
    "so the law is the cause": "because another law goes on",
    "a limit is named": "by a limit that is named with another law",
    "the limit is at": (
        "by another law whose path ends near the same pressure (earlier records, which do not say whether a limit was "
        "named there)"
    ),
    "passes through itself as well": "because the body passes through itself with another law too",
}
#: names of the three numbers in the records, and as they are written
NUMBERS = {"kappa_0": "κ₀(l/2)", "alpha2": "α₂", "force": "F"}


def targets(records: Sequence[Record]) -> str:
    """The goals beside what the seeds reached that were published last, and all of them."""
    last = of_last_seeds(records)
    goals = [
        ("designs that end wrong, with an error of the program, or not in time", "none"),
        ("states solved or beyond a limit that a second way confirms", percent(GOOD_STATES)),
        ("designs with numbers or an early refusal", "all"),
        (
            f"designs of the sample with κ₀, α₂ and F within {100 * MESH_ERROR:g} % of the limit of the mesh",
            "nine of ten",
        ),
        (f"the same, of arms that bend by {BENT:g} rad or more", ""),
    ]
    columns, met = {"result": last}, "met"
    if len(last) < len(records):
        columns = {
            f"last {LAST_SEEDS} seeds ({len(last)} designs)": last,
            f"all seeds ({len(records)} designs)": list(records),
        }
        met = "met by the last"
    words = {None: "", True: "yes", False: "**no**"}
    rows = [
        [*goal, *(result for result, _ in results), words[results[0][1]]]
        for goal, *results in zip(goals, *map(_results, columns.values()), strict=True)
    ]
    return table(["", "goal", *columns, met], rows)


def of_last_seeds(records: Sequence[Record]) -> list[Record]:
    """The designs of the seeds that were published last."""
    order = list(dict.fromkeys(record["seed"] for record in records))
    return [record for record in records if record["seed"] in order[-LAST_SEEDS:]]


def _results(records: Sequence[Record]) -> list[tuple[str, bool | None]]:
    """For each goal the result, and whether it is met; None where it is no goal."""
    bad = sum(_is_bad(record) for record in records)
    states = states_of_all(records)
    numbers = sum(has_numbers(record) for record in records)
    good, measured = _meshes(records)
    good_bent, bent = _meshes([record for record in records if _bends(record)])
    return [
        (f"{bad} of {len(records)}", bad == 0),
        (share(states.good), states.good >= GOOD_STATES),
        (f"{numbers} of {len(records)}", numbers == len(records)),
        (f"{good} of {measured}" if measured else "not measured", measured > 0 and good >= GOOD_MESHES * measured),
        (f"{good_bent} of {bent}" if bent else "not measured", None),
    ]


def _is_bad(record: Record) -> bool:
    return outcome(record) in (WRONG, TRACEBACK, TOO_SLOW)


def _bends(record: Record) -> bool:
    """Whether an arm bends visibly at its lower pressure."""
    return abs(record.get("turn_rad") or 0.0) >= BENT


def _meshes(records: Sequence[Record]) -> tuple[int, int]:
    """How many default meshes are within the goal, and of how many that was measured."""
    measured = [good for record in records if (good := within_mesh_error(record)) is not None]
    return sum(measured), len(measured)


def seeds(records: Sequence[Record]) -> str:
    """The same results by seed, in the order of the campaigns, and the default meshes of arms that bend visibly."""
    rows = []
    for seed in dict.fromkeys(record["seed"] for record in records):
        of_seed = [record for record in records if record["seed"] == seed]
        bad = sum(_is_bad(record) for record in of_seed)
        states = states_of_all(of_seed)
        meshes = [_meshes(some) for some in (of_seed, [record for record in of_seed if _bends(record)])]
        rows.append(
            [
                str(seed),
                str(len(of_seed)),
                str(bad),
                share(states.good),
                str(sum(has_numbers(record) for record in of_seed)),
                *(f"{good} of {measured}" for good, measured in meshes),
                f"{max(map(run_seconds, of_seed)):.0f}",
            ]
        )
    head = [
        "seed",
        "designs",
        "wrong, error or too slow",
        "states solved or beyond a confirmed limit",
        "with numbers",
        f"meshes within {100 * MESH_ERROR:g} %",
        f"the same, arms that bend by {BENT:g} rad or more",
        "CPU time of the longest run s",
    ]
    return table(head, rows)


def largest_share(bad: int, count: int) -> float:
    """The largest part of bad designs that is compatible with `bad` of `count` (95 % one-sided, Clopper-Pearson)."""
    return float(beta.ppf(0.95, bad + 1, count - bad)) if bad < count else 1.0


def certainty(records: Sequence[Record]) -> str:
    """What so many designs say about all that can be drawn."""
    bad = sum(_is_bad(record) for record in records)
    largest = percent(largest_share(bad, len(records)))
    return (
        f"{bad} of {len(records)} designs ended wrong, with an error of the program, or not in time: of all designs "
        f"that can be drawn at most {largest} do so (upper limit with 95 % confidence)."
    )


def bend(records: Sequence[Record]) -> str:
    """How far the arms bend, because a small bend is a mild test."""
    turns = [abs(degrees(record["turn_rad"])) for record in records if record.get("turn_rad") is not None]
    if not turns:
        return ""
    return (
        f"At the lower pressure the arms bend by {min(turns):.1f} to {max(turns):.1f} degrees over their length, "
        f"median {median(turns):.1f}: the pressures are drawn by the strain of the walls and not by the bend, so that "
        "arms that curl are rare here; those are among the hard cases ([robustness](robustness.md))."
    )


def outcomes(records: Sequence[Record]) -> str:
    """How many designs ended in which way."""
    counts = Counter(outcome(record) for record in records)
    return table(["outcome", "designs"], [[name, str(counts[name])] for name in OUTCOMES])


def sums(records: Sequence[Record]) -> str:
    """How many states were solved, and how many designs have numbers."""
    states = states_of_all(records)
    numbers = sum(has_numbers(record) for record in records)
    early = sum(outcome(record) == EARLY for record in records)
    sentences = (
        f"States (experiments I, II and III at both pressures): {states.solved} of {states.all} are solved, "
        f"{states.beyond} are beyond a limit that a second way confirms, {states.not_confirmed} are not reached "
        f"without such a confirmation or belong to a wrong design, {states.not_tried} belong to designs that did not "
        f"end: {share(states.good)} are solved or beyond a confirmed limit.",
        f"Numbers (five parameters or the arm's own law) or an early refusal: {numbers} of {len(records)} designs, "
        f"{early} of them refused.",
    )
    return "\n\n".join(fill(sentence, WIDTH) for sentence in sentences)


def rods(records: Sequence[Record]) -> str:
    """The errors of the recommended rods, also of arms that bend far, and which they are."""
    sentences = []
    for name, errors in rod_errors(records).items():
        if errors:
            small = {"shape": 0.03, "force": 0.10}[name]
            sentences.append(
                f"{name.capitalize()} error: median {percent(median(errors))}, largest {percent(max(errors))}, below "
                f"{percent(small)} on {sum(error < small for error in errors)} of {len(errors)} designs."
            )
    far = [record for record in records if abs(degrees(record.get("turn_rad") or 0.0)) >= FAR]
    if shapes := rod_errors(far)["shape"]:
        nine_of_ten = percent(float(np.percentile(shapes, 90)))
        sentences.append(
            f"An arm that hardly bends is a mild test of the shape; on the {len(shapes)} that bend by {FAR:g} degrees "
            f"or more at the lower pressure the shape error has a median of {percent(median(shapes))}, is at most "
            f"{nine_of_ten} on nine of ten and at most {percent(max(shapes))} on all."
        )
    chosen = Counter(record["rod"]["rod"] for record in records if record.get("rod"))
    if chosen:
        sentences.append(
            "Recommended rod: " + ", ".join(f"`{rod}` on {count}" for rod, count in chosen.most_common()) + "."
        )
    return " ".join(sentences)


def confirmed(records: Sequence[Record]) -> str:
    """How many of the ends that were checked a second way confirms as limits, by which way, and which were too slow."""
    limits = [limit for record in records for limit in limits_in(record)]
    slow = [name_of(record) for record in records if "limits" in record["slow"]]
    if not limits and not slow:
        return "No design met a limit."
    counts = Counter(outcome(record) for record in records)
    sentences = [f"{counts[LIMIT]} designs ended at a named limit{_stopped(counts[NO_LIMIT])}."]
    sentences.append("Of each of them one end was checked: that of experiment II, if it has one.")
    if slow:
        sentences.append(f"For {len(slow)} ({', '.join(slow)}) the check ran out of CPU time.")
    confirmed = [limit["sentence"].partition("; prescribed volume: ")[0] for limit in limits if limit["confirmed"]]
    ways = Counter(next(way for words, way in WAYS.items() if words in sentence) for sentence in confirmed)
    by = "; ".join(f"{ways[way]} {way}" for way in WAYS.values() if ways[way])
    sentences.append(
        f"Of the {'other ' if slow else ''}{len(limits)} ends {len(confirmed)} are confirmed as limits"
        + (f": {by}." if by else ".")
    )
    return " ".join(sentences)


def _stopped(count: int) -> str:
    return f", {count} stopped without one" if count else ""


def checks(records: Sequence[Record]) -> str:
    """The largest difference that each check has given, and the designs of which it could not be made."""
    rows = []
    for name, allowed in ALLOWED.items():
        results = [check for record in records for check in checks_in(record) if check.name == name]
        made = [check.value for check in results if check.made]
        numbers = [f"{median(made):.1e}", f"{max(made):.1e}"] if made else ["", ""]
        failed = sum(check.failed for check in results)
        rows.append([name, str(len(made)), *numbers, f"{allowed:g}", str(failed), str(len(results) - len(made))])
    return table(["check", "designs", "median difference", "largest", "allowed", "failed", "not made"], rows)


def mesh(records: Sequence[Record]) -> str:
    """The error of the default mesh on the designs that were solved on a finer one too."""
    measured = [record for record in records if record.get("finer", {}).get("errors")]
    lacking = [record for record in records if record.get("finer") and not record["finer"].get("errors")]
    if not measured:
        return "Not measured in this campaign."
    good = sum(bool(within_mesh_error(record)) for record in measured)
    head = ["seed and no.", "design", "elements", "size mm"]
    for name in NUMBERS.values():
        head += [f"{name}, measured", f"{name}, estimated"]
    rows = []
    for record in measured:
        errors = record["finer"]["errors"]
        row = [name_of(record), record["words"], record["elements"], f"{record['size_mm']:g}"]
        for name in NUMBERS:
            entry = errors[name]
            estimated = entry["estimated"]
            row += [
                f"{100 * entry['error']:+.1f} ± {100 * entry['std']:.1f} %",
                "" if estimated is None else f"{100 * estimated:.1f} %",
            ]
        rows.append(row)
    text = (
        f"On a sample of {len(measured)} designs, chosen by their numbers before anything was solved, II and III were "
        "solved again at the lower pressure on a mesh with elements smaller by a factor of 1.5. The table has the "
        "error of the default mesh against the limit that both extrapolate to (the standard deviation covers orders "
        "of convergence from 1 to 2), and the error that the run itself has estimated from a coarser mesh. "
        f"{good} of {len(measured)} designs are within {100 * MESH_ERROR:g} % in all three numbers."
    )
    parts = [fill(text, WIDTH), table(head, rows)]
    if lacking:
        reasons = "\n".join(item(f"Design {name_of(r)}: {r['finer'].get('failure', '')}") for r in lacking)
        parts.append("Of the sample these could not be compared:\n\n" + reasons)
    return "\n\n".join(parts)
