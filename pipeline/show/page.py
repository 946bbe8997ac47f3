"""The report: one HTML file that opens offline, made from the results of a run alone."""

import base64
import json
from pathlib import Path

from pipeline.answers.rods.budget import budget_section
from pipeline.answers.rods.poses import Hand
from pipeline.results.verdict import verdict_of
from pipeline.show import figures, tables
from pipeline.show.body_view import body_view
from pipeline.values.page import render
from pipeline.values.pressure import name_of_state
from pipeline.values.run import Run

#: what the page is made of beside the templates of all pages
TEMPLATES = Path(__file__).parent / "templates"
#: colours of a field on the body, from its smallest to its largest value
_RAMP = ("#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725")


def render_page(run: Run) -> str:
    """The page on a run, whose pictures are in its folder."""
    view, verdict = body_view(run), verdict_of(run)
    return render(
        "report.html.j2",
        TEMPLATES,
        title=f"{verdict.design}: a rod model of a pneumatic arm",
        run=run,
        arm=Hand.of(run).arm,
        verdict=verdict,
        bent=_picture(run, _bent_body(run)),
        body=_picture(run, "body_open") or _picture(run, "body"),
        figures=figures.make_figures(run),
        tables=tables.make_tables(run),
        budget=budget_section(run),
        view=view,
        ramp=[[int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)] for colour in _RAMP],
        gradient=", ".join(_RAMP),
        config=json.dumps(run.config, indent=1, ensure_ascii=False),
    )


def _bent_body(run: Run) -> str:
    """The name of the picture of the arm bent the most without a load."""
    reached = [state.pressure_kPa for state in run.states if state.experiment == "II" and state.reached]
    return name_of_state("II", max(reached)) if reached else "body"


def _picture(run: Run, name: str) -> str:
    """A picture as PNG in base64; empty where there is none."""
    path = run.picture(name)
    return base64.b64encode(path.read_bytes()).decode() if path else ""
