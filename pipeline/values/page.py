"""Pages that open offline: sections of sentences, lines of a configuration, tables and figures in one HTML file."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jinja2

from pipeline.values.json_values import JsonObject
from pipeline.values.plots import Panel, figure, packed_plotly
from pipeline.values.table import Table

#: what pages are made of
TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Section:
    """A part of a page in the order of its fields; what is empty is left out."""

    heading: str = ""
    link: str = ""  #: where the heading leads
    sentences: Sequence[str] = ()
    code: str = ""  #: lines of a configuration
    panels: Sequence[Panel] = ()
    table: Table | None = None
    notes: Sequence[str] = ()  #: as a list
    arm: JsonObject = field(default_factory=dict)  #: that bends under the hand, as the first picture

    @property
    def drawn(self) -> str:
        """The figure as an HTML element."""
        return figure(self.panels)


def page(title: str, *sections: Section) -> str:
    """An HTML page with sections under a title."""
    return render("page.html.j2", title=title, sections=sections)


def figure_page(title: str, panels: Sequence[Panel]) -> str:
    """An HTML page with a figure under a title."""
    return page(title, Section(panels=panels))


def render(template: str, *folders: Path, **values: Any) -> str:
    """A page by its template, which extends `page.html.j2`; folders: where to look for it and what it includes."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([TEMPLATES, *folders]),
        autoescape=True,
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template(template).render(packed_plotly=packed_plotly(), **values)
