"""Tables on the terminal, among them those of a body and of a study of effects."""

from collections.abc import Sequence
from pathlib import Path

from rich import table as rich_table

from geometry import Body
from pipeline.config.config import Config
from pipeline.study.effects.rows import COLUMNS, EffectRow
from pipeline.study.effects.table import _OTHER_STATES, _costs, _number
from pipeline.values.table import Table

#: a table with so many columns or more has less space between them
CLOSE = 10


def body_table(file: Path, config: Config, body: Body) -> Table:
    """The meshed body: volumes beside those of the drawing, what was chosen for its mesh and why, and the quality of
    the elements."""
    design, quality, halves = config.design, body.mesh.quality, 2 if body.half else 1
    rows = [
        ("mesh", f"{file}, {'the half z >= 0' if body.half else 'the full body'}"),
        ("length", f"{body.length:g} mm"),
        ("solid", f"{body.volume:.7g} mm3 in the full body; from the drawing {design.solid_volume:.7g}"),
    ]
    for name, tets in body.mesh.regions.items():
        meshed, drawn = halves * float(body.mesh.volumes[tets].sum()), design.region_volumes[name]
        rows.append((f"of it {name}", f"{meshed:.7g} mm3; from the drawing {drawn:.7g}"))
    for name, drawn in design.cavity_volumes.items():
        air = halves * body.mesh.enclosed_volume(name)
        rows.append((name, f"{air:.7g} mm3 in the full body; from the drawing {drawn:.7g}"))
    filled = "the inlet is filled with the material of the body"
    rows += [(f"plug {name}", f"{filled}, {depth:.4g} mm deep") for name, depth in design.plug_depths.items()]
    chosen = config.mesh.chosen
    rows += [(name, f"{value}, because {chosen[name]}") for name, value in _chosen_values(config).items()]
    at = ", ".join(f"{coordinate:.3g}" for coordinate in quality.position)
    rows += [
        ("tetrahedra", str(quality.count)),
        ("radius ratio", f"smallest {quality.minimum:.3f} at ({at}) mm, mean {quality.mean:.3f}"),
        ("edges", f"{quality.mean_edge:.3g} mm on average, at most {quality.longest_edge:.3g} mm"),
    ]
    return Table(("", ""), tuple(rows))


def _chosen_values(config: Config) -> dict[str, str]:
    """What the program has chosen for the mesh, by the key of the section `mesh`."""
    mesh = config.mesh
    values = {"formulation": mesh.formulation, "grading": mesh.grading, "size": f"{mesh.size_mm:g} mm"}
    return {name: value for name, value in values.items() if name in mesh.chosen}


def text_table(of: Table) -> rich_table.Table:
    """A table for the terminal; a cell may have several lines, and columns without numbers begin at the left."""
    heads = [head.replace(" (", "\n(") for head in of.heads]
    padding = (0, 2 if len(heads) < CLOSE else 1, 0, 0)
    table = rich_table.Table(*heads, box=None, padding=padding, show_header=any(heads))
    table.caption, table.caption_justify = of.caption or None, "left"
    for number, column in enumerate(table.columns):
        column.justify = "left" if number in of.words else "right"
    for row in of.rows:
        table.add_row(*row)
    return table


def effects_table(rows: Sequence[EffectRow]) -> Table:
    """Every number above its change against the configuration, and the cost; it fits into 80 columns."""
    titles = [title.replace(" ", "\n", 1) for title in COLUMNS.values()]
    heads = ("effect", "p\nkPa", *titles, "single\nline", "CPU\ns", "facto-\nriza-\ntions")
    caption = "single line: whether one slope describes the arm as well as two"
    if any(row["other_states"] for row in rows):
        caption += f"\n{_OTHER_STATES} reached more or fewer states than as configured, so the costs differ"
    cells, previous = [], ""
    for row in rows:
        name = f"{row['effect']} {row['state']}".strip().replace("_", " ")
        first, previous = name != previous, name
        suffices = {True: "yes", False: "no", None: ""}[row["single_line_suffices"]]
        numbers = [_number(row, row[key], key) for key in COLUMNS]
        cost = _costs(row) if first else ("", "")
        cells.append((name if first else "", f"{row['pressure_kPa']:g}", *numbers, suffices, *cost))
    return Table(heads, tuple(cells), caption)
