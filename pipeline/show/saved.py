"""The last files of a run, made from its results alone: run.json and report.html, one page that opens offline.

A run that is repeated without a change keeps both.
"""

import base64
import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from pipeline.answers.rods.budget import budget_section
from pipeline.answers.rods.poses import Hand
from pipeline.results.files import read_results, save_value
from pipeline.results.verdict import verdict_of
from pipeline.show import figures, tables
from pipeline.show.body_view import body_view
from pipeline.store.result_folder import ResultFolder
from pipeline.store.state_key import ALL_SOURCES, result_key
from pipeline.store.store import Store
from pipeline.values.page import TEMPLATES as OF_ALL_PAGES
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
    reached = [state.pressure_kPa for state in run.states if state.experiment == "II" and state.reached]
    return render(
        "report.html.j2",
        TEMPLATES,
        title=f"{verdict.design}: a rod model of a pneumatic arm",
        run=run,
        arm=Hand.of(run).arm,
        verdict=verdict,
        bent=_picture(run, name_of_state("II", max(reached)) if reached else "body"),
        body=_picture(run, "body_open") or _picture(run, "body"),
        figures=figures.make_figures(run),
        tables=tables.make_tables(run),
        budget=budget_section(run),
        view=view,
        ramp=[[int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)] for colour in _RAMP],
        gradient=", ".join(_RAMP),
        config=json.dumps(run.config, indent=1, ensure_ascii=False),
    )


def _picture(run: Run, name: str) -> str:
    """A picture as PNG in base64; empty where there is none."""
    path = run.picture(name)
    return base64.b64encode(path.read_bytes()).decode() if path else ""


#: what every number is computed from, to rounding: solved states, and points of the arm's own law
_SOLVED = ("states/*", "law/*")
_KEY = "states/report.json"
#: keys of these files that differ from run to run though nothing was computed
_TIMES = ("seconds", "share_of_time")


def save_report(store: Store, run: Run) -> Run:
    """Write run.json and the report on all results, and return the results as the files have them.

    Where nothing was solved anew and no source or template has changed since the report was written, both files stay:
    they tell how long the run took when it solved something.
    """
    key = {"solved": _digest(store)}
    complete = all((store.directory / name).is_file() for name in ("run.json", "report.html"))
    if complete and store.read_json(_KEY) == key:
        return replace(run, record=read_results(store.directory).record)
    run = replace(run, record=save_value(store, "run.json", run.record))
    store.save_text("report.html", render_page(run))
    store.save_json(_KEY, key)
    return run


def save_page(directory: Path) -> None:
    """Write the report on a folder that holds a law alone."""
    ResultFolder(directory).save_text("report.html", render_page(read_results(directory)))


def _digest(store: Store) -> str:
    """sha256 of everything that decides what the report shows."""
    solved = (path for pattern in _SOLVED for path in sorted(store.directory.glob(pattern)))
    templates = sorted([*TEMPLATES.iterdir(), *OF_ALL_PAGES.iterdir()])
    digest = hashlib.sha256(result_key(store.key, ALL_SOURCES).encode())
    for path in (*templates, *(path for path in solved if path != store.directory / _KEY)):
        digest.update(path.name.encode())
        digest.update(_content(path))
    return digest.hexdigest()


def _content(path: Path) -> bytes:
    """The content of a file, that of a JSON file without times; nothing where there is no such file."""
    if not path.is_file():
        return b""
    if path.suffix != ".json":
        return path.read_bytes()
    return json.dumps(_without_times(json.loads(path.read_text(encoding="utf-8")))).encode()


def _without_times(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_times(entry) for key, entry in value.items() if key not in _TIMES}
    return [_without_times(entry) for entry in value] if isinstance(value, list) else value
