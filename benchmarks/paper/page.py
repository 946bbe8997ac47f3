"""paper.md from the claims, with paper.json beside it."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.markdown import table
from benchmarks.paper.reading import OPEN, Claim, Reading


def write_page(
    folder: Path,
    provenance: str,
    claims: Sequence[Claim],
    unreached: Mapping[str, Sequence[str]],
    figures: Sequence[tuple[str, str]],
) -> None:
    """Write paper.json and paper.md into a folder.

    unreached: sentences by sweep on what was not reached; figures: files and titles.
    """
    every = [claim.record() for claim in claims]
    record = {"provenance": provenance, "claims": every, "unreached": unreached, "figures": figures}
    (folder / "paper.json").write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    missing = [[name, sentence.replace("|", "/")] for name, sentences in unreached.items() for sentence in sentences]
    parts = {
        "The results of the paper, reproduced": provenance,
        "Claims": overview(claims),
        "All test numbers": "\n\n".join(details(claim) for claim in claims if claim.readings),
        "What was not reached": table(["sweep", "what was not reached, and why"], missing) if missing else "Nothing.",
        "Figures": table(["file", "content"], [[f"`{name}`", title] for name, title in figures]),
    }
    text = "\n\n".join(f"## {title}\n\n{text}" for title, text in parts.items()) + "\n"
    (folder / "paper.md").write_text(text, encoding="utf-8")


def overview(claims: Sequence[Claim]) -> str:
    """What the paper says, and the verdict."""
    rows = [[claim.number, claim.says, f"**{claim.verdict}**", claim.why or claim.missing] for claim in claims]
    return table(["claim", "the paper says", "verdict", "why"], rows)


def details(claim: Claim) -> str:
    """All numbers of a claim."""
    head = ["what", "law", "estimator", "number", "required range", ""]
    rows = [[r.what, r.law, r.estimator, number(r), _required(r), _status(r)] for r in claim.readings]
    return f"### {claim.number}. {claim.says}\n\nVerdict: {claim.verdict}.\n\n{table(head, rows)}"


def _status(reading: Reading) -> str:
    if reading.status is None:
        return "beside"
    return "no number" if math.isnan(reading.value) and reading.status == OPEN else reading.status


def number(reading: Reading) -> str:
    """The number with its interval and unit, or why there is none."""
    if math.isnan(reading.value):
        return reading.without or "no number"
    spread = max(reading.value - reading.low, reading.high - reading.value)
    digits = min(4, max(0, 1 - math.floor(math.log10(spread)))) if spread else 3
    value, low, high = (f"{v:.{digits}f}" for v in (reading.value, reading.low, reading.high))
    interval = "" if low == high else f" ({low} to {high})"
    return f"{value}{interval} {reading.unit}".rstrip()


def _required(reading: Reading) -> str:
    if reading.required is None:
        return ""
    low, high = reading.required
    return f"{low:.3g} to {high:.3g} {reading.unit}".rstrip()
