"""What the report says about the mesh: what was chosen and why, and how long its edges are."""

from pipeline.report.formatting import number, percent
from pipeline.report.results import Results

#: volume of the mesh over that of the drawing, minus 1, from which the difference is told
VOLUME_DIFFERS = 1e-3
#: names of the choices in a sentence, with the unit of their values
_CHOICES = {"formulation": "elements", "grading": "grading", "size": "size"}


def mesh_sentences(results: Results) -> list[str]:
    """Elements, size and edges of the mesh, and the reasons for what the program chose; empty in older files."""
    mesh = results.run.get("mesh")
    if not mesh:
        return []
    sentences = [
        f"Mesh: {mesh['elements']} {mesh['formulation']} elements, {_graded(mesh['grading'])}; mesh.size is "
        f"{number(mesh['size_mm'])} mm, the edges are {mesh['mean_edge_mm']:.2g} mm long on average and "
        f"{mesh['longest_edge_mm']:.2g} mm at most."
    ]
    values = {"formulation": mesh["formulation"], "grading": mesh["grading"], "size": f"{number(mesh['size_mm'])} mm"}
    sentences += [
        f"Chosen by the program: {name} {values[key]}, because {mesh['chosen'][key]}."
        for key, name in _CHOICES.items()
        if key in mesh["chosen"]
    ]
    differs = mesh["volume_over_drawing"] - 1.0
    if abs(differs) > VOLUME_DIFFERS:
        sentences.append(f"The volume of the mesh differs from that of the drawing by {percent(differs)}.")
    return sentences


def _graded(grading: str) -> str:
    return "of one size" if grading == "off" else f"smaller at the {grading}"
