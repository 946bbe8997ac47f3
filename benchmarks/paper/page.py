"""paper.md from the claims, with paper.json beside it."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

from benchmarks.markdown import table
from benchmarks.paper.data import LAWS
from benchmarks.paper.reading import OPEN, Claim, Reading, claim_from_record

WIDTH = 118  #: characters of a line
_SYMBOLS = {"alpha1": "α₁", "alpha2": "α₂"}


def write_page(folder: Path, record: Mapping[str, Any]) -> None:
    """Write paper.json and paper.md into a folder."""
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    (folder / "paper.json").write_text(text, encoding="utf-8")
    (folder / "paper.md").write_text(page(json.loads(text)), encoding="utf-8")


def page(record: Mapping[str, Any]) -> str:
    """The page of a record: claims, what was not reached, figures, and how the results were made."""
    claims = [claim_from_record(entry) for entry in record["claims"]]
    parts = {
        "The results of the paper, reproduced": fill(record["provenance"], WIDTH),
        "Claims": _overview(claims),
        "All test numbers": "\n\n".join(_details(claim) for claim in claims if claim.readings),
        "What was not reached": _unreached(record["unreached"]),
        "Figures": _figures(record["figures"]),
    }
    return "\n\n".join(f"## {title}\n\n{text}" for title, text in parts.items()) + "\n"


def _overview(claims: Sequence[Claim]) -> str:
    head = ["claim", "the paper says", *(f"we find, `{law}`" for law in LAWS), "verdict", "why"]
    rows = [
        [c.number, c.says, *(_summary(c, law) for law in LAWS), f"**{c.verdict}**", c.why or c.missing] for c in claims
    ]
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _summary(claim: Claim, law: str) -> str:
    """The readings of one law that count, and whether they hold."""
    readings = [r for r in claim.readings if r.law == law and r.status is not None]
    return "; ".join(_named(r) for r in readings) or ("not yet measured" if claim.readings else "")


def _named(reading: Reading) -> str:
    arm = "" if reading.arm == "pneunet" else reading.arm
    parts = (
        arm,
        reading.pressure,
        _SYMBOLS.get(reading.part, reading.part),
        reading.estimator and f"`{reading.estimator}`",
    )
    name = ", ".join(filter(None, parts))
    status = "" if math.isnan(reading.value) and reading.status == OPEN else f" ({reading.status})"
    return f"{name}: {number(reading)}{status}" if name else f"{number(reading)}{status}"


def _details(claim: Claim) -> str:
    head = ["what", "law", "estimator", "number", "required range", ""]
    rows = [[r.what, r.law, r.estimator, number(r), _required(r), _status(r)] for r in claim.readings]
    lines = [head, ["---", "---", "---", "---:", "---", "---"], *rows]
    body = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return f"### {claim.number}. {claim.says}\n\nVerdict: {claim.verdict}.\n\n{body}"


def _status(reading: Reading) -> str:
    if reading.status is None:
        return "beside"
    return "no number" if math.isnan(reading.value) and reading.status == OPEN else reading.status


def number(reading: Reading) -> str:
    """The number with its interval and unit, or why there is none."""
    if math.isnan(reading.value):
        return reading.without or "no number"
    unit = f" {reading.unit}" if reading.unit else ""
    low, high = reading.value - reading.low, reading.high - reading.value
    digits = _digits(max(low, high) or abs(reading.value) * 0.02)
    value = _rounded(reading.value, digits)
    if low == high == 0.0:
        return f"{reading.value:.3g}".replace("-", "−") + unit
    if _rounded(reading.low, digits) == _rounded(reading.high, digits):
        return value + unit
    if math.isclose(low, high, rel_tol=1e-6, abs_tol=1e-12):
        return f"{value} ± {_rounded(high, digits)}{unit}"
    return f"{value} ({_rounded(reading.low, digits)} to {_rounded(reading.high, digits)}){unit}"


def _digits(spread: float) -> int:
    """Decimals that show a spread with two digits, at most four."""
    return 3 if spread <= 0.0 else min(4, max(0, 1 - math.floor(math.log10(spread))))


def _rounded(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    return text.replace("-", "−") if float(text) else text.replace("-", "")


def _required(reading: Reading) -> str:
    if reading.required is None:
        return ""
    low, high = reading.required
    unit = f" {reading.unit}" if reading.unit else ""
    if math.isinf(low):
        return f"below {high:g}{unit}"
    if math.isinf(high):
        return f"above {low:g}{unit}"
    if low == high:
        return f"{low:g}{unit}"
    return f"{low:.3g} to {high:.3g}{unit}".replace("-", "−")


def _unreached(unreached: Mapping[str, Sequence[str]]) -> str:
    rows = [[name, sentence.replace("|", "/")] for name, sentences in unreached.items() for sentence in sentences]
    return table(["sweep", "what was not reached, and why"], rows) if rows else "Everything was reached."


def _figures(figures: Sequence[Sequence[str]]) -> str:
    return "\n".join(["| file | content |", "|---|---|", *(f"| `{name}` | {title} |" for name, title in figures)])
