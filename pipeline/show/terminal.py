"""Tables on the terminal: a meshed body, any table of texts, the laws of a material."""

from pathlib import Path

from rich.table import Table

from geometry import Body
from pipeline.answers.material.page import law_rows
from pipeline.answers.material.study import Material
from pipeline.config.config import Config
from pipeline.values.table import Table as TextTable


def body_table(file: Path, config: Config, body: Body) -> Table:
    """The meshed body: volumes beside those of the drawing, what was chosen for its mesh and why, and the quality of
    the elements."""
    design, quality, halves = config.design, body.mesh.quality, 2 if body.half else 1
    table = Table.grid(padding=(0, 2))
    table.add_row("mesh", f"{file}, {'the half z >= 0' if body.half else 'the full body'}")
    table.add_row("length", f"{body.length:g} mm")
    table.add_row("solid", f"{body.volume:.7g} mm3 in the full body; from the drawing {design.solid_volume:.7g}")
    for name, tets in body.mesh.regions.items():
        meshed, drawn = halves * float(body.mesh.volumes[tets].sum()), design.region_volumes[name]
        table.add_row(f"of it {name}", f"{meshed:.7g} mm3; from the drawing {drawn:.7g}")
    for name, drawn in design.cavity_volumes.items():
        air = halves * body.mesh.enclosed_volume(name)
        table.add_row(name, f"{air:.7g} mm3 in the full body; from the drawing {drawn:.7g}")
    for name, depth in design.plug_depths.items():
        table.add_row(f"plug {name}", f"the inlet is filled with the material of the body, {depth:.4g} mm deep")
    for name, value in _chosen_values(config).items():
        table.add_row(name, f"{value}, because {config.mesh.chosen[name]}")
    table.add_row("tetrahedra", str(quality.count))
    at = ", ".join(f"{coordinate:.3g}" for coordinate in quality.position)
    table.add_row("radius ratio", f"smallest {quality.minimum:.3f} at ({at}) mm, mean {quality.mean:.3f}")
    table.add_row("edges", f"{quality.mean_edge:.3g} mm on average, at most {quality.longest_edge:.3g} mm")
    return table


def _chosen_values(config: Config) -> dict[str, str]:
    """What the program has chosen for the mesh, by the key of the section `mesh`."""
    mesh = config.mesh
    values = {"formulation": mesh.formulation, "grading": mesh.grading, "size": f"{mesh.size_mm:g} mm"}
    return {name: value for name, value in values.items() if name in mesh.chosen}


def text_table(of: TextTable) -> Table:
    """A table of texts as the report has it; a cell may have two lines."""
    table = Table(*(head.replace(" (", "\n(") for head in of.heads), box=None, padding=(0, 2, 0, 0))
    table.caption, table.caption_justify = of.caption or None, "left"
    for column in table.columns:
        column.justify = "right"
    for row in of.rows:
        table.add_row(*row)
    return table


def law_table(material: Material) -> Table:
    """All laws, the one to take first."""
    head, *rows = law_rows(material)
    table = Table(*head[:-2], head[-2].replace(" at", "\nat"), head[-1], box=None, padding=(0, 2, 0, 0))
    for number in (2, 4):
        table.columns[number].justify = "right"
    for name, constants, *numbers, why in rows:
        table.add_row(name, constants.replace(", ", "\n"), *numbers, why)
    return table
