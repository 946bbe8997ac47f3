"""docs/paper.md from the claims, with docs/paper.json beside it, from which the page can be written again."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template
from textwrap import fill
from typing import Any

from benchmarks.markdown import table
from benchmarks.paper.claims.common import SAME, STRAIGHT
from benchmarks.paper.claims.rigidities import SLOPE_BY_PROCESS, SLOPE_OF_ONE_RIGIDITY, SUBTRACTED
from benchmarks.paper.data import LAWS
from benchmarks.paper.estimates import LENGTH_SCALE, PROCESS
from benchmarks.paper.reading import CONTRADICTED, FAILS, HOLDS, OPEN, Claim, Reading, claim_from_record

TEMPLATE = Path(__file__).with_name("page.md")
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
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        provenance=fill(record["provenance"], WIDTH),
        folder=record["folder"],
        scale=f"{LENGTH_SCALE:g}",
        straight=f"{100 * STRAIGHT:g}",
        same=f"{100 * SAME:g}",
        overview=_overview(claims),
        follows=_follows(claims),
        readings="\n\n".join(_details(claim) for claim in claims if claim.readings),
        unreached=_unreached(record["unreached"]),
        figures=_figures(record["figures"]),
    )


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


def _follows(claims: Sequence[Claim]) -> str:
    """What the numbers say together; a sentence stands here only if the numbers show it."""
    by_number = {claim.number: claim for claim in claims}
    sentences = [
        _of_force(by_number["16"]),
        _of_law(by_number["1a"], by_number["15"]),
        _of_zone(by_number["9"]),
        _of_sign(by_number["6b"]),
        _of_single_cavities(by_number["8a"]),
    ]
    shown = [sentence for sentence in sentences if sentence]
    return "## What follows\n\n" + "\n\n".join(fill(sentence, WIDTH) for sentence in shown) if shown else ""


def _by_law(claim: Claim, start: str) -> dict[str, Reading]:
    return {r.law: r for r in claim.readings if r.what.startswith(start)}


def _of_force(claim: Claim) -> str:
    readings = _by_law(claim, "F_y at rest height")
    if "svk" not in readings or readings["svk"].status != HOLDS:
        return ""
    parts = [f"{abs(100.0 * (r.value - 1.0)):.1f} % (`{law}`)" for law, r in readings.items()]
    return (
        f"**The end force of the paper's own experiment is met within {parts[0]}**"
        + (f", and within {parts[1]}" if len(parts) > 1 else "")
        + ". Dimensions, material and height of the end had been fixed before this force was compared."
    )


def _of_law(curvature: Claim, scaling: Claim) -> str:
    status = {law: r.status for law, r in _by_law(curvature, "off a line").items()}
    scaled = {law: {r.status for r in scaling.readings if r.law == law} for law in LAWS}
    if status != {"svk": FAILS, "hencky": HOLDS} or FAILS not in scaled["svk"] or scaled["hencky"] != {HOLDS}:
        return ""
    return (
        "**κ₀ proportional to p, and with it eq. (9), comes with `hencky`, not with `svk`.** Inference: the paper "
        "names St. Venant-Kirchhoff material and used a program with large displacements; what such programs call "
        "elastic is close to linear in the logarithmic strain. The end force (claim 16) speaks for `svk`: the question "
        "stays open."
    )


def _of_zone(claim: Claim) -> str:
    printed = [r for r in claim.readings if r.estimator in ("paper_cells", PROCESS) and r.status == HOLDS]
    control = _by_law(claim, "d/l that the process").get("svk")
    zone = _by_law(claim, "d of the default").get("svk")
    own = [r for r in claim.readings if r.estimator == "default" and r.status == FAILS]
    required = printed[0].required if printed else None
    if (
        control is None
        or zone is None
        or not own
        or required is None
        or not required[0] <= control.value <= required[1]
    ):
        return ""
    return (
        "**d/l = 0.13 belongs to the smoothing, not to the arm.** Means over a pitch and a Gaussian process print it, "
        f"and the process, whose length scale was chosen because it prints 0.13, prints {control.value:.3f} for a rod "
        f"that has one rigidity everywhere. The default puts the end of the softer zone at {number(zone)} from the "
        "clamp; the range is that over the pressures, and the uncertainty of d at each of them is larger."
    )


def _of_sign(claim: Claim) -> str:
    starts = (f"{SLOPE_BY_PROCESS}, {SUBTRACTED[0]} subtracted", SLOPE_OF_ONE_RIGIDITY)
    chord, single = (_by_law(claim, start).get("svk") for start in starts)
    if chord is None or single is None or not (chord.high < 0.0 and single.value < 0.0):
        return ""
    return (
        "**The paper's α₁ may be negative** (inference). `paper_process`, which prints its d/l, gives a negative slope "
        "next to the clamp that falls with p, as Fig. 15 (b) has it; eq. (10) names the limits ±∞ and ±0; no sign is "
        "printed. The same process gives a rod with one rigidity a negative slope: the smoothing makes it. "
        + _of_subtraction(claim)
    )


def _of_subtraction(claim: Claim) -> str:
    readings = [_by_law(claim, f"{SLOPE_BY_PROCESS}, {name} subtracted").get("svk") for name in SUBTRACTED]
    if any(reading is None for reading in readings):
        return ""
    parts = [f"{number(r)} ({name})" for name, r in zip(SUBTRACTED, readings, strict=True) if r is not None]
    return (
        f"It depends on what is subtracted from the coordinates before they become a process: {', '.join(parts)}, at "
        "17 to 37 kPa. A process has the mean zero, and next to the clamp, where data lie on one side alone, the curve "
        "bends towards whatever was subtracted."
    )


def _of_single_cavities(claim: Claim) -> str:
    counted = [r for r in claim.readings if r.status not in (None, OPEN)]
    if not claim.verdict.startswith(CONTRADICTED):
        return ""
    return (
        "**α₂ of the arms with one cavity along the axis rises here**, in all "
        f"{len(counted)} test numbers that are not open, where the paper's falls. The paper prints no dimension of "
        "these arms; its bodies may be others."
    )


def _unreached(unreached: Mapping[str, Sequence[str]]) -> str:
    rows = [[name, sentence.replace("|", "/")] for name, sentences in unreached.items() for sentence in sentences]
    return table(["sweep", "what was not reached, and why"], rows) if rows else "Everything was reached."


def _figures(figures: Sequence[Sequence[str]]) -> str:
    return "\n".join(["| file | content |", "|---|---|", *(f"| `{name}` | {title} |" for name, title in figures)])
