"""The meshed body of a design as a table."""

from pathlib import Path

from geometry import Body
from pipeline.config.config import Config
from pipeline.values.table import Table


def body_table(file: Path, config: Config, body: Body) -> Table:
    """The meshed body: volumes beside those of the drawing, moduli of its materials, what was chosen for its mesh and
    why, and the quality of the elements."""
    design, quality, halves = config.design, body.mesh.quality, 2 if body.half else 1
    rows = [
        ("mesh", f"{file}, {'the half z >= 0' if body.half else 'the full body'}"),
        ("length", f"{body.length:g} mm"),
        ("solid", f"{body.volume:.7g} mm3 in the full body; from the drawing {design.solid_volume:.7g}"),
    ]
    for name, tets in body.mesh.regions.items():
        meshed, drawn = halves * float(body.mesh.volumes[tets].sum()), design.region_volumes[name]
        rows.append((f"of it {name}", f"{meshed:.7g} mm3; from the drawing {drawn:.7g}"))
    materials = {"material": config.material, **{f"materials.{name}": law for name, law in config.materials.items()}}
    rows += [(key, f"{law.law}, {law.told}") for key, law in materials.items()]
    for name, drawn in design.cavity_volumes.items():
        air = halves * body.mesh.enclosed_volume(name)
        rows.append((name, f"{air:.7g} mm3 in the full body; from the drawing {drawn:.7g}"))
    filled = "the inlet is filled with the material of the body"
    rows += [(f"plug {name}", f"{filled}, {depth:.4g} mm deep") for name, depth in design.plug_depths.items()]
    chosen = config.mesh.chosen
    values = {
        "formulation": config.mesh.formulation,
        "grading": config.mesh.grading,
        "size": f"{config.mesh.size_mm:g} mm",
    }
    rows += [(name, f"{value}, because {chosen[name]}") for name, value in values.items() if name in chosen]
    at = ", ".join(f"{coordinate:.3g}" for coordinate in quality.position)
    rows += [
        ("tetrahedra", str(quality.count)),
        ("radius ratio", f"smallest {quality.minimum:.3f} at ({at}) mm, mean {quality.mean:.3f}"),
        ("edges", f"{quality.mean_edge:.3g} mm on average, at most {quality.longest_edge:.3g} mm"),
    ]
    return Table(("", ""), tuple(rows))
